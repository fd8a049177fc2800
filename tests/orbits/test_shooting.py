import numpy as np
import pytest

from racs_bif.errors import ConvergenceError, ModelError, UsageError
from racs_bif.orbits import OrbitSettings, from_samples, refined
from racs_bif.orbits.mesh import Mesh

LAM, W = 0.25, 1.7
PERIOD = 2 * np.pi / W


def circle(turns=1.0):
    angle = np.linspace(0.0, 2 * np.pi, 65) * turns
    return 0.5 * np.cos(angle), 0.5 * np.sin(angle)


@pytest.fixture
def on_circle(hopf):
    def build(**settings):
        times = np.linspace(0.0, PERIOD, 65)
        return from_samples(
            *hopf, times, np.array(circle()), LAM, settings=OrbitSettings(**settings)
        )

    return build


def solved(start, *, hold=-1):
    """Solve with one unknown held, by a plain Newton on the dense Jacobian."""
    problem, z = start.problem, start.z.copy()
    for _ in range(12):
        keep = np.zeros(len(z))
        keep[hold] = 1.0
        matrix = np.vstack([problem.jacobian(z), keep])
        step = np.linalg.solve(matrix, np.append(problem.residual(z), 0.0))
        z = z - step
        if np.abs(step).max() < 1e-12:
            return z
    raise AssertionError("the tests' Newton did not converge")


@pytest.mark.parametrize("segments", [1, 2, 8])
def test_hopf_normal_form(on_circle, segments):
    start = on_circle(segments=segments)
    z = solved(start)
    problem = start.problem
    assert problem.period(z) == pytest.approx(PERIOD, rel=1e-9)
    orbit = problem.orbit(z)
    np.testing.assert_allclose(np.hypot(*orbit.profile), 0.5, rtol=2e-7)
    np.testing.assert_allclose([orbit.maxima, orbit.minima], [[0.5, 0.5], [-0.5, -0.5]], rtol=1e-8)
    np.testing.assert_allclose(orbit.multipliers, [1.0, np.exp(-2 * LAM * PERIOD)], rtol=1e-7)
    assert orbit.trivial_error < 1e-10
    assert orbit.stable is True
    assert orbit.value == LAM
    assert orbit.times[-1] == orbit.period


def test_bent_coordinates_have_the_same_period_and_multipliers(bent_hopf):
    times = np.linspace(0.0, PERIOD, 65)
    x, y = circle()
    # the third state's steady solution of c' = -3 c + a b is left to Newton
    start = from_samples(*bent_hopf, times, np.array([x, y + x**2 / 2, 0.03 * x]), LAM)
    z = solved(start)
    expected = [1.0, np.exp(-2 * LAM * PERIOD), np.exp(-3 * PERIOD)]
    assert start.problem.period(z) == pytest.approx(PERIOD, rel=1e-8)
    np.testing.assert_allclose(start.problem.spectrum(z), expected, rtol=2e-6)
    # extrema of b = y + x^2/2 on the circle of radius 1/2: at y = 1/2, and at y = -1/2
    highest, lowest = start.problem.extrema(z)
    np.testing.assert_allclose([highest[1], lowest[1]], [0.5, -0.5], rtol=1e-7)


@pytest.fixture
def relaxed(van_der_pol):
    """A Van der Pol orbit from a simulation's tail."""
    from scipy.integrate import solve_ivp

    field, path = van_der_pol

    def build(mu, **settings):
        p = np.array([mu])
        found = solve_ivp(
            lambda _t, x: field.f(x, p),
            (0.0, 80.0),
            [2.0, 0.0],
            rtol=1e-7,
            atol=1e-9,
            dense_output=True,
            events=lambda _t, x: x[1],
        )
        begin, end = found.t_events[0][[-3, -1]]
        times = np.linspace(begin, end, 400)
        return from_samples(
            field, path, times, found.sol(times), mu, settings=OrbitSettings(**settings)
        )

    return build


def test_van_der_pol_period_and_maximum(relaxed):
    start = relaxed(1.0, steps=128)
    z = solved(start)
    assert start.problem.period(z) == pytest.approx(6.6632868593231, abs=5e-8)
    assert start.problem.extrema(z)[0][0] == pytest.approx(2.00861986, abs=1e-8)


def test_period_converges_with_order_five(relaxed):
    errors = []
    for steps in (40, 80, 160):
        start = relaxed(1.0, steps=steps)
        errors.append(abs(start.problem.period(solved(start)) - 6.6632868593231))
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert np.all(orders > 4.5), orders


def test_adapted_mesh_resolves_a_relaxation_orbit(relaxed):
    start = relaxed(5.0, steps=200)
    equal = Mesh.uniform(200, start.problem.reference(start.z).mesh.segments)
    z = start.problem.on_mesh(solved(start), equal)[0]  # the start itself is finer where it is fast
    before = abs(start.problem.period(z) - 11.61223066772)
    hold = np.zeros(len(z))
    hold[-1] = 1.0
    uniform = z
    z, tangent = start.problem.adapt(z, start.problem.tangent(z, hold))
    mesh = start.problem.reference(z).mesh
    adapted = start.problem.on_mesh(uniform, mesh)[0]  # at the same parameter
    after = abs(start.problem.period(adapted) - 11.61223066772)
    assert mesh.steps <= 200
    assert adapted[-1] == 5.0
    assert after < 2e-6
    assert after < before / 50
    # what adapt returns is a solution, and its tangent is the branch's
    jacobian = start.problem.jacobian(z)
    assert np.abs(start.problem.residual(z)).max() < 1e-8
    assert np.abs(jacobian @ tangent).max() < 1e-7 * np.abs(jacobian).max()


def test_refined_estimates_the_error(relaxed):
    start = relaxed(1.0, steps=40)
    z = solved(start)
    exact = 6.6632868593231
    error = abs(start.problem.period(z) - exact) / exact
    found = refined(start.problem, z)
    assert found.period == pytest.approx(error, rel=0.1)
    assert abs(found.orbit.period - exact) < 0.1 * error * exact
    assert found.extremes.max() < 1e-5
    assert found.multiplier < 1e-5


def test_single_and_multiple_shooting_agree(relaxed):
    found = []
    for segments in (1, 4, 16):
        start = relaxed(1.0, segments=segments)
        z = solved(start)
        found.append([start.problem.period(z), *start.problem.spectrum(z).real])
    np.testing.assert_allclose(found[1], found[0], rtol=1e-9)
    np.testing.assert_allclose(found[2], found[0], rtol=1e-9)


@pytest.mark.parametrize("segments", [1, 4])
def test_jacobian_against_differences(relaxed, segments):
    start = relaxed(1.0, segments=segments, steps=32)
    problem = start.problem
    z = start.z + 0.01 * np.sin(np.arange(len(start.z)))  # away from the solution
    z[-2] = start.z[-2]
    jacobian = problem.jacobian(z)
    for column in range(len(z)):
        step = np.zeros(len(z))
        step[column] = 1e-5
        difference = (problem.residual(z + step) - problem.residual(z - step)) / 2e-5
        np.testing.assert_allclose(jacobian[:, column], difference, atol=2e-7, err_msg=f"{column}")


@pytest.mark.parametrize("segments", [1, 4, 72])  # dense, dense and condensed
def test_bordered_solves_the_jacobian(relaxed, segments):
    start = relaxed(1.0, segments=segments, steps=72)
    problem, z = start.problem, start.z
    row = np.cos(np.arange(len(z)))
    rhs = np.sin(np.arange(2.0 * len(z)).reshape(-1, 2))
    solution = problem.bordered(z, row)(rhs)
    np.testing.assert_allclose(np.vstack([problem.jacobian(z), row]) @ solution, rhs, atol=1e-8)
    np.testing.assert_allclose(problem.bordered(z, row)(rhs[:, 0]), solution[:, 0])


def test_no_time_shift_is_left(on_circle):
    start = on_circle()
    z = solved(start)
    assert start.problem.reference(z).phase(start.problem.flow(z).stages) == pytest.approx(0.0)
    # an orbit shifted in time by a small s has the phase s
    shifted = z.copy()
    angle = 2 * np.pi * (Mesh.uniform(64, 8).starts + 1e-3)
    shifted[:-3] = np.column_stack([0.5 * np.cos(angle), 0.5 * np.sin(angle)]).ravel()
    assert start.problem.residual(shifted)[-2] == pytest.approx(1e-3, rel=1e-4)


def test_earlier_solutions_keep_their_mesh(relaxed):
    start = relaxed(5.0, steps=200)
    problem, z = start.problem, solved(start)
    hold = np.zeros(len(z))
    hold[-1] = 1.0
    profile = problem.orbit(z).profile
    later = [z]
    for _ in range(9):  # more than are kept whole
        later.append(problem.adapt(later[-1], problem.tangent(later[-1], hold))[0])
    assert problem.reference(later[-1]).mesh is not problem.reference(z).mesh
    np.testing.assert_allclose(problem.orbit(z).profile, profile, atol=1e-10)
    for orbit in later:  # old phase conditions are computed again
        assert np.abs(problem.residual(orbit)).max() < 1e-8


def test_unknowns_of_another_problem_are_refused(on_circle):
    start = on_circle()
    foreign = start.z.copy()
    foreign[-2] = 7
    with pytest.raises(UsageError, match="mesh 7 of another branch"):
        start.problem.residual(foreign)
    with pytest.raises(UsageError, match="do not fit"):
        start.problem.residual(start.z[2:])


def test_period_that_is_not_positive(on_circle):
    start = on_circle()
    z = start.z.copy()
    z[-3] = -1.0
    with pytest.raises(ConvergenceError, match="not positive"):
        start.problem.residual(z)


def test_a_field_that_raises_is_the_users_error(on_circle, monkeypatch):
    start = on_circle()

    def broken(_x, _p):
        raise KeyError("spring")

    monkeypatch.setattr(start.problem.field, "f", broken)
    with pytest.raises(ModelError, match=r"raised KeyError \('spring'\): make"):
        start.problem.residual(start.z)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"segments": 0}, "segments"),
        ({"steps": 4}, "steps"),
        ({"tolerance": float("nan")}, "tolerance"),
        ({"growth": 0.5}, "growth"),
    ],
)
def test_settings_are_checked(change, message):
    with pytest.raises(UsageError, match=message):
        OrbitSettings(**change)


@pytest.mark.parametrize(
    ("times", "profile", "message"),
    [
        (np.linspace(0, 1, 9), np.zeros((2, 9)), "must move"),
        (np.linspace(0, 1, 9), np.zeros((3, 9)), "2 states"),
        (np.linspace(1, 0, 9), np.eye(2, 9), "must rise"),
        (np.linspace(0, 1, 3), np.eye(2, 3), "at least 5"),
    ],
)
def test_samples_are_checked(hopf, times, profile, message):
    with pytest.raises(UsageError, match=message):
        from_samples(*hopf, times, profile, LAM)


def test_segments_are_halved_where_the_flow_grows(relaxed):
    start = relaxed(2.0, segments=1, growth=1.5)
    problem, z = start.problem, solved(start)
    hold = np.zeros(len(z))
    hold[-1] = 1.0
    finer, tangent = problem.adapt(z, problem.tangent(z, hold))
    assert problem.reference(finer).mesh.segments == 2
    assert len(finer) == len(tangent) == len(z) + 2
    assert problem.period(finer) == pytest.approx(problem.period(z), rel=1e-5)
    assert np.abs(problem.residual(finer)).max() < 1e-8
