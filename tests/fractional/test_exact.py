"""The exact model of the vehicle: equilibria, roots and the characteristic matrix."""

import cmath

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.errors import ConvergenceError, ModelError
from racs_bif.fractional.static import StaticField


def exact_equilibrium(system, **values):
    p = system.with_parameters(values).values
    X = system.exact.equilibrium(np.zeros(system.exact.size), p)
    return X, p


@pytest.mark.parametrize(("u", "delta_c"), [(5.0, -0.0015083144), (30.0, -0.0072687)])
def test_equilibria_of_the_vehicle(vehicle, u, delta_c):
    """model.md and the issue: the digits that are given there."""
    X, _ = exact_equilibrium(vehicle, u=u)
    digits = 1e-10 if u == 5.0 else 5e-8
    assert X[2] == pytest.approx(delta_c, abs=digits)
    assert X[4] == pytest.approx(X[2], rel=1e-12)  # Z(0) = 1
    assert X[3] == pytest.approx(0.0, abs=1e-12)
    x = vehicle.with_parameters({"u": u}).equilibrium()
    np.testing.assert_allclose(x[:4], X[:4], rtol=1e-10, atol=1e-13)


def test_residual_vanishes_and_derivatives_are_right(vehicle, differences):
    X, p = exact_equilibrium(vehicle, u=17.0)
    exact = vehicle.exact
    rng = np.random.default_rng(0)
    X = X + rng.uniform(-0.02, 0.02, len(X))
    jacobian = exact.jacobian(X, p)
    for k, unit in enumerate(np.eye(len(X))):
        column = differences(lambda t, unit=unit: exact.residual(X + t * unit, p), 0.0, 1e-3)
        np.testing.assert_allclose(jacobian[:, k], column, rtol=1e-6, atol=1e-7)
    for name in ("u", "C_s", "alpha", "tau_eps", "delta_f", "D_r"):
        value = vehicle.with_parameters({}).parameters[name]
        path = vehicle.path(name)
        slope = differences(
            lambda t, path=path: exact.residual(X, path.vector(t)), value, 1e-3 * abs(value)
        )
        p, dp = path.vector(value), path.direction(value)
        np.testing.assert_allclose(exact.residual_p(X, p, dp), slope, rtol=1e-6, atol=1e-8)


def test_static_gains_that_are_parameters_move_the_equilibrium(system_of, differences):
    """x' = b - Z x with Z(0) = n/d rests at x = b d/n."""
    system = system_of(
        {"x": "b - w"},
        elements=[("w", "x", "(n + s**q)/(d + s**(q/2))")],
        parameters={"b": 3.0, "n": 2.0, "d": 5.0, "q": 0.6},
    )
    exact, p = system.exact, system.values
    X = exact.equilibrium(np.zeros(2), p)
    np.testing.assert_allclose(X, [7.5, 3.0], rtol=1e-14)
    for dp in np.eye(4):
        slope = differences(lambda t, dp=dp: exact.residual(X, p + t * dp), 0.0, 1e-3)
        np.testing.assert_allclose(exact.residual_p(X, p, dp), slope, atol=1e-11)


def test_static_gains_of_two_elements_move_the_equilibrium(system_of, differences):
    """x' = b - Z x - Y y and y' = x - Y y: each law's own gain stands in its own row."""
    system = system_of(
        {"x": "b - w - v", "y": "x - v"},
        elements=[("w", "x", "n + s**q"), ("v", "y", "(1 + s**q)/(d + s**(q/2))")],
        parameters={"b": 3.0, "n": 2.0, "d": 5.0, "q": 0.6},
    )
    exact, p = system.exact, system.values
    X = exact.equilibrium(np.zeros(4), p)
    np.testing.assert_allclose(X, [1.0, 5.0, 2.0, 1.0], rtol=1e-14)
    for dp in np.eye(4):
        slope = differences(lambda t, dp=dp: exact.residual(X, p + t * dp), 0.0, 1e-3)
        np.testing.assert_allclose(exact.residual_p(X, p, dp), slope, atol=1e-10)


def test_sparse_and_dense_jacobians_agree(system_of):
    system = system_of(
        {"x": "b - w - v", "y": "x*y - v"},
        elements=[("w", "x**2", "n + s**q"), ("v", "y", "(1 + s**q)/(d + s**(q/2))")],
        parameters={"b": 3.0, "n": 2.0, "d": 5.0, "q": 0.6},
    )
    exact, p = system.exact, system.values
    X = np.array([0.3, -0.7, 1.1, 0.2])
    found = exact._sparse_jacobian(X, p).toarray()
    np.testing.assert_allclose(found, exact.jacobian(X, p), rtol=1e-14)


def test_weights_of_two_elements_move_in_their_own_rows(system_of, differences):
    system = system_of(
        {"x": "-w - v"},
        elements=[("w", "x", "n + s**q"), ("v", "x", "(1 + s**q)/(d + s**(q/2))")],
        parameters={"n": 2.0, "d": 5.0, "q": 0.6},
    )
    exact, p, s = system.exact, system.values, 0.4 + 1.7j
    for dp in np.eye(3):
        slope = exact.weights_p(s, p, dp)
        for side in ("left", "right"):
            moved = differences(
                lambda t, side=side, dp=dp: getattr(exact.weights(s, p + t * dp), side), 0.0, 1e-3
            )
            np.testing.assert_allclose(getattr(slope, side), moved, rtol=1e-8, atol=1e-10)


def newton(function, s):
    """Polish a root by the secant method, which needs no derivative."""
    before, s = s, s * (1.0 + 1e-5)
    for _ in range(30):
        f, g = function(before), function(s)
        if g == f or abs(s - before) < 1e-14 * abs(s):
            break
        before, s = s, s - g * (s - before) / (g - f)
    return s


@pytest.mark.parametrize(
    ("u", "root"),
    [(12.0, 0.49290598 + 8.93656849j), (20.0, 1.80501519 + 7.66054698j)],
)
def test_characteristic_roots(vehicle, u, root):
    X, p = exact_equilibrium(vehicle, u=u)

    def determinant(s):
        return np.linalg.det(vehicle.exact.delta(s, X, p))

    found = newton(determinant, root * 1.001)
    assert found == pytest.approx(root, abs=1.5e-8)
    values = np.linalg.svd(vehicle.exact.delta(found, X, p))[1]
    assert values[-1] < 1e-12 * values[0]
    assert newton(determinant, root.conjugate()) == pytest.approx(root.conjugate(), abs=1.5e-8)


@pytest.mark.parametrize(
    ("law", "a0", "b0", "root"),
    [
        # acceptance.md, Fractional 4 and 5: s^2 + a0 s^q + b0
        ("s**1.5", 0.5, 0.5, -0.0973132111 + 0.5668651135j),
        ("s**0.5", 0.2, 1.0, -0.0706227832 + 1.0707870668j),
        ("s**0.5", 0.5, 1.0, -0.1754419826631 + 1.1777194119858j),
    ],
)
def test_roots_of_fractional_oscillators(system_of, law, a0, b0, root):
    order = float(law[3:])
    # a law may grow like s at most: the rest of the order is taken by feeding y' instead of y
    source, rest = ("y", order - 1.0) if order > 1.0 else ("x", order)
    system = system_of(
        {"x": "y", "y": "-a0*w - b0*x"},
        elements=[("w", source, "s**q")],
        parameters={"a0": a0, "b0": b0, "q": rest},
    )
    X = np.zeros(3)

    def determinant(s):
        return np.linalg.det(system.exact.delta(s, X, system.values))

    for s in (0.3 + 0.7j, -1.0 + 0.2j, 2.0j):
        assert determinant(s) == pytest.approx(s**2 + a0 * s**order + b0, rel=1e-13)
    assert newton(determinant, root + 0.01) == pytest.approx(root, abs=2e-10)


def test_derivatives_of_the_characteristic_weights(vehicle, differences):
    p = vehicle.values
    s = 0.4 + 7.0j
    slope = vehicle.exact.weights_s(s, p)
    for side in ("left", "right"):
        exact = getattr(slope, side)
        moved = differences(
            lambda t, side=side: getattr(vehicle.exact.weights(s + t, p), side), 0.0, 1e-3
        )
        np.testing.assert_allclose(exact, moved, rtol=1e-10, atol=1e-11)
    for name in ("alpha", "gamma", "tau_eps", "tau_sig", "u"):
        path = vehicle.path(name)
        value = vehicle.parameters[name]
        slope = vehicle.exact.weights_p(s, p, path.direction(value))
        for side in ("left", "right"):
            moved = differences(
                lambda t, side=side, path=path: getattr(
                    vehicle.exact.weights(s, path.vector(t)), side
                ),
                value,
                1e-3 * value,
            )
            np.testing.assert_allclose(getattr(slope, side), moved, rtol=1e-9, atol=1e-10)


def test_determinant_of_the_vehicle_by_hand(vehicle):
    """Eliminate the element by hand: M s^2 + ... with F_d = -C_s Z(s) delta_c, at one s."""
    X, p = exact_equilibrium(vehicle, u=15.0)
    s = 1.3 + 6.0j
    delta = vehicle.exact.delta(s, X, p)
    law = (1 + cmath.exp(0.7 * cmath.log(s))) / (1 + cmath.exp(0.3 * cmath.log(s)))
    core = vehicle.compiled.core_jacobian(X, vehicle.compiled.padded(p))
    reduced = s * np.eye(4) - core[:4, :4] - law * np.outer(core[:4, 4], core[4, :4])
    expected = np.linalg.det(reduced) * (1 + s**0.3)
    assert np.linalg.det(delta) == pytest.approx(expected, rel=1e-11)


def test_no_equilibrium_is_said_in_words(system_of):
    system = system_of({"x": "1 + x**2"}, guess={"x": 0.3})
    with pytest.raises(ConvergenceError, match="model 'test': no equilibrium found"):
        system.equilibrium()


def test_a_guess_where_the_model_is_undefined(system_of):
    system = system_of({"x": "log(x) - 1"})
    with pytest.raises(ModelError, match=r"model 'test': .* not finite at the guess x = 0"):
        system.equilibrium()
    better = system_of({"x": "log(x) - 1"}, guess={"x": 1.0})
    assert better.equilibrium()[0] == pytest.approx(np.e, rel=1e-13)


def test_damping_reaches_far_equilibria(system_of):
    """Plain Newton from 3 diverges on atan(x)."""
    system = system_of({"x": "-atan(x - 1)"}, guess={"x": 4.0})
    assert system.equilibrium()[0] == pytest.approx(1.0, abs=1e-12)


def test_where_newton_is_led_away_the_equations_are_minimised():
    """A lorry whose tyres saturate on Newton's way: its lateral velocity would go to infinity."""
    values = {
        **{"u": 3.0, "delta_f": -0.0744, "m": 4419.0, "I_z": 8358.0, "a": 1.85, "b": 1.08},
        **{"m_c": 268.6, "I_cs": 139.9, "e": 0.3775, "c": 0.4046, "d": 0.5493, "C_s": 20830.0},
        **{"B_f": 14.69, "C_f": 1.655, "D_f": -21340.0, "E_f": -0.5191},
        **{"B_r": 8.785, "C_r": 1.245, "D_r": -16260.0, "E_r": -0.06965},
    }
    system = rb.load_model("racs", parameters=values, variant="restoring")
    with pytest.raises(ConvergenceError, match="no equilibrium found"):
        system.exact.equilibrium(np.zeros(5), system.values)
    x = system.equilibrium()
    X = system.exact_point(x, system.values)
    assert np.abs(system.exact.residual(X, system.values)).max() < 1e-11
    assert np.abs(X[:4]).max() < 2.0


def test_a_singular_jacobian_at_the_guess(system_of):
    system = system_of({"x": "x**3 - 1 + y", "y": "y"}, guess={"x": 0.0})
    with pytest.raises(ConvergenceError, match="better guess"):
        system.equilibrium()


@pytest.mark.parametrize(
    ("equations", "message"),
    [
        ({"x": "x**2 + 1"}, r"do not change with the states at the guess"),
        ({"x": "x**2 + y", "y": "y*(1 + x)"}, r"equilibrium with a singular Jacobian"),
    ],
)
def test_what_is_wrong_with_a_singular_guess_is_said(system_of, equations, message):
    with pytest.raises(ConvergenceError, match=message):
        system_of(equations).equilibrium()


def test_polish_and_exact_point_are_inverse(vehicle):
    system = vehicle.with_parameters({"u": 20.0, "alpha": 0.45})
    X = system.exact.equilibrium(np.zeros(5), system.values)
    x = system.polish(X + 1e-3, system.values)
    np.testing.assert_allclose(system.exact_point(x, system.values), X, rtol=1e-9, atol=1e-12)


def test_an_integrator_keeps_its_output_at_rest(system_of):
    """x' = w - x, w = s^-q (1 - x): at rest x = 1 and w = 1, held by the integrator's state."""
    system = system_of({"x": "w - x"}, elements=[("w", "1 - x", "1/s**q")], parameters={"q": 0.7})
    x = system.equilibrium()
    np.testing.assert_allclose(system.exact_point(x, system.values), 1.0, rtol=1e-12)
    assert np.abs(system.field.f(x, system.values)).max() < 1e-12


def test_the_static_field_where_gains_are_parameters(system_of, differences):
    """Every derivative by parameters that stand in the equations and in the laws."""
    system = system_of(
        {"x": "b - w - v", "y": "x - v"},
        elements=[("w", "b*x**2", "n*d + s**q"), ("v", "y", "(b + s**q)/(d*b + s**(q/2))")],
        parameters={"b": 3.0, "n": 2.0, "d": 5.0, "q": 0.6},
    )
    field, p = StaticField(system.exact), system.values
    rng = np.random.default_rng(0)
    x, v, _ = rng.normal(size=(3, 4))
    dp, dq = rng.normal(size=(2, 4)) * [1.0, 1.0, 1.0, 0.0]
    cases = (
        (field.f_x(x, p) @ v, lambda t: field.f(x + t * v, p)),
        (field.f_p(x, p, dp), lambda t: field.f(x, p + t * dp)),
        (field.f_xp(x, p, v, dp), lambda t: field.f_x(x, p + t * dp) @ v),
        (field.f_pp(x, p, dp, dq), lambda t: field.f_p(x, p + t * dq, dp)),
        (field.f_pp(x, p, dp, dp), lambda t: field.f_p(x, p + t * dp, dp)),
        (field.f_xx(x, p, v, x), lambda t: field.f_x(x + t * x, p) @ v),
    )
    for exact, moved in cases:
        np.testing.assert_allclose(exact, differences(moved, 0.0, 1e-3), rtol=1e-7, atol=1e-9)


def test_the_static_field_where_no_gain_moves(system_of, differences):
    system = system_of(
        {"x": "b**2 - w"},
        elements=[("w", "b*x", "n + s**q")],
        parameters={"b": 3.0, "n": 2.0, "q": 0.6},
    )
    field, p = StaticField(system.exact), system.values
    x, dp, dn = np.array([0.3, 0.4]), np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
    assert field.f_pp(x, p, dp, dp).tolist() == [2.0, 0.0]
    assert field.f_pp(x, p, dp, dn).tolist() == field.f_pp(x, p, dn, dp).tolist() == [0.0, 0.3]
    slope = differences(lambda t: field.f(x, p + t * dp), 0.0, 1e-3)
    np.testing.assert_allclose(field.f_p(x, p, dp), slope, atol=1e-10)


def test_beside_a_fold_what_is_zero_but_for_rounding_is_an_equilibrium(system_of):
    """Newton's corrections need not fall below 1e-11 there: rounding over the small slope."""
    system = system_of({"x": "exp(x) - q*x"}, parameters={"q": 3.0})
    for beside in np.geomspace(1e-12, 1e-9, 60):
        q = np.array([np.e + beside])
        X = system.exact.equilibrium(np.array([1.0 + 1e-5]), q)
        assert X[0] == pytest.approx(1.0 + np.sqrt(2.0 * beside / np.e), abs=1e-8)


@pytest.mark.parametrize("unit", [1e-3, 100.0])
def test_the_unit_of_a_state_beside_a_fold_does_not_matter(system_of, unit):
    system = system_of({"x": "exp(x/c) - q*x/c"}, parameters={"q": 3.0, "c": unit})
    for beside in np.geomspace(1e-12, 1e-9, 60):
        p = np.array([np.e + beside, unit])
        X = system.exact.equilibrium(np.array([unit * (1.0 + 1e-5)]), p)
        assert X[0] / unit == pytest.approx(1.0 + np.sqrt(2.0 * beside / np.e), abs=1e-8)


def test_a_step_that_no_halving_makes_good_is_a_small_one(system_of):
    exact, p = system_of({"x": "x**2 - 1"}).exact, np.zeros(0)
    X, step = np.array([3.0]), np.array([2.0])
    after, value, size = exact._damped((X, p), step, lambda _: np.array([1e3]))
    assert after == pytest.approx([2.9998], rel=1e-14)
    assert value == pytest.approx(after**2 - 1.0, rel=1e-14)
    assert size == 2.0


def test_a_guess_where_a_model_with_an_element_is_undefined(system_of):
    elements = [("w", "x", "s**q")]
    system = system_of({"x": "log(x) - w"}, elements=elements, parameters={"q": 0.5})
    with pytest.raises(ModelError, match=r"not finite at the guess x = 0; give another guess"):
        system.equilibrium()


def test_a_guess_where_the_slope_is_undefined(system_of):
    with pytest.raises(ConvergenceError, match="no equilibrium found"):
        system_of({"x": "sqrt(x**2 + y**2) + 1", "y": "y"}).equilibrium()


@pytest.mark.parametrize(
    "equations",
    [{"x": "sqrt(x) + 1"}, {"x": "sqrt(x) - 1"}, {"x": "sqrt(x) + 1 - y", "y": "y - 3"}],
)
def test_a_guess_where_the_slope_is_infinite_is_no_equilibrium(system_of, equations):
    with pytest.raises(ConvergenceError, match="no equilibrium found"):
        system_of(equations).equilibrium()


def test_beside_a_fold_at_zero(system_of):
    """What is small there is not small compared with the state."""
    system = system_of({"x": "exp(x + 1) - q*(x + 1)"}, parameters={"q": 3.0})
    for beside in np.geomspace(1e-12, 1e-9, 60):
        X = system.exact.equilibrium(np.array([1e-5]), np.array([np.e + beside]))
        assert X[0] == pytest.approx(np.sqrt(2.0 * beside / np.e), abs=1e-8)


@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e3])
def test_far_equilibria_are_reached_in_any_unit(system_of, unit):
    system = system_of({"x": "-atan(x/c - 1)"}, parameters={"c": unit})
    X = system.exact.equilibrium(np.array([4.0 * unit]), np.array([unit]))
    assert X[0] == pytest.approx(unit, rel=1e-12)
