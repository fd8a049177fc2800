"""Periodic orbits of the exact fractional operator: acceptance.md, Fractional 6; model.md, 4."""

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.continuation.settings import StepSettings
from racs_bif.continuation.trace import trace
from racs_bif.fractional.diffusive import Diffusive
from racs_bif.fractional.exact_hopf import solve_hopf
from racs_bif.orbits.balance_settings import BalanceSettings
from racs_bif.orbits.balance_start import from_exact_hopf, small_orbit
from racs_bif.orbits.exact_crossing import exact_crossing
from racs_bif.orbits.exact_expansion import expand
from racs_bif.orbits.hill import exact_multiplier

KAPPA = 50.3487
STEPS = StepSettings(maximum=0.05, tolerance=1e-8)


@pytest.fixture(scope="module")
def vehicle():
    """The exact Hopf point of the vehicle; its realisation is good to low frequencies."""
    system = rb.load_model("racs", realisation=Diffusive(band=(0.05, 60.0), order=14))
    path = system.path("u")
    p = path.vector(10.2)
    X = system.exact_point(system.equilibrium(p), p)
    return system, path, solve_hopf(system.exact, path, X, 10.2, 9.52)


@pytest.fixture(scope="module")
def window(vehicle):
    """The branch beyond the short window in which the orbit is unstable."""
    system, path, hopf = vehicle
    settings = BalanceSettings(tail=1e-6)
    start = from_exact_hopf(system.exact, path, hopf, settings=settings)
    found = trace(
        *(start.problem, start.z, (10.0, 21.4), (), STEPS),
        tangent=start.tangent,
        direction=1,
        targets=(21.0, 21.277, 21.2785, 21.32, 21.33),
    )
    return start.problem, {s.parameter: s for s in found.special}, found


@pytest.fixture(scope="module")
def branch():
    """The verb's own branch at default settings, from the realised Hopf point of the diagram."""
    equilibria = rb.continue_equilibria(rb.load_model("racs"), "u", (9, 18))
    return rb.continue_orbits(equilibria["H1"], method="harmonic-balance", at=(12, 18))


@pytest.mark.parametrize(
    ("u", "period", "low", "high"),
    [(12, 0.7393668, -0.0839322, 0.0754349), (18, 1.1496047, -0.1095942, 0.1009184)],
)
def test_vehicle_orbits(branch, u, period, low, high):
    point = branch.at(u=u)
    assert point.period == pytest.approx(period, abs=6e-8)
    assert branch.measures["min delta_c"][point.index] == pytest.approx(low, abs=6e-8)
    assert branch.measures["max delta_c"][point.index] == pytest.approx(high, abs=6e-8)
    assert branch.stable[point.index]
    assert "realisation" in point.data["stability by"]


def test_vehicle_branch_starts_at_the_exact_hopf_point(branch):
    assert branch.method == "harmonic-balance"
    assert branch.column("u")[0] == pytest.approx(10.2, abs=1e-9)
    assert branch.measures["period"][0] == pytest.approx(2 * np.pi / 9.5200832, rel=1e-8)
    assert not branch.early
    assert [p.label for p in branch.special] == ["UZ", "UZ"]


def test_vehicle_amplitude_from_the_expansion_and_from_small_orbits(vehicle):
    """u - u_H = kappa A^2, A the first harmonic of delta_c."""
    system, path, hopf = vehicle
    expansion = expand(system.exact, path, hopf)
    steering = 2.0 * abs(hopf.q[system.states.index("delta_c")])
    assert expansion.parameter / steering**2 == pytest.approx(KAPPA, abs=5e-5)
    start = from_exact_hopf(system.exact, path, hopf)
    problem = start.problem
    place = problem.balance.kept.index(system.states.index("delta_c"))
    ratios = []
    for amplitude in (0.01, 0.005):
        z = problem.solved(small_orbit(start, hopf, amplitude, expansion))
        series = problem.series(z)
        first = np.hypot(series[1, place], series[1 + problem.harmonics(z), place])
        ratios.append(((z[-1] - hopf.value) / first**2, first**2))
    (a, A), (b, B) = ratios
    assert (b * A - a * B) / (A - B) == pytest.approx(KAPPA, abs=5e-4)


def test_vehicle_loses_stability_in_a_short_window(window):
    """Both ends are NS points of the exact operator, by Hill's method."""
    problem, at, _ = window
    guesses = ((21.277, 21.2785, 0.9961 + 0.0122j), (21.32, 21.33, 1.0036 + 0.0580j))
    ends = [exact_crossing(problem, at[a].z, at[b].z, guess) for a, b, guess in guesses]
    assert [end.value for end in ends] == pytest.approx([21.277672, 21.324400], abs=2e-6)
    assert [abs(end.multiplier) for end in ends] == pytest.approx([1.0, 1.0], abs=1e-9)
    angles = [abs(np.angle(end.multiplier)) for end in ends]
    assert angles == pytest.approx([0.01096, 0.06478], abs=2e-5)
    inside = exact_multiplier(problem.solution(at[21.32].z), 1.0036 + 0.0580j)
    assert abs(inside.multiplier) > 1.004


def test_vehicle_has_no_fold_before_the_window_ends(window):
    problem, at, found = window
    u = np.array([p.parameter for p in found.points])
    assert np.all(np.diff(u) > 0.0)
    assert problem.period(at[21.0].z) == pytest.approx(2.04517, rel=1e-5)
    assert max(p.measures["tail"] for p in found.points) < 1e-5


@pytest.mark.parametrize(
    ("mu", "omega", "highest"),
    [(0.4, 1.1758762053, 0.860161194111), (1.0, 1.1503136123, 1.643220549382)],
)
def test_van_der_pol_with_a_springpot(springpot, mu, omega, highest):
    """The maxima differ from acceptance.md's (.8601611934, 1.6432206301) by 7e-10 and 8e-8.

    Those here solve the equation, evaluated independently of the project, to rounding.
    """
    problem, found = springpot
    z = problem.solved(next(s.z for s in found.special if s.parameter == mu))
    period = problem.period(z)
    assert 2 * np.pi / period == pytest.approx(omega, abs=1e-9)
    assert problem.extrema(z)[0][0] == pytest.approx(highest, abs=1e-11)
    k = np.arange(problem.harmonics(z) + 1)
    s = 2j * np.pi / period * k
    x = problem.solution(z).spectrum[:, 0]
    turns = np.exp(2j * np.pi * np.outer(k, np.linspace(0.0, 1.0, 1001)))

    def in_time(spectrum):
        return 2.0 * (spectrum @ turns).real - spectrum[0].real

    place, rate, acceleration = in_time(x), in_time(s * x), in_time(s**2 * x)
    balance = acceleration - mu * (1 - place**2) * rate + 0.5 * in_time(s**0.5 * x) + place
    assert np.abs(balance).max() < 1e-10
    assert place.max() == pytest.approx(highest, abs=1e-5)


@pytest.fixture(scope="module")
def springpot():
    model = rb.model_from_strings(
        "springpot",
        {"x": "y", "y": "mu*(1 - x**2)*y - c*w - x"},
        parameters={"mu": 0.3, "c": 0.5, "a": 0.5},
        guess={"x": 0.0, "y": 0.0},
        elements=[("w", "x", "s**a")],
    )
    equilibria = rb.continue_equilibria(model, "mu", (0.2, 1.1))
    origin = equilibria["H1"].origin
    exact = equilibria["H1"].exact
    path = origin.system.path("mu")
    hopf = solve_hopf(origin.system.exact, path, np.zeros(3), exact.parameters["mu"], exact.omega)
    assert hopf.value == pytest.approx(0.3259981216, abs=1e-10)
    assert hopf.omega == pytest.approx(1.1761963238, abs=1e-10)
    settings = BalanceSettings(tail=1e-12)
    start = from_exact_hopf(origin.system.exact, path, hopf, settings=settings)
    found = trace(
        *(start.problem, start.z, (0.2, 1.1), (), STEPS),
        tangent=start.tangent,
        direction=1,
        targets=(0.4, 1.0),
    )
    return start.problem, found
