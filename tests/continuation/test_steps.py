"""The iterator, the settings and the reasons for ending."""

import itertools
import math

import numpy as np
import pytest

from racs_bif.continuation import StepSettings, Stopped, steps
from racs_bif.continuation.building import Builder
from racs_bif.continuation.scaling import Scaling
from racs_bif.continuation.start import begin
from racs_bif.continuation.stepping import Stepper
from racs_bif.errors import UsageError
from racs_bif.numerics.newton import Corrected


def test_steps_yields_points_and_returns_why_it_ended(line):
    points = list(steps(line, [0.0, 0.0], (0, 1)))
    walk = steps(line, [0.0, 0.0], (0, 1))
    for _ in points:
        next(walk)
    with pytest.raises(StopIteration) as ended:
        next(walk)
    assert ended.value.value is Stopped.SPAN
    assert points[0].z[1] == 0.0
    assert points[-1].z[1] == 1.0


def test_steps_walks_both_ways(fold):
    for direction in (1, -1):
        points = list(steps(fold, [1.0, 1.0], (-1, 2), direction=direction))
        assert np.sign(points[1].z[1] - 1) == direction
        assert points[0].arclength == 0.0
        assert all(b.arclength > a.arclength for a, b in itertools.pairwise(points))


def test_tangents_are_those_of_the_curve(fold):
    for point in steps(fold, [1.0, 1.0], (-1, 2), direction=-1):
        x = point.z[0]
        assert point.tangent[1] == pytest.approx(2 * x * point.tangent[0], abs=1e-8)


def test_step_sizes_obey_their_limits(fold):
    settings = StepSettings(maximum=0.01, initial=0.001, angle=0.1)
    points = list(steps(fold, [1.0, 1.0], (-1, 2), settings, direction=-1))
    p = np.array([point.z[1] for point in points])
    assert np.abs(np.diff(p)).max() <= 0.01 * 3 * 1.11
    assert len(points) > 200


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"initial": -1.0}, "'initial'"),
        ({"tolerance": math.nan}, "'tolerance'"),
        ({"tolerance": 0.0}, "'tolerance'"),
        ({"minimum": 0.1}, "minimum <= initial"),
        ({"initial": 0.5}, "minimum <= initial"),
        ({"angle": 2.0}, "'angle'"),
        ({"points": 0}, "'points'"),
        ({"iterations": 0}, "'iterations'"),
    ],
)
def test_wrong_settings_are_named(wrong, message):
    with pytest.raises(UsageError, match=message):
        StepSettings(**wrong)


def test_reasons_are_sentences():
    for member in Stopped:
        assert member.value[0].isupper()
        assert member.value.endswith(".")
    early = {Stopped.STEP, Stopped.TURN, Stopped.FAILED, Stopped.COLLAPSED, Stopped.VANISHED}
    assert not any(member.complete for member in early)
    assert all(member.complete for member in (Stopped.SPAN, Stopped.CLOSED, Stopped.HOPF))


def test_scaled_norm_counts_span_and_magnitudes():
    scaling = Scaling(10.0, np.array([2.0, 3e-6]))
    assert scaling.norm(np.array([0, 0, 10.0])) == pytest.approx(1)
    assert scaling.norm(np.array([2.0, 3e-6, 0])) == pytest.approx(1)
    assert scaling.grow(np.array([1.0, 3e-5]))
    assert scaling.norm(np.array([2.0, 3e-5, 0])) == pytest.approx(1)
    assert not scaling.grow(np.array([1.0, 1e-5]))


def test_a_branch_that_is_vertical_foresees_nothing():
    scaling = Scaling(10.0, np.array([2.0, 3e-6]))
    before = scaling.weights.copy()
    assert not scaling.foresee(np.array([1.0, 1.0, 0.0]))
    np.testing.assert_array_equal(scaling.weights, before)
    assert scaling.foresee(np.array([1.0, 1.0, 1e-6]))


def test_steps_of_one_length_only_are_allowed():
    settings = StepSettings(minimum=0.01, initial=0.01, maximum=0.01)
    assert settings.minimum == settings.initial == settings.maximum


def test_steps_may_turn_by_nearly_a_right_angle():
    assert StepSettings(angle=1.5).angle == 1.5
    with pytest.raises(UsageError, match="'angle'"):
        StepSettings(angle=math.pi / 2)


def test_tangents_turn_by_less_than_a_third_of_a_radian(kinds):
    bent = kinds.Scalar(
        lambda x, p: x - math.tanh(50 * p),
        lambda x, p: 1.0,
        lambda x, p: -50 / math.cosh(50 * p) ** 2,
    )
    points = steps(bent, [-1.0, -1.0], (-1, 1))
    scaled = np.array([[point.tangent[0], point.tangent[1] / 2] for point in points])
    angles = np.arccos(np.minimum((scaled[1:] * scaled[:-1]).sum(axis=1), 1.0))
    assert 0.1 < angles.max() < 1 / 3


def test_each_unknown_foresees_its_own_magnitude():
    scaling = Scaling(10.0, np.full(2, 1e-9))
    assert scaling.foresee(np.array([1.0, 4.0, 2.0]))
    for unknown in ([0.005, 0.0, 0.0], [0.0, 0.02, 0.0]):  # within a thousandth of the span
        assert scaling.norm(np.array(unknown)) == pytest.approx(math.sqrt(0.5))


@pytest.mark.parametrize(
    ("at", "tangent", "longest"),
    [
        ([0.5, 1.0], [0.2, -2.0, 0.5], 1 / 15),  # y by a thirtieth of 4
        ([0.5, -3.99], [0.2, -2.0, 0.5], 1 / 3),  # y grows: x by a thirtieth of 2
        ([0.5, -3.99], [0.0, -2.0, 0.0], 1.0),  # y grows, by half of what it was
    ],
)
def test_the_longest_step_by_each_unknown(at, tangent, longest):
    scaling = Scaling(10.0, np.array([2.0, 4.0]))
    step = scaling.longest(np.array([*at, 5.0]), np.array(tangent), 1 / 30)
    assert step == pytest.approx(longest, rel=1e-12)


def test_only_the_parameter_bends_a_branch():
    scaling = Scaling(2.0, np.ones(3))
    before, after = np.array([1.0, 2.0, 3.0, 0.5]), np.array([1.0, 7.0, -3.0, 0.5])
    assert scaling.bend(before, after) == 0.0
    after[-1] = 0.7
    small = scaling.bend(before, after)
    after[-1] = 0.1
    assert scaling.bend(before, after) == pytest.approx(2.0 * small)
    assert Scaling(4.0, np.ones(3)).bend(before, after) == pytest.approx(small)


@pytest.mark.parametrize(
    ("at", "tangent", "outgrown"),
    [
        ([1.0, 2e5], [0.0, 1.0, 0.0], True),
        ([1.0, 9e4], [0.0, 1.0, 0.0], False),  # not far enough
        ([1.0, 2e5], [0.0, -1.0, 0.0], False),  # on its way back
        ([1.0, -2e5], [0.0, -1.0, 4e-10], True),  # e-fold within 8e-5 of the parameter
        ([1.0, 2e5], [0.0, 1.0, 6e-10], False),  # within 1.2e-4, more than a millionth of 100
        ([1.0, 2e5], [0.0, 1.0, 1.0], False),
    ],
)
def test_when_a_branch_counts_as_running_to_infinity(at, tangent, outgrown):
    scaling = Scaling(100.0, np.ones(2))
    assert scaling.outgrown(np.array([*at, 50.0]), np.array(tangent)) is outgrown


def test_running_to_infinity_does_not_depend_on_units():
    scaling, at = Scaling(100.0, np.full(2, 1e-9)), np.array([1e-9, 2e-4, 50.0])
    assert scaling.outgrown(at, np.array([0.0, 1e-6, 0.0]))
    assert not scaling.outgrown(at, np.array([0.0, -1e-6, 0.0]))


def test_a_start_is_corrected_across_a_tangent_along_one_axis(circle):
    start = next(steps(circle, [0.1, 0.9], (-2, 2), tangent=[1.0, 0.0]))
    assert start.z == pytest.approx([0.1, math.sqrt(0.99)], rel=1e-12)


def test_a_start_is_not_corrected_across_a_tangent_far_from_its_branch(line):
    start, tangent = np.array([0.4, 0.6]), np.array([0.3, -1.0])
    z, _, iterations, _ = begin(line, start, (0, 1), StepSettings(), tangent)
    assert z.tolist() == [0.4, 0.6]
    assert iterations == 0


def test_the_first_tangent_is_of_length_one_though_the_scales_grew(circle):
    tangent = np.array([-0.6, 0.6])
    z, unit, _, scaling = begin(circle, np.array([0.4, 0.6]), (-2, 2), StepSettings(), tangent)
    assert z[0] > 0.4
    assert scaling.norm(unit) == pytest.approx(1.0, rel=1e-12)


def test_a_tangent_that_is_too_far_off_is_replaced_by_one_of_length_one(line):
    settings = StepSettings()
    first, second = itertools.islice(steps(line, [0.5, 0.5], (0, 1), tangent=[1.0, 0.1]), 2)
    assert second.arclength - first.arclength == pytest.approx(settings.initial, rel=1e-9)


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize(("x", "end"), [((0.5, 1.0), 0.5), ((1.0, 0.5), 0.5), ((0.9, 0.6), 0.4)])
def test_where_a_step_left_its_span_is_foreseen_by_the_cubic(kinds, sense, x, end):
    """Of the branch p = x**3; the equations are solved at the end of the span afterwards."""
    cubic = kinds.Scalar(lambda x, p: p - x**3, lambda x, p: -3.0 * x * x, lambda x, p: 1.0)
    scaling, builder = Scaling(1.0, np.ones(1)), Builder(cubic, (), 0)
    way = math.copysign(1.0, x[1] - x[0])

    def at(x):
        tangent = way * np.array([1.0, 3.0 * x * x])
        return np.array([x, x**3]), tangent / scaling.norm(tangent)

    (a, along_a), (b, along_b) = map(at, x)
    span = (0.0, end) if way > 0.0 else (end, 1.0)
    start = builder.point(a, sense * along_a, 0.0, 0)
    stepper = Stepper(builder, scaling, start, span, StepSettings(), sense)
    share, prediction = stepper._overshot(Corrected(b, along_b, 3, 0.0), (-1, *span))
    assert 0.0 < share < 1.0
    assert prediction == pytest.approx([end ** (1 / 3), end], abs=0.02)
    assert prediction[1] == pytest.approx(end, abs=1e-7)


def test_which_eigenvalues_are_unstable_is_asked_one_by_one(line):
    spectrum = np.array([1.0, -2.0, 3.0 + 1j, 3.0 - 1j, 0.0])
    assert line.sides(spectrum).tolist() == [True, False, True, True, False]


@pytest.mark.parametrize("direction", [0, 2, None])
def test_other_directions_than_forwards_and_backwards_are_refused(line, direction):
    with pytest.raises(UsageError, match="must be 1 or -1"):
        list(steps(line, [0, 0], (0, 1), direction=direction))
