"""Phase response curves: an exact one, kicks that are simulated, and every discretisation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import racs_bif as rb
from racs_bif.errors import UsageError
from racs_bif.orbits import collocated_from_samples
from racs_bif.orbits.phase_response import phase_response
from racs_bif.shelf.load import system_of

LAM, SHEAR = 0.49, 0.8


@pytest.fixture(scope="module")
def clock():
    """Stuart-Landau with shear: r' = (lam - r^2) r, phi' = 1 + b (r^2 - lam), r = lam^(1/2)."""
    model = rb.model_from_strings(
        "clock",
        {
            "x": "lam*x - (1 - b*lam)*y - (x + b*y)*(x**2 + y**2)",
            "y": "lam*y + (1 - b*lam)*x - (y - b*x)*(x**2 + y**2)",
        },
        parameters={"lam": -0.5, "b": SHEAR},
        guess={"x": 0.0, "y": 0.0},
    )
    return rb.continue_equilibria(model, "lam", (-0.5, 1.0))["H1"]


def exact(orbit):
    """Return the gradient of the phase phi + b log r, which grows by 1 everywhere."""
    x, y = orbit
    r2 = x**2 + y**2
    return np.stack((-y + SHEAR * x, x + SHEAR * y)) / r2


@pytest.mark.parametrize("method", ["shooting", "collocation", "harmonic-balance"])
def test_exact_response_of_a_clock_with_shear(clock, method):
    point = rb.continue_orbits(clock, (-0.5, 0.6), method=method, at=[LAM])["UZ1"]
    found = rb.phase_response(point)
    assert found.states == ("x", "y")
    assert found.period == pytest.approx(2.0 * np.pi, rel=1e-9)
    np.testing.assert_allclose(found.profile, exact(found.orbit), rtol=0.0, atol=1e-8)
    np.testing.assert_allclose(found.radians, found.profile, rtol=1e-9)
    assert np.abs(found.profile - exact(found.orbit)).max() < 10.0 * found.error < 1e-6
    assert not found.realised


def van_der_pol(m, period):
    """Compute the response of a van der Pol orbit, from a simulation."""
    model = rb.model_from_strings(
        "van_der_pol", {"x": "y", "y": "m*(1 - x**2)*y - x"}, parameters={"m": m}
    )
    system = system_of(model)
    run = solve_ivp(
        lambda t, x: system.field.f(x, system.values),
        (0.0, 200.0),
        [2.0, 0.0],
        rtol=1e-10,
        atol=1e-10,
        dense_output=True,
    )
    times = np.linspace(0.0, period, 2001)
    profile = run.sol(150.0 + times)
    start = collocated_from_samples(system.field, system.path("m"), times, profile, m)
    return phase_response(start.problem, start.z), system


def test_kicks_that_are_simulated():
    """A kick of 1e-4, some periods of waiting, and the time of the next crossing."""
    found, _ = van_der_pol(1.0, 6.6632868593231)
    assert found.error < 1e-6

    def rates(t, x):
        return [x[1], (1.0 - x[0] ** 2) * x[1] - x[0]]

    def crossing(t, x):
        return x[0] - 1.0

    crossing.direction = 1.0

    def passage(start):
        options = {"events": crossing, "rtol": 1e-12, "atol": 1e-13, "method": "DOP853"}
        run = solve_ivp(rates, (0.0, 8.2 * found.period), start, **options)
        return run.t_events[0]

    kick = 1e-4
    for place in (30, 145, 290):
        start, z = found.orbit[:, place], found.profile[:, place]
        for state in np.eye(2):
            ahead, behind = passage(start + kick * state), passage(start - kick * state)
            advance = (behind[6] - ahead[6]) / (2.0 * kick)
            assert advance == pytest.approx(float(z @ state), rel=1e-5, abs=1e-6)


def test_error_is_that_of_the_curve():
    """A relaxation oscillation, whose response has a spike."""
    found, system = van_der_pol(5.0, 11.61223066772)
    assert found.period == pytest.approx(11.61223066772, rel=1e-9)
    assert found.error < 1e-4
    rates = system.field.f(found.orbit, system.values)
    np.testing.assert_allclose(np.sum(found.profile * rates, axis=0), 1.0, atol=1e-4)


def test_only_a_stable_orbit_has_a_phase(clock):
    model = rb.model_from_strings(
        "subcritical",
        {"x": "m*x - y + x*(x**2 + y**2)", "y": "x + m*y + y*(x**2 + y**2)"},
        parameters={"m": -0.5},
        guess={"x": 0.0, "y": 0.0},
    )
    hopf = rb.continue_equilibria(model, "m", (-0.5, 0.5))["H1"]
    point = rb.continue_orbits(hopf, (-0.5, 0.5), at=[-0.2])["UZ1"]
    with pytest.raises(UsageError, match="UZ1 is not stable"):
        rb.phase_response(point)
    with pytest.raises(UsageError, match="H1 is no orbit"):
        rb.phase_response(clock)
    with pytest.raises(UsageError, match="loaded from a file"):
        rb.phase_response(replace(point, origin=None))
