"""Time integration against acceptance.md, fractional 4 and 7, and against model.md."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import racs_bif as rb

ROOT = 0.49290598 + 8.93656849j  # model.md, u = 12
RANGE, PERIOD = 0.1593671, 0.7393668  # harmonic balance of the exact operator, u = 12


@pytest.fixture(scope="module")
def torvik():
    return rb.model_from_strings(
        "torvik",
        {"y": "z", "z": "f - w/2 - y/2"},
        parameters={"f": 0.0},
        elements=[("w", "z", "s**0.5")],
    )


@pytest.fixture(scope="module")
def vehicle():
    return rb.load_model("racs", parameters={"u": 12})


# Digits that a step of 1/256 s gives: orders 2, 2 and 1.5, then 3, 3 and 2 by extrapolation.
@pytest.mark.parametrize(
    ("method", "extrapolate", "digits"),
    [
        ("bdf2", False, 4e-5),
        ("bdf2", True, 1.5e-7),
        ("fast", True, 1.5e-7),
        ("l1", False, 1.2e-4),
        ("l1", True, 3e-5),
    ],
)
def test_bagley_and_torvik(torvik, method, extrapolate, digits):
    done = rb.simulate(
        torvik,
        20.0,
        method=method,
        inputs={"f": {0.0: 8.0, 1.0: 0.0}},
        step=1.0 / 256.0,
        extrapolate=extrapolate,
    )
    at = [np.flatnonzero(done.times == t)[0] for t in (1.0, 5.0, 10.0, 20.0)]
    exact = np.array([2.952583880, 2.943935664, -2.848380869, -1.484329464])
    assert done.column("y")[at] == pytest.approx(exact, abs=digits)
    if not extrapolate and method == "bdf2":
        worst = np.abs(done.column("y")[at] - exact).max()
        assert done.errors["y"] == pytest.approx(worst, rel=0.5)


@pytest.mark.parametrize(
    ("q", "k", "exact"),
    [(0.5, 1.0, 0.4275835762), (0.7, 2.0, 0.2137867270), (1.5, 3.0, -0.1755653738)],
)
def test_mittag_leffler(q, k, exact):
    model = rb.model_from_strings(
        "relaxation", {}, parameters={"k": k}, elements=[("x", "-k*x", f"s**(-{q})")]
    )
    done = rb.simulate(model, 1.0, initial={"x": 1.0}, step=1.0 / 512.0, extrapolate=True)
    assert done.column("x")[-1] == pytest.approx(exact, abs=1e-7)


def test_the_growth_rate_is_that_of_the_exact_root(vehicle):
    done = rb.simulate(
        vehicle,
        7.0,
        history="equilibrium",
        initial={"ddelta_c": 1e-5},
        step=0.002,
        extrapolate=True,
    )
    late = done.times > 2.0
    x = done.column("delta_c") - done.column("delta_c")[0]
    curve = CubicSpline(done.times[late], x[late])
    turning = curve.derivative().roots(extrapolate=False)
    growth = np.polyfit(turning, np.log(np.abs(curve(turning))), 1)[0]
    assert growth == pytest.approx(ROOT.real, abs=1e-4)
    assert np.pi / np.diff(turning).mean() == pytest.approx(ROOT.imag, abs=1e-4)


def test_the_limit_cycle_of_the_exact_operator(vehicle):
    ranges, periods = [], []
    for step in (0.004, 0.002):
        done = rb.simulate(
            vehicle,
            14.0,
            method="fast",
            history="equilibrium",
            initial={"ddelta_c": 0.65},
            step=step,
        )
        low, high = done.extremes("delta_c", after=10.0)
        ranges.append(high - low)
        periods.append(done.period("delta_c", after=10.0))
    # Means decay algebraically and take the range a little with them.
    assert ranges[1] == pytest.approx(RANGE, rel=2e-4)
    period = periods[1] + (periods[1] - periods[0]) / 3.0
    assert period == pytest.approx(PERIOD, rel=1e-5)


def test_the_limit_cycle_of_a_realisation_with_a_wide_band():
    vehicle = rb.load_model("racs", parameters={"u": 12}, band=(1e-3, 1e4))
    done = rb.simulate(
        vehicle,
        14.0,
        operator="realised",
        history="equilibrium",
        initial={"ddelta_c": 0.65},
        step=0.004,
    )
    low, high = done.extremes("delta_c", after=10.0)
    assert high - low == pytest.approx(RANGE, rel=3e-4)
    assert done.period("delta_c", after=10.0) == pytest.approx(PERIOD, rel=1e-5)


def test_bagley_and_torvik_to_nine_digits(torvik):
    done = rb.simulate(
        torvik,
        20.0,
        method="bdf2",
        inputs={"f": {0.0: 8.0, 1.0: 0.0}},
        step=1.0 / 1024.0,
        extrapolate=True,
    )
    at = [np.flatnonzero(done.times == t)[0] for t in (1.0, 5.0, 10.0, 20.0)]
    exact = np.array([2.952583880, 2.943935664, -2.848380869, -1.484329464])
    assert done.column("y")[at] == pytest.approx(exact, abs=2.5e-9)
