"""Branches of equilibria that cross, and those that nothing leads to."""

from __future__ import annotations

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.continuation import StepSettings
from racs_bif.verbs.equilibria import as_branch, equilibrium_problem, follow


def states_at(diagram, parameter, value, state):
    """Return the values of a state where branches pass a value of the parameter, sorted."""
    found = []
    for branch in diagram:
        x, y = branch.column(parameter), branch.column(state)
        for a, b, ya, yb in zip(x[:-1], x[1:], y[:-1], y[1:], strict=True):
            if min(a, b) < value <= max(a, b):
                found.append(ya + (yb - ya) * (value - a) / (b - a))
    return np.sort(found)


@pytest.fixture(scope="module")
def vehicle():
    return rb.all_equilibria(rb.load_model("racs"), "u", (5, 30))


def test_the_vehicle_has_five_equilibria_below_20_9_metres_a_second(vehicle):
    delta = states_at(vehicle, "u", 20.0, "delta_c")
    assert len(delta) == 5
    assert np.all(np.abs(delta[[0, 1, 3, 4]]) > 0.13)
    assert abs(delta[2]) < 0.01
    assert len(states_at(vehicle, "u", 25.0, "delta_c")) == 3
    assert len(states_at(vehicle, "u", 29.0, "delta_c")) == 1


def test_their_folds_and_hopf_points_are_where_they_were_computed(vehicle):
    folds = sorted(p.parameters["u"] for p in vehicle.special_points if p.label == "LP")
    assert folds == pytest.approx([20.89, 28.10], abs=0.01)  # model.md, section 4
    hopf = [p.exact.parameters["u"] for p in vehicle.special_points if p.label == "H"]
    assert hopf[0] == pytest.approx(10.2, rel=1e-9)
    assert all(7.0 < u < 7.15 for u in hopf[1:])
    assert len(hopf) == 3


def test_the_first_branch_is_the_one_through_the_guess(vehicle):
    assert [branch.connected for branch in vehicle] == [True, False, False]
    assert abs(vehicle["EQ1"].column("delta_c")).max() < 0.01


def test_a_pitchfork_leads_to_its_other_branch():
    model = rb.model_from_strings(
        "pitchfork", {"x": "p*x-x**3"}, parameters={"p": -1.0}, guess={"x": 0.0}
    )
    diagram = rb.all_equilibria(model, "p", (-1, 1), probes=0)
    points = [p for p in diagram.special_points if p.label == "BP"]
    assert points[0].parameters["p"] == pytest.approx(0.0, abs=1e-9)
    assert points[0].kind == "pitchfork"
    assert states_at(diagram, "p", 0.49, "x") == pytest.approx([-0.7, 0.0, 0.7], abs=2e-3)
    assert all(branch.connected for branch in diagram)


@pytest.mark.parametrize(
    ("name", "parameter", "span", "fork"),
    [
        ("lorenz", "r", (0.0, 30.0), 1.0),
        ("bicycle_car", "u", (20.0, 60.0), 43.66373),
        ("fractional_duffing", "k", (-1.0, 1.0), 0.0),
        ("freire", "nu", (-0.75, -0.45), -0.5),
    ],
)
def test_a_pitchfork_makes_no_folds(name, parameter, span, fork):
    system = rb.load_model(name)
    start, left = rb.all_equilibria(system, parameter, span, probes=0)
    branches = [start, left]
    # and the branch that comes back to the symmetric one
    problem, k = equilibrium_problem(system, parameter), len(left) // 3
    z = np.append(left.states[k], left.column(parameter)[k])
    back = follow(problem, z, span, StepSettings(), own=len(system.states))
    branches.append(as_branch(system, problem, back, span))
    for branch in branches:
        (point,) = [p for p in branch.special if p.label != "H"]
        assert point.label == "BP"
        assert point.parameters[parameter] == pytest.approx(fork, abs=1e-5)
        assert len(branch) < 150
        assert "unexplained" not in branch.stopped


def test_a_branch_that_runs_to_infinity_has_no_absurd_points():
    """x = (c +- sqrt(c^2 - 4 a b))/2, y = -x/a: one of them is infinite at a = 0."""
    diagram = rb.all_equilibria(rb.load_model("roessler"), "a", (-0.05, 0.2))
    assert ["infinity" in branch.stopped for branch in diagram] == [False, True, True]
    assert not any(branch.early for branch in diagram)
    (hopf,) = diagram.special_points
    assert hopf.omega == pytest.approx(1.0005, abs=1e-4)


@pytest.mark.parametrize(
    ("name", "values", "parameter", "span", "found"),
    [
        ("freire", {}, "nu", (-0.75, -0.5), ["H1", "BP1"]),
        ("towed_wheel", {"J": 0.3, "b": 0.15, "d": 100.0}, "v", (0.2, 5.0), ["H1"]),
        ("towed_wheel", {"J": 0.3, "b": 0.15, "d": 100.0}, "v", (5.0, 8.0), ["H1"]),
    ],
)
def test_a_special_point_at_the_end_of_the_span(name, values, parameter, span, found):
    branch = rb.continue_equilibria(rb.load_model(name, parameters=values), parameter, span)
    assert [point.name for point in branch.special] == found
    assert branch[found[-1]].parameters[parameter] in span
    assert not branch.early
    assert "unexplained" not in branch.stopped


@pytest.mark.parametrize("equation", ["p*x-x**3", "p*x+x**3"])
def test_branches_that_meet_at_the_end_of_the_span(equation):
    """Only one of the two leads back into the span."""
    model = rb.model_from_strings("fork", {"x": equation}, parameters={"p": -0.5}, guess={"x": 0.0})
    diagram = rb.all_equilibria(model, "p", (-1.0, 0.0), probes=0)
    assert diagram["EQ1"]["BP1"].parameters["p"] == 0.0
    assert len(list(diagram)) == (1 if "-" in equation else 2)


def test_a_transcritical_point_leads_to_its_other_branch():
    model = rb.model_from_strings(
        "transcritical", {"x": "p*x-x**2", "y": "-y"}, parameters={"p": -1.0}, guess={"x": 0.0}
    )
    diagram = rb.all_equilibria(model, "p", (-1, 1), probes=0)
    assert next(p.kind for p in diagram.special_points if p.label == "BP") == "transcritical"
    assert states_at(diagram, "p", 0.5, "x") == pytest.approx([0.0, 0.5], abs=1e-6)
    assert states_at(diagram, "p", -0.5, "x") == pytest.approx([-0.5, 0.0], abs=1e-6)


def test_a_branch_that_nothing_leads_to_is_found_once():
    """x = p and the circle (x-3)^2 + p^2 = 1/4 do not touch."""
    model = rb.model_from_strings(
        "isola", {"x": "(p-x)*((x-3)**2+p**2-0.25)"}, parameters={"p": -0.2}, guess={"x": -0.2}
    )
    diagram = rb.all_equilibria(model, "p", (-1, 1))
    assert len(diagram) == 2
    assert not diagram["EQ2"].connected
    circle = diagram["EQ2"]
    p, x = circle.column("p"), circle.column("x")
    assert (x - 3) ** 2 + p**2 == pytest.approx(0.25, abs=1e-8)
    assert "closed" in circle.stopped
    assert len([q for q in circle.special if q.label == "LP"]) == 2


def test_without_probes_only_what_is_connected_is_followed():
    diagram = rb.all_equilibria(rb.load_model("racs"), "u", (5, 12), probes=0)
    assert [branch.name for branch in diagram] == ["EQ1"]


def test_a_vertical_branch_of_orbits_is_called_degenerate():
    """Van der Pol's oscillator at mu = 0 is a linear centre: l1 = 0."""
    model = rb.model_from_strings(
        "vdp", {"x": "y", "y": "mu*(1-x**2)*y-x"}, parameters={"mu": -0.5}, guess={"x": 0.1}
    )
    hopf = rb.continue_equilibria(model, "mu", (-1, 1))["H1"]
    assert hopf.parameters["mu"] == pytest.approx(0.0, abs=1e-10)
    assert hopf.criticality == "degenerate"
