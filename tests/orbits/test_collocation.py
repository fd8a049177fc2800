import math

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.continuation import Stopped, trace
from racs_bif.errors import ConvergenceError, ModelError, UsageError
from racs_bif.orbits import (
    BranchPointOfCycles,
    CollocationSettings,
    FoldOfCycles,
    NeimarkSacker,
    PeriodDoubling,
    collocated_from_hopf,
    collocated_from_orbit,
    collocated_from_samples,
    doubled,
    from_samples,
    switched,
)
from racs_bif.orbits.condense import BorderedRing, Ring
from racs_bif.orbits.equations import Equations
from racs_bif.orbits.folded import BorderedFolds, Folds
from racs_bif.orbits.gauss import gauss
from racs_bif.orbits.lowrank import LowRankStages, modes
from racs_bif.orbits.mesh import Mesh
from racs_bif.orbits.piecewise import Piecewise, equidistant
from racs_bif.orbits.stages import FactoredStages, InvertedStages, interval_matrices

LAM, W = 0.25, 1.7
PERIOD = 2 * np.pi / W
Q = np.array([1.0, -1.0j]) / np.sqrt(2.0)


def circle(turns=1.0):
    angle = np.linspace(0.0, 2 * np.pi, 65) * turns
    return np.array([0.5 * np.cos(angle), 0.5 * np.sin(angle)])


@pytest.fixture
def on_circle(hopf):
    def build(**settings):
        times = np.linspace(0.0, PERIOD, 65)
        settings = CollocationSettings(**settings)
        return collocated_from_samples(*hopf, times, circle(), LAM, settings=settings)

    return build


def solved(start, z=None, *, hold=-1):
    """Solve with one unknown held, by a plain Newton on the bordered solver."""
    problem, z = start.problem, np.array(start.z if z is None else z)
    row = np.zeros(len(z))
    row[hold] = 1.0
    for _ in range(15):
        step = problem.bordered(z, row)(np.append(problem.residual(z), 0.0))
        z = z - step
        if np.abs(step).max() < 1e-11:
            return z
    raise AssertionError("the tests' Newton did not converge")


def detectors():
    return [FoldOfCycles(), BranchPointOfCycles(), PeriodDoubling(), NeimarkSacker()]


def run(start, span, **options):
    options = {"tangent": start.tangent, "direction": 1, **options}
    return trace(start.problem, start.z, span, detectors(), **options)


# ----------------------------------------------------------------------- the coefficients


@pytest.mark.parametrize("degree", range(2, 8))
def test_coefficients_are_those_of_the_gauss_methods(degree):
    g = gauss(degree)
    powers = np.arange(degree + 1)
    nodes = np.linspace(0.0, 1.0, degree + 1)[:, None] ** powers
    np.testing.assert_allclose(g.values @ nodes, g.abscissae[:, None] ** powers, atol=1e-13)
    slopes = powers * g.abscissae[:, None] ** np.maximum(powers - 1, 0)
    np.testing.assert_allclose(g.slopes @ nodes, slopes, atol=1e-11)
    assert g.weights @ g.abscissae ** (2 * degree - 1) == pytest.approx(1 / (2 * degree))
    # the end of the interval is the quadrature: x + b A A^-1 (Y - x)
    matrix = np.linalg.inv(g.inverse)
    np.testing.assert_allclose(matrix.sum(axis=1), g.abscissae, atol=1e-13)
    np.testing.assert_allclose(g.weights @ g.inverse, g.end, atol=1e-10)
    assert g.end_start == pytest.approx(1.0 - g.end.sum(), abs=1e-11)
    assert abs(g.end_start - (-1.0) ** degree) < 1e-9  # stability function at infinity
    assert np.polynomial.polynomial.polyval(1.0, g.error) == pytest.approx(0.0, abs=1e-13)


# ------------------------------------------------------------------------- the Jacobians


def rough(problem, start, seed=0):
    """Return unknowns near an orbit but not on it."""
    rng = np.random.default_rng(seed)
    z = start.z + 0.02 * rng.standard_normal(len(start.z)) * problem.magnitudes(start.z)
    z[-2] = 0.0
    return z


def uneven(start, seed=1):
    """Return a start's problem and solution on an uneven mesh."""
    problem, z = start.problem, solved(start)
    count = problem.reference(z).mesh.steps
    widths = 1.0 + 0.8 * np.random.default_rng(seed).random(count)
    nodes = np.concatenate(([0.0], np.cumsum(widths) / widths.sum()))
    nodes[-1] = 1.0
    return problem, problem.on_mesh(z, Mesh(nodes, 1))[0]


@pytest.mark.parametrize("degree", [2, 3, 4, 5])
def test_jacobian_against_differences(on_circle, degree):
    problem, z = uneven(on_circle(intervals=12, degree=degree))
    rng = np.random.default_rng(2)
    z[:-3] += 0.02 * rng.standard_normal(len(z) - 3)
    jacobian = problem.jacobian(z).toarray()
    for _ in range(3):
        direction = rng.standard_normal(len(z))
        direction[-2] = 0.0
        h = 1e-6
        ahead, behind = problem.residual(z + h * direction), problem.residual(z - h * direction)
        difference = (ahead - behind) / (2 * h)
        np.testing.assert_allclose(jacobian @ direction, difference, atol=2e-8 * len(z))
    assert jacobian[-1, -2] == 1.0


@pytest.fixture(scope="module")
def vehicle():
    """A start of the vehicle's branch of orbits, 12 states, and rough unknowns along it."""
    hopf = rb.continue_equilibria(rb.load_model("racs"), "u", (8, 12))["H1"]
    origin, form = hopf.origin, hopf.origin.raw.data["form"]
    start = collocated_from_hopf(
        origin.system.field,
        origin.problem.path,
        origin.raw.z,
        form.omega,
        form.q,
        form=form,
        settings=CollocationSettings(intervals=6),
    )
    z = rough(start.problem, start)
    z[:-3] += 5.0 * start.tangent[:-3]
    return start.problem, z


def test_jacobian_of_the_vehicle_against_differences(vehicle):
    problem, z = vehicle
    direction = np.random.default_rng(3).standard_normal(len(z)) * problem.magnitudes(z)
    direction[-2] = 0.0
    h = 1e-6
    difference = (problem.residual(z + h * direction) - problem.residual(z - h * direction)) / 2 / h
    exact = problem.jacobian(z) @ direction
    assert np.abs(exact - difference).max() < 1e-8 * np.abs(exact).max()


# ------------------------------------------------------------------- the linear algebra


def assert_solves(problem, z):
    rng = np.random.default_rng(4)
    magnitudes = problem.magnitudes(z)
    row = rng.standard_normal(len(z)) / magnitudes
    rhs = rng.standard_normal((len(z), 3))
    matrix = np.vstack([problem.jacobian(z).toarray(), row])
    expected = np.linalg.solve(matrix, rhs) / magnitudes[:, None]
    found = problem.bordered(z, row)(rhs) / magnitudes[:, None]
    np.testing.assert_allclose(found, expected, atol=1e-9 * np.abs(expected).max())
    one = problem.bordered(z, row)(rhs[:, 0])
    np.testing.assert_allclose(one / magnitudes, found[:, 0], atol=1e-12 * np.abs(expected).max())
    tangent = row * magnitudes**2
    scaled = np.vstack([problem.jacobian(z).toarray() * magnitudes, tangent / magnitudes])
    assert np.sign(problem.singularity(z, tangent)) == np.linalg.slogdet(scaled)[0]


def test_small_systems_are_solved_by_inverses(on_circle):
    problem, z = uneven(on_circle(intervals=7, degree=3))
    assert isinstance(problem.linearised(z).stages, InvertedStages)
    assert_solves(problem, z)


def test_systems_of_few_varying_entries_are_solved_by_modes(vehicle):
    problem, z = vehicle
    assert isinstance(problem.linearised(z).stages, LowRankStages)
    assert_solves(problem, z)


def test_other_systems_are_solved_by_factors(vehicle, monkeypatch):
    problem, z = vehicle
    monkeypatch.setattr(problem.field, "structure", lambda _p: None)
    monkeypatch.setattr(problem, "_bases", [])
    assert isinstance(problem.linearised(z).stages, FactoredStages)
    assert_solves(problem, z)


def test_modes_that_are_nearly_dependent_are_not_used(vehicle, monkeypatch):
    problem, z = vehicle
    monkeypatch.setattr("racs_bif.orbits.equations.CONDITION", 1.0)
    monkeypatch.setattr(problem, "_bases", [])
    assert isinstance(problem.linearised(z).stages, FactoredStages)


def test_modes_and_factors_eliminate_alike():
    rng = np.random.default_rng(5)
    g, n, k, r, tau = gauss(3), 9, 2, 4, np.array([0.1, 0.4, 0.05, 0.2, 2.0])
    constant, left = rng.standard_normal((n, n)), rng.standard_normal((n, k))
    right, varying = rng.standard_normal((r, n)), rng.standard_normal((5, 3, k, r))
    matrices = interval_matrices(g, constant + left @ varying @ right, tau)
    by_modes = LowRankStages(g, modes(constant), left, right, varying, tau)
    rhs = rng.standard_normal((2, 5, 3, n))
    for dense in (FactoredStages(g, matrices.copy()), InvertedStages(g, matrices.copy())):
        for one, other in (
            (dense.solve(rhs), by_modes.solve(rhs)),
            (dense.adjoint(rhs), by_modes.adjoint(rhs)),
            (dense.at_ends(rhs), by_modes.at_ends(rhs)),
            (dense.transitions(), by_modes.transitions()),
        ):
            np.testing.assert_allclose(one, other, atol=1e-9 * np.abs(one).max())


@pytest.mark.parametrize("count", [1, 2, 5, 12])
@pytest.mark.parametrize("size", [2, 3])
@pytest.mark.parametrize("growth", [0.0, 3.0, 1e9])
def test_ring_solution_and_sign_however_far_it_is_multiplied(count, size, growth):
    rng = np.random.default_rng(6 + count)
    transitions = rng.standard_normal((count, size, size))
    columns, rows = rng.standard_normal((count, size, 2)), rng.standard_normal((2, count, size))
    corner, rhs = rng.standard_normal((2, 2)), rng.standard_normal((count, size, 3))
    border = rng.standard_normal((2, 3))
    solver = BorderedFolds(Folds(transitions, growth), columns, rows, corner)
    points, unknowns = solver.solve(rhs, border)
    ends = transitions @ points + columns @ unknowns + rhs
    np.testing.assert_allclose(ends, np.roll(points, -1, axis=0), atol=1e-9)
    met = np.einsum("rkn,knc->rc", rows, points) + corner @ unknowns
    np.testing.assert_allclose(met, border, atol=1e-9)
    product = (
        np.linalg.multi_dot([*transitions[::-1], np.eye(size)]) if count > 1 else transitions[0]
    )
    minus = np.broadcast_to(-np.eye(size), transitions.shape)
    ring = Ring(transitions, minus)
    bare = BorderedRing(ring, columns[:, :, :0], rows[:0], corner[:0, :0])
    assert bare.sign() == np.sign(np.linalg.det(product - np.eye(size)))


# ------------------------------------------------------------------ orbits known exactly


def test_hopf_normal_form(on_circle):
    start = on_circle()
    z = solved(start)
    problem = start.problem
    assert problem.period(z) == pytest.approx(PERIOD, rel=1e-12)
    orbit = problem.orbit(z)
    np.testing.assert_allclose(np.hypot(*orbit.profile), 0.5, rtol=1e-8)
    np.testing.assert_allclose([orbit.maxima, orbit.minima], [[0.5, 0.5], [-0.5, -0.5]], rtol=1e-10)
    np.testing.assert_allclose(orbit.multipliers, [1.0, np.exp(-2 * LAM * PERIOD)], rtol=1e-10)
    assert orbit.stable is True
    assert orbit.times[-1] == orbit.period


@pytest.mark.parametrize(("degree", "counts"), [(2, (48, 96)), (3, (48, 96)), (4, (24, 48))])
def test_mesh_points_converge_with_twice_the_degree(van_der_pol, degree, counts):
    angle = np.linspace(0.0, 2 * np.pi, 65)
    ring = np.array([2 * np.cos(angle), -2 * np.sin(angle)])
    exact = 6.6632868593231306
    errors, inner, estimates = [], [], []
    for count in counts:
        settings = CollocationSettings(intervals=count, degree=degree)
        start = collocated_from_samples(*van_der_pol, angle, ring, 1.0, settings=settings)
        z = solved(start)
        errors.append(abs(start.problem.period(z) - exact))
        fine = start.problem.on_mesh(z, Mesh.uniform(4 * count, 1))[0]
        # off the mesh points, but on the finer mesh's
        times = (np.arange(4 * count) + 0.5) / (4 * count)
        gap = start.problem.curve(z)(times) - start.problem.curve(fine)(times)
        inner.append(np.abs(gap).max())
        scales = start.problem.curve(z).ranges()
        estimates.append(start.problem.curve(z).errors(np.ones(2)).max())
        assert np.all(scales > 3.0)
    assert math.log2(errors[0] / errors[1]) == pytest.approx(2 * degree, abs=0.5)
    assert math.log2(inner[0] / inner[1]) == pytest.approx(degree + 1, abs=0.5)
    assert 0.2 < estimates[1] / inner[1] < 5.0


def test_multipliers_that_span_twenty_decades(written):
    r2 = "(x**2 + y**2)"
    field, path = written(
        {
            "x": f"lam*x - w*y - x*{r2}",
            "y": f"w*x + lam*y - y*{r2}",
            "a": "k*a",
            "b": "-k*b",
        },
        lam=LAM,
        w=W,
        k=6.5,
    )
    times = np.linspace(0.0, PERIOD, 65)
    profile = np.vstack([circle(), np.zeros((2, 65))])
    start = collocated_from_samples(field, path, times, profile, LAM)
    found = start.problem.spectrum(solved(start))
    growth = 6.5 * PERIOD
    expected = [1.0, np.exp(growth), np.exp(-2 * LAM * PERIOD), np.exp(-growth)]
    assert expected[1] > 1e10
    np.testing.assert_allclose(found, expected, rtol=1e-6)


def test_extrema_between_the_nodes():
    mesh = Mesh.uniform(16, 1)
    times = equidistant(mesh, 4)
    shifts = np.linspace(0.0, 0.05, 40)
    curve = Piecewise(mesh, np.sin(2 * np.pi * (times[..., None] - shifts)))
    highest, lowest = curve.extrema()
    np.testing.assert_allclose(highest, 1.0, atol=3e-6)
    np.testing.assert_allclose(lowest, -1.0, atol=3e-6)
    values = curve(np.linspace(0.0, 1.0, 1001))
    assert np.abs(values.max(axis=0) - 1.0).max() > np.abs(highest - 1.0).max()


# --------------------------------------------------------------------------- branches


def test_branch_from_a_hopf_point_has_no_events_there(hopf):
    start = collocated_from_hopf(*hopf, [0.0, 0.0, 0.0], W, Q)
    found = run(start, (-1.0, 1.0), targets=[0.5])
    assert found.stopped is Stopped.SPAN
    assert [special.label for special in found.special] == ["UZ"]
    first, *others = found.points
    assert len(first.spectrum) == 0
    for point in others:
        assert point.measures["max x"] == pytest.approx(math.sqrt(point.parameter), rel=1e-7)
        assert point.measures["mesh error"] < 1e-6
        contraction = np.exp(-4 * np.pi * point.parameter / W)
        np.testing.assert_allclose(point.spectrum, [1.0, contraction], rtol=1e-7)


def test_branch_ends_at_another_hopf_point(written):
    r2, growth = "(x**2 + y**2)", "(lam*(1 - lam)"
    field, path = written(
        {"x": f"{growth} - {r2})*x - w*y", "y": f"w*x + {growth} - {r2})*y"}, lam=0.0, w=W
    )
    found = run(collocated_from_hopf(field, path, [0.0, 0.0, 0.0], W, Q), (-1.0, 2.0))
    assert found.stopped is Stopped.VANISHED
    assert found.special == []
    assert found.points[-1].parameter == pytest.approx(1.0, abs=5e-3)


def test_intervals_follow_the_error(van_der_pol):
    angle = np.linspace(0.0, 2 * np.pi, 65)
    ring = np.array([2 * np.cos(angle), -2 * np.sin(angle)])
    settings = CollocationSettings(intervals=20, tolerance=1e-6)
    start = collocated_from_samples(*van_der_pol, angle, ring, 0.1, settings=settings)
    found = run(start, (0.1, 8.0))
    assert found.stopped is Stopped.SPAN
    assert found.points[0].measures["intervals"] == 20
    last = found.points[-1]
    assert last.measures["intervals"] > 40
    mesh = start.problem.reference(last.z).mesh
    assert mesh.widths.max() > 5.0 * mesh.widths.min()
    # solved again on a mesh of twice as many intervals, the period is the same
    halves = np.sort(np.concatenate((mesh.nodes, 0.5 * (mesh.nodes[1:] + mesh.nodes[:-1]))))
    finer = start.problem.on_mesh(last.z, Mesh(halves, 1))[0]
    assert start.problem.period(finer) == pytest.approx(last.measures["period"], rel=1e-7)
    equal = collocated_from_samples(*van_der_pol, angle, ring, 0.1, settings=settings)
    again = run(equal, (0.1, 8.0))
    assert all(np.array_equal(a.z, b.z) for a, b in zip(found.points, again.points, strict=True))


def test_symmetry_breaking_and_the_branch_that_leaves_there(written):
    # a circle in x, y with a pitchfork in z: z' = (lam - 1) z - z^3 beside r = 1
    r2 = "(x**2 + y**2)"
    field, path = written(
        {"x": f"(1 - {r2})*x - w*y", "y": f"w*x + (1 - {r2})*y", "z": "(lam - 1)*z - z**3"},
        lam=0.5,
        w=W,
    )
    times = np.linspace(0.0, PERIOD, 65)
    ring = np.vstack([2.0 * circle(), np.zeros(65)])
    start = collocated_from_samples(field, path, times, ring, 0.5)
    found = run(start, (0.5, 1.5))
    assert [special.label for special in found.special] == ["BPC"]
    crossing = found["BPC1"]
    assert crossing.parameter == pytest.approx(1.0, abs=1e-8)
    other = run(switched(start.problem, crossing.z, crossing.tangent), (0.5, 1.5))
    assert other.stopped is Stopped.SPAN
    last = other.points[-1]
    assert last.parameter == 1.5
    level = max(last.measures["max z"], -last.measures["min z"])
    assert level == pytest.approx(math.sqrt(0.5), rel=1e-8)
    ordinary = found.points[0]
    with pytest.raises(UsageError, match="no other branch"):
        switched(start.problem, ordinary.z, ordinary.tangent)
    with pytest.raises(UsageError, match="no multiplier -1"):
        doubled(start.problem, ordinary.z)


def test_an_orbit_of_another_discretisation_is_taken_over(van_der_pol):
    angle = np.linspace(0.0, 2 * np.pi, 65)
    ring = np.array([2 * np.cos(angle), -2 * np.sin(angle)])
    shot = from_samples(*van_der_pol, angle, ring, 1.0)
    problem, z = shot.problem, shot.z
    for _ in range(8):
        row = np.zeros(len(z))
        row[-1] = 1.0
        z = z - problem.bordered(z, row)(np.append(problem.residual(z), 0.0))
    start = collocated_from_orbit(problem, z, van_der_pol[1])
    assert np.abs(start.problem.residual(start.z)).max() < 1e-3
    assert start.problem.period(solved(start)) == pytest.approx(6.6632868593231, rel=1e-9)


# ---------------------------------------------------------------------------- user errors


def test_an_orbit_of_another_problem_is_refused(on_circle):
    one, other = on_circle(intervals=8), on_circle(intervals=9)
    with pytest.raises(UsageError, match="do not fit"):
        one.problem.residual(other.z)
    z = one.z.copy()
    z[-2] = 7.0
    with pytest.raises(UsageError, match="another branch"):
        one.problem.residual(z)


def test_periods_that_are_not_positive_and_fields_that_fail(on_circle, monkeypatch):
    start = on_circle()
    z = start.z.copy()
    z[-3] = -1.0
    with pytest.raises(ConvergenceError, match="not positive"):
        start.problem.residual(z)

    def broken(_x, _p):
        raise KeyError("spring")

    monkeypatch.setattr(start.problem.field, "f", broken)
    with pytest.raises(ModelError, match=r"raised KeyError \('spring'\): make"):
        start.problem.residual(start.z * 1.01)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"degree": 1}, "degree"),
        ({"degree": 8}, "degree"),
        ({"intervals": 2}, "intervals"),
        ({"intervals": 100, "most_intervals": 50}, "intervals"),
        ({"tolerance": float("nan")}, "tolerance"),
    ],
)
def test_settings_are_checked(change, message):
    with pytest.raises(UsageError, match=message):
        CollocationSettings(**change)


def test_structure_is_the_jacobian(vehicle):
    problem, z = vehicle
    p = problem.path.vector(z[-1])
    structure = problem.field.structure(p)
    points = np.ascontiguousarray(problem.nodes(z).reshape(-1, len(problem.field.states)).T)
    whole = structure.constant + structure.left @ structure.varying(points) @ structure.right
    np.testing.assert_allclose(whole, problem.field.f_x(points, p), atol=1e-9)
    assert structure.rank == 3


def test_equations_count_every_evaluation_of_a_newton_step(hopf, on_circle):
    start = on_circle()
    equations = start.problem.equations
    assert isinstance(equations, Equations)
    before = equations.checked.count
    start.problem.residual(start.z)
    start.problem.bordered(start.z, np.eye(len(start.z))[-1])
    start.problem.residual(start.z)
    assert equations.checked.count == before + 1  # kept, not evaluated again
