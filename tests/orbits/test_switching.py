"""Branches that begin on other branches, by every discretisation."""

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.continuation import StepSettings, Stopped, trace
from racs_bif.errors import ConvergenceError, UsageError
from racs_bif.orbits import (
    BranchPointOfCycles,
    FoldOfCycles,
    NeimarkSacker,
    PeriodDoubling,
    from_samples,
)
from racs_bif.orbits.methods import METHODS, crossed, name_of
from racs_bif.orbits.same_orbit import distance, loop_of, loop_through
from racs_bif.orbits.settled import settled

W = 1.7
STEPS = StepSettings(maximum=0.05, tolerance=1e-8)


def detectors():
    return [FoldOfCycles(), BranchPointOfCycles(), PeriodDoubling(), NeimarkSacker()]


def run(start, span, **options):
    options = {"tangent": start.tangent, "direction": 1, **options}
    return trace(start.problem, start.z, span, detectors(), STEPS, **options)


@pytest.fixture(scope="module")
def adaptive():
    return rb.continue_equilibria(rb.load_model("adaptive_control"), "alpha", (0.5, 1.5))["H1"]


@pytest.fixture(scope="module", params=list(METHODS))
def doubling(request, adaptive):
    """The branch from the Hopf point to its period doubling, by each method."""
    method, origin = METHODS[request.param], adaptive.origin
    form = origin.raw.data["form"]
    path, z = origin.problem.path, origin.raw.z
    start = method.from_hopf(
        origin.system.field, path, z, form.omega, form.q, form=form, settings=None
    )
    found = run(start, (0.55, 1.2), targets={"period": [6.35]})
    return method, start.problem, found


def test_a_value_of_the_period_is_met_exactly(doubling):
    _, problem, found = doubling
    special = found["UZ1"]
    assert problem.period(special.z) == 6.35
    assert special.data == {"name": "period", "target": 6.35}
    assert special.parameter == pytest.approx(0.6999926935, rel=1e-6)


def test_a_doubled_branch_sets_off_and_doubles_again(doubling):
    method, problem, found = doubling
    pd = found["PD1"]
    assert pd.parameter == pytest.approx(0.63030200616, rel=1e-6)
    begun = method.doubled(problem, pd.z, pd.tangent)
    assert begun.problem.turns == 2
    assert np.abs(begun.problem.residual(begun.z)).max() < 1e-6
    twice = run(begun, (0.55, 1.2))
    assert [special.label for special in twice.special] == ["PD"]  # none at the doubling itself
    assert twice["PD1"].parameter == pytest.approx(0.579629840896, rel=1e-6)
    assert begun.problem.period(twice["PD1"].z) == pytest.approx(12.7343655422, rel=1e-6)
    assert twice.points[1].stable


def test_no_doubled_branch_leaves_an_ordinary_orbit(doubling):
    method, problem, found = doubling
    special = found["UZ1"]
    with pytest.raises(UsageError, match=r"no other branch|no multiplier -1"):
        method.doubled(problem, special.z, special.tangent)


def test_an_orbit_is_taken_over_on_its_own_mesh(doubling, adaptive):
    method, problem, found = doubling
    special = found["UZ1"]
    path = adaptive.origin.system.with_parameters({"alpha": special.parameter}).path("beta")
    begun = method.through(problem, special.z, path, 1.0)
    assert name_of(begun.problem) == name_of(problem)
    assert begun.problem.parameter == "beta"
    assert np.abs(begun.problem.residual(begun.z)).max() < 1e-7


def ring(turn=W, z=0.0):
    times = np.linspace(0.0, 2 * np.pi / turn, 65)
    return times, np.array([np.cos(turn * times), np.sin(turn * times), np.full(65, z)])


def branch_point(written, rate, method="collocation"):
    r2 = "(x**2 + y**2)"
    field, path = written(
        {"x": f"(1 - {r2})*x - w*y", "y": f"w*x + (1 - {r2})*y", "z": rate}, lam=0.5, w=W
    )
    start = METHODS[method].from_samples(field, path, *ring(), 0.5, settings=None)
    found = run(start, (0.5, 1.5))
    assert [special.label for special in found.special] == ["BPC"]
    return start.problem, found["BPC1"]


@pytest.mark.parametrize("method", ["shooting", "collocation"])
def test_a_broken_symmetry_is_left_orthogonally_and_one_way(written, method):
    problem, point = branch_point(written, "(lam - 1)*z - z**3", method)
    other = crossed(problem, point.z, point.tangent)
    assert other.symmetric
    found = trace(
        other.problem, other.z, (0.5, 1.5), detectors(), STEPS, tangent=other.direction, direction=1
    )
    assert [special.label for special in found.special] == []
    levels = [max(abs(p.measures["max z"]), abs(p.measures["min z"])) for p in found.points]
    expected = [np.sqrt(max(p.parameter - 1.0, 0.0)) for p in found.points]
    np.testing.assert_allclose(levels[2:], expected[2:], atol=1e-5)


@pytest.mark.parametrize("method", ["shooting", "collocation"])
def test_a_transversal_crossing_is_left_along_the_other_branch(written, method):
    # z = 0 and z = 2 (lam - 1) cross at lam = 1
    problem, point = branch_point(written, "z*(2*(lam - 1) - z)", method)
    other = crossed(problem, point.z, point.tangent)
    assert not other.symmetric
    found = trace(
        other.problem,
        other.z,
        (0.5, 1.5),
        detectors(),
        STEPS,
        tangent=other.direction,
        direction=None,
    )
    assert (found.points[0].parameter, found.points[-1].parameter) == (0.5, 1.5)
    for p in found.points:
        assert p.measures["max z"] == pytest.approx(2.0 * (p.parameter - 1.0), abs=1e-6)


def test_no_branch_crosses_at_an_ordinary_orbit(written):
    problem, point = branch_point(written, "(lam - 1)*z - z**3")
    z, tangent = settled(problem, point.z - np.eye(len(point.z))[-1] * 0.2)
    with pytest.raises(UsageError, match="no other branch"):
        crossed(problem, z, tangent)


# ------------------------------------------------------------------------------- comparing orbits


def test_orbits_are_the_same_wherever_they_begin(van_der_pol):
    angle = np.linspace(0.0, 2.0 * np.pi, 65)
    guess = np.array([2.0 * np.cos(angle), -2.0 * np.sin(angle)])
    loops = []
    for method, shift in (("shooting", 0), ("collocation", 23)):
        turned = np.roll(guess[:, :-1], shift, axis=1)
        turned = np.concatenate([turned, turned[:, :1]], axis=1)
        start = METHODS[method].from_samples(*van_der_pol, angle, turned, 3.0, settings=None)
        z = settled(start.problem, start.z)[0]
        loops.append(loop_of(start.problem, z, 2))
    assert loops[0].sample(np.zeros(1))[0, 0] != pytest.approx(
        loops[1].sample(np.zeros(1))[0, 0], abs=0.1
    )
    assert distance(*loops) < 1e-5


def test_orbits_of_one_period_and_one_parameter_can_differ():
    times = np.linspace(0.0, 1.0, 401)
    wave = np.cos(2 * np.pi * times)
    one = loop_through(times, np.array([wave, np.sin(2 * np.pi * times)]))
    other = loop_through(times, np.array([wave, 0.9 * np.sin(2 * np.pi * times)]))
    assert distance(one, one) < 1e-9
    assert distance(one, other) == pytest.approx(0.05 / np.sqrt(2.0), rel=0.1)


def test_a_guess_that_ends_in_an_equilibrium_is_refused(hopf):
    field, path = hopf
    times = np.linspace(0.0, 2 * np.pi / W, 65)
    tiny = 1e-7 * np.array([np.cos(W * times), np.sin(W * times)])
    start = from_samples(field, path, times, tiny, -0.2)  # below the Hopf point there are none
    with pytest.raises(ConvergenceError, match="no orbit near the guess"):
        settled(start.problem, start.z)


def test_a_step_onto_a_neighbouring_cycle_is_not_taken(written):
    # cycles of radius 1 and 1.06, turning at rates that part with lam
    r2 = "(x**2 + y**2)"
    pull, turn = f"(1 - {r2})*(1.1236 - {r2})", f"(w + lam*{r2})"
    field, path = written({"x": f"{pull}*x - {turn}*y", "y": f"{turn}*x + {pull}*y"}, lam=0.0, w=W)
    times, guess = ring()
    start = METHODS["collocation"].from_samples(field, path, times, guess[:2], 0.0, settings=None)
    coarse = StepSettings(initial=0.2, maximum=0.5, angle=1.0)
    found = trace(start.problem, start.z, (0.0, 5.0), detectors(), coarse, direction=1)
    assert found.stopped is Stopped.SPAN
    assert all(p.measures["max x"] == pytest.approx(1.0, abs=1e-5) for p in found.points)
