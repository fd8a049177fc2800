"""Nyquist curves."""

import matplotlib.pyplot as plt
import numpy as np
import pytest

import racs_bif as rb
from racs_bif.errors import UsageError
from racs_bif.plots.nyquist import draw, picture


@pytest.fixture(scope="module")
def vehicle():
    return rb.load_model("racs", parameters={"u": 10.2})


def test_at_the_hopf_point_the_curve_goes_through_the_cross(vehicle):
    figure, ax = plt.subplots()
    assert draw(rb.loop_response(vehicle, omega=np.geomspace(1, 100, 2001)), ax=ax) is ax
    curves = [line for line in ax.get_lines() if len(line.get_xdata()) == 2001]
    x, y = curves[0].get_data()
    assert np.hypot(x + 1.0, y).min() < 1e-3
    assert ax.get_aspect() == 1.0
    plt.close(figure)


def test_the_realised_loop_lies_on_the_exact_one(vehicle):
    figure = picture(rb.loop_response(vehicle), rb.loop_transfer(vehicle), limit=2.5)
    ax = figure.axes[0]
    assert ax.get_xlim() == (-2.5, 2.5)
    labels = [text.get_text() for text in ax.get_legend().get_texts()]
    assert labels == ["exact", "realised"]


def test_loops_have_one_input_and_one_output(vehicle):
    with pytest.raises(UsageError, match="outputs"):
        picture(rb.frequency_response(vehicle))
