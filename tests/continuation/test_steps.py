"""The iterator, the settings and the reasons for ending."""

import itertools
import math

import numpy as np
import pytest

from racs_bif.continuation import StepSettings, Stopped, steps
from racs_bif.continuation.scaling import Scaling
from racs_bif.errors import UsageError


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


def test_only_the_parameter_bends_a_branch():
    scaling = Scaling(2.0, np.ones(3))
    before, after = np.array([1.0, 2.0, 3.0, 0.5]), np.array([1.0, 7.0, -3.0, 0.5])
    assert scaling.bend(before, after) == 0.0
    after[-1] = 0.7
    small = scaling.bend(before, after)
    after[-1] = 0.1
    assert scaling.bend(before, after) == pytest.approx(2.0 * small)
    assert Scaling(4.0, np.ones(3)).bend(before, after) == pytest.approx(small)


def test_which_eigenvalues_are_unstable_is_asked_one_by_one(line):
    spectrum = np.array([1.0, -2.0, 3.0 + 1j, 3.0 - 1j, 0.0])
    assert line.sides(spectrum).tolist() == [True, False, True, True, False]
