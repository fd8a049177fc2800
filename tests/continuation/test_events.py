"""Events: which there are, where, and which are none."""

import itertools
import math

import numpy as np
import pytest

from racs_bif.continuation import StepSettings, Stopped, trace
from racs_bif.continuation.locating import apart, lowest_between

TRUE = 0.31


def found(branch):
    return [special.z[1] for special in branch.special]


@pytest.mark.parametrize(
    "real_parts",
    [
        # Opposite directions: the number of unstable eigenvalues is the same before and after.
        (lambda p: p - TRUE, lambda p: TRUE + 1e-3 - p),
        # The same direction: the test function keeps its sign.
        (lambda p: p - TRUE, lambda p: p - TRUE - 1e-3),
        # One pair, out and in again.
        (lambda p: (TRUE - p) * (p - TRUE - 1e-3),),
        (lambda p: (p - TRUE) * (p - TRUE - 1e-3), lambda p: -2.0),
    ],
)
def test_two_crossings_within_one_step_are_both_found(kinds, real_parts):
    branch = trace(kinds.Pairs(*real_parts), [0, 0], (-1, 1), [kinds.Hopf()])
    np.testing.assert_allclose(found(branch), [TRUE, TRUE + 1e-3], atol=1e-10)
    assert branch.message == ""


def test_two_crossings_within_the_first_step_are_both_found(kinds):
    near = (-0.995, -0.994)
    problem = kinds.Pairs(lambda p: p - near[0], lambda p: p - near[1], lambda p: -1.0)
    settings = StepSettings(initial=1 / 30)
    branch = trace(problem, [np.sin(-1.0), -1], (-1, 1), [kinds.Hopf()], settings)
    np.testing.assert_allclose(found(branch), near, atol=1e-10)
    assert branch.message == ""


@pytest.mark.parametrize("gap", [8e-5, 1e-6])
def test_crossings_very_near_each_other(kinds, gap):
    problem = kinds.Pairs(lambda p: p - TRUE, lambda p: TRUE + gap - p, lambda p: -1.0)
    branch = trace(problem, [0, 0], (-1, 1), [kinds.Hopf()])
    np.testing.assert_allclose(found(branch), [TRUE, TRUE + gap], atol=1e-10)


def test_crossings_that_no_detector_sees_are_told(kinds):
    problem = kinds.Pairs(lambda p: p - TRUE)
    branch = trace(problem, [0, 0], (-1, 1), [kinds.Fold()])
    assert branch.special == []
    assert "from 0 to 2" in branch.message
    assert "0.3" in branch.message


def test_crossings_that_no_detector_sees_are_told_where_they_are(kinds):
    branch = trace(kinds.Pairs(lambda p: p - TRUE), [0, 0], (-1, 1), [kinds.Fold()])
    ((low, high),) = branch.unexplained
    assert low < TRUE < high < low + 1e-5


def test_steps_are_shorter_after_crossings_that_no_detector_sees(kinds):
    def walked(problem, detectors):
        settings = StepSettings(initial=1e-3)
        branch = trace(problem, [0, 1.2], (0, 3), detectors, settings, direction=1)
        return np.array([point.parameter for point in branch.points])

    free = walked(kinds.Pairs(lambda p: -1.0), [])
    middle = 0.5 * (free[2] + free[3])
    divided = walked(kinds.Pairs(lambda p: p - middle), [kinds.Fold()])
    # It is known one step later that a segment had to be divided.
    last, following = divided[divided > free[3] + 1e-12][:2]
    assert last == pytest.approx(free[4], rel=1e-12)
    assert following - last == pytest.approx(0.5 * (free[5] - free[4]), rel=0.05)


def test_crossings_at_the_start_itself_are_not_told(kinds):
    start = TRUE - 1e-8
    problem = kinds.Pairs(lambda p: p - TRUE)
    branch = trace(problem, [np.sin(start), start], (-1, 1), [kinds.Fold()], direction=1)
    assert branch.message == ""
    assert branch.unexplained == []


def test_crossings_beside_the_start_that_no_detector_sees_are_told(kinds):
    start = TRUE - 1e-3
    problem = kinds.Pairs(lambda p: p - TRUE)
    branch = trace(problem, [np.sin(start), start], (-1, 1), [kinds.Fold()], direction=1)
    ((low, high),) = branch.unexplained
    assert low < TRUE < high < low + 1e-5


def test_crossings_where_the_equations_fail_are_told(kinds):
    class Broken(kinds.Pairs):
        middle = width = math.nan

        def residual(self, z):
            if abs(z[1] - self.middle) < 0.2 * self.width:
                msg = "outside its domain"
                raise FloatingPointError(msg)
            return super().residual(z)

    problem = Broken(lambda p: p - problem.middle)
    accepted = [point.z[1] for point in trace(problem, [0, 0], (-1, 1)).points]
    low, high = accepted[-6:-4]
    problem.middle, problem.width = 0.5 * (low + high), high - low
    branch = trace(problem, [0, 0], (-1, 1), [kinds.Fold()])
    assert branch.unexplained == [(low, high)]
    assert "from 0 to 2" in branch.message


def test_opposite_crossings_at_one_place_are_told(kinds):
    problem = kinds.Pairs(lambda p: p - TRUE, lambda p: TRUE - p)
    branch = trace(problem, [0, 0], (-1, 1), [kinds.Hopf()])
    assert "4 eigenvalues cross" in branch.message


def test_without_detectors_nothing_is_checked(kinds):
    branch = trace(kinds.Pairs(lambda p: p - TRUE), [0, 0], (-1, 1))
    assert branch.message == ""


def test_a_sign_change_that_a_detector_dismisses_is_no_event(kinds, line):
    class Choosy(kinds.Given):
        def dismisses(self, before, after):
            return before.z[1] < 0.5 < after.z[1] or before.z[1] > 0.5

    branch = trace(line, [0, 0], (0, 1), [Choosy(lambda z: (z[1] - 0.3) * (z[1] - 0.7))])
    assert found(branch) == pytest.approx([0.3], abs=1e-9)


def test_event_of_another_kind_is_dropped_and_explains_nothing(kinds):
    class Picky(kinds.Hopf):
        def data(self, problem, point):
            return None

    branch = trace(kinds.Pairs(lambda p: p - TRUE), [0, 0], (-1, 1), [Picky()])
    assert branch.special == []
    assert "unexplained" in branch.message


@pytest.mark.parametrize("rounding", [0.0, 1e-15, -1e-15, 1e-12, -1e-12])
def test_a_crossing_at_the_end_of_the_span_is_found_in_spite_of_rounding(kinds, rounding):
    problem = kinds.Pairs(lambda p: p - TRUE + (rounding if p == TRUE else 0.0))
    for span, direction in (((-1, TRUE), None), ((TRUE, 2), None), ((TRUE, 2), -1)):
        start = span[0] if direction is None else span[1]
        branch = trace(problem, [np.sin(start), start], span, [kinds.Hopf()], direction=direction)
        assert found(branch) == [TRUE]
        assert branch.message == ""


def test_branches_that_cross_at_the_end_of_the_span(kinds):
    def curve(x, p):
        return x - math.sin(p)

    problem = kinds.Scalar(
        lambda x, p: (p - TRUE) * curve(x, p) + curve(x, p) ** 3,
        lambda x, p: p - TRUE + 3 * curve(x, p) ** 2,
        lambda x, p: curve(x, p) - math.cos(p) * (p - TRUE + 3 * curve(x, p) ** 2),
    )
    branch = trace(problem, [math.sin(-1), -1], (-1, TRUE), [kinds.BranchPoint()])
    assert branch.stopped is Stopped.SPAN
    assert found(branch) == [TRUE]
    assert branch.message == ""


def test_a_fold_at_the_end_of_the_span(kinds):
    fold = kinds.Scalar(lambda x, p: p + x * x, lambda x, p: 2 * x, lambda x, p: 1.0)
    branch = trace(fold, [-1, -1], (-1, 0), [kinds.Fold()])
    assert found(branch) == [0.0]
    assert branch.stopped is Stopped.SPAN


def test_several_events_in_a_step_are_sorted_and_numbered(kinds, line):
    first, second = kinds.Given(lambda z: z[1] - 0.5002), kinds.Given(lambda z: 0.5001 - z[1])
    second.label = "K"
    third = kinds.Given(lambda z: z[1] - 0.5003)
    branch = trace(line, [0, 0], (0, 1), [first, second, third])
    assert [special.name for special in branch.special] == ["K1", "G1", "G2"]
    np.testing.assert_allclose(found(branch), [0.5001, 0.5002, 0.5003], atol=1e-10)


@pytest.mark.parametrize("start", [0.0, 0.2, 0.5, 1.0])
@pytest.mark.parametrize("sign", [1, -1])
def test_zero_at_the_start_or_an_end_counts_once(kinds, line, start, sign):
    for zero in (0.0, 0.5, 1.0):
        detector = kinds.Given(lambda z, zero=zero: sign * (z[1] - zero))
        branch = trace(line, [start, start], (0, 1), [detector])
        assert found(branch) == pytest.approx([zero], abs=1e-10)


def test_zero_at_an_accepted_point_counts_once(kinds, line):
    accepted = trace(line, [0, 0], (0, 1)).points[7].z[1]
    branch = trace(line, [0, 0], (0, 1), [kinds.Given(lambda z: z[1] - accepted)])
    assert found(branch) == [accepted]
    assert branch.special[0].interval == 0.0


def test_events_at_one_point_stay_in_their_order(kinds, line):
    detectors = [
        kinds.Given(lambda z, unit=unit: unit * (z[1] - 0.5) * (z[1] - 1.0)) for unit in (1, 2)
    ]
    detectors[1].label = "K"
    branch = trace(line, [0.5, 0.5], (0, 1), detectors)
    assert [special.name for special in branch.special] == ["G1", "K1", "G2", "K2"]
    assert found(branch) == [0.5, 0.5, 1.0, 1.0]
    assert (np.diff([point.arclength for point in branch.points]) >= 0.0).all()


def test_a_start_that_cannot_be_left_one_way_is_no_event(kinds):
    def f(x, p):
        return x - p if p <= 0.5 else math.nan

    half = kinds.Scalar(f, lambda x, p: 1.0, lambda x, p: -1.0, spectral=False)
    for sign in (1.0, -1.0):
        branch = trace(
            half, [0.5, 0.5], (0, 1), [kinds.Given(lambda z, sign=sign: sign * (z[1] - 0.7))]
        )
        assert (branch.points[0].z[1], branch.points[-1].z[1]) == (0.0, 0.5)
        assert branch.special == []


@pytest.mark.parametrize(
    "function",
    [
        lambda z: (z[1] - 0.5) ** 2,
        lambda z: z[1] ** 2 - z[1] + 0.25,
        lambda z: (z[1] - 0.4321) ** 4,
        lambda z: 0.0,
        lambda z: math.nan,
        lambda z: 1e-17 * math.cos(1e17 * z[1]),
        lambda z: abs(z[1] - 0.5) + 1e-17 * math.cos(1e17 * z[1]),
        lambda z: math.nan if 0.4 < z[1] < 0.6 else z[1] - 0.5,
        lambda z: z[0] - z[1],
    ],
)
@pytest.mark.parametrize("start", [0.0, 0.5])
def test_touching_rounding_and_nan_are_no_events(kinds, line, function, start):
    branch = trace(line, [start, start], (0, 1), [kinds.Given(function)])
    assert branch.special == []


def test_rounding_that_is_zero_between_points_is_no_event(kinds, line):
    accepted = {point.z[1] for point in trace(line, [0, 0], (0, 1)).points}

    def function(z):
        noise = math.cos(1e17 * z[1])
        return 1e-17 * (math.copysign(1.0, noise) if z[1] in accepted else round(noise))

    assert trace(line, [0, 0], (0, 1), [kinds.Given(function)]).special == []


@pytest.mark.parametrize("rounding", [-1e-16, -1e-14, 1e-16, 0.0])
def test_a_zero_but_for_rounding_between_ones_is_no_event(kinds, line, rounding):
    accepted = trace(line, [0, 0], (0, 1)).points[-6].z[1]
    touching = kinds.Given(lambda z: rounding if z[1] == accepted else 1.0)
    assert trace(line, [0, 0], (0, 1), [touching]).special == []


def test_equations_that_fail_where_a_function_dips_make_no_event(kinds, line):
    accepted = [point.z[1] for point in trace(line, [0, 0], (0, 1)).points]
    low, high = accepted[-6:-4]
    middle = 0.5 * (low + high)

    def broken(x, p):
        if low < p < high:
            msg = "outside its domain"
            raise FloatingPointError(msg)
        return x - p

    dip = kinds.Given(lambda z: (z[1] - middle) ** 2 - 1e-8)
    problem = kinds.Scalar(broken, lambda x, p: 1.0, lambda x, p: -1.0, spectral=False)
    branch = trace(problem, [0, 0], (0, 1), [dip])
    assert branch.special == []
    assert [point.z[1] for point in branch.points] == accepted
    assert len(trace(line, [0, 0], (0, 1), [dip]).special) == 2


@pytest.mark.parametrize("unit", [1e-9, 1.0, 1e9])
def test_the_unit_of_a_function_that_dips_does_not_matter(kinds, line, unit):
    detector = kinds.Given(lambda z: unit * ((z[1] - 0.4321) ** 2 - 1e-8))
    branch = trace(line, [0, 0], (0, 1), [detector])
    np.testing.assert_allclose(found(branch), [0.432, 0.4322], atol=1e-10)


@pytest.mark.parametrize("unit", [1.0, -100.0])
@pytest.mark.parametrize("way", [1.0, -1.0])
def test_where_a_function_may_dip_between_two_samples(unit, way):
    def lowest(others, at=0.4, least=0.0):
        def sample(share):
            return 5.0 + way * share, unit * ((share - at) ** 2 + least)

        return lowest_between((sample(0.0), sample(1.0)), [sample(share) for share in others])

    for other in (-1.0, -0.5, 1.5, 2.0):
        assert lowest([other]) == pytest.approx(0.4, rel=1e-12)
        assert lowest([other], least=0.1) == pytest.approx(0.4, rel=1e-12)
        assert lowest([other], least=1.0) is None  # it is too shallow
        assert lowest([other], at=-0.2) is None
        assert lowest([other], at=1.2) is None
    # A sample of the other sign does not tell, the next one does.
    assert lowest([0.5, -1.0], least=-0.05) == pytest.approx(0.4, rel=1e-12)


def test_samples_at_one_place_tell_of_no_dip():
    assert lowest_between(((5.0, 1.0), (5.0, 1.0)), [(4.0, 1.0)]) is None


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_step_of_height_one_beside_where_another_function_dips(kinds, line, sense):
    dip = kinds.Given(lambda z: (z[1] - 0.4321) ** 2 - 1e-8)
    step = kinds.Given(lambda z: math.copysign(1.0, sense * (z[1] - 0.43205)))
    branch = trace(line, [0, 0], (0, 1), [dip, step])
    np.testing.assert_allclose(found(branch), [0.432, 0.43205, 0.4322], atol=1e-10)


def test_a_dip_that_ends_at_an_accepted_point_is_seen(kinds, line):
    accepted = trace(line, [0, 0], (0, 1)).points[-6].z[1]
    dip = kinds.Given(lambda z: (z[1] - accepted) * (z[1] - accepted + 3e-3) + 1e-16)
    branch = trace(line, [0, 0], (0, 1), [dip])
    np.testing.assert_allclose(found(branch), [accepted - 3e-3, accepted], atol=1e-10)


def test_places_that_nearly_coincide_are_one():
    assert apart([0.7, 0.1, 0.4 + 1e-10, 0.4]) == [0.1, 0.4, 0.7]


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_equations_that_fail_beside_an_event_locate_it_roughly(kinds, sense):
    def wave(fails):
        def f(x, p):
            if fails(p):
                msg = "outside its domain"
                raise FloatingPointError(msg)
            return x - 0.2 * math.sin(20.0 * p)

        return kinds.Scalar(f, lambda x, p: 1.0, lambda x, p: -4.0 * math.cos(20.0 * p))

    accepted = [point.z[1] for point in trace(wave(lambda p: False), [0, 0], (0, 1)).points]
    low, high = accepted[-6:-4]
    middle, width = 0.5 * (low + high), high - low
    broken = wave(lambda p: abs(p - middle) < 0.4 * width)
    detector = kinds.Given(lambda z: sense * (z[1] - middle))
    branch = trace(broken, [0, 0], (0, 1), [detector])
    (event,) = branch.special
    assert 0.4 * width <= abs(event.z[1] - middle) <= 0.5 * width
    assert 0.8 * width < event.interval <= width
    assert "could be located only roughly near" in branch.message


def test_events_at_the_zero_of_a_flat_test_function(kinds, line):
    branch = trace(line, [0, 0], (0, 1), [kinds.Given(lambda z: (z[1] - 0.4321) ** 3)])
    assert found(branch) == pytest.approx([0.4321], abs=1e-4)


def test_step_function_is_located(kinds, line):
    detector = kinds.Given(lambda z: math.copysign(1.0, z[1] - 0.4321))
    branch = trace(line, [0, 0], (0, 1), [detector])
    assert found(branch) == pytest.approx([0.4321], abs=1e-10)
    assert 0 < branch.special[0].interval < 1e-10


def test_refinement_is_used_where_it_is_near(kinds, line):
    class Polished(kinds.Given):
        shift = 0.0

        def refine(self, problem, special):
            return np.full(2, 0.25 + self.shift)

        def data(self, problem, point):
            return {"at": point.z[1]}

    detector = Polished(lambda z: z[1] - 0.25 - 1e-7)
    branch = trace(line, [0, 0], (0, 1), [detector])
    assert found(branch) == [0.25]
    assert branch.special[0].data == {"at": 0.25}
    for Polished.shift in (0.1, 0.3):
        branch = trace(line, [0, 0], (0, 1), [detector])
        assert found(branch) == pytest.approx([0.25 + 1e-7], abs=1e-10)


def test_a_detector_that_fails_sees_nothing(kinds, line):
    def value(z):
        if z[1] < 0.5:
            msg = "singular"
            raise np.linalg.LinAlgError(msg)
        return z[1] - 0.75

    branch = trace(line, [0, 0], (0, 1), [kinds.Given(value)])
    assert found(branch) == pytest.approx([0.75], abs=1e-10)
    assert math.isnan(branch.points[0].tests["G"])


@pytest.mark.parametrize(("shift", "at"), [(1e-6, 0.25 + 1e-6), (0.1, 0.25)])
def test_refinement_at_a_point_is_used_where_it_is_near(kinds, line, shift, at):
    class Polished(kinds.Given):
        def refine(self, problem, special):
            return np.full(2, 0.25 + shift)

    branch = trace(line, [0.25, 0.25], (0, 1), [Polished(lambda z: z[1] - 0.25)])
    assert found(branch) == [at]


def test_failing_polish_keeps_the_event_and_is_told(kinds, line):
    class Failing(kinds.Given):
        def refine(self, problem, special):
            msg = "no way out"
            raise np.linalg.LinAlgError(msg)

    branch = trace(line, [0, 0], (0, 1), [Failing(lambda z: z[1] - 0.25)])
    assert found(branch) == pytest.approx([0.25], abs=1e-10)
    assert "G could not be polished (no way out) at p = 0.25." in branch.message


def test_failing_description_keeps_the_event_and_is_told(kinds, line):
    class Failing(kinds.Given):
        def data(self, problem, point):
            msg = "no normal form"
            raise np.linalg.LinAlgError(msg)

    branch = trace(line, [0, 0], (0, 1), [Failing(lambda z: z[1] - 0.25)])
    assert branch["G1"].data == {}
    assert "no normal form" in branch.message


def test_tests_are_kept_in_the_points(kinds, line):
    branch = trace(line, [0, 0], (0, 1), [kinds.Given(lambda z: z[1] - 0.25)], targets=[0.5])
    assert all(point.tests == {"G": point.z[1] - 0.25} for point in branch.points)


@pytest.mark.parametrize("unit", [1e-9, 1.0, -1e3])
def test_an_event_where_a_dip_divides_a_segment_is_found(kinds, line, unit):
    def dips(z):
        return (z[1] - 0.4321) ** 2 - 1e-8

    plain = {point.z[1] for point in trace(line, [0, 0], (0, 1)).points}
    divided = trace(line, [0, 0], (0, 1), [kinds.Given(dips)])
    (middle,) = {point.z[1] for point in divided.points if not point.label} - plain
    detectors = [kinds.Given(dips), kinds.Given(lambda z: unit * (z[1] - middle))]
    branch = trace(line, [0, 0], (0, 1), detectors)
    np.testing.assert_allclose(found(branch), [0.432, middle, 0.4322], atol=1e-10)
    assert all(b.arclength > a.arclength for a, b in itertools.pairwise(branch.points))
    wanted = trace(line, [0, 0], (0, 1), [kinds.Given(dips)], targets=[middle])
    np.testing.assert_allclose(found(wanted), [0.432, middle, 0.4322], atol=1e-10)


def test_a_walk_that_cannot_begin_makes_no_events_of_the_start(kinds):
    half = kinds.Scalar(
        lambda x, p: p - x * x if x >= 0 else math.nan, lambda x, p: -2 * x, lambda x, p: 1.0
    )
    detectors = [kinds.Given(lambda z: z[1] - 0.5)]
    branch = trace(half, [0, 0], (0, 1), detectors, targets=[0.7])
    np.testing.assert_allclose(found(branch), [0.5, 0.7], atol=1e-10)
