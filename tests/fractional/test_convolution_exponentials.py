import numpy as np
import pytest

from racs_bif.errors import UsageError
from racs_bif.fractional.convolution_quadrature import quadrature_weights
from racs_bif.fractional.exponential_sums import exponential_sum
from racs_bif.fractional.laws import Law, PowerSum

ONE = PowerSum(np.ones(1), np.zeros(1))


@pytest.mark.parametrize("tolerance", [1e-4, 1e-8, 1e-11])
@pytest.mark.parametrize("order", [0.1, 0.5, 0.9, 1.3, 1.7])
def test_every_far_weight_is_within_the_tolerance(order, tolerance):
    power = PowerSum(np.ones(1), np.array([order]))
    count = 400  # farther out the reference itself has no such relative accuracy
    exact = quadrature_weights(Law(power, ONE), 0.05, count)
    sums = exponential_sum((power,), 0.05, 100_000, tolerance)
    n = np.arange(sums.near, count)
    far = np.exp(-np.outer(n, sums.rates)) @ sums.far(power)
    noise = 1e-14 * exact[0]
    assert np.all(np.abs(far - exact[n]) <= tolerance * np.abs(exact[n]) + noise)
    assert sums.nearby(power) == pytest.approx(exact[: sums.near], abs=noise)


def test_far_weights_of_the_distant_past_follow_the_kernel():
    power = PowerSum(np.ones(1), np.array([0.4]))
    sums = exponential_sum((power,), 1e-3, 10_000_000, 1e-9)
    n = np.array([1e5, 1e6, 1e7])
    far = np.exp(-np.outer(n, sums.rates)) @ sums.far(power)
    # t**-1.4 / Gamma(-0.4), times the step
    kernel = (1e-3 * n) ** -1.4 / -3.7229806220320424 * 1e-3
    assert far == pytest.approx(kernel, rel=2e-5)


def test_rates_grow_with_the_logarithm_of_the_duration():
    power = PowerSum(np.ones(1), np.array([0.5]))
    few = exponential_sum((power,), 0.01, 10**3, 1e-8)
    many = exponential_sum((power,), 0.01, 10**6, 1e-8)
    assert many.near == few.near
    assert len(few.rates) < len(many.rates) < len(few.rates) + 25


def test_whole_powers_have_no_far_weights():
    row = PowerSum(np.array([1.0, 2.0, 3.0]), np.array([0.0, 1.0, 2.0]))
    sums = exponential_sum((row,), 0.1, 1000, 1e-8)
    assert np.all(sums.far(row) == 0.0)


@pytest.mark.parametrize("tolerance", [0.0, -1.0, 1.0, float("nan")])
def test_a_useless_tolerance_is_refused(tolerance):
    with pytest.raises(UsageError, match="memory tolerance"):
        exponential_sum((ONE,), 0.1, 100, tolerance)
