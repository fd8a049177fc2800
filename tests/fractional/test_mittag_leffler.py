import math

import mpmath
import numpy as np
import pytest

from racs_bif.errors import UsageError
from racs_bif.fractional.mittag_leffler import mittag_leffler


def reference(a, b, z):
    """The series in as many digits as its cancellation takes."""
    size = abs(z) ** (1.0 / a)
    with mpmath.workdps(int(60 + 0.5 * size)):
        a, b, z = mpmath.mpf(a), mpmath.mpf(b), mpmath.mpc(z)
        total, k = mpmath.mpf(0), 0
        while True:
            term = z**k * mpmath.rgamma(a * k + b)
            total += term
            if k > 5 and a * k + min(b, 0) > size and abs(term) < mpmath.mpf(10) ** -40:
                return complex(total)
            k += 1


@pytest.mark.parametrize("seed", range(4))
def test_against_the_series_in_many_digits(seed):
    rng = np.random.default_rng(seed)
    for k in range(40):
        a = rng.uniform(0.15, 2.0)
        b = rng.choice([1.0, a, a + 1.0, rng.uniform(-0.9, 3.0)])
        largest = min(30.0, 40.0**a)
        z = rng.uniform(-largest, min(largest, 15.0**a))
        if k % 2:
            angle = rng.uniform(-math.pi, math.pi)
            z = rng.uniform(0.1, min(largest, 20.0**a)) * np.exp(1j * angle)
        expected = reference(a, b, z)
        error = abs(complex(mittag_leffler(a, b, z)) - expected)
        assert error < 2e-13 * max(abs(expected), 1.0 / (1.0 + abs(z)))


def test_elementary_cases():
    x = np.linspace(-6.0, 4.0, 41)
    assert mittag_leffler(1.0, 1.0, x) == pytest.approx(np.exp(x), rel=1e-13)
    assert mittag_leffler(2.0, 1.0, -(x**2)) == pytest.approx(np.cos(x), abs=2e-13)
    assert mittag_leffler(1.0, 2.0, x + 0.03) == pytest.approx(
        np.expm1(x + 0.03) / (x + 0.03), rel=1e-12
    )
    from scipy.special import erfcx

    y = np.linspace(0.0, 50.0, 40)
    assert mittag_leffler(0.5, 1.0, -y) == pytest.approx(erfcx(y), rel=1e-12)


def test_far_out_it_is_its_asymptotic_series():
    z = np.array([-1e6, -1e9])
    assert mittag_leffler(0.5, 1.0, z) == pytest.approx(
        -1.0 / (z * math.gamma(0.5)) - 1.0 / (z**3 * math.gamma(-0.5)), rel=1e-11
    )


def test_shapes_types_and_overflow():
    assert mittag_leffler(0.7, 1.0, np.zeros((2, 3))).shape == (2, 3)
    assert not np.iscomplexobj(mittag_leffler(0.7, 1.0, [-3.0, 0.5, 2.0]))
    assert np.iscomplexobj(mittag_leffler(0.7, 1.0, 1.0j))
    assert mittag_leffler(0.5, 1.0, 1e3) == math.inf
    assert mittag_leffler(0.5, 0.0, 0.0) == 0.0


@pytest.mark.parametrize(
    ("a", "b", "z"), [(0.0, 1.0, 1.0), (2.5, 1.0, 1.0), (0.5, 99.0, 1.0), (0.5, 1.0, math.nan)]
)
def test_what_it_refuses(a, b, z):
    with pytest.raises(UsageError):
        mittag_leffler(a, b, z)


def test_up_to_the_largest_number():
    """Just below overflow E_1/2(z) is 2 exp(z**2)."""
    z = complex(705.0, 1.0) ** 0.5
    expected = 2.0 * math.exp(705.0) * complex(math.cos(1.0), math.sin(1.0))
    assert complex(mittag_leffler(0.5, 1.0, z)) == pytest.approx(expected, rel=1e-10)
    expected *= complex(705.0, 1.0) ** 0.25
    assert complex(mittag_leffler(0.5, 0.75, z)) == pytest.approx(expected, rel=1e-10)


def test_both_parameters_two():
    x = np.linspace(1.0, 6.0, 11)
    assert mittag_leffler(2.0, 2.0, -(x**2)) == pytest.approx(np.sin(x) / x, abs=2e-13)


def test_second_parameters_up_to_ten_are_taken():
    for b in (-9.5, 9.5, 10.0):
        expected = reference(0.7, b, 0.5).real
        assert mittag_leffler(0.7, b, 0.5) == pytest.approx(expected, rel=1e-12)
    for b in (-10.5, 10.5):
        with pytest.raises(UsageError, match=r"\|b\| <= 10"):
            mittag_leffler(0.7, b, 0.5)


@pytest.mark.parametrize("b", [2.5, 3.0])
def test_a_low_order_and_a_higher_second_parameter(b):
    expected = reference(0.3, b, -1.0).real
    assert mittag_leffler(0.3, b, -1.0) == pytest.approx(expected, rel=2e-13)


@pytest.mark.parametrize("b", [-9.5, -7.5, -4.0, -2.0, 3.5, 5.0, 7.0, 10.0])
def test_second_parameters_of_any_size(b):
    """The integrand has a pole of order b - a at zero, or grows as s**(a - b) far out."""
    rng = np.random.default_rng(int(10 * b + 100))
    for a in (0.3, 0.5, 0.9, 1.4, 1.9):
        for angle in (0.0, math.pi, rng.uniform(-math.pi, math.pi)):
            z = rng.uniform(0.95, min(6.0, 20.0**a)) * np.exp(1j * angle)
            expected = reference(a, b, z)
            error = abs(complex(mittag_leffler(a, b, z)) - expected)
            assert error < 2e-13 * max(abs(expected), 1.0 / (1.0 + abs(z)))


def test_values_that_do_not_overflow_though_their_exponential_does():
    z = math.sqrt(750.0)
    leading = 2.0 * math.exp(375.0) * math.exp(375.0 - 9.0 * math.log(750.0))
    assert mittag_leffler(0.5, 10.0, z) == pytest.approx(leading, rel=1e-12)
