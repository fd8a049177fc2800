import numpy as np
import pytest

from racs_bif.continuation.settings import StepSettings
from racs_bif.continuation.stopped import Stopped
from racs_bif.continuation.trace import trace
from racs_bif.errors import ConvergenceError, UsageError
from racs_bif.fractional.exact_hopf import solve_hopf
from racs_bif.orbits import (
    BranchPointOfCycles,
    FoldOfCycles,
    NeimarkSacker,
    PeriodDoubling,
    fourier,
    from_samples,
)
from racs_bif.orbits.balance import Balance
from racs_bif.orbits.balance_settings import BalanceSettings
from racs_bif.orbits.balance_start import (
    balanced_from_hopf,
    from_exact_hopf,
    from_profile,
    small_orbit,
)
from racs_bif.orbits.exact_expansion import expand
from racs_bif.orbits.hill import exact_multiplier
from racs_bif.shelf.load import load_model, system_of
from racs_bif.symbolic.strings import model_from_strings

STEPS = StepSettings(maximum=0.1, tolerance=1e-8)
DETECTORS = (FoldOfCycles(), BranchPointOfCycles(), PeriodDoubling(), NeimarkSacker())
VAN_DER_POL = {"x": "y", "y": "mu*(1 - x**2)*y - x"}
BRUSSELATOR = {"x": "A - (B + 1)*x + x**2*y", "y": "B*x - x**2*y"}
# a law that integrates and one fed by a nonlinearity, one state whose rate is another
MIXED = {"x": "y", "y": "mu*(1 - x**2)*y - c*x - v - 0.2*w", "z": "w - z"}
ELEMENTS = [("v", "x", "k*s**(-q)"), ("w", "x + x**3/5", "(1 + s**a)/(1 + (2*s)**b)")]


def built(equations, guess, elements=(), **parameters):
    model = model_from_strings(
        "test", equations, parameters=parameters, guess=guess, elements=elements
    )
    return system_of(model)


def exact_hopf(system, name, value, omega):
    path = system.path(name)
    p = path.vector(value)
    X = system.exact_point(system.equilibrium(p), p)
    return path, solve_hopf(system.exact, path, X, value, omega)


@pytest.fixture(scope="module")
def relaxed():
    """Van der Pol orbits from mu = 0.1 to 5, by harmonic balance from 2 cos t."""
    system = built(VAN_DER_POL, {"x": 0.0, "y": 0.0}, mu=0.1)
    t = np.linspace(0.0, 2 * np.pi, 65)
    start = from_profile(
        *(system.exact, system.path("mu"), t, [2 * np.cos(t), -2 * np.sin(t)], 0.1),
        settings=BalanceSettings(tail=1e-11, most_harmonics=400),
    )
    found = trace(start.problem, start.z, (0.1, 5.0), DETECTORS, STEPS, direction=1, targets=(1,))
    return start.problem, found


@pytest.fixture(scope="module")
def vehicle():
    system = load_model("racs")
    path, hopf = exact_hopf(system, "u", 10.2, 9.52)
    start = from_exact_hopf(system.exact, path, hopf)
    found = trace(
        start.problem,
        start.z,
        (10.0, 18.0),
        DETECTORS,
        StepSettings(maximum=0.05, tolerance=1e-8),
        tangent=start.tangent,
        direction=1,
        targets=(12.0,),
    )
    return system, hopf, start, found


# ---------------------------------------------------------------------- Fourier series


def test_series_and_spectrum_are_the_same_function():
    rng = np.random.default_rng(1)
    series = rng.standard_normal((11, 3))
    spectrum = fourier.to_complex(series)
    np.testing.assert_allclose(fourier.to_real(spectrum), series, atol=1e-15)
    points = fourier.points_for(5)
    t = np.arange(points) / points
    k = np.arange(1, 6)[:, None]
    angle = 2 * np.pi * k * t
    values = (series[:1].T + series[1:6].T @ np.cos(angle)) + series[6:].T @ np.sin(angle)
    np.testing.assert_allclose(fourier.sampled(spectrum, points), values, atol=1e-13)
    np.testing.assert_allclose(fourier.evaluated(spectrum, t), values, atol=1e-13)
    np.testing.assert_allclose(fourier.analysed(values, 5), spectrum, atol=1e-14)
    slopes = fourier.to_complex(fourier.turned(series))
    np.testing.assert_allclose(slopes, 1j * np.arange(6)[:, None] * spectrum, atol=1e-14)


def test_extrema_lie_between_the_samples():
    series = np.zeros((9, 2))
    series[1, 0], series[5, 0], series[0, 1] = 3.0, 4.0, 7.0  # 5 cos(theta - 0.927), and 7
    highest, lowest = fourier.extrema(fourier.to_complex(series))
    np.testing.assert_allclose([highest, lowest], [[5.0, 7.0], [-5.0, 7.0]], rtol=1e-14)


def test_resizing_keeps_what_fits():
    series = np.arange(14.0).reshape(7, 2)
    np.testing.assert_array_equal(fourier.resized(fourier.resized(series, 8), 3), series)
    np.testing.assert_array_equal(fourier.resized(series, 1), series[[0, 1, 4]])


# ---------------------------------------------------------------------- the equations


def test_only_the_unknowns_of_the_nonlinearity_are_left(vehicle):
    problem = vehicle[2].problem
    states = (*problem.balance.compiled.states, *problem.balance.compiled.elements)
    assert [states[k] for k in problem.balance.kept] == ["v", "w", "delta_c"]


def test_a_ring_of_rates_is_not_eliminated_away():
    system = built({"x": "y", "y": "-x", "r": "mu*r - r**3 + x"}, {"r": 0.1}, mu=0.5)
    balance = Balance(system.exact, system.path("mu"), 0.5)
    assert len(balance.kept) == 2


def test_an_integrating_element_is_kept():
    values = {"mu": 0.5, "c": 0.7, "q": 0.4, "k": 0.3, "a": 0.6, "b": 0.5}
    system = built(MIXED, {"x": 0.0, "y": 0.0, "z": 0.0}, ELEMENTS, **values)
    balance = Balance(system.exact, system.path("mu"), 0.5)
    names = (*balance.compiled.states, *balance.compiled.elements)
    assert [names[k] for k in balance.kept] == ["x", "z", "v", "w"]


@pytest.mark.parametrize("name", ["mu", "c", "q", "k", "a", "b"])
def test_derivatives_against_differences(name):
    values = {"mu": 0.5, "c": 0.7, "q": 0.4, "k": 0.3, "a": 0.6, "b": 0.5}
    system = built(MIXED, {"x": 0.0, "y": 0.0, "z": 0.0}, ELEMENTS, **values)
    path, value, period = system.path(name), values[name], 5.3
    balance = Balance(system.exact, path, value)
    rng = np.random.default_rng(2)
    decay = np.concatenate((np.arange(1.0, 8.0), np.arange(2.0, 8.0))) ** -2.0
    series = rng.standard_normal((13, len(balance.kept))) * decay[:, None]
    here = balance.at(series, period, value)
    size, step = series.size, 1e-6

    def difference(change, by_period=0.0, by_value=0.0):
        ends = [
            balance.at(series + s * change, period + s * by_period, value + s * by_value).residual
            for s in (step, -step)
        ]
        return (ends[0] - ends[1]) / (2 * step)

    columns = [difference(unit.reshape(series.shape)).ravel() for unit in np.eye(size)]
    jacobian = here.jacobian.reshape(size, size)
    np.testing.assert_allclose(jacobian, np.array(columns).T, atol=2e-8)
    still = np.zeros_like(series)
    np.testing.assert_allclose(here.slopes[0], difference(still, by_period=1.0), atol=2e-9)
    np.testing.assert_allclose(here.slopes[1], difference(still, by_value=1.0), atol=2e-9)


def test_jacobian_of_the_problem_against_differences(vehicle):
    _, _, start, found = vehicle
    problem, z = start.problem, found.points[10].z
    exact = problem.jacobian(z)
    scales = np.append(problem.scales(z), 1.0)
    for k in (0, 1, 5, 60, 64, len(z) - 3, len(z) - 2, len(z) - 1):
        step = np.zeros(len(z))
        step[k] = 1e-6 * scales[k]
        change = (problem.residual(z + step) - problem.residual(z - step)) / (2 * step[k])
        size = np.abs(exact[:, k]).max()
        np.testing.assert_allclose(change, exact[:, k], atol=2e-8 * max(size, 1.0))


# ---------------------------------------------------------------------- known orbits


@pytest.mark.parametrize(("mu", "period"), [(0.1, 6.2871112722887), (5, 11.61223066772)])
def test_van_der_pol_at_the_ends(relaxed, mu, period):
    problem, found = relaxed
    point = found.points[0 if mu == 0.1 else -1]
    assert point.parameter == mu
    assert problem.period(point.z) == pytest.approx(period, rel=1e-12)
    assert point.stable


def test_van_der_pol_between(relaxed):
    problem, found = relaxed
    z = found["UZ1"].z
    assert problem.period(z) == pytest.approx(6.6632868593231, rel=1e-12)
    assert problem.extrema(z)[0][0] == pytest.approx(2.00861986, abs=5e-9)
    assert found.stopped is Stopped.SPAN
    assert [s.label for s in found.special] == ["UZ"]


def test_harmonics_follow_the_tail(relaxed):
    _, found = relaxed
    counts = [p.measures["harmonics"] for p in found.points]
    assert counts[0] == 20
    assert counts[-1] > 150
    assert max(p.measures["tail"] for p in found.points[1:]) < 1e-8


def test_error_decays_spectrally(relaxed):
    """The orbit converges geometrically, and its period twice as fast."""
    problem, found = relaxed
    z = found["UZ1"].z
    period, highest = problem.period(z), problem.extrema(z)[0][0]
    counts = np.array([10, 14, 18, 22])
    coarse = [problem.with_harmonics(z, int(h))[0] for h in counts]
    periods = [abs(problem.period(c) - period) for c in coarse]
    heights = [abs(problem.extrema(c)[0][0] - highest) for c in coarse]
    rates = [np.polyfit(counts, np.log(error), 1)[0] for error in (heights, periods)]
    assert rates[0] < -0.3
    assert rates[1] == pytest.approx(2.0 * rates[0], rel=0.3)
    assert periods[-1] < 1e-9


def test_brusselator_needs_no_second_order_structure():
    system = built(BRUSSELATOR, {"x": 1.0, "y": 1.5}, B=1.5, A=1.0)
    path, hopf = exact_hopf(system, "B", 2.0, 1.0)
    settings = BalanceSettings(tail=1e-11, most_harmonics=400)
    start = from_exact_hopf(system.exact, path, hopf, settings=settings)
    found = trace(
        *(start.problem, start.z, (1.9, 3.0), DETECTORS, STEPS),
        tangent=start.tangent,
        direction=1,
        targets=(2.5,),
    )
    first, last = found["UZ1"], found.points[-1]
    assert start.problem.period(first.z) == pytest.approx(6.577284341906, rel=1e-12)
    assert start.problem.period(last.z) == pytest.approx(7.15691992118, rel=1e-11)
    assert last.spectrum[1] == pytest.approx(2.516e-4, rel=1e-3)
    assert [s.label for s in found.special] == ["UZ"]


# ---------------------------------------------------------------------- starts


def test_small_orbits_are_predicted_to_second_order(vehicle):
    system, hopf, _, _ = vehicle
    path = system.path("u")
    start = from_exact_hopf(system.exact, path, hopf)
    expansion = expand(system.exact, path, hopf)
    errors = []
    for amplitude in (0.02, 0.01):
        guess = small_orbit(start, hopf, amplitude, expansion)
        row = np.zeros(len(guess))
        row[3:6] = 1.0  # hold the cosine coefficients of the first harmonic together
        z = guess.copy()
        for _ in range(6):
            right = np.append(start.problem.residual(z), row @ (z - guess))
            z -= start.problem.bordered(z, row)(right)
        errors.append(abs(z[-1] - guess[-1]))
    assert errors[0] / errors[1] == pytest.approx(16.0, rel=0.2)


def test_the_exact_hopf_point_is_found_from_the_realisation(vehicle):
    system, hopf, start, _ = vehicle
    path = system.path("u")
    p = path.vector(10.3)
    near = balanced_from_hopf(
        system.field, path, np.append(system.equilibrium(p), 10.3), 9.3, np.empty(0)
    )
    assert near.z[-1] == pytest.approx(hopf.value, abs=1e-12)
    np.testing.assert_allclose(near.z, start.z, atol=1e-12)


def test_a_vector_field_alone_is_refused(van_der_pol):
    field, path = van_der_pol
    with pytest.raises(UsageError, match="take shooting or collocation"):
        balanced_from_hopf(field, path, [0.0, 0.0, 0.0], 1.0, np.array([1.0, 1j]))


@pytest.mark.parametrize(
    ("times", "profile", "text"),
    [
        ([0, 1, 2], [[0, 1, 0]], "m of at least 5"),
        ([0, 1, 2, 3, 3], np.ones((2, 5)), "must rise"),
        ([0, 1, 2, 3, 4], np.ones((2, 5)), "must move"),
    ],
)
def test_samples_that_are_no_orbit(times, profile, text):
    system = built(VAN_DER_POL, {"x": 0.0, "y": 0.0}, mu=1.0)
    with pytest.raises(UsageError, match=text):
        from_profile(system.exact, system.path("mu"), times, profile, 1.0)


# ---------------------------------------------------------------------- the door


def test_points_know_their_phase_condition(vehicle):
    problem, found = vehicle[2].problem, vehicle[3]
    for point in found.points[1::6]:
        residual = problem.residual(point.z)
        # the last rows: phase and number
        assert np.abs(residual[-2:]).max() < 1e-6
    with pytest.raises(UsageError, match="no orbit of this branch"):
        problem.residual(np.append(found.points[3].z[:-2], (1e4, 12.0)))


def test_memory_states_are_the_realisation_in_step_with_the_orbit(vehicle):
    system, _, start, found = vehicle
    z = found["UZ1"].z
    orbit = start.problem.orbit(z)
    assert orbit.states == system.field.states
    np.testing.assert_allclose(orbit.profile[:, 0], orbit.profile[:, -1], atol=1e-12)
    # shooting on the realisation moves it by no more than the realisation is off
    shot = from_samples(system.field, system.path("u"), orbit.times, orbit.profile, 12.0)
    row = np.zeros(len(shot.z))
    row[-1] = 1.0
    x = shot.z
    for _ in range(6):
        x = x - shot.problem.bordered(x, row)(np.append(shot.problem.residual(x), 0.0))
    assert shot.problem.period(x) == pytest.approx(orbit.period, rel=1e-3)
    multipliers = shot.problem.spectrum(x)
    np.testing.assert_allclose(multipliers[1:4], orbit.multipliers[1:4], atol=0.02)


def test_the_result_says_where_the_multipliers_come_from(vehicle):
    problem, found = vehicle[2].problem, vehicle[3]
    said = problem.remarks(found["UZ1"].z)
    assert "realisation" in said["stability by"]
    assert said["tail"] < 1e-8


def test_stability_is_unknown_where_the_realisation_does_not_tell(vehicle):
    problem = vehicle[2].problem
    assert problem.stable(np.array([1.001, 0.5 + 0j])) is True
    assert problem.stable(np.array([1.001, 1.5 + 0j])) is False
    assert problem.stable(np.array([1.2, 0.5 + 0j])) is None
    assert problem.stable(np.empty(0, dtype=complex)) is None


def test_a_negative_period_is_no_solution(vehicle):
    problem, found = vehicle[2].problem, vehicle[3]
    z = found.points[3].z.copy()
    z[-3] = -1.0
    with pytest.raises(ConvergenceError, match="not positive"):
        problem.residual(z)


def test_a_branch_ends_where_harmonics_run_out():
    system = built(VAN_DER_POL, {"x": 0.0, "y": 0.0}, mu=0.1)
    t = np.linspace(0.0, 2 * np.pi, 65)
    start = from_profile(
        *(system.exact, system.path("mu"), t, [2 * np.cos(t), -2 * np.sin(t)], 0.1),
        settings=BalanceSettings(harmonics=8, most_harmonics=12, poorest=1e-4),
    )
    found = trace(start.problem, start.z, (0.1, 5.0), (), STEPS, direction=1)
    assert found.stopped is Stopped.ACCURACY
    assert found.points[-1].measures["harmonics"] == 12


def test_a_branch_that_shrinks_to_an_equilibrium_ends():
    """r' = m (1 - m) r - r^3: orbits live between the Hopf points 0 and 1."""
    system = built(
        {"x": "m*(1 - m)*x - y - x*(x**2 + y**2)", "y": "x + m*(1 - m)*y - y*(x**2 + y**2)"},
        {"x": 0.0, "y": 0.0},
        m=0.0,
    )
    path, hopf = exact_hopf(system, "m", 0.0, 1.0)
    start = from_exact_hopf(system.exact, path, hopf)
    found = trace(
        *(start.problem, start.z, (-0.5, 1.5), DETECTORS, STEPS),
        tangent=start.tangent,
        direction=1,
    )
    assert found.stopped is Stopped.VANISHED
    assert found.points[-1].parameter == pytest.approx(1.0, abs=1e-3)
    assert not found.special
    largest = max(p.measures["max x"] for p in found.points)
    assert largest == pytest.approx(0.5, rel=1e-2)


@pytest.mark.parametrize(
    "settings",
    [
        {"tail": 0.0},
        {"trivial": float("nan")},
        {"harmonics": 3},
        {"harmonics": 30, "most_harmonics": 20},
        {"steps": 0},
    ],
)
def test_settings_out_of_range(settings):
    with pytest.raises(UsageError, match="harmonic balance"):
        BalanceSettings(**settings)


# ---------------------------------------------------------------------- Hill's method


def test_hill_agrees_with_the_monodromy_of_an_ordinary_equation():
    """Langford's torus point: multipliers of the full system at rho below and above it."""
    equations = {
        "x": "(z - 0.7)*x - om*y",
        "y": "om*x + (z - 0.7)*y",
        "z": "0.6 + al*z - z**3/3 - (x**2 + y**2)*(1 + rho*z)",
    }
    system = built(equations, {"z": 0.7}, rho=0.5, om=3.5, al=0.95)
    # the orbit is exact: z = 0.7, a circle with r^2 (1 + 0.7 rho) = 0.6 + 0.7 al - 0.7^3 / 3
    radius = np.sqrt((0.6 + 0.7 * 0.95 - 0.343 / 3) / 1.35)
    t = np.linspace(0.0, 2 * np.pi / 3.5, 65)
    profile = [radius * np.cos(3.5 * t), radius * np.sin(3.5 * t), 0.7 + 1e-9 * np.cos(3.5 * t)]
    start = from_profile(system.exact, system.path("rho"), t, profile, 0.5)
    z = start.problem.solved(start.z)
    assert start.problem.period(z) == pytest.approx(2 * np.pi / 3.5, rel=1e-13)
    spectrum = start.problem.spectrum(z)
    found = exact_multiplier(start.problem.solution(z), spectrum[1])
    # z'' = (al - z0^2 - rho r^2) z' - 2 r^2 (1 + rho z0) z about the orbit
    trace_, product = 0.95 - 0.49 - 0.5 * radius**2, 2 * radius**2 * 1.35
    root = 0.5 * trace_ + 1j * np.sqrt(product - 0.25 * trace_**2)
    expected = np.exp(root * 2 * np.pi / 3.5)
    assert min(abs(found.multiplier - m) for m in (expected, expected.conj())) < 1e-10
    assert min(abs(spectrum[1] - m) for m in (expected, expected.conj())) < 1e-6


def test_hill_does_not_return_the_trivial_multiplier(vehicle):
    problem, found = vehicle[2].problem, vehicle[3]
    solution = problem.solution(found["UZ1"].z)
    with pytest.raises(ConvergenceError, match="no multiplier near"):
        exact_multiplier(solution, 1.0 + 1e-4)
