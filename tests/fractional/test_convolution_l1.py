from math import gamma

import mpmath
import numpy as np
import pytest

from racs_bif.fractional.l1_scheme import l1_order, l1_series, l1_weights
from racs_bif.fractional.laws import Law, PowerSum


def power(order):
    return PowerSum(np.ones(1), np.array([order]))


@pytest.mark.parametrize("order", [0.3, 0.8, -0.5, -1.5])
def test_weights_keep_their_digits_far_away(order):
    weights = l1_series(order, 1.0, 5000)
    with mpmath.workdps(40):
        a = 1 - mpmath.mpf(order)
        for n in (5, 23, 24, 25, 400, 4999):
            exact = ((n + 1) ** a - 2 * mpmath.mpf(n) ** a + (n - 1) ** a) / mpmath.gamma(1 + a)
            assert weights[n] == pytest.approx(float(exact), rel=1e-12)


def test_first_order_is_the_backward_difference():
    assert l1_series(1.0, 0.5, 5) == pytest.approx([2.0, -2.0, 0.0, 0.0, 0.0], abs=1e-15)


@pytest.mark.parametrize("order", [0.4, -0.6, -1.4])
def test_a_straight_line_is_exact(order):
    weights = l1_series(order, 0.01, 301)
    line = 0.01 * np.arange(301)
    exact = line ** (1.0 - order) / gamma(2.0 - order)
    assert np.convolve(weights, line)[:301] == pytest.approx(exact, abs=1e-13)


def test_a_law_divides_its_series():
    law = Law(
        PowerSum(np.ones(2), np.array([0.0, 0.7])), PowerSum(np.ones(2), np.array([0.0, 0.3]))
    )
    weights = l1_weights(law, 0.02, 200)
    bottom = l1_series(-0.3, 0.02, 200) + np.eye(200)[0]
    top = l1_series(-0.3, 0.02, 200) + l1_series(0.4, 0.02, 200)
    assert np.convolve(weights, bottom)[:200] == pytest.approx(top, abs=1e-11)
    assert l1_order(law) == pytest.approx(1.6)
    assert l1_order(Law(power(0.0), power(0.5))) == 2.0
