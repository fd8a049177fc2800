"""Brute-force sweeps, against orbits with known amplitude."""

from __future__ import annotations

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.errors import UsageError
from racs_bif.verbs.sweep import sweep, turning_points


@pytest.fixture(scope="module")
def hopf():
    """The normal form of a supercritical Hopf point: an orbit of radius sqrt(mu)."""
    return rb.model_from_strings(
        "normal_form",
        {"x": "mu*x-y-x*(x**2+y**2)", "y": "x+mu*y-y*(x**2+y**2)"},
        parameters={"mu": 0.5},
    )


def test_amplitude_is_that_of_the_orbit(hopf):
    told = []
    found = sweep(
        hopf,
        "mu",
        [-0.5, -0.02, 0.25, 1.0],
        quantity="x",
        initial={"x": 0.5},
        duration=60.0,
        kept=20.0,
        progress=told.append,
    )
    assert found.amplitude[2:] == pytest.approx([0.5, 1.0], rel=1e-4)
    assert found.ways == ("rest", "dying", "oscillating", "oscillating")
    assert found.stretches == [
        (-0.5, -0.5, "rest"),
        (-0.02, -0.02, "dying"),
        (0.25, 1.0, "oscillating"),
    ]
    assert np.ptp(np.abs(found.turns[3])) < 1e-4
    assert max(told) <= 1.0 + 1e-12


def test_samples_without_extremes_keep_their_last():
    assert turning_points(np.array([3.0, 2.0, 1.0])).tolist() == [1.0]
    assert len(turning_points(np.array([1.0, np.nan, 2.0]))) == 0


@pytest.mark.parametrize("wrong", [{"quantity": "z"}, {"quantity": "x", "kept": 61.0}])
def test_what_cannot_be_swept(hopf, wrong):
    with pytest.raises(UsageError, match="a sweep must watch a state"):
        sweep(hopf, "mu", [0.1], duration=60.0, **wrong)
