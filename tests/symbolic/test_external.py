"""Functions that are called: where they fail, what is kept of them, their series."""

import math

import numpy as np
import pytest

from racs_bif.errors import ConvergenceError, ModelError
from racs_bif.symbolic import external
from racs_bif.symbolic.compiled import compile_model
from racs_bif.symbolic.functions import model_from_function
from racs_bif.symbolic.jets import total_degree

TABLE = np.array([1.0, 2.0])


def counted(number):
    """Return a step above a number, by a loop that cannot be recorded."""
    k = 0
    while number > k:
        k += 1
    return k


def rounded(x, p):
    return [math.exp(float(x[0])) - p.a * x[1], float(x[0]) ** 2 * float(x[1])]


def build(function, states="x y", **options):
    options.setdefault("parameters", {"a": 1.0})
    model = model_from_function("m", function, states=states, **options)
    assert model.external is not None
    return compile_model(model)


def test_a_constant_rate_among_called_ones_has_no_slope():
    core = build(lambda x, p: [p.a * x[0] * counted(x[0]), 2.0])
    x, p = np.array([0.5, 0.25]), np.array([3.0])
    np.testing.assert_array_equal(core.core(x, p), [1.5, 2.0])
    np.testing.assert_array_equal(core.core_jacobian(x, p), [[3.0, 0.0], [0.0, 0.0]])


def test_where_a_called_function_is_undefined_so_is_its_jacobian():
    core = build(lambda x, p: [p.a * x[0] + math.log(3 - counted(x[0])), x[1]])
    p = np.array([1.0])
    np.testing.assert_array_equal(
        core.core_jacobian(np.array([1.5, 0.0]), p), [[1.0, 0.0], [0.0, 1.0]]
    )
    assert np.isnan(core.core_jacobian(np.array([4.5, 0.0]), p)).all()


def test_a_constant_that_is_not_finite_has_no_slope_that_is_a_number():
    core = build(lambda x, p: [p.a * x[0], 1.0 if counted(x[0]) < 3 else math.inf])
    p = np.array([1.0])
    np.testing.assert_array_equal(
        core.core_jacobian(np.array([1.5, 0.0]), p), [[1.0, 0.0], [0.0, 0.0]]
    )
    jacobian = core.core_jacobian(np.array([4.5, 0.0]), p)
    np.testing.assert_array_equal(jacobian[0], [1.0, 0.0])
    assert np.isnan(jacobian[1]).all()


def test_a_wrong_number_of_rates_is_told_where_only_the_jacobian_is_asked_for():
    core = build(lambda x, p: [p.a * x[0], x[1]] if counted(x[0]) < 3 else [x[0]])
    with pytest.raises(ModelError, match="returns 1 number; return 2, one for each of x, y"):
        core.core_jacobian(np.array([4.5, 0.0]), np.array([1.0]))


def test_a_complex_step_is_no_number_where_the_function_divides_by_zero():
    def solved(x, y, a):
        return [np.linalg.solve([[2.0]], [a * x])[0], a / x + y]

    core = build(solved, guess=[1.0, 0.0])
    assert core.meta["external"]["derivatives"] == "complex step"
    p = np.array([3.0])
    found = core.core_jacobian(np.array([2.0, 1.0]), p)
    np.testing.assert_allclose(found, [[1.5, 0.0], [-0.75, 1.0]], rtol=1e-13, atol=1e-14)
    # The step along x leaves the pole, the one along y stays on it.
    assert np.isnan(core.core_jacobian(np.array([0.0, 1.0]), p)[:, 1]).all()


def test_what_is_remembered_of_a_called_function_is_bounded(monkeypatch):
    monkeypatch.setattr(external, "_MOST", 5)
    core = build(rounded)
    sizes = []
    for u in np.linspace(0.1, 2.0, 20):
        value = core.core(np.array([u, 1.0]), np.array([1.0]))
        np.testing.assert_allclose(value, [math.exp(u) - 1.0, u**2], rtol=1e-15)
        sizes.append(len(core.external._known))
    assert max(sizes) == 6
    assert sizes.count(1) > 1


def test_series_of_what_has_only_differences():
    core = build(rounded)
    algebra = total_degree(2, 3)
    x = np.zeros((2, len(algebra)))
    x[:, 0] = 0.3, -0.4
    x[0, algebra.index[1, 0]] = x[1, algebra.index[0, 1]] = 1.0
    found = core.expand("core", algebra, np.array([1.5]), x)
    e = math.exp(0.3)
    wanted = {
        (0, 0): (e + 0.6, 0.09 * -0.4),
        (1, 0): (e, 0.6 * -0.4),
        (0, 1): (-1.5, 0.09),
        (2, 0): (e / 2, -0.4),
        (1, 1): (0.0, 0.6),
        (0, 2): (0.0, 0.0),
        (3, 0): (e / 6, 0.0),
        (2, 1): (0.0, 1.0),
        (1, 2): (0.0, 0.0),
        (0, 3): (0.0, 0.0),
    }
    for monomial, value in wanted.items():
        at = found[:, algebra.index[monomial]]
        np.testing.assert_allclose(at, value, atol=1e-6, err_msg=str(monomial))


def test_series_of_a_called_function_are_those_of_the_recorded_one():
    def cubic(x, p):
        return [p.a * x[0] ** 3 * x[1] + counted(x[0]) - counted(x[0]), math.sin(x[1])]

    def plain(x, p):
        return [p.a * x[0] ** 3 * x[1], math.sin(x[1])]

    recorded = model_from_function("m", plain, states="x y", parameters={"a": 1.0})
    algebra = total_degree(1, 5)
    x = np.zeros((2, len(algebra)))
    x[:, :2] = [[0.3, 1.0], [0.5, -2.0]]
    p = np.array([1.5])
    wanted = compile_model(recorded).expand("core", algebra, p, x)
    np.testing.assert_allclose(build(cubic).expand("core", algebra, p, x), wanted, rtol=1e-13)


def test_constants_expand_to_constants():
    algebra = total_degree(1, 2)
    found = build(rounded).expand("core", algebra, np.array([1.0]), np.array([0.0, 2.0]))
    np.testing.assert_array_equal(found, [[-1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])


def test_series_and_derivatives_beyond_what_differences_give_are_refused():
    core = build(rounded)
    algebra = total_degree(1, 4)
    x = np.zeros((2, len(algebra)))
    x[0, 1] = 1.0
    with pytest.raises(ConvergenceError, match="a series of degree 4 of 'rounded' cannot be had"):
        core.expand("core", algebra, np.array([1.0]), x)
    directions = [(1.0, 0.0, 0.0)] * 4
    with pytest.raises(ConvergenceError, match="derivatives of order 4 of 'rounded' cannot be had"):
        core.external(0, (0.1, 0.2, 1.0), *directions)


def factorial(number):
    return 1.0 if number < 1 else number * factorial(number - 1)


def from_table(x, p):
    return [float(x[0]) * TABLE[0] - p.a]


def test_digests_tell_what_functions_use(monkeypatch):
    first = external.digest(from_table)
    assert external.digest(from_table) == first
    monkeypatch.setitem(globals(), "TABLE", np.array([1.0, 3.0]))
    assert external.digest(from_table) != first


def test_digests_of_functions_that_call_themselves_come_to_an_end():
    assert external.digest(factorial) == external.digest(factorial)
    assert external.digest(factorial) != external.digest(counted)


def test_a_form_along_nothing_is_nothing():
    core = build(lambda x, p: [p.a * x[0] ** 2 * counted(x[0]), x[1] ** 2])
    x, p, zero = np.array([0.5, 2.0]), np.array([3.0]), np.zeros(2)
    np.testing.assert_array_equal(core.core_xx(x, p, zero, zero), [0.0, 0.0])
    np.testing.assert_array_equal(core.core_xx(x, p, np.ones(2), np.ones(2)), [6.0, 2.0])


def test_a_form_of_differences_along_nothing_is_nothing():
    core = build(rounded)
    x, p = np.array([0.3, -0.4]), np.array([1.0])
    np.testing.assert_array_equal(core.core_xx(x, p, np.ones(2), np.zeros(2)), [0.0, 0.0])
    assert np.all(core.core_xx(x, p, np.ones(2), np.ones(2)) != 0.0)


def test_differences_are_judged_where_the_function_is_defined():
    def root(x, p):
        return [math.sqrt(float(x[0]) - 1.0) * p.a]

    core = build(root, states="x", guess=[1.02])
    assert core.meta["external"]["derivatives"] == "differences"
    assert 0.0 < core.meta["external"]["error"] < 1e-3
    jacobian = core.core_jacobian(np.array([2.0]), np.array([3.0]))
    np.testing.assert_allclose(jacobian, [[1.5]], rtol=1e-8)


@pytest.mark.parametrize("guess", [0.0, 1.0])
def test_a_function_that_is_undefined_around_its_guess_is_refused(guess):
    """Neither series nor differences could be compared with anything."""

    def root(x, p):
        return [math.sqrt(float(x[0]) - 1.0) * p.a]

    with pytest.raises(ModelError, match=r"'root' is not finite around the guess.*another guess"):
        build(root, states="x", guess=[guess])


def test_division_by_zero_makes_the_function_undefined_there():
    core = build(lambda x, y, a: [a / float(x), y], guess=[1.0, 0.0])
    p = np.array([3.0])
    np.testing.assert_array_equal(core.core(np.array([2.0, 1.0]), p), [1.5, 1.0])
    assert np.isnan(core.core(np.array([0.0, 1.0]), p)).all()


def test_what_fails_for_a_number_and_for_an_array_is_told_of_the_number():
    with pytest.raises(ModelError, match=r"raises TypeError at x = 0, a = 1: .*not subscriptable"):
        build(lambda x, p: [x[5]], states="x")
    with pytest.raises(ModelError, match="raises IndexError at x = 0, a = 1: invalid index"):
        build(lambda state, p: [state[0][0]], states="x")
