"""Roots and dips."""

import math

import pytest

from racs_bif.numerics.bracketing import dip, root, vertex


class Counted:
    def __init__(self, function):
        self.function, self.calls = function, 0

    def __call__(self, x, low, high):
        assert low < x < high
        self.calls += 1
        return x, self.function(x)


@pytest.mark.parametrize(
    ("function", "at", "most"),
    [
        (lambda x: x - 0.3, 0.3, 10),
        (lambda x: math.exp(3 * x) - 2, math.log(2) / 3, 12),
        (lambda x: math.copysign(1, x - 0.123), 0.123, 45),
        (lambda x: (x - 0.7) ** 5, 0.7, 45),
        (lambda x: 1 / (x - 0.4), 0.4, 45),
    ],
)
def test_root_is_never_much_slower_than_bisection(function, at, most):
    counted = Counted(function)
    a, b, fa, fb = root(counted, (0.0, 1.0, function(0.0), function(1.0)), 1e-12)
    assert 0 <= b - a <= 1e-12
    assert a - 1e-12 <= at <= b + 1e-12
    assert fa * fb <= 0
    assert counted.calls <= most


def test_root_at_nan_is_none():
    function = Counted(lambda x: math.nan if 0.2 < x < 0.8 else x - 0.5)
    assert root(function, (0.0, 1.0, -0.5, 0.5), 1e-12) is None


def test_vertex_of_a_parabola():
    assert vertex((0.0, 0.5, 2.0), (4.0, 2.25, 0.0)) == pytest.approx((2, 0))
    assert math.isnan(vertex((0.0, 1.0, 2.0), (0.0, 1.0, 0.0))[0])


@pytest.mark.parametrize("depth", [1e-5, 1e-7, 1e-10])
@pytest.mark.parametrize("at", [0.03, 0.4, 0.99])
def test_dip_is_found(depth, at):
    def function(x):
        return math.cosh(x - at) - 1 - depth

    ends = function(0.0), function(1.0)
    assert min(ends) > 0
    x = dip(Counted(function), (0.0, 1.0, *ends), min(at + 0.1, 0.9))
    assert function(x) < 0


@pytest.mark.parametrize("height", [1e-3, 1e-9, 0.0])
def test_positive_minimum_is_no_dip(height):
    def function(x):
        return math.cosh(x - 0.4) - 1 + height

    assert dip(Counted(function), (0.0, 1.0, function(0.0), function(1.0)), 0.5) is None


def test_a_bracket_of_neighbouring_numbers_is_left_as_it_is():
    above = math.nextafter(1.0, 2.0)

    def never(x, low, high):
        raise AssertionError

    assert root(never, (1.0, above, -1.0, 1.0), 0.0) == (1.0, above, -1.0, 1.0)


def test_a_root_is_looked_for_only_so_often():
    trials = []

    def sign(x, low, high):
        trials.append(x)
        return x, math.copysign(1.0, x - 1e-250)

    a, b, fa, fb = root(sign, (0.0, 1.0, -1.0, 1.0), 1e-300)
    assert a <= 1e-250 <= b
    assert (fa, fb) == (-1.0, 1.0)
    assert 20 < len(trials) < 1000


def test_points_out_of_order_have_no_vertex():
    assert all(map(math.isnan, vertex((0.0, 0.0, 1.0), (1.0, 0.0, 1.0))))
    assert all(map(math.isnan, vertex((0.0, 2.0, 1.0), (1.0, 0.0, 1.0))))
