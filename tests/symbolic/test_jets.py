"""Truncated power series: exact derivatives of any order."""

from __future__ import annotations

import math

import numpy as np
import pytest
import sympy as sp

from racs_bif.errors import ConvergenceError
from racs_bif.symbolic.compiled import compile_model
from racs_bif.symbolic.jets import JETS, Jet, multilinear, total_degree
from racs_bif.symbolic.series import ELEMENTARY, power
from racs_bif.symbolic.strings import model_from_strings

FUNCTIONS = {
    "exp": sp.exp, "log": sp.log, "sqrt": sp.sqrt, "sin": sp.sin, "cos": sp.cos, "tan": sp.tan,
    "asin": sp.asin, "acos": sp.acos, "atan": sp.atan, "sinh": sp.sinh, "cosh": sp.cosh,
    "tanh": sp.tanh, "asinh": sp.asinh, "acosh": sp.acosh, "atanh": sp.atanh, "erf": sp.erf,
    "fabs": sp.Abs, "sign": sp.sign,
}  # fmt: skip


def taylor(expression, variable, at, degree):
    return [
        float(sp.diff(expression, variable, k).subs(variable, at)) / math.factorial(k)
        for k in range(degree + 1)
    ]


@pytest.mark.parametrize("name", sorted(ELEMENTARY))
def test_series_of_elementary_functions(name):
    t = sp.Symbol("t", real=True)
    at = sp.Rational(17, 10) if name == "acosh" else sp.Rational(37, 100)
    if name in {"fabs", "sign"}:
        expected = [float(abs(at)), 1.0, 0.0, 0.0] if name == "fabs" else [1.0, 0.0, 0.0, 0.0]
    else:
        expected = taylor(FUNCTIONS[name](t), t, at, 6)
    found = ELEMENTARY[name](float(at), len(expected) - 1)
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-13)


@pytest.mark.parametrize(("x", "exponent"), [(0.7, -2.5), (2.0, 3.0), (0.0, 3.0), (-1.5, 4.0)])
def test_series_of_powers(x, exponent):
    t = sp.Symbol("t")
    base = t ** sp.nsimplify(exponent)
    np.testing.assert_allclose(
        power(x, exponent, 5), taylor(base, t, sp.nsimplify(x), 5), rtol=1e-12
    )


def test_every_function_of_compiled_models_has_a_series():
    assert set(FUNCTIONS) == set(ELEMENTARY)
    assert set(vars(JETS)) >= set(ELEMENTARY)


def test_arithmetic_of_jets():
    algebra = total_degree(2, 3)
    x = Jet(algebra, np.eye(len(algebra))[algebra.index[1, 0]] + 2.0 * np.eye(len(algebra))[0])
    y = Jet(algebra, np.eye(len(algebra))[algebra.index[0, 1]] - 1.0 * np.eye(len(algebra))[0])
    result = 1.0 / x + (3.0 - x * y) / (y - 2.0) - (-x) * 0.5 + JETS.pow(x, 2.5) * JETS.pow(y, 3.0)
    result = result + JETS.pow(x, y) + JETS.where(x > y, x, y)
    a, b = sp.symbols("a b")
    exact = 1 / a + (3 - a * b) / (b - 2) + a / 2 + a ** sp.Rational(5, 2) * b**3 + a**b + a
    for (i, j), value in zip(algebra.monomials, result.c, strict=True):
        slope = sp.diff(exact, a, i, b, j).subs({a: 2, b: -1})
        scale = math.factorial(i) * math.factorial(j)
        assert value == pytest.approx(float(slope) / scale, rel=1e-12, abs=1e-13)


def test_comparisons_are_those_of_the_constants():
    algebra = total_degree(1, 1)
    one, two = (Jet(algebra, np.array([c, 5.0])) for c in (1.0, 2.0))
    assert one < two
    assert one <= 1.0
    assert two > 1.5
    assert two >= one
    assert one == 1.0
    assert one != two


@pytest.fixture(scope="module")
def compiled():
    return compile_model(
        model_from_strings(
            "smooth",
            {"x": "k*sin(x*y) + x**2.5/(1 + y**2)", "y": "tanh(x - k*y) + exp(-x*k) * sqrt(y)"},
            parameters={"k": 0.7},
            guess={"x": 1.0, "y": 1.0},
        )
    )


def test_forms_agree_with_the_compiled_ones(compiled):
    rng = np.random.default_rng(2)
    x, p = np.array([0.8, 1.3]), np.array([0.7])
    u, v, w = rng.standard_normal((3, 2)) + 1j * rng.standard_normal((3, 2))
    algebra = multilinear(3)
    moved = np.zeros((2, len(algebra)), dtype=complex)
    moved[:, 0] = x
    for k, direction in enumerate((u, v, w)):
        unit = tuple(int(j == k) for j in range(3))
        moved[:, algebra.index[unit]] = direction
    found = compiled.expand("core", algebra, p, moved)
    np.testing.assert_allclose(found[:, 0].real, compiled.core(x, p), rtol=1e-14)
    second = compiled.core_xx(x, p, u, v)
    np.testing.assert_allclose(found[:, algebra.index[1, 1, 0]], second, rtol=1e-12)
    third = compiled.core_xxx(x, p, u, v, w)
    np.testing.assert_allclose(found[:, algebra.index[1, 1, 1]], third, rtol=1e-12)


def test_derivatives_by_parameters(compiled):
    x, p = np.array([0.8, 1.3]), np.array([0.7])
    algebra = total_degree(1, 4)
    moved = np.array([[0.7, 1.0, 0.0, 0.0, 0.0]])
    found = compiled.expand("core", algebra, moved, x)
    k = sp.Symbol("k")
    first = k * sp.sin(sp.Float("0.8") * sp.Float("1.3"))
    second = sp.tanh(sp.Float("0.8") - k * sp.Float("1.3"))
    second += sp.exp(-sp.Float("0.8") * k) * sp.sqrt(sp.Float("1.3"))
    np.testing.assert_allclose(found[0, 1:], taylor(first, k, 0.7, 4)[1:], rtol=1e-12)
    np.testing.assert_allclose(found[1], taylor(second, k, 0.7, 4), rtol=1e-11)
    np.testing.assert_allclose(found[:, 1], compiled.core_p(x, p, np.ones(1)), rtol=1e-12)


def test_where_there_is_no_series_it_says_so(compiled):
    with pytest.raises(ConvergenceError, match="not being smooth"):
        compiled.expand(
            "core", total_degree(1, 3), np.array([0.7]), np.array([[1.0, 1, 0, 0], [0.0, 1, 0, 0]])
        )
