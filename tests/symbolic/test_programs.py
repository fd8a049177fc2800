"""Compiled programs against sympy: values and derivatives of random expressions."""

import numpy as np
import pytest

from racs_bif.symbolic.graph import Graph


def close(value, reference, tolerance=1e-13):
    return np.abs(value - reference).max() <= tolerance * max(1.0, np.abs(reference).max())


def directions(seed, count, size=3):
    rng = np.random.default_rng(seed)
    return [rng.uniform(-1.0, 1.0, size) for _ in range(count)]


def test_values_agree_with_sympy(shallow):
    value = shallow.compiled.core(shallow.x, shallow.p)
    assert close(value, shallow.reference(shallow.expressions)), shallow.expressions


def test_deep_expressions_agree_with_sympy(deep):
    value = deep.compiled.core(deep.x, deep.p)
    assert close(value, deep.reference(deep.expressions)), deep.expressions


def test_many_points_at_once_equal_single_points(shallow):
    rng = np.random.default_rng(3)
    x = rng.uniform(0.3, 1.4, (3, 7))
    u = rng.uniform(-1.0, 1.0, (3, 7))
    dp = rng.uniform(-1.0, 1.0, (3, 7))
    core, p = shallow.compiled, shallow.p
    many = core.core(x, p)
    matrices = core.core_jacobian(x, p)
    slopes = core.core_p(x, p, dp)
    forms = core.core_xx(x, p, u, u[::-1])
    assert many.shape == (3, 7)
    assert matrices.shape == (7, 3, 3)
    for k in range(7):
        one = x[:, k]
        assert close(many[:, k], core.core(one, p), 1e-15 * 4)
        assert close(matrices[k], core.core_jacobian(one, p), 1e-15 * 8)
        assert close(slopes[:, k], core.core_p(one, p, dp[:, k]), 1e-15 * 8)
        assert close(forms[:, k], core.core_xx(one, p, u[:, k], u[::-1, k]), 1e-14)


def test_parameters_may_be_arrays(shallow):
    rng = np.random.default_rng(4)
    p = rng.uniform(0.4, 1.6, (3, 5))
    kernel = shallow.compiled.kernel("core")
    fixed_x, moving_x = kernel(p, shallow.x), kernel(p, rng.uniform(0.3, 1.4, (3, 5)))
    assert fixed_x.shape == moving_x.shape == (3, 5)
    for k in range(5):
        assert close(fixed_x[:, k], kernel(p[:, k], shallow.x), 1e-15 * 4)


def test_jacobian_agrees_with_sympy(shallow):
    jacobian = shallow.compiled.core_jacobian(shallow.x, shallow.p)
    for k in range(3):
        unit = np.zeros(6)
        unit[k] = 1.0
        assert close(jacobian[:, k], shallow.derivative(unit)), shallow.expressions


def test_parameter_derivatives_agree_with_sympy(shallow):
    for k in range(3):
        unit = np.zeros(6)
        unit[3 + k] = 1.0
        slope = shallow.compiled.core_p(shallow.x, shallow.p, unit[3:])
        assert close(slope, shallow.derivative(unit)), shallow.expressions


def test_higher_derivatives_agree_with_sympy(shallow):
    core, x, p = shallow.compiled, shallow.x, shallow.p
    u, v, w = directions(5, 3)
    dp = directions(6, 1)[0]
    full = [np.append(d, np.zeros(3)) for d in (u, v, w)]
    aside = np.append(np.zeros(3), dp)
    assert close(core.core_xx(x, p, u, v), shallow.derivative(*full[:2]))
    assert close(core.core_xp(x, p, u, dp), shallow.derivative(full[0], aside))
    assert close(core.core_xxx(x, p, u, v, w), shallow.derivative(*full), 4e-13)


def test_complex_directions_are_multilinear(shallow):
    core, x, p = shallow.compiled, shallow.x, shallow.p
    a, b, c, d, e, f = directions(7, 6)
    dp = directions(8, 1)[0]
    u, v, w = a + 1j * b, c + 1j * d, e + 1j * f

    def second(s, t):
        return core.core_xx(x, p, s, t)

    def third(s, t, r):
        return core.core_xxx(x, p, s, t, r)

    whole = second(a, c) - second(b, d) + 1j * (second(a, d) + second(b, c))
    assert close(second(u, v), whole)
    assert close(second(u, v), second(v, u))
    split = third(a, v, w) + 1j * third(b, v, w)
    assert close(third(u, v, w), split)
    assert close(third(u, v, w), third(w, u, v))
    split = core.core_xp(x, p, a, dp) + 1j * core.core_xp(x, p, b, dp)
    assert close(core.core_xp(x, p, u, dp), split)


def test_forms_take_matrices_of_directions(shallow):
    core, x, p = shallow.compiled, shallow.x, shallow.p
    rng = np.random.default_rng(9)
    u = rng.uniform(-1, 1, (3, 4)) + 1j * rng.uniform(-1, 1, (3, 4))
    v = rng.uniform(-1, 1, (3, 4))
    forms = core.core_xx(x, p, u, v)
    assert forms.shape == (3, 4)
    for k in range(4):
        assert close(forms[:, k], core.core_xx(x, p, u[:, k], v[:, k]), 1e-14)


@pytest.mark.parametrize(
    ("name", "value"),
    [("exp", np.e), ("erf", 0.8427007929497149), ("fabs", 1.0), ("asinh", 0.881373587019543)],
)
def test_constants_fold(name, value):
    graph = Graph()
    assert graph.value(graph.unary(name, graph.one)) == pytest.approx(value, rel=1e-15)


def test_equal_expressions_are_one_node():
    graph = Graph()
    a, b = graph.input("a"), graph.input("b")
    assert graph.mul(a, b) == graph.mul(b, a)
    assert graph.sub(a, graph.neg(b)) == graph.add(b, a)
    assert graph.sub(a, a) == graph.zero
    assert graph.neg(graph.sub(a, b)) == graph.sub(b, a)
    assert graph.power(a, graph.constant(3.0)) == graph.mul(graph.mul(a, a), a)
    assert graph.unary("sin", graph.neg(a)) == graph.neg(graph.unary("sin", a))


def test_what_overflows_is_not_folded():
    graph = Graph()
    huge = graph.constant(1e200)
    for node in (
        graph.mul(huge, huge),
        graph.power(graph.constant(10.0), graph.constant(400.0)),
        graph.div(graph.one, graph.zero),
        graph.unary("log", graph.zero),
    ):
        assert graph.value(node) is None
    a = graph.input("a")
    assert graph.ops[graph.div(a, graph.constant(1e-320))][0] == "div"
