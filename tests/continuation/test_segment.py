"""The branch between two of its points."""

import math

import numpy as np
import pytest

from racs_bif.continuation import StepSettings
from racs_bif.continuation.building import Builder
from racs_bif.continuation.scaling import Scaling
from racs_bif.continuation.segment import Segment
from racs_bif.errors import ConvergenceError


@pytest.fixture
def quintic(kinds):
    """The branch x = p**5 from p = -0.5 to 0.5: the cubic's error is odd about the middle."""
    problem = kinds.Scalar(
        lambda x, p: x - p**5, lambda x, p: 1.0, lambda x, p: -5.0 * p**4, spectral=False
    )
    scaling, builder = Scaling(1.0, np.ones(1)), Builder(problem, (), 0)

    def end(p):
        tangent = np.array([5.0 * p**4, 1.0])
        return builder.point(np.array([p**5, p]), tangent / scaling.norm(tangent), p, 0)

    return Segment(builder, scaling, StepSettings(), end(-0.5), end(0.5))


def error(z):
    return abs(z[0] - z[1] ** 5)


def test_the_cubic_goes_through_the_nearest_points_known(quintic):
    before = [error(quintic.interpolate(at)[0]) for at in (0.25, 0.75)]
    quintic.correct(0.5)
    after = [error(quintic.interpolate(at)[0]) for at in (0.25, 0.75)]
    assert min(before) > 3e-3
    assert max(after) < 0.6 * min(before)


def test_a_cubic_worse_than_foreseen_is_corrected(quintic):
    # Almost nothing is to be corrected near the middle, so that little is expected elsewhere.
    quintic.correct(0.49999)
    z, _, iterations = quintic.correct(0.25)
    assert error(z) < 1e-12
    assert iterations > 0


@pytest.mark.parametrize(
    ("fails", "expected"),
    [
        (lambda p: abs(p + 0.1) < 0.01, 0.502),
        (lambda p: p > -0.11, 0.332),
        (lambda p: -0.2 < p < 0.05, 0.586),
        (lambda p: p > -0.2, 0.276),
    ],
)
def test_a_point_that_fails_is_looked_for_a_little_further_along(quintic, fails, expected):
    problem = quintic._builder.problem
    works = problem.f

    def f(x, p):
        return math.nan if fails(p) else works(x, p)

    problem.f = f
    at, point = quintic.point(0.4)
    assert at == pytest.approx(expected, rel=1e-12)
    assert point.parameter == pytest.approx(at - 0.5, abs=1e-3)
    assert quintic.point(at) == (at, point)


def test_a_point_that_fails_is_looked_for_between_the_places_given(quintic):
    problem = quintic._builder.problem
    works = problem.f
    problem.f = lambda x, p: math.nan if p > -0.11 else works(x, p)
    assert quintic.point(0.4, 0.3, 0.5)[0] == pytest.approx(0.383, rel=1e-12)


def test_the_cubic_begins_and_ends_where_the_segment_does(quintic):
    for at, end in ((0.0, quintic.a), (1.0, quintic.b)):
        z, tangent = quintic.interpolate(at)
        np.testing.assert_allclose(z, end.z, rtol=1e-14)
        np.testing.assert_allclose(tangent, end.tangent, rtol=1e-14)


def test_a_correction_that_does_not_shrink_is_no_solution(quintic):
    problem = quintic._builder.problem
    works, noise = problem.f, 1e-3

    def f(x, p):
        nonlocal noise
        noise = -noise
        return works(x, p) + noise

    problem.f = f
    with pytest.raises(ConvergenceError, match="contract"):
        quintic.correct(0.4)


@pytest.mark.parametrize(
    ("error", "slope"),
    [
        (math.nan, -1.0),  # the equations fail
        (0.0, -1.1),  # the tangent of a nearly singular matrix
        (1e-8, -1.0001),  # its solution
    ],
)
def test_where_corrections_are_worse_the_cubic_stands(kinds, error, slope):
    def bend(p):
        return 1e-11 * p**4

    problem = kinds.Scalar(
        lambda x, p: x - p - bend(p), lambda x, p: 1.0, lambda x, p: -1.0, spectral=False
    )
    scaling, builder = Scaling(1.0, np.ones(1)), Builder(problem, (), 0)
    tangent = np.ones(2) / scaling.norm(np.ones(2))
    ends = [
        builder.point(np.array([p + bend(p), p]), tangent * [1.0 + 4e-11 * p**3, 1.0], p, 0)
        for p in (-0.5, 0.5)
    ]
    segment = Segment(builder, scaling, StepSettings(), *ends)
    assert segment.correct(0.5)[2] > 0
    works = problem.f
    problem.f = lambda x, p: works(x, p) + error
    problem.f_p = lambda x, p: slope
    z, direction, iterations = segment.correct(0.3)
    assert iterations == 0
    assert z[0] - z[1] == pytest.approx(0.0, abs=1e-12)
    np.testing.assert_allclose(direction, tangent, rtol=1e-9)


def test_the_tangent_is_that_of_the_cubic(quintic):
    quintic.correct(0.5)
    for at in (0.1, 0.3, 0.6, 0.95):
        moved = quintic.interpolate(at + 1e-6)[0] - quintic.interpolate(at - 1e-6)[0]
        tangent = quintic.interpolate(at)[1]
        np.testing.assert_allclose(tangent[0] / tangent[1], moved[0] / moved[1], rtol=1e-6)
        for unit in (tangent, quintic.correct(at)[1]):
            assert quintic._scaling.norm(unit) == pytest.approx(1.0, rel=1e-14)
