"""Mass matrices against numpy's solver."""

import numpy as np
import pytest
import sympy as sp

from racs_bif.symbolic.compiled import compile_model
from racs_bif.symbolic.model import Model, Parameter

GRAVITY = 9.81


def mass_of_pendulum(x, p):
    """Double pendulum (theta1, theta2, omega1, omega2), point masses; p = m1, m2, l1, l2."""
    m1, m2, l1, l2 = p
    c = np.cos(x[0] - x[1])
    M = np.eye(4, dtype=complex)
    M[2:, 2:] = [[(m1 + m2) * l1**2, m2 * l1 * l2 * c], [m2 * l1 * l2 * c, m2 * l2**2]]
    return M


def right_of_pendulum(x, p):
    m1, m2, l1, l2 = p
    s = np.sin(x[0] - x[1])
    return np.array(
        [
            x[2],
            x[3],
            -m2 * l1 * l2 * s * x[3] ** 2 - (m1 + m2) * GRAVITY * l1 * np.sin(x[0]),
            m2 * l1 * l2 * s * x[2] ** 2 - m2 * GRAVITY * l2 * np.sin(x[1]),
        ]
    )


def pendulum(x, p):
    return np.linalg.solve(mass_of_pendulum(x, p), right_of_pendulum(x, p))


@pytest.fixture(scope="module")
def double_pendulum():
    t1, t2, o1, o2, m1, m2, l1, l2 = sp.symbols("t1 t2 o1 o2 m1 m2 l1 l2")
    c, s = sp.cos(t1 - t2), sp.sin(t1 - t2)
    mass = sp.eye(4)
    mass[2, 2], mass[3, 3] = (m1 + m2) * l1**2, m2 * l2**2
    mass[2, 3] = mass[3, 2] = m2 * l1 * l2 * c
    equations = {
        "t1": o1,
        "t2": o2,
        "o1": -m2 * l1 * l2 * s * o2**2 - (m1 + m2) * GRAVITY * l1 * sp.sin(t1),
        "o2": m2 * l1 * l2 * s * o1**2 - m2 * GRAVITY * l2 * sp.sin(t2),
    }
    parameters = tuple(Parameter(str(k), 1.0) for k in (m1, m2, l1, l2))
    return compile_model(Model("pendulum", equations, parameters, mass=mass))


@pytest.mark.parametrize("seed", range(5))
def test_state_dependent_mass(double_pendulum, seed):
    rng = np.random.default_rng(seed)
    x, p = rng.uniform(-2.0, 2.0, 4), rng.uniform(0.5, 2.0, 4)
    exact = pendulum(x, p).real
    np.testing.assert_allclose(double_pendulum.core(x, p), exact, rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("seed", range(3))
def test_derivatives_through_the_mass(double_pendulum, seed):
    """Complex steps differentiate numpy's solution to the last digit."""
    rng = np.random.default_rng(10 + seed)
    x, p = rng.uniform(-2.0, 2.0, 4), rng.uniform(0.5, 2.0, 4)
    step = 1e-30
    by_x = np.column_stack([pendulum(x + 1j * step * e, p).imag / step for e in np.eye(4)])
    np.testing.assert_allclose(
        double_pendulum.core_jacobian(x, p), by_x, rtol=1e-12, atol=1e-12 * np.abs(by_x).max()
    )
    dp = rng.uniform(-1.0, 1.0, 4)
    by_p = pendulum(x, p + 1j * step * dp).imag / step
    np.testing.assert_allclose(double_pendulum.core_p(x, p, dp), by_p, rtol=1e-12, atol=1e-12)


def matrices():
    x, y, a = sp.symbols("x y a")
    return {
        "zero on the diagonal": sp.Matrix([[0, 1, 0], [1, 0, 0], [0, 0, a]]),
        "a cycle": sp.Matrix([[0, 0, 2], [3, 0, 0], [0, a, 0]]),
        "zero at the guess only": sp.Matrix([[x, 2, 1], [1, y, 0], [a, 1, 3]]),
        "rows of unlike size": sp.Matrix([[1e-9, 1, 0], [1, 1, 1e-3], [1e6, 0, 1e6 * a]]),
        "full, with states": sp.Matrix(
            [[0, sp.cos(x), 1], [2 + sp.sin(y), 0, a * x], [1, a, x * y]]
        ),
    }


@pytest.mark.parametrize("case", matrices())
def test_pivoting(case):
    symbols = sp.symbols("x y z a")
    mass = matrices()[case]
    right = [sp.sin(symbols[0]), symbols[1] ** 2, symbols[2] - symbols[0]]
    model = Model("pivots", dict(zip("xyz", right, strict=True)), (Parameter("a", 0.7),), mass=mass)
    compiled = compile_model(model)
    numbers = sp.lambdify(symbols, [mass, sp.Matrix(right)], "numpy")
    rng = np.random.default_rng(0)
    for x in rng.uniform(-0.5, 0.5, (4, 3)):
        M, b = numbers(*x, 0.7)
        exact = np.linalg.solve(M, b)[:, 0]
        np.testing.assert_allclose(compiled.core(x, np.array([0.7])), exact, rtol=1e-12)


@pytest.mark.parametrize("case", matrices())
def test_forces_and_determinant_before_the_mass_is_inverted(case):
    symbols = sp.symbols("x y z a")
    mass = matrices()[case]
    x, y, z, a = symbols
    right = [sp.sin(x), y**2, z - a * x]
    model = Model("pivots", dict(zip("xyz", right, strict=True)), (Parameter("a", 0.7),), mass=mass)
    compiled = compile_model(model)
    assert compiled.has_inertia
    wanted = sp.Matrix([*right, mass.det()])
    exact = sp.lambdify(symbols, [wanted, wanted.jacobian(symbols)], "numpy")
    factors = []
    for at in np.random.default_rng(1).uniform(-0.5, 0.5, (6, 4)):
        value, slopes = exact(*at)
        told = compiled.forces(at[:3], at[3:])
        assert compiled.inertia(at[:3], at[3:]) == told[-1]
        np.testing.assert_allclose(told[:-1], value[:-1, 0], rtol=1e-14)
        factors.append(told[-1] / value[-1, 0])
        for direction in np.eye(4):
            slope = compiled.forces_d(at[:3], at[3:], direction[:3], direction[3:])
            slope[-1] /= factors[-1]
            size = np.abs(slopes).max()
            np.testing.assert_allclose(slope, slopes @ direction, rtol=1e-9, atol=1e-11 * size)
    assert factors == pytest.approx([factors[0]] * 6, rel=1e-9)


def test_a_mass_that_is_never_singular_has_no_determinant_to_watch():
    x, y = sp.symbols("x y")
    equations = {"x": x + y, "y": x - y}
    assert not compile_model(Model("plain", equations)).has_inertia
    assert not compile_model(Model("numbers", equations, mass=sp.diag(2, 3))).has_inertia


def test_mass_and_element_together():
    """m w' = -k Z(s) x: the element's output is not multiplied by the mass."""
    from racs_bif.symbolic.model import FractionalElement

    x, v, z, m, s = sp.symbols("x v z m s")
    model = Model(
        "oscillator",
        {"x": v, "v": -z},
        (Parameter("m", 4.0),),
        elements=(FractionalElement("z", x, s ** sp.Rational(1, 2)),),
        mass=sp.diag(1, m),
    )
    compiled = compile_model(model)
    value = compiled.core(np.array([2.0, 3.0, 5.0]), np.array([4.0, 7.0]))
    np.testing.assert_allclose(value, [3.0, -(5.0 + 7.0 * 2.0) / 4.0, 2.0], rtol=1e-15)


@pytest.mark.parametrize("at", [0.0, np.pi / 2, np.pi / 2 - 1e-9, 1.0, np.pi, 4.0])
def test_pivots_that_vanish_away_from_the_guess(at):
    """A rotation is never singular, but either pivot of it vanishes somewhere."""
    x, y = sp.symbols("x y")
    mass = sp.Matrix([[sp.cos(x), sp.sin(x)], [-sp.sin(x), sp.cos(x)]])
    compiled = compile_model(Model("turning", {"x": x + y, "y": x - y}, mass=mass))
    point, none = np.array([at, 0.5]), np.array([])

    def exact(p):
        c, s = np.cos(p[0]), np.sin(p[0])
        return np.array([[c, -s], [s, c]]) @ np.array([p[0] + p[1], p[0] - p[1]])

    np.testing.assert_allclose(compiled.core(point, none), exact(point), atol=1e-14)
    many = compiled.core(np.column_stack([point, np.zeros(2)]), none)
    np.testing.assert_allclose(many[:, 0], exact(point), atol=1e-14)
    by_x = np.column_stack([exact(point + 1e-30j * e).imag / 1e-30 for e in np.eye(2)])
    np.testing.assert_allclose(compiled.core_jacobian(point, none), by_x, atol=1e-13)


@pytest.mark.parametrize("a", [3.0, 1.0, 1.0 + 1e-14, 0.0, -1.0])
def test_pivots_that_vanish_at_other_parameters(a):
    x, y, s = sp.symbols("x y a")
    mass = sp.Matrix([[s - 1, 1], [1, s]])
    compiled = compile_model(
        Model("masses", {"x": sp.sin(x), "y": y}, (Parameter("a", 3.0),), mass=mass)
    )
    point, p = np.array([0.4, 0.5]), np.array([a])
    M = np.array([[a - 1.0, 1.0], [1.0, a]])
    np.testing.assert_allclose(
        compiled.core(point, p), np.linalg.solve(M, [np.sin(0.4), 0.5]), rtol=1e-12
    )
    by_a = -np.linalg.solve(M, np.linalg.solve(M, [np.sin(0.4), 0.5]))
    np.testing.assert_allclose(compiled.core_p(point, p, np.ones(1)), by_a, rtol=1e-12)


def test_a_mass_of_parameters_is_inverted_once():
    """No division is left for every evaluation."""
    import re

    x, y, a = sp.symbols("x y a")
    mass = sp.Matrix([[a, 1], [2, a**2]])
    model = Model("masses", {"x": sp.sin(x), "y": y}, (Parameter("a", 3.0),), mass=mass)
    text = compile_model(model).sources.main
    pattern = r"core_prepare\(p\):(.*?)def core\(c, x\):(.*?)def "
    prepare, body = re.search(pattern, text, re.DOTALL).groups()
    assert "/" in prepare
    assert "/" not in body
    assert "where" not in body
