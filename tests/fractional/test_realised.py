"""The realised vector field of the vehicle: every derivative against differences."""

import pickle
from copy import copy
from dataclasses import replace

import numpy as np
import pytest

from racs_bif.fractional.diffusive import Diffusive
from racs_bif.fractional.oustaloup import Oustaloup
from racs_bif.fractional.realised import RealisedField
from racs_bif.fractional.system import System
from racs_bif.symbolic.field import VectorField
from racs_bif.symbolic.model import Calibration


@pytest.fixture(params=["diffusive", "oustaloup"], scope="module")
def system(request, vehicle):
    if request.param == "diffusive":
        return vehicle
    return System(vehicle.compiled, vehicle.values, Oustaloup(band=(1e-2, 1e3), sections=4))


def state(system, seed):
    """Return a state in the nonlinear range of the tyres."""
    rng = np.random.default_rng(seed)
    scale = np.ones(len(system.field.states))
    scale[:4] = [1.0, 0.3, 0.05, 0.5]
    scale[4:] = 0.05
    return rng.uniform(-1.0, 1.0, len(scale)) * scale, scale


def agree(value, reference, tolerance, noise=1e-12):
    """Compare row by row: rows have different units."""
    scale = np.abs(np.asarray(reference))
    noise = np.broadcast_to(noise, scale.shape)
    np.testing.assert_array_less(np.abs(value - reference), tolerance * scale + noise)


def names(system):
    return [p.name for p in system.parameter_table]


def test_names(vehicle):
    field = vehicle.field
    assert field.states[:4] == vehicle.states == ("v", "w", "delta_c", "ddelta_c")
    assert field.states[4] == "memory_of_delta_z_1"
    assert len(field.states) == 4 + vehicle.realisation.states
    assert field.parameters == tuple(p.name for p in vehicle.compiled.parameters)


@pytest.mark.parametrize("seed", [0, 1])
def test_jacobian(system, differences, seed):
    x, scale = state(system, seed)
    field, p = system.field, system.values
    jacobian = field.f_x(x, p)
    for k, unit in enumerate(np.eye(len(x))):
        column = differences(lambda t, unit=unit: field.f(x + t * unit, p), 0.0, 1e-3 * scale[k])
        agree(jacobian[:, k], column, 1e-7)


def test_parameter_derivatives(system, differences):
    """Every parameter, base and derived: orders and times move the filter too."""
    x, _ = state(system, 2)
    v, _ = state(system, 3)
    field = system.field
    for name in names(system):
        value = system.parameters[name]
        path = system.path(name)
        p, dp = path.vector(value), path.direction(value)
        step = 1e-3 * abs(value)

        def f(t, path=path):
            return field.f(x, path.vector(t))

        def moved(t, path=path):
            return field.f_x(x, path.vector(t)) @ v

        slope, turned = field.f_p(x, p, dp), field.f_xp(x, p, v, dp)
        # the weights of a fit carry the rounding of its least squares
        lost = 1e-11 / step
        agree(slope, differences(f, value, step), 1e-7, lost * (1e-3 + np.abs(f(value))))
        agree(turned, differences(moved, value, step), 1e-7, lost * (1e-3 + np.abs(moved(value))))


def test_derivatives_along_several_parameters_add_up(system):
    x, _ = state(system, 4)
    field, p = system.field, system.values
    rng = np.random.default_rng(5)
    dp = rng.uniform(-1.0, 1.0, len(p)) * np.abs(p)
    parts = sum(field.f_p(x, p, unit * dp) for unit in np.eye(len(p)))
    agree(field.f_p(x, p, dp), parts, 1e-11)
    parts = sum(field.f_xp(x, p, x, unit * dp) for unit in np.eye(len(p)))
    agree(field.f_xp(x, p, x, dp), parts, 1e-11)


def test_second_and_third_derivatives(system, differences):
    field, p = system.field, system.values
    x, _ = state(system, 6)
    u, v, w = (state(system, seed)[0] for seed in (7, 8, 9))
    second = differences(lambda t: field.f_x(x + t * v, p) @ u, 0.0, 1e-3)
    agree(field.f_xx(x, p, u, v), second, 1e-7)
    third = differences(lambda t: field.f_xx(x + t * w, p, u, v), 0.0, 1e-3)
    agree(field.f_xxx(x, p, u, v, w), third, 1e-6)
    matrices = field.f_xx_matrices(x, p, np.column_stack([u, v]))
    agree(matrices[0] @ v, field.f_xx(x, p, u, v), 1e-12)
    agree(matrices[1] @ w, field.f_xx(x, p, v, w), 1e-12)


def test_complex_directions(system):
    field, p = system.field, system.values
    x, _ = state(system, 6)
    a, b, c, d = (state(system, seed)[0] for seed in (7, 8, 9, 10))
    B = field.f_xx
    whole = B(x, p, a, c) - B(x, p, b, d) + 1j * (B(x, p, a, d) + B(x, p, b, c))
    agree(B(x, p, a + 1j * b, c + 1j * d), whole, 1e-12)
    C = field.f_xxx
    whole = C(x, p, a, c, d) + 1j * C(x, p, b, c, d)
    agree(C(x, p, a + 1j * b, c, d), whole, 1e-12)
    dp = np.eye(len(p))[field.parameters.index("alpha")]
    whole = field.f_xp(x, p, a, dp) + 1j * field.f_xp(x, p, b, dp)
    agree(field.f_xp(x, p, a + 1j * b, dp), whole, 1e-12)


def test_many_points_equal_single_points(system):
    field, p = system.field, system.values
    x = np.column_stack([state(system, seed)[0] for seed in range(5)])
    dp = np.eye(len(p))[field.parameters.index("alpha")]
    values, jacobians, slopes = field.f(x, p), field.f_x(x, p), field.f_p(x, p, dp)
    assert jacobians.shape == (5, len(x), len(x))
    for k in range(5):
        agree(values[:, k], field.f(x[:, k], p), 1e-14)
        agree(slopes[:, k], field.f_p(x[:, k], p, dp), 1e-13)
        np.testing.assert_allclose(jacobians[k], field.f_x(x[:, k], p), rtol=1e-13, atol=1e-13)
    forms = field.f_xx(x[:, 0], p, x, x[:, ::-1])
    moved = field.f_xp(x[:, 0], p, x, dp)
    for k in range(5):
        agree(forms[:, k], field.f_xx(x[:, 0], p, x[:, k], x[:, 4 - k]), 1e-13)
        agree(moved[:, k], field.f_xp(x[:, 0], p, x[:, k], dp), 1e-13)


@pytest.mark.parametrize("turn", [1.0, np.exp(0.7j)], ids=["real", "complex"])
@pytest.mark.parametrize("moves", ["alpha", "law", "none"])
def test_forms_along_many_points_equal_those_at_each(system, turn, moves):
    field, p = system.field, system.values
    x, u, v, w = (
        np.column_stack([state(system, 4 * seed + k)[0] for seed in range(5)]) for k in range(4)
    )
    u, v = u * turn, v / turn**2
    dp = np.zeros(len(p))
    if moves == "alpha":
        dp[field.parameters.index("alpha")] = 1.0
    elif moves == "law":
        dp += np.random.default_rng(1).uniform(0.0, 0.1, len(p)) * np.abs(p)
    else:
        dp[0] = 1.0
    found = {
        "xx": field.f_xx_along(x, p, u, v),
        "xxx": field.f_xxx_along(x, p, u, v, w),
        "xp": field.f_xp_along(x, p, u, dp),
    }
    assert all(form.shape == x.shape for form in found.values())
    for k in range(5):
        at, a, b, c = x[:, k], u[:, k], v[:, k], w[:, k]
        agree(found["xx"][:, k], field.f_xx(at, p, a, b), 1e-13)
        agree(found["xxx"][:, k], field.f_xxx(at, p, a, b, c), 1e-13)
        agree(found["xp"][:, k], field.f_xp(at, p, a, dp), 1e-13)
    loops = (
        VectorField.f_xx_along(field, x, p, u, v),
        VectorField.f_xxx_along(field, x, p, u, v, w),
        VectorField.f_xp_along(field, x, p, u, dp),
    )
    for form, loop in zip(found.values(), loops, strict=True):
        np.testing.assert_allclose(form, loop, rtol=1e-12, atol=1e-12 * np.abs(loop).max())


def test_other_parameters_are_noticed(system):
    """What is kept from call to call belongs to the parameters it was made for."""
    x, _ = state(system, 1)
    field, p = system.field, system.values
    first = field.f(x, p)
    q = p.copy()
    q[field.parameters.index("alpha")] = 0.5
    fresh = System(system.compiled, q, system.settings).field.f(x, q)
    assert np.abs(fresh - first).max() > 1e-3
    np.testing.assert_array_equal(field.f(x, q), fresh)
    np.testing.assert_array_equal(field.f(x, p), first)


def test_jacobians_may_be_written_on(system):
    x, _ = state(system, 1)
    field, p = system.field, system.values
    before = field.f_x(x, p).copy()
    field.f_x(x, p)[:] = 0.0
    np.testing.assert_array_equal(field.f_x(x, p), before)


def test_the_realised_filter_is_the_one_of_the_realisation(system):
    """(i omega - f_x)^-1 between input and output of the element gives its frequency response."""
    field, p = system.field, system.values
    ny, frame = 4, system.field.frame(system.values)
    (f,) = frame.filters
    jacobian = field.f_x(np.zeros(len(field.states)), p)
    s = 3.0j
    B = jacobian[ny:, system.states.index("delta_c")]
    memory = np.linalg.solve(s * np.eye(len(B)) - jacobian[ny:, ny:], B)
    assert f.C @ memory + f.D == pytest.approx(complex(f(s)[0]), rel=1e-12)
    (law,) = frame.laws
    assert abs(f(s)[0] / law(s) - 1.0) < 0.05


def test_rest_is_at_rest_and_tells_the_exact_point(system):
    x = system.equilibrium()
    residual = system.field.f(x, system.values)
    assert np.abs(residual).max() < 1e-10
    X = system.exact_point(x, system.values)
    assert np.abs(system.exact.residual(X, system.values)).max() < 1e-7  # N(0) e - w and forces
    assert X[4] == pytest.approx(X[2], rel=1e-11)  # Z(0) = 1: delta_z = delta_c


@pytest.mark.parametrize("what", ["compiled", "system", "field"])
def test_pickles(system, what):
    x, _ = state(system, 0)
    expected = system.field.f(x, system.values)
    system.field.f_xx(x, system.values, x, x)  # everything loaded
    if what == "compiled":
        core = pickle.loads(pickle.dumps(system.compiled))
        assert core.digest == system.compiled.digest
        value = System(core, system.values, system.settings).field.f(x, system.values)
    elif what == "system":
        again = pickle.loads(pickle.dumps(system))
        assert again.parameters == system.parameters
        value = again.field.f(x, again.values)
    else:
        value = pickle.loads(pickle.dumps(system.field)).f(x, system.values)
    np.testing.assert_array_equal(value, expected)


def test_a_model_without_elements(system_of, differences):
    """Van der Pol in plain form: the same interface, no memory."""
    system = system_of(
        {"x": "y", "y": "mu*(1 - x**2)*y - x"}, parameters={"mu": 1.5}, guess={"x": 0.1}
    )
    field, p, x = system.field, system.values, np.array([0.7, -0.4])
    assert field.states == ("x", "y")
    assert system.realisation.states == 0
    assert system.realisation.name == "none"
    assert system.realisation.error == 0.0
    assert len({system, system.with_parameters({})}) == 2
    np.testing.assert_allclose(field.f(x, p), [-0.4, 1.5 * 0.51 * -0.4 - 0.7], rtol=1e-15)
    exact = [[0.0, 1.0], [-2.0 * 1.5 * 0.7 * -0.4 - 1.0, 1.5 * 0.51]]
    np.testing.assert_allclose(field.f_x(x, p), exact, rtol=1e-14)
    np.testing.assert_allclose(field.f_p(x, p, np.ones(1)), [0.0, 0.51 * -0.4], rtol=1e-14)
    # f2_xxx = -2 mu for (x, x, y) in any order
    e1, e2 = np.eye(2)
    np.testing.assert_allclose(field.f_xxx(x, p, e1, e2, e1), [0.0, -3.0], rtol=1e-15)
    np.testing.assert_allclose(field.f_xp(x, p, e2, np.ones(1)), [0.0, 0.51], rtol=1e-15)
    np.testing.assert_allclose(system.equilibrium(), 0.0, atol=1e-12)


def test_names_of_states_where_a_parameter_of_a_law_is_calibrated(system_of):
    system = system_of({"x": "-x-w"}, elements=[("w", "x", "c*s**0.5")], parameters={"c": 2.0})
    (given,), names = system.compiled.parameters, system.field.states
    computed = replace(given, default=Calibration("c", {"c": 1.0}, (0.0, 2.0)))
    compiled = copy(system.compiled)
    compiled.parameters = (computed,)
    assert RealisedField(compiled, system.settings).states == names


def test_two_elements_and_an_integrator(system_of, differences):
    """Feedthrough of one into the other; a law that integrates; parameters in all of them."""
    system = system_of(
        {"x": "y", "y": "-w - r*x**2 - k*y + b", "z": "x - z + r"},
        elements=[
            ("w", "x + 0.2*z", "(1 + s**a)/(2 + s**(a/2))"),
            ("r", "x - c + 0.1*w", "1/s**q"),
        ],
        parameters={"k": 0.7, "b": 0.3, "c": 0.4, "a": 0.6, "q": 0.8},
        guess={"x": 0.3, "r": 0.5},
        realisation=Diffusive(band=(0.1, 10.0)),
    )
    field, p = system.field, system.values
    rng = np.random.default_rng(0)
    n = len(field.states)
    x, v = rng.uniform(-1.0, 1.0, n), rng.uniform(-1.0, 1.0, n)
    jacobian = field.f_x(x, p)
    for k, unit in enumerate(np.eye(n)):
        column = differences(lambda t, unit=unit: field.f(x + t * unit, p), 0.0, 1e-3)
        agree(jacobian[:, k], column, 1e-8)
    for dp in np.eye(len(p)):
        slope = differences(lambda t, dp=dp: field.f(x, p + t * dp), 0.0, 1e-3)
        agree(field.f_p(x, p, dp), slope, 1e-8, 1e-7)
        slope = differences(lambda t, dp=dp: field.f_x(x, p + t * dp) @ v, 0.0, 1e-3)
        agree(field.f_xp(x, p, v, dp), slope, 1e-8, 1e-7)
    at_rest = system.equilibrium()
    assert np.abs(field.f(at_rest, p)).max() < 1e-11
    X = system.exact_point(at_rest, p)
    # the integrator demands x + 0.1 w = c, the first element rests at w = (x + 0.2 z)/2
    assert X[0] - 0.4 + 0.1 * X[3] == pytest.approx(0.0, abs=1e-12)
    assert X[3] == pytest.approx((X[0] + 0.2 * X[2]) / 2.0, rel=1e-12)


def test_outputs_of_an_element_that_passes_its_input_on(system_of, differences):
    """Z(0) = n/d, and Z tends to one: its output has a share of its input at once."""
    system = system_of(
        {"x": "b - w*(1 + x)", "y": "w - y"},
        elements=[("w", "x + y", "(n + s**q)/(d + s**q)")],
        parameters={"b": 3.0, "n": 2.0, "d": 5.0, "q": 0.6},
    )
    field, p = system.field, system.values
    rest = system.equilibrium()
    X = system.exact_point(rest, p)
    assert field.outputs(rest, p) == pytest.approx([X[2]], rel=1e-10)
    assert X[2] == pytest.approx(0.4 * (X[0] + X[1]), rel=1e-10)
    rng = np.random.default_rng(0)
    x, v = rng.normal(size=(2, len(rest)))
    slope = differences(lambda t: field.outputs(x + t * v, p), 0.0, 1e-3)
    np.testing.assert_allclose(field.outputs_along(x, p, v), slope, rtol=1e-9)
    both = field.outputs(np.column_stack([rest, x]), p)
    np.testing.assert_allclose(both.T, [field.outputs(rest, p), field.outputs(x, p)], rtol=1e-13)


def test_outputs_tell_where_there_are_no_states(system_of, vehicle):
    elements = [("x", "1 - x + y", "s**(-q)"), ("y", "x - 2*y", "s**(-q)")]
    field = system_of({}, elements=elements, parameters={"q": 0.6}).field
    p = np.array([0.6])
    rng = np.random.default_rng(1)
    x, v = rng.normal(size=(2, len(field.states)))
    assert field.stateless
    np.testing.assert_array_equal(field.telling(x, p, v, 0), field.outputs_along(x, p, v))
    x, v = (state(vehicle, seed)[0] for seed in (0, 1))
    assert not vehicle.field.stateless
    np.testing.assert_array_equal(vehicle.field.telling(x, vehicle.values, v, 4), v[:4])


def test_forms_along_many_points_where_an_output_is_squared(system_of):
    """The filter's output moves with the order of its law, and the slope with the output."""
    system = system_of(
        {"x": "b - w**2 - x*w"}, elements=[("w", "x", "1 + s**q")], parameters={"b": 3.0, "q": 0.6}
    )
    field, p = system.field, system.values
    rng = np.random.default_rng(0)
    x, v = rng.normal(size=(2, len(field.states), 5))
    for dp in np.eye(2):
        found = field.f_xp_along(x, p, v, dp)
        wanted = [field.f_xp(x[:, k], p, v[:, k], dp) for k in range(5)]
        np.testing.assert_allclose(found.T, wanted, rtol=1e-12, atol=1e-12)
