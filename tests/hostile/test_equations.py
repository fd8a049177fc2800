"""Equations that jump, overflow, have no equilibrium, or too many of them."""

import re

import numpy as np
import pytest
import sympy as sp

import racs_bif as rb
from racs_bif.errors import ModelError, RacsBifError

x, y, a = sp.symbols("x y a")


def parameter_a(value=1.0):
    return (rb.Parameter("a", value),)


@pytest.mark.parametrize(
    ("equations", "options", "words"),
    [
        ({"x": "a - sign(x)"}, {}, "do not change with the states at the guess"),
        ({"x": "heaviside(x) - a"}, {}, "do not change with the states"),
        ({"x": "0*x"}, {}, "their Jacobian is 0"),
        ({"x": "0", "y": "0"}, {}, "their Jacobian is 0"),
        ({"x": "a"}, {}, "their Jacobian is 0"),
        ({"x": "x*y", "y": "-x*y"}, {"guess": {"x": 1.0}}, "maybe not isolated"),
        ({"x": "1 + x^2 + a^2"}, {"guess": {"x": 1.0}}, "no equilibrium found"),
        ({"x": "exp(-x)"}, {"guess": {"x": 1.0}}, "no equilibrium found"),
        ({"x": "exp(exp(exp(x))) - a"}, {"guess": {"x": 3.0}}, "not finite at the guess x = 3"),
        ({"x": "log(x) - a"}, {"guess": {"x": -1.0}}, "not finite at the guess x = -1"),
        ({"x": "x/0"}, {}, "'zoo' is not a finite real number"),
        ({"x": "1e308*(a - x)*10"}, {}, r"'1.000e\+309' is not a finite real number"),
        ({}, {}, "no equations; give at least one state"),
    ],
)
def test_one_line_says_what_is_wrong(equations, options, words, follow):
    said = follow(equations, **options)
    assert isinstance(said, str), said
    assert re.search(words, said)
    assert "hostile" in said or "number" in said
    assert "\n" not in said


def test_jumps_end_a_branch_and_are_no_special_points(follow):
    for equation in ("a - x - sign(x)", "a - x*heaviside(x - 0.5) - x", "a - x if x < 1 else a"):
        branch = follow({"x": equation}, span=(-3.0, 3.0), parameters={"a": 2.0})
        if isinstance(branch, str):
            assert "equilibrium" in branch
            continue
        assert {p.label for p in branch.special} <= {"BP"}, equation


def test_a_jump_in_the_equation(follow):
    branch = follow({"x": "a - x - sign(x)"}, span=(-3.0, 3.0), parameters={"a": 2.0})
    np.testing.assert_allclose(branch.states[:, 0], branch.parameter - 1.0, atol=1e-9)
    assert branch.parameter.min() == pytest.approx(1.0, abs=1e-2)
    assert branch.early


def test_equilibria_that_go_to_infinity(follow):
    branch = follow({"x": "a*x - 1"}, guess={"x": 1.0})
    assert branch.parameter.max() == 1.0
    assert 0.0 < branch.parameter.min() < 1e-5
    assert "infinity" in branch.stopped
    assert branch.special == ()
    branch = follow({"x": "exp(-x) - a"}, guess={"x": 1.0})
    assert branch.special == ()
    assert branch.parameter.min() >= 0.0


def test_very_large_and_very_small_equations(follow):
    for factor in ("1e-300", "1e300"):
        branch = follow({"x": f"{factor}*(a - x)"}, guess={"x": 1.0})
        np.testing.assert_allclose(branch.states[:, 0], branch.parameter, atol=1e-9)
        assert not branch.early


def test_equilibria_that_are_not_isolated_have_no_branch_points(follow):
    circle = {"x": "x*(a - x^2 - y^2)", "y": "y*(a - x^2 - y^2)"}
    branch = follow(circle, span=(0.5, 2.0), guess={"x": 1.0})
    assert branch.special == ()
    radius = np.hypot(branch.states[:, 0], branch.states[:, 1])
    np.testing.assert_allclose(radius**2, branch.parameter, rtol=1e-9)


def test_a_pitchfork_of_one_state_is_still_one(follow):
    branch = follow({"x": "a*x - x^3"}, parameters={"a": -0.5})
    (point,) = branch.special
    assert point.label == "BP"
    assert point.parameters["a"] == pytest.approx(0.0, abs=1e-10)


def test_no_states_but_an_element(follow):
    branch = follow({}, elements=[("w", "a - w", "1/s^0.5")])
    assert branch.parameter[[0, -1]].tolist() in ([-1.0, 1.0], [1.0, -1.0])


MASSES = {
    "singular": ([[1, 0], [0, 0]], "singular at the default parameters"),
    "of rank one": ([[1, 1], [1, 1]], "singular at the default parameters"),
    "of another shape": ([[1]], r"it must be \(2, 2\)"),
    "complex": ([[sp.I, 0], [0, 1]], "complex"),
    "infinite": ([[1 / (a - 1), 0], [0, 1]], "not finite"),
}


@pytest.mark.parametrize("case", MASSES)
def test_mass_matrices_that_cannot_be(case):
    mass, words = MASSES[case]
    with pytest.raises(ModelError, match=words):
        rb.continue_equilibria(
            rb.Model(
                name="heavy",
                equations={"x": a - x, "y": x - y},
                parameters=parameter_a(),
                mass=sp.Matrix(mass),
            ),
            "a",
            (0.5, 3.0),
        )


def test_a_mass_that_vanishes_within_the_span_is_no_branch_point():
    model = rb.Model(
        name="heavy",
        equations={"x": a - x, "y": x - y},
        parameters=parameter_a(),
        mass=sp.Matrix([[1, 0], [0, a - 2]]),
    )
    branch = rb.continue_equilibria(model, "a", (0.5, 3.0))
    np.testing.assert_allclose(branch.states[:, 1], branch.parameter, rtol=1e-9)
    assert branch.special == ()
    assert "unexplained" in branch.stopped


@pytest.mark.parametrize(
    "expression",
    [sp.DiracDelta(x), sp.floor(x), sp.I * x, sp.oo * x, sp.nan, sp.gamma(x), sp.Symbol("x") > 0],
    ids=str,
)
def test_expressions_without_a_real_smooth_value(expression):
    with pytest.raises(RacsBifError) as caught:
        rb.continue_equilibria(
            rb.Model(name="odd", equations={"x": expression}, parameters=parameter_a()),
            "a",
            (0.0, 1.0),
        )
    assert "\n" not in str(caught.value)


def test_through_the_command_line(command):
    text = '[equations]\nx = "1 + x^2 + a^2"\n[parameters]\na = 1\n[guess]\nx = 1'
    status, said = command(text, "h.toml")
    assert (status, len(said.splitlines())) == (1, 1)
    assert "no equilibrium found" in said
    status, said = command('mass = [[0]]\n[equations]\nx = "a - x"\n[parameters]\na = 1', "h.toml")
    assert (status, len(said.splitlines())) == (2, 1)
    assert "mass matrix is singular" in said
