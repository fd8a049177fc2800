"""Hopf points of the exact model, on the vehicle and on problems with known answers."""

import math

import mpmath
import numpy as np
import pytest
from scipy.optimize import brentq

from racs_bif.errors import ConvergenceError
from racs_bif.fractional import exact_fold, exact_hopf
from racs_bif.fractional.exact_fold import null_vectors, solve_fold
from racs_bif.fractional.exact_hopf import solve_hopf
from racs_bif.fractional.realised_hopf import _eigenpair, solve_realised_hopf

# model.md, section 4: one parameter changed -> u_H and omega_H of the exact model
VEHICLE = {
    (): (10.2, 9.5200832),
    (("C_s", 20000.0),): (4.5672697, 10.414023),
    (("C_s", 35000.0),): (15.81316, 8.3598728),
    (("C_s", 40000.0),): (22.318792, 7.4845221),
    (("alpha", 0.2),): (14.23821, 7.7314068),
    (("alpha", 0.4),): (4.7922914, 12.550348),
    (("gamma", 0.6),): (3.9916341, 12.99678),
    (("gamma", 0.8),): (15.266725, 7.2073304),
    (("m_c", 30.0),): (9.3015361, 10.198924),
    (("m_c", 200.0),): (11.576326, 8.6582576),
    (("c", 0.30),): (18.934671, 7.693726),
    (("c", 0.40),): (5.831142, 11.027693),
    (("delta_f", 0.08),): (10.308432, 9.4531972),
}


def leading_pair(system, u):
    """Return the rightmost oscillating eigenvalue of the realised model at speed u."""
    there = system.with_parameters({"u": u})
    values = np.linalg.eigvals(there.field.f_x(there.equilibrium(), there.values))
    pairs = values[values.imag > 1.0]
    return pairs[np.argmax(pairs.real)]


def realised_hopf(system, low, high):
    u = brentq(lambda x: leading_pair(system, x).real, low, high, xtol=1e-8)
    return u, leading_pair(system, u).imag


@pytest.mark.parametrize("changed", VEHICLE, ids=str)
def test_hopf_points_of_the_vehicle(vehicle, changed):
    """From the realised point, found without knowing the exact one beyond a bracket."""
    system = vehicle.with_parameters(dict(changed))
    u_exact, omega_exact = VEHICLE[changed]
    u, omega = realised_hopf(system, 0.8 * u_exact, 1.25 * u_exact)
    assert u == pytest.approx(u_exact, rel=1e-2)  # the realisation is good, but not exact
    there = system.with_parameters({"u": u})
    X = there.exact_point(there.equilibrium(), there.values)
    found = solve_hopf(system.exact, system.path("u"), X, u, omega)
    digits = 1e-7 if not changed else 6e-8
    assert found.value == pytest.approx(u_exact, rel=digits)
    assert found.omega == pytest.approx(omega_exact, rel=digits)
    assert found.residual < 1e-9
    delta = system.exact.delta(1j * found.omega, found.X, system.path("u").vector(found.value))
    assert np.abs(delta @ found.q).max() < 1e-9 * np.abs(delta).max()


def test_no_hopf_point_at_a_large_order(vehicle):
    """alpha = 0.6: none between 1 and 60 m/s."""
    system = vehicle.with_parameters({"alpha": 0.6})
    signs = {leading_pair(system, u).real > 0.0 for u in np.linspace(1.0, 60.0, 60)}
    assert len(signs) == 1


def test_calibrated_stiffness(vehicle):
    """With C_s active at u = 10.2: the constant of model.md to its eight digits."""
    system = vehicle.with_parameters({"u": 10.2})
    x = system.equilibrium()
    X = system.exact_point(x, system.values)
    found = solve_hopf(system.exact, system.path("C_s"), X, 30_000.0, 9.4)
    assert found.value == pytest.approx(29661.065, abs=5e-4)
    assert found.omega == pytest.approx(9.5200832, abs=5e-8)
    A_h = system.path("C_s").vector(found.value)[system.field.parameters.index("A_h")]
    assert A_h == pytest.approx(0.741526625, abs=5e-10)


@pytest.mark.parametrize("name", ["alpha", "gamma", "tau_eps", "tau_sig", "m_c", "D_r", "delta_f"])
def test_any_parameter_may_be_active(vehicle, name):
    """The Hopf point at u = 10.2 again, by moving another parameter back to its default."""
    system = vehicle.with_parameters({"u": 10.2})
    value = system.parameters[name]
    X = system.exact_point(system.equilibrium(), system.values)
    found = solve_hopf(system.exact, system.path(name), X, 1.02 * value, 9.5)
    # delta_f moves the point least, so the eight digits of C_s tell least about it
    assert found.value == pytest.approx(value, rel=1e-3 if name == "delta_f" else 1e-6)


@pytest.mark.parametrize("ep", [0.5, 1.0, 1.5])
def test_van_der_pol_of_equal_orders(system_of, ep):
    """q_H = (2/pi) acos(ep/2), omega = 1 (acceptance.md, Fractional 1)."""
    system = system_of(
        {},
        elements=[("x", "y", "s**(-q)"), ("y", "-x - ep*(x**2 - 1)*y", "s**(-q)")],
        parameters={"ep": ep, "q": 0.9},
    )
    exact = 2.0 / math.pi * math.acos(ep / 2.0)
    found = solve_hopf(system.exact, system.path("q"), np.zeros(2), exact + 0.03, 1.1)
    assert found.value == pytest.approx(exact, abs=1e-12)
    assert found.omega == pytest.approx(1.0, abs=1e-12)
    known = {0.5: 0.8391387535, 1.0: 2.0 / 3.0, 1.5: 0.4601069123}[ep]
    assert found.value == pytest.approx(known, abs=1e-9)


@pytest.mark.parametrize(
    ("A", "orders", "B", "omega"),
    [
        (1.0, (0.9, 0.9), 2.3128689301, 1.0),
        (2.0, (0.95, 0.95), 5.3138363829, 2.0743100889),
        (1.0, (0.8, 0.9), 2.456314723, 1.123584120),
    ],
)
def test_brusselator(system_of, A, orders, B, omega):
    """acceptance.md, Fractional 2; B_H = 1 + A^2 + 2 A cos(al pi/2), omega = A^(1/al)."""
    a1, a2 = orders
    system = system_of(
        {},
        elements=[("x", "A - (B+1)*x + x**2*y", "s**(-a1)"), ("y", "B*x - x**2*y", "s**(-a2)")],
        parameters={"A": A, "B": B, "a1": a1, "a2": a2},
    )
    start = np.array([A, 1.05 * B / A])
    found = solve_hopf(system.exact, system.path("B"), start, 1.05 * B, 0.95 * omega)
    assert found.value == pytest.approx(B, abs=1e-9)
    assert found.omega == pytest.approx(omega, abs=1e-9)
    np.testing.assert_allclose(found.X, [A, found.value / A], rtol=1e-12)
    if a1 == a2:
        closed = 1.0 + A**2 + 2.0 * A * math.cos(a1 * math.pi / 2.0)
        assert found.value == pytest.approx(closed, rel=1e-13)
        assert found.omega == pytest.approx(A ** (1.0 / a1), rel=1e-13)


def test_van_der_pol_with_a_springpot(system_of):
    """acceptance.md, Fractional 6: the Hopf point for a = c = 1/2."""
    system = system_of(
        {"x": "y", "y": "mu*(1 - x**2)*y - c*w - x"},
        elements=[("w", "x", "s**a")],
        parameters={"mu": 0.4, "c": 0.5, "a": 0.5},
    )
    found = solve_hopf(system.exact, system.path("mu"), np.zeros(3), 0.4, 1.0)
    assert found.value == pytest.approx(0.3259981216, abs=1e-10)
    assert found.omega == pytest.approx(1.1761963238, abs=1e-10)
    # by hand: -om^2 + 1 + c om^a cos(a pi/2) = 0 and mu om = c om^a sin(a pi/2)
    om, c, a = found.omega, 0.5, 0.5
    assert 1.0 - om**2 + c * om**a * math.cos(a * math.pi / 2) == pytest.approx(0.0, abs=1e-13)
    assert found.value * om == pytest.approx(c * om**a * math.sin(a * math.pi / 2), abs=1e-13)


CHAOTIC = {
    # acceptance.md, Fractional 3: equations, parameters, start, estimate of q and omega, q
    "Lorenz": (
        {"x": "10*(y - x)", "y": "x*(28 - z) - y", "z": "x*y - 8/3*z"},
        [8.485, 8.485, 27.0],
        (0.98, 10.2),
        0.9941328870,
    ),
    "Chen": (
        {"x": "35*(y - x)", "y": "-7*x - x*z + 28*y", "z": "x*y - 3*z"},
        [7.94, 7.94, 21.0],
        (0.83, 20.0),
        0.8243631582,
    ),
    "Roessler": (
        {"x": "-y - z", "y": "x + y/5", "z": "1/5 + z*(x - 5.7)"},
        [0.007, -0.035, 0.035],
        (0.93, 1.0),
        0.9381444765,
    ),
}


@pytest.mark.parametrize("name", CHAOTIC)
def test_least_orders_of_chaotic_systems(system_of, name):
    right, X, (q, omega), exact = CHAOTIC[name]
    elements = [(state, text, "s**(-q)") for state, text in right.items()]
    system = system_of({}, elements=elements, parameters={"q": q})
    found = solve_hopf(system.exact, system.path("q"), np.array(X), q, omega)
    assert found.value == pytest.approx(exact, abs=1e-10)


@pytest.mark.parametrize("unit", [1.0, 1e-12, 1e12])
def test_the_unit_of_the_parameter_does_not_matter(system_of, unit):
    """Hopf normal form x'' - (mu/unit) x' + 4 x; also mu_H = 0, where nothing is relative."""
    for offset in (0.0, 0.3):
        system = system_of(
            {"x": "y", "y": "(mu/unit - offset - x**2)*y - 4*x"},
            parameters={"mu": unit, "unit": unit, "offset": offset},
        )
        start = unit * (offset + 0.2)
        found = solve_hopf(system.exact, system.path("mu"), np.zeros(2), start, 1.7)
        assert found.value == pytest.approx(unit * offset, rel=1e-12, abs=1e-12 * unit)
        assert found.omega == pytest.approx(2.0, rel=1e-12)


def test_no_hopf_point_is_said_in_words(system_of):
    system = system_of({"x": "y", "y": "-(1 + mu**2)*y - x"}, parameters={"mu": 0.5})
    with pytest.raises(ConvergenceError, match=r"no exact Hopf .* near mu = 0\.5, omega = 1"):
        solve_hopf(system.exact, system.path("mu"), np.zeros(2), 0.5, 1.0)


def test_few_iterations(vehicle, monkeypatch):
    """Newton's method converges quadratically: rounding must not keep it going."""
    system, calls = vehicle.with_parameters({"u": 10.25}), []
    inner = exact_hopf._system
    monkeypatch.setattr(exact_hopf, "_system", lambda *a: calls.append(a) or inner(*a))
    X = system.exact_point(system.equilibrium(), system.values)
    solve_hopf(system.exact, system.path("u"), X, 10.25, 9.5)
    assert len(calls) <= 6


def test_a_parameter_that_moves_nothing_has_no_hopf_point_and_no_fold(system_of):
    equations = {"x": "mu*x - y - x**3", "y": "x + mu*y"}
    system = system_of(equations, parameters={"mu": 0.1, "idle": 1.0}, guess={"x": 0.0, "y": 0.0})
    found = solve_hopf(system.exact, system.path("mu"), np.zeros(2), 0.1, 1.1)
    assert (found.value, found.omega) == (pytest.approx(0.0, abs=1e-12), pytest.approx(1.0))
    with pytest.raises(ConvergenceError):
        solve_hopf(system.exact, system.path("idle"), np.zeros(2), 1.0, 1.1)
    with pytest.raises(ConvergenceError):
        solve_fold(system.exact, system.path("idle"), np.zeros(2), 1.0)


def test_a_real_eigenvalue_is_no_realised_hopf_point(system_of):
    system = system_of(
        {"x": "(mu - 3)*x + x**2", "y": "x - 5*y"},
        parameters={"mu": 1.0},
        guess={"x": 0.0, "y": 0.0},
    )
    with pytest.raises(ConvergenceError, match="no Hopf point of the realised system near mu = 1"):
        solve_realised_hopf(system, system.path("mu"), np.zeros(2), 1.0, 0.0)


def test_a_parameter_that_moves_no_eigenvalue_has_no_hopf_point(system_of):
    system = system_of(
        {"x": "mu - 3*x", "y": "x - y"}, parameters={"mu": 1.0}, guess={"x": 0.3, "y": 0.3}
    )
    with pytest.raises(ConvergenceError, match="no Hopf point of the realised system near mu = 1"):
        solve_realised_hopf(system, system.path("mu"), np.array([0.3, 0.3]), 1.0, 0.0)


def test_an_eigenvalue_of_a_stiff_matrix_is_sharp():
    """The eigenvalues that are found first are exact to the largest entries only."""
    A = np.array(
        [
            [0.1, 10.0, 1e4, 0.0],
            [-10.0, 0.1, 0.0, 3e3],
            [3e5, 1e5, -1e10, 2e7],
            [2e6, -1e5, 1e8, -3e9],
        ]
    )
    with mpmath.workdps(50):
        values = [complex(value) for value in mpmath.eig(mpmath.matrix(A.tolist()))[0]]
    expected = min(values, key=lambda value: abs(value - 10j))
    assert expected.imag > 5.0
    assert np.abs(np.linalg.eigvals(A) - expected).min() > 1e-11
    mu, left, right = _eigenpair(A, 10j)
    assert abs(mu - expected) < 1e-13 * abs(expected)
    assert complex(np.vdot(left, right)) == pytest.approx(1.0, rel=1e-12)
    np.testing.assert_allclose((A @ right)[:2], mu * right[:2], rtol=1e-9)


def test_what_corrections_of_a_hopf_point_are_compared_with():
    for q in ([-0.7, 0.1, 0.2, 0.3], [0.1, -0.7, 0.2, 0.3]):
        size = exact_hopf._magnitudes(np.array([3.0, 1e-9, 1e-6, 9.0, *q]), 2)
        assert size == pytest.approx([3.0, 9e-3, 9e-3, 9.0, 0.7, 0.7, 0.7, 0.7])
    size = exact_fold._magnitudes(np.array([3.0, 1e-9, 1e-6, 0.1, -0.7]), 2)
    assert size == pytest.approx([3.0, 3e-3, 1e-3, 0.7, 0.7])


def test_what_is_no_hopf_point_is_refused(system_of, monkeypatch):
    system = system_of({"x": "y", "y": "(mu - 1 - x**2)*y - x/4"}, parameters={"mu": 1.2})
    of = system.exact, system.path("mu"), np.zeros(2), 1.2
    assert solve_hopf(*of, 0.45).omega == pytest.approx(0.5, rel=1e-12)
    with pytest.raises(ConvergenceError, match="no exact Hopf"):
        solve_hopf(*of, -0.45)
    monkeypatch.setattr(exact_hopf, "_ITERATIONS", 2)
    with pytest.raises(ConvergenceError, match="no exact Hopf"):
        solve_hopf(*of, 0.45)


def test_null_vectors_of_badly_scaled_matrices():
    matrix = np.array([[1.0, 20.0, 300.0], [4.0, -50.0, 6.0], [5.0, -30.0, 306.0]])
    right = null_vectors(np.diag([1e-6, 1.0, 1e6]) @ matrix)[1]
    assert matrix @ right == pytest.approx(np.zeros(3), abs=1e-11)
    assert np.linalg.norm(right) == pytest.approx(1.0)
    left = null_vectors(np.array([[3.0, 1.0], [0.0, 0.0]]))[0]
    assert np.abs(left) == pytest.approx([0.0, 1.0], abs=1e-15)


def test_the_null_vector_of_a_fold_has_length_one(system_of):
    system = system_of({"x": "q - exp(x) + 3*x", "y": "100*x - y"}, parameters={"q": 1.0})
    fold = solve_fold(system.exact, system.path("q"), np.array([1.1, 110.0]), -0.3)
    assert fold.value == pytest.approx(3.0 - 3.0 * math.log(3.0), rel=1e-12)
    assert fold.v[1] == pytest.approx(100.0 * fold.v[0], rel=1e-12)
    assert np.linalg.norm(fold.v) == pytest.approx(1.0, rel=1e-3)


def test_a_realised_hopf_point_beside_another_pair(system_of):
    """Eigenvalues 3 (mu - 0.3) + (mu + 0.2) i, as a = mu, and 0.45 + 0.55 i."""
    system = system_of(
        {
            "a": "mu - a",
            "x": "(mu + 2*a - 0.9)*x - (mu + 0.2)*y",
            "y": "(mu + 0.2)*x + (mu + 2*a - 0.9)*y",
            "v": "0.45*v - 0.55*w",
            "w": "0.55*v + 0.45*w",
        },
        parameters={"mu": 0.2},
    )
    found = solve_realised_hopf(system, system.path("mu"), np.zeros(5), 0.2, 0.45)
    assert found.value == pytest.approx(0.3, rel=1e-12)
    assert found.omega == pytest.approx(0.5, rel=1e-12)
    assert found.slope == pytest.approx(3.0 + 1.0j, rel=1e-12)
    assert found.x == pytest.approx([0.3, 0.0, 0.0, 0.0, 0.0], abs=1e-12)


def test_a_realised_hopf_point_whose_first_corrections_grow(system_of):
    growth = "((mu - 1)**3 + 1)"
    system = system_of({"x": f"{growth}*x - y/2", "y": f"x/2 + {growth}*y"}, parameters={"mu": 2.5})
    found = solve_realised_hopf(system, system.path("mu"), np.zeros(2), 2.5, 0.5)
    assert found.value == pytest.approx(0.0, abs=1e-12)
