"""How rectangles are searched for roots; what is found in them is in test_roots.py."""

import numpy as np

from racs_bif.fractional import search
from racs_bif.fractional.characteristic import Characteristic
from racs_bif.fractional.laws import PowerSum


def test_a_box_is_cut_near_its_middle():
    """Whichever cut is taken, as roots lie on those before it: both parts are smaller."""
    for fraction in search._CUTS:
        assert 0.3 < fraction < 0.7


def test_nothing_in_a_rectangle():
    one, s = PowerSum(np.ones(1), np.zeros(1)), PowerSum(np.ones(1), np.ones(1))
    found = search.zeros_in_rectangle(Characteristic([s], [one], [[2.0]]), -1.0 - 1.0j, 0.5 + 1.0j)
    assert len(found.t) == len(found.errors) == len(found.multiplicities) == 0
