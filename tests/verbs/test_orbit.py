"""One orbit by either way, from a history, and cascades of doublings."""

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.errors import ConvergenceError, UsageError
from racs_bif.results.cascade import FEIGENBAUM, Cascade

OSCILLATOR = {"x": "y", "y": "mu*(1 - x**2)*y - x"}


@pytest.fixture(scope="module")
def oscillator():
    return rb.model_from_strings(
        "oscillator", OSCILLATOR, parameters={"mu": 5.0}, guess={"x": 0.0, "y": 0.0}
    )


def test_the_orbit_of_the_vehicle_at_a_speed():
    system = rb.load_model("racs")
    orbit = rb.find_orbit(system, "u", 12.0, method="harmonic-balance")
    assert len(orbit) == 1
    assert orbit.labels == ("UZ",)
    assert orbit["UZ1"].period == pytest.approx(0.7393668, abs=1e-7)
    assert orbit.column("max delta_c")[0] == pytest.approx(0.0754349, abs=2e-7)
    assert orbit.column("min delta_c")[0] == pytest.approx(-0.0839322, abs=2e-7)
    assert orbit.stable[0]
    assert "Followed from H1 at u = 10.2" in orbit.stopped
    assert not orbit.early


def test_an_orbit_that_no_hopf_point_leads_to_is_simulated(oscillator):
    orbit = rb.find_orbit(oscillator, "mu")
    assert orbit["UZ1"].period == pytest.approx(11.61223066772, rel=1e-6)
    assert "tail of a simulation" in orbit.stopped
    with pytest.raises(ConvergenceError, match=r"no Hopf point from 0\.5 to 50"):
        rb.find_orbit(oscillator, "mu", start="hopf")
    with pytest.raises(UsageError, match="unknown start 'hop'; did you mean 'hopf'"):
        rb.find_orbit(oscillator, "mu", start="hop")


def test_both_ways_that_fail_are_told():
    still = rb.model_from_strings("still", {"x": "-k*x"}, parameters={"k": 1.0}, guess={"x": 0.0})
    with pytest.raises(ConvergenceError, match=r"no Hopf point .* simulated: nothing swings"):
        rb.find_orbit(still, "k")


@pytest.mark.parametrize("method", ["collocation", "shooting", "harmonic-balance"])
def test_an_orbit_from_a_history_is_continued(oscillator, method):
    history = rb.simulate(
        oscillator, 100.0, initial={"x": 0.5}, inputs={"mu": {0.0: 5.0, 20.0: 1.0}}
    )
    orbit = rb.orbit_from_history(history, method=method, model=oscillator)
    assert orbit["UZ1"].parameters["mu"] == 1.0  # as it is in the end
    assert orbit["UZ1"].period == pytest.approx(6.6632868593231, rel=1e-6)
    assert orbit["UZ1"].tail < 1e-3
    branch = rb.continue_orbits(orbit["UZ1"], (0.9, 1.1))
    assert branch.method == method
    assert branch.parameter[[0, -1]] == pytest.approx([0.9, 1.1])


def test_an_exact_history_of_the_vehicle_gives_the_orbit_of_its_realisation():
    system = rb.load_model("racs", parameters={"u": 12.0})
    history = rb.simulate(system, 8.0, initial={"delta_c": 0.07}, history="equilibrium", step=0.02)
    orbit = rb.orbit_from_history(history, "u")
    assert orbit["UZ1"].period == pytest.approx(0.7393575, abs=1e-6)


def test_histories_that_have_no_orbit_say_why(oscillator):
    moving = rb.simulate(
        oscillator, 60.0, initial={"x": 0.5}, inputs={"mu": lambda t: 1.0 + 0.01 * t}
    )
    with pytest.raises(UsageError, match="'mu' still moves"):
        rb.orbit_from_history(moving, model=oscillator)
    damped = rb.simulate(
        rb.load_model("brusselator", parameters={"B": 1.2}),
        80.0,
        history="equilibrium",
        initial={"x": 1.1},
    )
    with pytest.raises(UsageError, match=r"does not repeat|at rest"):
        rb.orbit_from_history(damped)
    with pytest.raises(UsageError, match="made in Python"):
        rb.orbit_from_history(rb.simulate(oscillator, 50.0, initial={"x": 0.5}))


# ------------------------------------------------------------------------------------- cascades


@pytest.fixture(scope="module")
def hopf():
    system = rb.load_model("roessler", parameters={"a": 0.1, "b": 2.0, "c": 4.0})
    found = rb.all_equilibria(system, "a", (0.05, 0.45), probes=2)
    return next(p for p in found.special_points if p.label == "H")


def test_a_cascade_is_followed_to_its_depth(hopf):
    cascade = rb.period_doubling_cascade(hopf, 4, span=(0.05, 0.45))
    assert [branch.name for branch in cascade.branches] == ["PO1", "PO2", "PO3", "PO4"]
    expected = [0.334856622297, 0.374757965549, 0.383333655996, 0.38515480077]
    assert cascade.values == pytest.approx(expected, rel=1e-6)
    periods = [point.period for point in cascade.doublings]
    assert np.divide(periods[1:], periods[:-1]) == pytest.approx([2, 2, 2], rel=0.01)
    assert cascade.ratios == pytest.approx([4.6528, 4.709], rel=1e-3)
    limit, error = cascade.limit
    assert abs(limit - 0.3856514) < error < 1e-4
    assert "ratio 4.65" in repr(cascade)
    assert len(cascade.diagram) == 4
    assert "is reached" in cascade.stopped


def test_a_cascade_that_ends_says_where(hopf):
    cascade = rb.period_doubling_cascade(hopf, 3, span=(0.05, 0.36))
    assert len(cascade.doublings) == 1
    assert "PO2 has no period doubling from 0.05 to 0.36" in cascade.stopped
    with pytest.raises(UsageError, match="1 of 3 doublings do not tell"):
        _ = cascade.limit
    with pytest.raises(UsageError, match="depth of at least 1"):
        rb.period_doubling_cascade(hopf, 0)


def test_ratios_of_a_perfect_cascade(hopf):
    branch = rb.continue_orbits(hopf, (0.05, 0.36), method="collocation")
    point = branch["PD1"]
    from dataclasses import replace

    values = 1.0 - FEIGENBAUM ** -np.arange(4.0)
    points = tuple(replace(point, parameters={"a": value}) for value in values)
    cascade = Cascade((branch,), points, "")
    assert cascade.ratios == pytest.approx([FEIGENBAUM, FEIGENBAUM])
    assert cascade.limit[0] == pytest.approx(1.0)
