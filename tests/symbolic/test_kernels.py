"""Running compiled programs: undefined points, what is computed once, whole numbers."""

import re

import numpy as np
import pytest


def test_undefined_points_give_nan_and_leave_the_others_alone(compiled):
    core = compiled(
        {
            "x": "log(x)",
            "y": "1/y",
            "z": "sqrt(z) + z**q",
            "t": "asin(t) + acosh(t) + atanh(t)",
            "r": "exp(r)",
            "k": "2*k",
        },
        parameters={"q": 0.5},
    )
    p = np.array([0.5])
    point = np.array([-1.0, 0.0, -1.0, 3.0, 1e4, 3.0])
    value = core.core(point, p)
    assert np.isnan(value[[0, 2, 3]]).all()
    assert np.isinf(value[[1, 4]]).all()
    assert value[5] == 6.0
    many = core.core(np.column_stack([point, np.full(6, 0.5)]), p)
    np.testing.assert_array_equal(many[:, 0], value)
    assert np.isfinite(many[[0, 1, 2, 4, 5], 1]).all()
    assert np.isfinite(core.core_jacobian(point, p)[5]).all()
    for form in (
        core.core_p(point, p, np.ones(1)),
        core.core_xx(point, p, np.ones(6), np.ones(6)),
        core.core_xxx(point, p, np.ones(6), np.ones(6) * 1j, np.ones(6)),
    ):
        assert form[5] == 0.0


def test_undefined_parameters_give_nan(compiled):
    core = compiled({"x": "x*log(a) + b/a", "y": "y"}, parameters={"a": 1.0, "b": 1.0})
    for bad in (0.0, -1.0):
        value = core.core(np.array([1.0, 2.0]), np.array([bad, 1.0]))
        assert not np.isfinite(value[0]) or bad < 0.0
        assert value[1] == 2.0
    assert core.core(np.array([1.0, 2.0]), np.array([2.0, 1.0]))[0] == np.log(2.0) + 0.5


def test_a_branch_that_is_not_taken_may_be_undefined(compiled):
    core = compiled({"x": "log(x) if x > 0 else x**2"})
    none = np.array([])
    assert core.core(np.array([-3.0]), none) == 9.0
    assert core.core_jacobian(np.array([-3.0]), none) == -6.0
    np.testing.assert_array_equal(core.core(np.array([[-3.0, 1.0]]), none), [[9.0, 0.0]])
    assert core.core_xx(np.array([-3.0]), none, np.ones(1), np.ones(1)) == 2.0


def test_parameter_expressions_are_computed_once(compiled):
    core = compiled({"x": "exp(a)*b**2*x + sin(a*x)"}, parameters={"a": 1.0, "b": 2.0})
    text = core.sources.main
    pattern = r"def core_prepare\(p\):(.*?)def core\(c, x\):(.*?)def "
    prepare, body = re.search(pattern, text, re.DOTALL).groups()
    assert "exp_" in prepare
    assert "exp_" not in body
    assert "sin_" in body
    kernel, calls = core.kernel("core"), []
    inner = kernel._prepare_scalar
    kernel._prepare_scalar = lambda p: calls.append(p) or inner(p)
    p = np.array([1.0, 2.0])
    for x in (np.array([1.0]), np.array([2.0]), np.ones((1, 4))):
        kernel(p, x)
    assert len(calls) == 1
    kernel(np.array([1.5, 2.0]), np.array([1.0]))
    assert len(calls) == 2


def test_parameters_that_change_are_noticed(compiled):
    core = compiled({"x": "a*x**2"}, parameters={"a": 1.0})
    p, x = np.array([2.0]), np.array([3.0])
    assert core.core(x, p) == 18.0
    assert core.core_jacobian(x, p) == 12.0
    p[0] = 5.0  # in place
    assert core.core(x, p) == 45.0
    assert core.core_jacobian(x, p) == 30.0


def test_whole_numbers_are_taken_as_floats(compiled):
    core = compiled({"x": "a*x**9", "y": "3"}, parameters={"a": 1.0})
    one = core.core(np.array([200, 1]), np.array([1]))
    many = core.core(np.array([[200, 2], [1, 1]]), np.array([1]))
    assert one.dtype == many.dtype == float
    assert one[0] == many[0, 0] == 200.0**9
    np.testing.assert_array_equal(many[1], 3.0)


@pytest.mark.parametrize("n", [1.0, 2.0, 3.0])
def test_parameter_powers_are_smooth_at_zero(compiled, n):
    """x**n with a whole number in the parameter n has all its derivatives at x = 0."""
    core = compiled({"x": "a*x**n", "y": "x"}, parameters={"a": 1.0, "n": n})
    at, p, one = np.zeros(2), np.array([3.0, n]), np.array([1.0, 0.0])
    assert core.core_jacobian(at, p)[0, 0] == (3.0 if n == 1.0 else 0.0)
    assert core.core_xx(at, p, one, one)[0] == (6.0 if n == 2.0 else 0.0)
    assert core.core_xxx(at, p, one, one, one)[0] == (18.0 if n == 3.0 else 0.0)
    assert core.core_p(at, p, np.array([1.0, 0.0]))[0] == 0.0
    assert core.core_p(at, p, np.array([0.0, 1.0]))[0] == 0.0
    below = np.array([-2.0, 0.0])
    assert core.core(below, p)[0] == 3.0 * (-2.0) ** n
    assert core.core_p(below, p, np.array([1.0, 0.0]))[0] == (-2.0) ** n


def test_hill_function_with_a_parameter_order_at_zero(compiled):
    core = compiled({"x": "b*x**n/(K**n + x**n) - x"}, parameters={"b": 2.0, "K": 3.0, "n": 2.0})
    at, p, one = np.zeros(1), np.array([2.0, 3.0, 2.0]), np.ones(1)
    assert core.core_jacobian(at, p) == -1.0
    assert core.core_xx(at, p, one, one) == pytest.approx(2.0 * 2.0 / 9.0, rel=1e-15)
    assert core.core_xxx(at, p, one, one, one) == 0.0
    for dp in np.eye(3):
        assert core.core_p(at, p, dp) == 0.0
        assert core.core_xp(at, p, one, dp) == 0.0


def test_long_sums_and_deep_nests_compile(compiled):
    terms = " + ".join(f"sin({k}*x)" for k in range(1, 151))
    nest = "x"
    for _ in range(60):
        nest = f"sin({nest})"
    core = compiled({"x": terms, "y": nest.replace("x", "y")})
    at = np.array([0.3, 0.4])
    expected = 0.4
    for _ in range(60):
        expected = np.sin(expected)
    value = core.core(at, np.array([]))
    assert value[0] == pytest.approx(np.sin(0.3 * np.arange(1, 151)).sum(), abs=1e-12)
    assert value[1] == pytest.approx(expected, rel=1e-14)
