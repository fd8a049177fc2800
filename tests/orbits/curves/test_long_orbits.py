"""Homoclinic curves: one known exactly, and one that leaves a Bogdanov-Takens point."""

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.continuation.settings import StepSettings
from racs_bif.errors import UsageError

STEPS = StepSettings(maximum=0.1, angle=0.3, tolerance=1e-8)


@pytest.fixture(scope="module")
def orbits():
    """H = y^2/2 - x^2/2 + x^3/3 is constant on H = 0 where a = b: a homoclinic orbit for all a."""
    model = rb.model_from_strings(
        "loop",
        {"x": "y", "y": "x-x**2+y*(k*(y**2/2-x**2/2+x**3/3)+a-b)"},
        parameters={"k": 1.0, "a": 0.15, "b": 0.0},
        guess={"x": 1.0, "y": 0.0},
    )
    hopf = rb.continue_equilibria(model, "a", (-0.5, 0.5))["H1"]
    return rb.continue_orbits(hopf, method="collocation")


def test_the_shift_says_how_far_the_homoclinic_orbit_is(orbits):
    spans = {"a": (-0.5, 0.5), "b": (-0.3, 0.3)}
    curve = rb.continue_curve(
        orbits.special[-1], ("a", "b"), spans, kind="homoclinic", settings=STEPS
    )
    apart = curve.values[:, 0] - curve.values[:, 1]
    assert curve.values[[0, -1], 1] == pytest.approx([-0.3, 0.3])
    assert 1e-9 < apart.max() < 1e-5
    assert curve.measures["shift"] == pytest.approx(apart, rel=1e-2)
    assert np.ptp(curve.measures["period"]) == 0.0


def test_a_homoclinic_orbit_leaves_a_bogdanov_takens_point():
    model = rb.model_from_strings(
        "bt",
        {"x": "y", "y": "b1+b2*x+x**2-x*y"},
        parameters={"b1": -0.1, "b2": -0.1},
        guess={"x": -0.3, "y": 0.0},
    )
    fold = rb.continue_equilibria(model, "b1", (-1, 1))["LP1"]
    spans = {"b1": (-1.0, 1.0), "b2": (-0.5, 0.5)}
    folds = rb.continue_curve(fold, ("b1", "b2"), spans)
    bt = next(point for point in folds.special if point.label == "BT")
    curve = rb.continue_curve(bt, ("b1", "b2"), spans, kind="homoclinic", settings=STEPS)
    good = np.abs(curve.measures["shift"]) < 1e-9
    b1, b2 = curve.values[good].T
    smallest = np.argmax(b2)
    # b1 = -6/25 b2^2 + ... (Kuznetsov, section 8.4)
    assert b2[smallest] > -0.06
    assert b1[smallest] / b2[smallest] ** 2 == pytest.approx(-0.24, rel=0.01)


def test_other_points_start_none(orbits):
    hopf = orbits.special[0].origin
    assert hopf is not None
    model = rb.load_model("brusselator")
    point = rb.continue_equilibria(model, "B", (1, 4))["H1"]
    with pytest.raises(UsageError, match="orbit of long period or at BT, not H1"):
        rb.continue_curve(point, ("B", "A"), kind="homoclinic")
