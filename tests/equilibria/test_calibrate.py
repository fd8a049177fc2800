"""Values of a parameter that put a Hopf point where it is wanted."""

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.equilibria import calibrate as module
from racs_bif.equilibria.calibrate import calibrate
from racs_bif.errors import ConvergenceError, UsageError
from racs_bif.fractional.diffusive import Diffusive
from racs_bif.fractional.system import System
from racs_bif.symbolic.compiled import compile_model


@pytest.fixture
def system():
    """Return a model with Hopf points where u = (k - 1)(k - 3)."""
    growth = "(u - (k - 1)*(k - 3))"
    model = rb.model_from_strings(
        "two",
        {"x": f"{growth}*x - 2*y - x*(x**2 + y**2)", "y": f"2*x + {growth}*y - y*(x**2 + y**2)"},
        parameters={"u": -5.0, "k": 2.5, "zero": 0.0},
    )
    compiled = compile_model(model)
    values = np.array([q.default for q in compiled.parameters])
    return System(compiled, values, Diffusive(band=(0.1, 100.0)))


def test_one_value_in_the_span(system):
    found = calibrate(system, "k", {"u": 0.0}, span=(2.0, 4.0))
    assert found.value == pytest.approx(3.0, abs=1e-9)


def test_several_values_are_told_and_none_is_taken(system):
    with pytest.raises(UsageError, match=r"'k' has 2 such values, (1, 3|3, 1); narrow --span to"):
        calibrate(system, "k", {"u": 0.0}, span=(0.5, 4.0))


def test_a_parameter_that_is_zero_needs_a_span(system):
    with pytest.raises(UsageError, match="'zero' is 0, which gives no interval to search"):
        calibrate(system, "zero", {"u": 0.0})


def test_points_that_are_not_hopf_points_of_the_exact_model_are_left_out(system, monkeypatch):
    def refuses(exact, path, X, value, omega):
        if value > 2.0:
            raise ConvergenceError("no root")
        return solve(exact, path, X, value, omega)

    solve = module.solve_hopf
    monkeypatch.setattr(module, "solve_hopf", refuses)
    found = calibrate(system, "k", {"u": 0.0}, span=(0.5, 4.0))
    assert found.value == pytest.approx(1.0, abs=1e-9)


def test_points_that_the_exact_model_has_outside_the_span_are_left_out(system, monkeypatch):
    solve = module.solve_hopf
    far = []

    def moved(exact, path, X, value, omega):
        point = solve(exact, path, X, value, omega)
        if value > 2.0:
            object.__setattr__(point, "value", 4.5)
            far.append(value)
        return point

    monkeypatch.setattr(module, "solve_hopf", moved)
    found = calibrate(system, "k", {"u": 0.0}, span=(0.5, 4.0))
    assert found.value == pytest.approx(1.0, abs=1e-9)
    np.testing.assert_allclose(far, [3.0], atol=1e-6)
