"""Whole branches of problems with exact solutions."""

import math
import re

import numpy as np
import pytest

from racs_bif.continuation import Problem, StepSettings, Stopped, trace
from racs_bif.continuation.start import begin
from racs_bif.errors import ConvergenceError, UsageError

LOCATED = 3e-11


def names(branch):
    return [special.name for special in branch.special]


def column(branch, place):
    return np.array([point.z[place] for point in branch.points])


def test_circle_closes_with_its_two_folds_and_every_target(kinds, circle):
    branch = trace(circle, [1, 0], (-2, 2), [kinds.Fold()], targets=[0.5])
    assert branch.stopped is Stopped.CLOSED
    assert branch.stopped_backward is None
    assert np.array_equal(branch.points[0].z, branch.points[-1].z)
    np.testing.assert_allclose(column(branch, 0) ** 2 + column(branch, 1) ** 2, 1, atol=1e-12)
    assert names(branch) == ["UZ1", "LP1", "UZ2", "LP2"]
    np.testing.assert_allclose(branch["LP1"].z, [0, 1], atol=LOCATED)
    np.testing.assert_allclose(branch["LP2"].z, [0, -1], atol=LOCATED)
    for name, sign in (("UZ1", 1), ("UZ2", -1)):
        assert branch[name].z[1] == 0.5
        assert branch[name].z[0] == pytest.approx(sign * math.sqrt(0.75), rel=1e-14)


def test_fold_is_at_zero_and_both_ends_are_exact(kinds, fold):
    branch = trace(fold, [1, 1], (-1, 2), [kinds.Fold()], targets=[0.25])
    assert names(branch) == ["UZ1", "LP1", "UZ2"]
    assert abs(branch["LP1"].z[1]) < 1e-20
    assert abs(branch["LP1"].z[0]) < LOCATED
    assert (branch["UZ1"].z[0], branch["UZ2"].z[0]) == pytest.approx((-0.5, 0.5), rel=1e-14)
    assert branch.stopped is branch.stopped_backward is Stopped.SPAN
    assert branch.points[0].z[1] == branch.points[-1].z[1] == 2.0
    assert branch.message == ""


def test_special_points_are_in_the_branch_in_order(kinds, fold):
    branch = trace(fold, [1, 1], (-1, 2), [kinds.Fold()], targets=[0.25, 0.5, 1.7])
    lengths = [point.arclength for point in branch.points]
    assert lengths == sorted(lengths)
    assert lengths[0] == 0.0
    for special in branch.special:
        point = branch.points[special.index]
        assert point.label == special.label
        assert np.array_equal(point.z, special.z)
        assert np.array_equal(point.tangent, special.tangent)
        chord = branch.points[special.index + 1].z - branch.points[special.index - 1].z
        assert chord @ special.tangent > 0
    indices = [special.index for special in branch.special]
    assert indices == sorted(set(indices))
    stability = [point.stable for point in branch.points if not point.label]
    assert stability == sorted(stability)


def test_pictures_are_smooth_without_choosing_a_step(fold):
    branch = trace(fold, [1, 1], (-1, 2))
    x, p = column(branch, 0), column(branch, 1)
    assert np.abs(np.diff(p)).max() <= 3 / 20
    assert np.abs(np.diff(x)).max() <= 2 * math.sqrt(2) / 20
    assert len(branch.points) < 200


@pytest.mark.parametrize("separation", [1.0, 1e-2, 1e-4, 1e-6])
def test_unfolded_cusp_has_two_folds_however_near(kinds, separation):
    cusp = kinds.Scalar(
        lambda x, p: p - x**3 + separation * x,
        lambda x, p: separation - 3 * x * x,
        lambda x, p: 1.0,
    )
    branch = trace(cusp, [-1, -1], (-1, 1.1), [kinds.Fold()])
    assert names(branch) == ["LP1", "LP2"]
    at = math.sqrt(separation / 3)
    np.testing.assert_allclose([branch["LP1"].z[0], branch["LP2"].z[0]], [-at, at], atol=LOCATED)
    value = 2 * at**3
    assert branch["LP1"].z[1] == pytest.approx(value, rel=1e-9, abs=0)
    assert branch["LP2"].z[1] == pytest.approx(-value, rel=1e-9, abs=0)
    assert branch.message == ""


def test_cusp_itself_is_no_fold(kinds):
    cusp = kinds.Scalar(lambda x, p: p - x**3, lambda x, p: -3 * x * x, lambda x, p: 1.0)
    assert trace(cusp, [-1, -1], (-1, 1.1), [kinds.Fold()]).special == []


def test_start_between_the_folds_is_ordered_from_low_to_high(kinds):
    cubic = kinds.Scalar(lambda x, p: p - x**3 + x, lambda x, p: 1 - 3 * x * x, lambda x, p: 1.0)
    branch = trace(cubic, [0, 0], (-2, 2), [kinds.Fold()])
    assert (branch.points[0].z[1], branch.points[-1].z[1]) == (-2.0, 2.0)
    assert np.all(np.diff(column(branch, 0)) > 0)
    assert all(point.tangent[0] > 0 for point in branch.points)
    assert names(branch) == ["LP1", "LP2"]
    assert branch["LP1"].z[0] < 0 < branch["LP2"].z[0]


@pytest.mark.parametrize("start", [[0, -1], [-1, -1]])
def test_transcritical_branch_point(kinds, start):
    problem = kinds.Scalar(lambda x, p: p * x - x * x, lambda x, p: p - 2 * x, lambda x, p: x)
    branch = trace(problem, start, (-1, 1.1), [kinds.Fold(), kinds.BranchPoint()])
    assert names(branch) == ["BP1"]
    np.testing.assert_allclose(branch["BP1"].z, 0, atol=LOCATED)
    assert branch.points[-1].z[0] == pytest.approx(0 if start[0] == 0 else 1.1, abs=1e-12)
    assert branch.message == ""


@pytest.fixture
def pitchfork(kinds):
    return kinds.Scalar(lambda x, p: p * x - x**3, lambda x, p: p - 3 * x * x, lambda x, p: x)


def test_pitchfork_from_both_of_its_branches(kinds, pitchfork):
    detectors = [kinds.Fold(), kinds.BranchPoint()]
    trivial = trace(pitchfork, [0, -1], (-1, 1), detectors)
    assert names(trivial) == ["BP1"]
    np.testing.assert_allclose(trivial["BP1"].z, 0, atol=LOCATED)
    curved = trace(pitchfork, [1, 1], (-1, 1), detectors)
    assert {special.label for special in curved.special} == {"LP", "BP"}
    for special in curved.special:
        # The tangent that the fold is judged by is ill-determined where branches meet.
        np.testing.assert_allclose(special.z, 0, atol=1e-8)
    np.testing.assert_allclose(curved.points[-1].z, [-1, 1], atol=1e-12)


@pytest.mark.parametrize("shift", [0.0, 0.1234, 0.4])
@pytest.mark.parametrize("start", ["first", "second"])
def test_branch_point_of_two_curved_branches(kinds, shift, start):
    """(x - sin p) (x - sin p - (p - s) cos p) = 0: the branches cross at p = s alone."""

    def first(x, p):
        return x - math.sin(p)

    def second(x, p):
        return first(x, p) - (p - shift) * math.cos(p)

    def second_p(p):
        return -2 * math.cos(p) + (p - shift) * math.sin(p)

    problem = kinds.Scalar(
        lambda x, p: first(x, p) * second(x, p),
        lambda x, p: first(x, p) + second(x, p),
        lambda x, p: -math.cos(p) * second(x, p) + first(x, p) * second_p(p),
    )
    at = -1.0
    x = math.sin(at) + (0 if start == "first" else (at - shift) * math.cos(at))
    branch = trace(problem, [x, at], (-1, 1), [kinds.Fold(), kinds.BranchPoint()])
    crossing = [special for special in branch.special if special.label == "BP"]
    assert [special.name for special in crossing] == ["BP1"]
    np.testing.assert_allclose(crossing[0].z, [math.sin(shift), shift], atol=1e-9)
    other = first if start == "first" else second
    assert max(abs(other(*point.z)) for point in branch.points) < 1e-8
    assert branch.message == ""


def test_a_helix_comes_by_its_start_but_does_not_close(kinds):
    class Helix(kinds.Scalar):
        def residual(self, z):
            turn = (z[1] - 10.0) / 5e-3
            return np.array([z[0] - np.cos(turn), z[2] - np.sin(turn)])

        def jacobian(self, z):
            turn = (z[1] - 10.0) / 5e-3
            return np.array([[1.0, np.sin(turn) / 5e-3, 0.0], [0.0, -np.cos(turn) / 5e-3, 1.0]])

    helix = Helix(None, None, None, spectral=False)
    helix.measures = lambda z: {"turns": (z[1] - 10.0) / 5e-3 / (2.0 * math.pi)}
    settings = StepSettings(points=400)
    branch = trace(helix, [1.0, 10.0, 0.0], (-2, 2), (), settings, direction=1)
    assert branch.stopped is Stopped.POINTS
    assert branch.points[-1].measures["turns"] > 1.5


def test_a_ring_far_from_the_parameter_closes(kinds):
    """Only the parameter is compared with its span, not an unknown that is far from it."""

    class Ring(kinds.Scalar):
        def residual(self, z):
            return np.array([z[0] ** 2 + z[2] ** 2 - 1.0, z[1] - 50.0 - z[0]])

        def jacobian(self, z):
            return np.array([[2.0 * z[0], 0.0, 2.0 * z[2]], [-1.0, 1.0, 0.0]])

    branch = trace(Ring(None, None, None, spectral=False), [1.0, 51.0, 0.0], (-2, 2))
    assert branch.stopped is Stopped.CLOSED
    assert len(branch.points) < 400


def test_a_ring_closes_however_narrow_another_bound(kinds):
    class Ring(kinds.Scalar):
        def residual(self, z):
            return np.array([z[0] ** 2 + z[2] ** 2 - 1.0, z[1] - 50.0 - 1e-3 * z[0]])

        def jacobian(self, z):
            return np.array([[2.0 * z[0], 0.0, 2.0 * z[2]], [-1e-3, 1.0, 0.0]])

        def bounds(self):
            return ((-2, 49.9, 50.1),)

    ring, settings = Ring(None, None, None, spectral=False), StepSettings(points=400)
    branch = trace(ring, [1.0, 50.001, 0.0], (-2, 2), (), settings)
    assert branch.stopped is Stopped.CLOSED


def test_given_tangent_is_corrected_onto_the_branch(circle):
    branch = trace(circle, [0.6, 0.79], (-2, 2), tangent=[-0.8, 0.6])
    assert branch.stopped is Stopped.CLOSED
    np.testing.assert_allclose(branch.points[0].z @ branch.points[0].z, 1, atol=1e-12)
    assert branch.points[1].z[0] < 0.6


def test_every_span_ends_exactly(kinds):
    for end in np.linspace(0.02, 1.5, 60):
        steep = kinds.Scalar(
            lambda x, p: p - x**2 - x**6, lambda x, p: -2 * x - 6 * x**5, lambda x, p: 1.0
        )
        branch = trace(steep, [0, 0], (-1, end), settings=StepSettings(angle=0.6, maximum=0.2))
        assert branch.stopped is branch.stopped_backward is Stopped.SPAN
        assert branch.points[0].z[1] == branch.points[-1].z[1] == end
        assert branch.points[0].z[0] == pytest.approx(-branch.points[-1].z[0], rel=1e-12)
        assert column(branch, 1).max() == end


@pytest.mark.parametrize(("end", "off"), [(1.0, 1e-13), (0.0, -1e-13)])
def test_a_start_beyond_the_span_by_rounding_is_at_its_end(line, end, off):
    branch = trace(line, [end + off, end + off], (0, 1))
    assert branch.points[0].z[1] == end
    assert len(branch.points) > 10


def test_rounding_at_an_end_of_the_span_is_relative_to_its_width(line):
    branch = trace(line, [1e6, 1e6 + 1e-7], (-1e6, 1e6))
    assert branch.points[0].z.tolist() == [1e6, 1e6]


@pytest.mark.parametrize("start", [0.0, 0.25, 1.0])
def test_arclength_is_that_of_the_parameter_on_a_level_branch(kinds, start):
    level = kinds.Scalar(lambda x, p: x - 1.0, lambda x, p: 1.0, lambda x, p: 0.0)
    branch = trace(level, [1.0, start], (0, 1))
    length = [point.arclength for point in branch.points]
    p = column(branch, 1)
    np.testing.assert_allclose(length, np.abs(p - p[0]), atol=1e-12)
    np.testing.assert_allclose([abs(point.tangent[1]) for point in branch.points], 1.0)


def test_a_branch_that_is_put_in_order_keeps_its_arclength(line):
    branch = trace(line, [0.5, 0.5], (0, 1), tangent=[-1.0, -1.0])
    length = np.array([point.arclength for point in branch.points])
    assert (branch.points[0].parameter, branch.points[-1].parameter) == (0.0, 1.0)
    assert length[0] == 0.0
    assert (np.diff(length) > 0.0).all()
    assert all(point.tangent[1] > 0.0 for point in branch.points)


class Two(Problem):
    """Two unknowns x and y, each with an equation of its own in p."""

    name = "two"
    parameter = "p"

    def __init__(self, x, y, y_y, y_p):
        self.x, self.y, self.y_y, self.y_p = x, y, y_y, y_p

    def residual(self, z):
        return np.array([z[0] - self.x, self.y(z[1], z[2])])

    def jacobian(self, z):
        return np.array([[1.0, 0.0, 0.0], [0.0, self.y_y(z[1], z[2]), self.y_p(z[1], z[2])]])


def test_a_start_beyond_the_span_with_other_unknowns_about_is_at_its_end():
    problem = Two(0.3, lambda y, p: y - 7.0, lambda y, p: 1.0, lambda y, p: 0.0)
    branch = trace(problem, [0.3, 7.0, 1.0 + 1e-13], (0, 1))
    assert branch.points[0].parameter == 1.0
    assert branch.points[-1].parameter == 0.0


def test_a_start_is_solved_at_its_parameter_which_then_increases():
    problem = Two(0.3, lambda y, p: y + p - 7.0, lambda y, p: 1.0, lambda y, p: 1.0)
    branch = trace(problem, [0.2, 6.0, 0.25], (0, 1), direction=1)
    assert branch.points[0].z == pytest.approx([0.3, 6.75, 0.25], rel=1e-12)
    assert (np.diff(column(branch, 2)) > 0.0).all()


def test_one_of_two_unknowns_runs_to_infinity():
    problem = Two(1.0, lambda y, p: y * (1.0 - p) - 1.0, lambda y, p: 1.0 - p, lambda y, p: -y)
    branch = trace(problem, [1.0, 1.0, 0.0], (-1, 2), direction=1)
    assert branch.stopped is Stopped.INFINITY
    assert branch.points[-1].parameter == pytest.approx(1.0, abs=1e-4)


def test_a_start_on_a_fold_far_from_zero(kinds):
    problem = kinds.Scalar(
        lambda x, p: p - (x - 5.0) ** 2, lambda x, p: -2.0 * (x - 5.0), lambda x, p: 1.0
    )
    branch = trace(problem, [5.0, 0.0], (-1, 1), [kinds.Fold()])
    assert sorted(branch.points[k].z[0] for k in (0, -1)) == pytest.approx([4.0, 6.0], rel=1e-9)


@pytest.mark.parametrize("end", [0.0, 1.0])
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_given_tangent_at_an_end_of_the_span_is_followed_inwards(line, end, sense):
    branch = trace(line, [end, end], (0, 1), tangent=[sense, sense])
    assert {branch.points[0].z[1], branch.points[-1].z[1]} == {0.0, 1.0}
    assert branch.points[0].z[1] == end


def test_a_given_tangent_may_be_short(line):
    branch = trace(line, [0.5, 0.5], (0, 1), tangent=[1e-3, 1e-3])
    assert (branch.points[0].parameter, branch.points[-1].parameter) == (0.0, 1.0)


def test_given_tangent_switches_branches(pitchfork):
    branch = trace(pitchfork, [0, 0], (-1, 1), tangent=[1, 0], direction=-1)
    x, p = column(branch, 0), column(branch, 1)
    np.testing.assert_allclose(p, x * x, atol=1e-12)
    np.testing.assert_allclose(branch.points[-1].z, [-1, 1], atol=1e-12)


@pytest.mark.parametrize("unit_x", [1e-6, 1.0, 1e6])
def test_a_branch_that_leaves_zero_takes_natural_steps_at_once(kinds, unit_x):
    problem = kinds.Scalar(
        lambda x, p: p * x / unit_x - (x / unit_x) ** 3,
        lambda x, p: (p - 3 * (x / unit_x) ** 2) / unit_x,
        lambda x, p: x / unit_x,
    )
    branch = trace(problem, [0, 0], (-1, 1), [kinds.BranchPoint()], tangent=[unit_x, 0])
    x, p = column(branch, 0) / unit_x, column(branch, 1)
    np.testing.assert_allclose(p, x * x, atol=1e-12)
    assert (x.min(), x.max()) == pytest.approx((-1, 1), rel=1e-9)
    assert len(branch.points) < 100
    assert np.sort(np.abs(x))[1] > 1e-4
    assert names(branch) == ["BP1"]
    assert branch.message == ""


class Leaving(Problem):
    """x leaves zero at p = 0 as a pitchfork, in its unit; y is 5 and leans on it a little."""

    name = "leaving"
    parameter = "p"

    def __init__(self, unit):
        self.unit = unit

    def residual(self, z):
        x = z[0] / self.unit
        return np.array([z[2] * x - x**3, z[1] - 5.0 - 1e-3 * x])

    def jacobian(self, z):
        x = z[0] / self.unit
        lean = -1e-3 / self.unit
        return np.array([[(z[2] - 3.0 * x * x) / self.unit, 0.0, x], [lean, 1.0, 0.0]])


@pytest.mark.parametrize("unit", [1e-4, 1.0, 1e6])
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_one_of_two_unknowns_leaves_zero_in_natural_steps(unit, sense):
    tangent = [sense * unit, sense * 1e-3, 0.0]
    branch = trace(Leaving(unit), [0.0, 5.0, 0.0], (-1, 1), tangent=tangent)
    x = np.sort(np.abs(column(branch, 0))) / unit
    assert x[0] == 0.0
    assert x[1] > 1e-4
    assert x[-1] == pytest.approx(1.0, rel=1e-9)


def test_an_unknown_that_is_not_zero_keeps_its_magnitude_where_another_leaves_zero():
    start, tangent = np.array([0.0, 5.0, 0.0]), np.array([1.0, 1e-3, 0.0])
    scaling = begin(Leaving(1.0), start, (-1, 1), StepSettings(), tangent)[3]
    assert scaling.norm(np.array([0.0, 5.0, 0.0])) == pytest.approx(math.sqrt(0.5), rel=1e-3)


def test_an_unknown_that_is_not_zero_at_the_start_keeps_its_magnitude(kinds):
    upright = kinds.Scalar(lambda x, p: p, lambda x, p: 0.0, lambda x, p: 1.0)
    start, tangent = np.array([0.5, 0.0]), np.array([1.0, 0.0])
    scaling = begin(upright, start, (-1, 1), StepSettings(), tangent)[3]
    assert scaling.norm(start) == pytest.approx(1.0, rel=1e-12)


def test_a_branch_that_leaves_zero_to_one_side_only_takes_natural_steps(kinds):
    def f(x, p):
        return p * x - x**3 if x >= 0.0 else math.nan

    half = kinds.Scalar(f, lambda x, p: p - 3.0 * x * x, lambda x, p: x)
    branch = trace(half, [0, 0], (-1, 1), tangent=[1, 0], direction=1)
    assert branch.points[1].z[0] > 1e-4
    np.testing.assert_allclose(branch.points[-1].z, [1, 1], atol=1e-12)


@pytest.mark.parametrize("direction", [None, 1, -1])
def test_given_tangent_that_leads_nowhere_is_an_error(kinds, direction):
    cross = kinds.Scalar(
        lambda x, p: x * x + p * p + 1e-3, lambda x, p: 2 * x, lambda x, p: 2 * p, spectral=False
    )
    with pytest.raises(ConvergenceError, match="tangent"):
        trace(cross, [0, 0], (-1, 1), tangent=[1, 0.5], direction=direction)


def test_parallel_branch_is_not_jumped_to(kinds):
    def steep(p):
        return math.tanh(20 * p)

    def f_x(x, p):
        return 2 * (x - steep(p)) - 0.05

    problem = kinds.Scalar(
        lambda x, p: (x - steep(p)) * (x - steep(p) - 0.05),
        f_x,
        lambda x, p: -20 * (1 - steep(p) ** 2) * f_x(x, p),
        spectral=False,
    )
    for start in (-1.0, -0.95):
        branch = trace(problem, [start, -1], (-1, 1))
        offset = column(branch, 0) - np.tanh(20 * column(branch, 1))
        np.testing.assert_allclose(offset, start + 1, atol=1e-10)
        assert branch.stopped is Stopped.SPAN


@pytest.mark.parametrize("unit_x", [1e-6, 1e6])
@pytest.mark.parametrize("unit_p", [1e-6, 1e6])
@pytest.mark.parametrize("from_zero", [True, False])
def test_units_do_not_matter(kinds, unit_x, unit_p, from_zero):
    problem = kinds.Scalar(
        lambda x, p: p / unit_p - (x / unit_x) ** 3 + x / unit_x,
        lambda x, p: (1 - 3 * (x / unit_x) ** 2) / unit_x,
        lambda x, p: 1 / unit_p,
    )
    start = [0, 0] if from_zero else [-unit_x, 0]
    branch = trace(problem, start, (-unit_p, 2 * unit_p), [kinds.Fold()])
    at = 1 / math.sqrt(3)
    assert branch["LP1"].z == pytest.approx([-at * unit_x, 2 * at**3 * unit_p], rel=1e-10, abs=0)
    assert branch["LP2"].z == pytest.approx([at * unit_x, -2 * at**3 * unit_p], rel=1e-10, abs=0)
    assert len(branch.points) < 200
    assert branch.message == ""


def test_targets_of_a_measure(fold):
    branch = trace(fold, [1, 1], (-1, 2), targets={"x": [-0.3, 1.1], "p": [1.5]})
    assert len(branch.special) == 4
    on_x = [special for special in branch.special if special.data["name"] == "x"]
    np.testing.assert_allclose([special.z[0] for special in on_x], [-0.3, 1.1], atol=LOCATED)


def test_target_just_short_of_a_fold_is_met_on_both_sides(fold):
    branch = trace(fold, [1, 1], (-1, 2), targets=[1e-6])
    assert [special.z[1] for special in branch.special] == [1e-6, 1e-6]
    found = [special.z[0] for special in branch.special]
    np.testing.assert_allclose(found, [-1e-3, 1e-3], rtol=1e-9)


def test_target_just_short_of_a_fold_where_an_unknown_goes_on(kinds):
    """Only the parameter turns back; the second unknown does not."""

    class Turning(kinds.Scalar):
        def residual(self, z):
            return np.array([z[2] - z[0] ** 2, z[1] - 5.0 - z[0]])

        def jacobian(self, z):
            return np.array([[-2.0 * z[0], 0.0, 1.0], [-1.0, 1.0, 0.0]])

    problem = Turning(None, None, None, spectral=False)
    branch = trace(problem, [1.0, 6.0, 1.0], (-1, 2), targets=[1e-6])
    assert [special.parameter for special in branch.special] == [1e-6, 1e-6]
    assert {point.parameter for point in (branch.points[0], branch.points[-1])} == {2.0}
    np.testing.assert_allclose([s.z[0] for s in branch.special], [-1e-3, 1e-3], rtol=1e-9)


def test_target_just_short_of_a_fold_is_met_in_a_walk_of_one_step(kinds):
    # No other point tells that the parameter dips between these two.
    problem = kinds.Scalar(
        lambda x, p: p - (x - 5.0) ** 2, lambda x, p: -2.0 * (x - 5.0), lambda x, p: 1.0
    )
    settings = StepSettings(initial=4e-3, points=1)
    branch = trace(problem, [4.99, 1e-4], (-1, 1), (), settings, targets=[1e-6], direction=-1)
    assert branch.points[-1].z[0] > 5.005
    np.testing.assert_allclose([s.z[0] for s in branch.special], [4.999, 5.001], atol=LOCATED)


class Turning(Problem):
    """x turns the parameter back at 5, y goes on with it or against it."""

    name = "turning"
    parameter = "p"

    def __init__(self, sense, side=1):
        self.sense, self.side = sense, side

    def residual(self, z):
        return np.array([z[2] - self.side * (z[0] - 5.0) ** 2, z[1] - 9.0 - self.sense * z[0]])

    def jacobian(self, z):
        bend = -2.0 * self.side * (z[0] - 5.0)
        return np.array([[bend, 0.0, 1.0], [-self.sense, 1.0, 0.0]])


def test_a_start_on_a_fold_sets_off_with_its_largest_unknown_growing(fold):
    branch = trace(fold, [0, 0], (-1, 2), direction=1)
    assert branch.points[1].z[0] > 0.0
    for sense, y, largest in ((1.0, 14.0, 0), (-1.0, 4.0, 1)):
        branch = trace(Turning(sense), [5.0, y, 0.0], (-1, 1), direction=1)
        assert branch.points[1].z[largest] > branch.points[0].z[largest]


@pytest.mark.parametrize("sense", [1.0, -1.0])
@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("way", [1.0, -1.0])
def test_target_just_short_of_a_fold_of_two_unknowns_is_met_in_a_walk_of_one_step(sense, side, way):
    problem, settings = Turning(sense, side), StepSettings(initial=4e-3, points=1)
    x = 5.0 - way * 0.01
    start = [x, 9.0 + sense * x, side * 1e-4]
    branch = trace(problem, start, (-1, 1), (), settings, targets=[side * 1e-6], direction=-side)
    assert way * (branch.points[-1].z[0] - 5.0) > 0.005
    found = [5.0 + way * (s.z[0] - 5.0) for s in branch.special]
    np.testing.assert_allclose(found, [4.999, 5.001], atol=LOCATED)


def test_equations_that_fail_where_the_parameter_turns_back_end_nothing(kinds):
    def f(x, p):
        if 4.995 < x < 5.007:
            msg = "outside its domain"
            raise FloatingPointError(msg)
        return p - (x - 5.0) ** 2

    problem = kinds.Scalar(f, lambda x, p: -2.0 * (x - 5.0), lambda x, p: 1.0)
    settings = StepSettings(initial=4e-3, points=1)
    branch = trace(problem, [4.99, 1e-4], (-1, 1), (), settings, targets=[1e-6], direction=-1)
    assert branch.special == []
    assert [point.z[0] > 5.0 for point in branch.points] == [False, True]


def test_a_turn_away_from_all_targets_adds_no_point(fold):
    plain = trace(fold, [1, 1], (-1, 2))
    wanted = trace(fold, [1, 1], (-1, 2), targets=[1.7])
    assert names(wanted) == ["UZ1", "UZ2"]
    ordinary = [point.z for point in wanted.points if not point.label]
    np.testing.assert_array_equal(ordinary, [point.z for point in plain.points])


def test_target_where_the_parameter_cannot_be_held_is_left_as_it_was_located(kinds):
    cusp = kinds.Scalar(lambda x, p: p - x**3, lambda x, p: -3 * x * x, lambda x, p: 1.0)
    branch = trace(cusp, [-1, -1], (-1, 1.1), targets=[0.0])
    assert names(branch) == ["UZ1"]
    np.testing.assert_allclose(branch["UZ1"].z, 0.0, atol=LOCATED)
    assert branch.message == ""


def test_target_of_an_unknown_is_met_exactly(kinds):
    class Placed(kinds.Scalar):
        def place(self, measure):
            return -2 if measure == "x" else None

    problem = Placed(lambda x, p: x - math.sin(p), lambda x, p: 1.0, lambda x, p: -math.cos(p))
    branch = trace(problem, [0, 0], (-1, 1), targets={"x": [0.25]})
    assert branch["UZ1"].z[0] == 0.25
    assert branch["UZ1"].z[1] == pytest.approx(math.asin(0.25), rel=1e-14)


def test_targets_at_the_ends_and_the_start_count_once(line):
    branch = trace(line, [0.5, 0.5], (0, 1), targets=[0, 0.5, 1])
    assert [special.z[1] for special in branch.special] == [0.0, 0.5, 1.0]
    assert [branch.points[special.index].label for special in branch.special] == ["UZ"] * 3


@pytest.mark.parametrize(
    ("targets", "message"),
    [([3.0], "outside the span"), ({"y": [1.0]}, "no 'y'"), ([math.nan], "must be finite")],
)
def test_targets_that_cannot_be_are_named(fold, targets, message):
    with pytest.raises(UsageError, match=message):
        trace(fold, [1, 1], (-1, 2), targets=targets)


@pytest.mark.parametrize("direction", [None, 1])
def test_start_at_the_low_edge_goes_inwards(line, direction):
    branch = trace(line, [0, 0], (0, 1), direction=direction)
    assert (branch.points[0].z[1], branch.points[-1].z[1]) == (0.0, 1.0)
    assert branch.stopped is Stopped.SPAN
    assert branch.stopped_backward is None


def test_start_at_the_high_edge_goes_inwards(line):
    branch = trace(line, [1, 1], (0, 1))
    assert (branch.points[0].z[1], branch.points[-1].z[1]) == (1.0, 0.0)


def test_start_at_the_edge_sent_outwards_has_one_point(line):
    branch = trace(line, [0, 0], (0, 1), direction=-1)
    assert len(branch.points) == 1
    assert branch.stopped is Stopped.SPAN


def test_start_at_the_edge_sent_outwards_has_one_point_whatever_else_is_bounded(kinds):
    class Bounded(kinds.Scalar):
        def bounds(self):
            return ((-2, -5.0, 5.0),)

    line = Bounded(lambda x, p: x - p, lambda x, p: 1.0, lambda x, p: -1.0)
    branch = trace(line, [0, 0], (0, 1), direction=-1)
    assert len(branch.points) == 1
    assert branch.stopped is Stopped.SPAN


def test_a_fold_at_an_end_of_the_span_is_left_both_ways(fold):
    branch = trace(fold, [0, 0], (0, 1))
    ends = sorted(branch.points[k].z[0] for k in (0, -1))
    assert ends == pytest.approx([-1.0, 1.0], rel=1e-12)


def test_a_branch_that_is_level_at_the_end_of_its_span_ends_there(kinds):
    problem = kinds.Scalar(
        lambda x, p: x - 1.0 - (p - 1.0) ** 2, lambda x, p: 1.0, lambda x, p: -2.0 * (p - 1.0)
    )
    branch = trace(problem, [2, 0], (0, 1))
    assert branch.stopped is Stopped.SPAN
    assert branch.points[-1].z == pytest.approx([1.0, 1.0], rel=1e-12)
    assert len(branch.points) < 40


@pytest.mark.parametrize(
    ("z", "span", "message"),
    [
        ([0, 2], (0, 1), "outside the span"),
        ([0, 1], (1, 0), "from low to high"),
        ([0, 1], (1, 1), "from low to high"),
        ([0, 1], (0, math.inf), "from low to high"),
        ([math.nan, 1], (0, 1), "must be finite"),
        ([0.5], (0, 1), "at least one unknown"),
        ([[0.5, 0.5]], (0, 1), "at least one unknown"),
    ],
)
def test_unusable_start_or_span_is_named(line, z, span, message):
    with pytest.raises(UsageError, match=message):
        trace(line, z, span)


def test_a_start_outside_the_span_is_told_by_its_parameter():
    problem = Two(0.3, lambda y, p: y - 7.0, lambda y, p: 1.0, lambda y, p: 0.0)
    with pytest.raises(UsageError, match="two starts at p = 2, outside the span 0 to 1"):
        trace(problem, [0.3, 7.0, 2.0], (0, 1))


def test_unusable_direction_and_tangent_are_named(line):
    with pytest.raises(UsageError, match="direction"):
        trace(line, [0, 0], (0, 1), direction=2)
    with pytest.raises(UsageError, match="tangent"):
        trace(line, [0.5, 0.5], (0, 1), tangent=[0, 0])


@pytest.mark.parametrize("z", [[1, -0.5], [0.01, -0.001]])
def test_start_without_a_solution_names_the_parameter(fold, z):
    with pytest.raises(
        ConvergenceError, match=rf"scalar: no solution .* p = {re.escape(str(z[1]))} "
    ):
        trace(fold, z, (-1, 2))


def test_start_far_from_its_solution_is_found(kinds):
    problem = kinds.Scalar(
        lambda x, p: math.atan(x - 3) - p, lambda x, p: 1 / (1 + (x - 3) ** 2), lambda x, p: -1.0
    )
    branch = trace(problem, [50, 0], (0, 1))
    assert branch.points[0].z[0] == pytest.approx(3, abs=1e-12)


def test_start_on_a_fold_reports_it_once(kinds, fold):
    branch = trace(fold, [0, 0], (-1, 2), [kinds.Fold()])
    assert names(branch) == ["LP1"]
    assert branch["LP1"].z.tolist() == [0.0, 0.0]
    assert branch.stopped is branch.stopped_backward is Stopped.SPAN
    assert branch.message == ""


def test_interruption_keeps_everything(kinds, line):
    def stop(point):
        if point.z[1] > 0.5:
            raise KeyboardInterrupt

    branch = trace(line, [0, 0], (0, 1), [kinds.Given(lambda z: z[1] - 0.3)], progress=stop)
    assert branch.stopped is Stopped.INTERRUPTED
    assert 0.5 < branch.points[-1].z[1] < 0.6
    assert names(branch) == ["G1"]
    assert np.all(np.diff(column(branch, 1)) > 0)


def test_progress_sees_every_accepted_point(line):
    seen = []
    branch = trace(line, [0.5, 0.5], (0, 1), progress=seen.append)
    assert sorted(point.z[1] for point in seen) == column(branch, 1).tolist()
    assert seen[0].z[1] == 0.5


def test_until_sees_every_step_and_ends_the_branch(line):
    seen = []

    def until(before, point):
        seen.append(before)
        return Stopped.VALIDITY if point.parameter > 0.7 else None

    branch = trace(line, [0.5, 0.5], (0, 1), until=until)
    assert seen[0].parameter == 0.5
    assert seen[0].arclength == 0.0
    assert len(seen) == len(branch.points) - 1
    assert (branch.stopped, branch.stopped_backward) == (Stopped.VALIDITY, Stopped.SPAN)
    assert 0.7 < branch.points[-1].parameter < 0.75


def test_most_points(line):
    branch = trace(line, [0, 0], (0, 1), settings=StepSettings(points=5))
    assert branch.stopped is Stopped.POINTS
    assert len(branch.points) == 6


def test_equations_that_fail_end_the_branch_where_they_fail(kinds):
    def f(x, p):
        if p > 0.5:
            msg = "no tyre force beyond the peak"
            raise FloatingPointError(msg)
        return x - p

    problem = kinds.Scalar(f, lambda x, p: 1.0, lambda x, p: -1.0)
    branch = trace(problem, [0, 0], (0, 1))
    assert branch.stopped is Stopped.FAILED
    assert branch.points[-1].z[1] == pytest.approx(0.5, abs=1e-6)
    assert "no tyre force" in branch.message


@pytest.mark.parametrize("low", [-1.0, 0.3])
@pytest.mark.parametrize("tangent", [None, [1.0, 1.0]])
def test_each_end_of_a_branch_has_its_own_reason(kinds, low, tangent):
    def f(x, p):
        if not low <= p < 0.7:
            msg = "outside its domain"
            raise FloatingPointError(msg)
        return x - p

    problem = kinds.Scalar(f, lambda x, p: 1.0, lambda x, p: -1.0)
    branch = trace(problem, [0.5, 0.5], (0, 1), tangent=tangent)
    assert branch.stopped is Stopped.FAILED
    assert branch.stopped_backward is (Stopped.FAILED if low > 0.0 else Stopped.SPAN)
    assert branch.points[0].parameter == pytest.approx(max(low, 0.0), abs=1e-6)
    assert branch.points[-1].parameter == pytest.approx(0.7, abs=1e-6)


def test_a_start_that_cannot_be_left_is_a_branch_of_one_point(kinds):
    def only_at_the_start(x, p):
        if p != 0.5:
            msg = "outside its domain"
            raise FloatingPointError(msg)
        return x - p

    problem = kinds.Scalar(only_at_the_start, lambda x, p: 1.0, lambda x, p: -1.0)
    branch = trace(problem, [0.5, 0.5], (0, 1))
    assert len(branch.points) == 1
    assert branch.stopped is branch.stopped_backward is Stopped.FAILED
    assert "outside its domain" in branch.message


def test_nan_ends_the_branch_without_a_warning(kinds):
    problem = kinds.Scalar(
        lambda x, p: x - np.log(1 - p), lambda x, p: 1.0, lambda x, p: 1 / (1 - p)
    )
    # The branch runs off to infinity at p = 1 and the logarithm gives NaN beyond.
    branch = trace(problem, [0, 0], (0, 2), settings=StepSettings(points=300))
    assert branch.stopped in {Stopped.FAILED, Stopped.POINTS, Stopped.STEP}
    x, p = column(branch, 0), column(branch, 1)
    np.testing.assert_allclose(p, -np.expm1(x), atol=1e-8)
    square_root = kinds.Scalar(
        lambda x, p: x - np.sqrt(0.5 - p), lambda x, p: 1.0, lambda x, p: 0.5 / np.sqrt(0.5 - p)
    )
    branch = trace(square_root, [1, 0], (0, 2))
    assert branch.stopped is Stopped.FAILED
    assert branch.points[-1].z[1] == pytest.approx(0.5, abs=1e-4)


def test_nan_at_the_start_is_an_error(kinds):
    problem = kinds.Scalar(lambda x, p: math.nan, lambda x, p: 1.0, lambda x, p: 1.0)
    with pytest.raises(ConvergenceError, match="not finite"):
        trace(problem, [0, 0], (0, 1))


def test_other_exceptions_reach_the_caller(kinds):
    def f(x, p):
        if p > 0.5:
            msg = "a mistake in the model"
            raise KeyError(msg)
        return x - p

    problem = kinds.Scalar(f, lambda x, p: 1.0, lambda x, p: -1.0)
    with pytest.raises(KeyError, match="a mistake"):
        trace(problem, [0, 0], (0, 1))


def test_corner_ends_the_branch_with_a_reason(kinds):
    problem = kinds.Scalar(
        lambda x, p: x - 5 * abs(p - 0.5),
        lambda x, p: 1.0,
        lambda x, p: -5 * math.copysign(1, p - 0.5),
    )
    branch = trace(problem, [2.5, 0], (0, 1))
    assert branch.stopped in {Stopped.TURN, Stopped.STEP}
    assert branch.points[-1].z[1] == pytest.approx(0.5, abs=1e-6)
    assert "ended at p = 0.5" in branch.message or "ended at p = 0.4999" in branch.message


def test_fold_just_inside_the_end_of_the_span(kinds):
    problem = kinds.Scalar(lambda x, p: 1 - p - x * x, lambda x, p: -2 * x, lambda x, p: -1.0)
    inside = trace(problem, [-1, 0], (-1, 1 + 1e-5), [kinds.Fold()])
    assert names(inside) == ["LP1"]
    assert inside.points[-1].z == pytest.approx([math.sqrt(2), -1])
    outside = trace(problem, [-1, 0], (-1, 1 - 1e-5), [kinds.Fold()], direction=1)
    assert outside.special == []
    assert outside.points[-1].z[1] == 1 - 1e-5
    assert outside.points[-1].z[0] == pytest.approx(-math.sqrt(1e-5), rel=1e-9)


def test_problem_ends_the_branch(kinds):
    class Short(kinds.Scalar):
        def ends(self, point):
            return Stopped.VALIDITY if point.z[1] > 0.4 else None

    problem = Short(lambda x, p: x - p, lambda x, p: 1.0, lambda x, p: -1.0)
    branch = trace(problem, [0, 0], (0, 1))
    assert branch.stopped is Stopped.VALIDITY
    assert 0.4 < branch.points[-1].z[1] < 0.44


def test_adaptation_may_change_the_dimension(kinds):
    class Copies(kinds.Scalar):
        """x = sin p, written down once more on every other step up to five times."""

        def residual(self, z):
            return z[:-1] - np.sin(z[-1])

        def jacobian(self, z):
            n = len(z) - 1
            return np.hstack([np.eye(n), np.full((n, 1), -np.cos(z[-1]))])

        def spectrum(self, z):
            return np.array([z[-1] - 1], dtype=complex)

        def adapt(self, z, tangent):
            if len(z) > 5:
                return None
            return np.insert(z, 0, z[0]), np.insert(tangent, 0, tangent[0])

    problem = Copies(None, None, None)
    event = kinds.Given(lambda z: z[-1] - 1.0)
    event.crossings = 1
    branch = trace(problem, [0, 0], (0, 3), [event])
    assert len(branch.points[-1].z) == 6
    assert branch["G1"].z[-1] == pytest.approx(1, abs=1e-10)
    assert all(point.z[0] == pytest.approx(math.sin(point.z[-1])) for point in branch.points)
    assert branch.message == ""
    wanted = trace(problem, [0, 0], (0, 3), targets=[0.0, 2.0])
    assert [special.z[-1] for special in wanted.special] == [0.0, 2.0]


@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e6])
def test_a_branch_to_infinity_says_so(kinds, unit):
    problem = kinds.Scalar(
        lambda x, p: p * x / unit - 1, lambda x, p: p / unit, lambda x, p: x / unit
    )
    branch = trace(problem, [unit, 1], (-1, 1), [kinds.Fold(), kinds.Hopf()], targets=[0.1])
    assert branch.stopped is Stopped.INFINITY
    assert names(branch) == ["UZ1"]
    assert len(branch.points) < 150
    assert branch.message == ""
    # a steep branch that is not infinite goes on
    steep = kinds.Scalar(
        lambda x, p: x - 1e5 * math.tanh(1e5 * p),
        lambda x, p: 1.0,
        lambda x, p: -1e10 / math.cosh(1e5 * p) ** 2 if abs(p) < 1e-3 else 0.0,
    )
    assert trace(steep, [-1e5, -1], (-1, 1)).stopped is Stopped.SPAN


def test_runs_are_reproducible_bit_for_bit(kinds, fold):
    def run():
        branch = trace(fold, [1, 1], (-1, 2), [kinds.Fold(), kinds.BranchPoint()], targets=[0.3])
        return b"".join(point.z.tobytes() + point.tangent.tobytes() for point in branch.points)

    assert run() == run()


def test_work_is_moderate(kinds, fold):
    branch = trace(fold, [1, 1], (-1, 2), [kinds.Fold()])
    assert fold.residuals < 4 * len(branch.points)
    assert max(point.iterations for point in branch.points[1:-1]) <= 6


def test_many_unknowns(kinds):
    n = 400

    class Chain(kinds.Scalar):
        """Bratu's problem by differences: its fold is at lambda = 3.5138 + O(h^2)."""

        h = 1 / (n + 1)
        laplacian = (np.eye(n, k=1) + np.eye(n, k=-1) - 2 * np.eye(n)) / h**2

        def residual(self, z):
            return self.laplacian @ z[:-1] + z[-1] * np.exp(z[:-1])

        def jacobian(self, z):
            growth = np.exp(z[:-1])
            return np.column_stack([self.laplacian + np.diag(z[-1] * growth), growth])

        def spectrum(self, z):
            return np.empty(0, dtype=complex)

        def measures(self, z):
            return {}

    branch = trace(
        Chain(None, None, None), np.zeros(n + 1), (0, 4), [kinds.Fold()], StepSettings(points=45)
    )
    assert branch["LP1"].z[-1] == pytest.approx(3.513830719, rel=1e-5)


def test_unknown_special_point_lists_those_there_are(fold, kinds):
    branch = trace(fold, [1, 1], (-1, 2), [kinds.Fold()])
    with pytest.raises(KeyError, match="LP1"):
        branch["H1"]


@pytest.mark.parametrize("beside", [0.0, 1e-11, -1e-9, 1e-8, -1e-7, 3e-7, 1e-6, -1e-4])
def test_a_start_beside_a_fold_sets_off_as_from_anywhere(kinds, beside):
    problem = kinds.Scalar(lambda x, p: p - (x - 5) ** 2, lambda x, p: -2 * (x - 5), lambda x, p: 1)
    branch = trace(problem, [5 + beside, beside**2], (-1, 1), [kinds.Fold()])
    assert branch.stopped is branch.stopped_backward is Stopped.SPAN
    assert {round(point.z[0], 9) for point in (branch.points[0], branch.points[-1])} == {4.0, 6.0}
    assert len(branch.points) < 80
