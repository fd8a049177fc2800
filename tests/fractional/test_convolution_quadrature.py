import numpy as np
import pytest

from racs_bif.errors import ParameterError
from racs_bif.fractional.convolution_quadrature import check_orders, quadrature_weights
from racs_bif.fractional.laws import Law, PowerSum


def powers(*terms):
    c, e = zip(*terms, strict=True)
    return PowerSum(np.array(c, dtype=float), np.array(e, dtype=float))


ONE = powers((1, 0))


def miller(order, count):
    """Return the series of ((1 - z) (3 - z) / 2)**order by J. C. P. Miller's recursion."""
    first, second = np.ones(count), np.ones(count)
    for n in range(1, count):
        first[n] = first[n - 1] * (n - 1 - order) / n
        second[n] = second[n - 1] * (n - 1 - order) / n / 3.0
    return 1.5**order * np.convolve(first, second)[:count]


@pytest.mark.parametrize("order", [0.3, 0.5, 0.9, 1.5])
def test_weights_of_a_power_are_those_of_its_series(order):
    weights = quadrature_weights(Law(powers((1, order)), ONE), 0.1, 300)
    assert weights == pytest.approx(10.0**order * miller(order, 300), abs=1e-12 * weights[0])
    inverse = quadrature_weights(Law(ONE, powers((1, order))), 0.1, 300)
    # Each is bounded by the n-th power of time.
    assert inverse == pytest.approx(0.1**order * miller(-order, 300), abs=2e-13 * inverse.max())


def test_weights_of_a_quotient_divide_the_series():
    law = Law(powers((1, 0), (1, 0.7)), powers((1, 0), (2, 0.3)))
    weights = quadrature_weights(law, 0.02, 200)
    bottom = 2 * 0.02**-0.3 * miller(0.3, 200) + np.eye(200)[0]
    top = 0.02**-0.7 * miller(0.7, 200) + np.eye(200)[0]
    assert np.convolve(weights, bottom)[:200] == pytest.approx(top, abs=1e-11)


def test_a_constant_input_gives_the_exact_law_late():
    # Relaxation after a step tends to Z(0); s**0.5 acting on one is 1 / sqrt(pi t).
    weights = quadrature_weights(Law(powers((1, 0.5)), ONE), 0.01, 2000)
    t = 0.01 * np.arange(500, 2000)
    assert np.cumsum(weights)[500:] == pytest.approx(1.0 / np.sqrt(np.pi * t), rel=1e-3)


def test_orders_above_two_are_refused_in_one_line():
    check_orders(Law(ONE, powers((1, 2.0))))
    with pytest.raises(ParameterError, match=r"law of 'Z' spans s\*\*2.5.*split it") as told:
        check_orders(Law(ONE, powers((1, 2.5))))
    assert "\n" not in str(told.value)


def test_an_unstable_pole_is_refused():
    law = Law(ONE, powers((-9, 0), (1, 0.5)))  # pole at s = 81
    with pytest.raises(ParameterError, match="unstable pole"):
        quadrature_weights(law, 0.01, 500)
