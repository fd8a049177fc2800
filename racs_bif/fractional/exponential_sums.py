"""Memory as a sum of exponentials: the far weights of convolution quadrature, at constant cost.

The weights of ``(delta(zeta) / h)**q`` are an integral over the cut of that function,

    omega_n = -h**-q sin(pi q) / pi * integral of sigma(x)**q x**(-n-1) over x from 1 to 3,
    sigma(x) = (x - 1) (3 - x) / 2,

plus what decays like 2**-n. With ``x = exp(tau)``, ``tau = exp(xi)`` the trapezoidal rule in xi
converges exponentially and uniformly in n: every weight from the `near`-th on is a sum of
``c_i exp(-n tau_i)``, and a sum over the whole past is one state for each tau_i. The rates serve
all orders at once. A law N/D is taken power by power, ``D w = N e``: powers have no poles. The idea
is that of A. Schaedle, M. Lopez-Fernandez, Ch. Lubich, *Fast and oblivious convolution
quadrature*, SIAM J. Sci. Comput. 28 (2006) 421-438; real exponentials suffice here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import UsageError
from racs_bif.fractional.convolution_quadrature import (
    coefficients,
    difference_symbol,
    upper_half,
)

if TYPE_CHECKING:
    from racs_bif.fractional.laws import PowerSum
    from racs_bif.symbolic.field import Array

_SHARPEST = 1e-14
_EDGE = 0.6  # largest tau: the integral over x beyond exp(0.6) is below the tolerance


@dataclass(frozen=True)
class ExponentialSum:
    """Rates that represent far weights.

    Parameters
    ----------
    step : float
        Distance of times, h [s].
    near : int
        First weight that is represented; earlier ones are used as they are.
    rates : array (M,)
        The tau_i, per step.
    spacing : float
        Distance of their logarithms.
    """

    step: float
    near: int
    rates: Array
    spacing: float

    def far(self, powers: PowerSum) -> Array:
        """Return the c_i (M,) of a sum of powers of s, all of them non-negative."""
        x = np.exp(self.rates)
        sigma = np.expm1(self.rates) * (3.0 - x) / 2.0
        total = np.zeros(len(self.rates))
        for c, q in zip(powers.coefficients, powers.exponents, strict=True):
            if q != np.round(q):  # whole powers have a few weights only
                total -= c * self.step**-q * math.sin(math.pi * q) / math.pi * sigma**q
        return total * self.rates * self.spacing

    def nearby(self, powers: PowerSum) -> Array:
        """Return the weights before `near` (near,), by their definition."""
        s = difference_symbol(upper_half(self.near)) / self.step
        return coefficients(powers(s), self.near)


def exponential_sum(
    powers: tuple[PowerSum, ...], step: float, count: int, tolerance: float
) -> ExponentialSum:
    """Return rates for the far weights of sums of powers of s.

    Parameters
    ----------
    powers : tuple of PowerSum
        What is to be represented; exponents are non-negative.
    step : float
        Distance of times [s].
    count : int
        Number of steps over which the memory reaches back.
    tolerance : float
        Largest error of a far weight, relative to the weight of that power.

    Raises
    ------
    UsageError
        If the tolerance is not between 1e-14 and 0.1.
    """
    if not _SHARPEST <= tolerance <= 0.1:
        msg = f"memory tolerance {tolerance:g} is not usable; give one between 1e-14 and 0.1"
        raise UsageError(msg)
    digits = math.log(10.0 / tolerance)
    near = math.ceil((digits + 2.0) / _EDGE)
    exponents = np.concatenate([row.exponents for row in powers]) if powers else np.ones(1)
    broken = exponents[exponents != np.round(exponents)]
    lowest, highest = (float(broken.min()), float(broken.max())) if len(broken) else (1.0, 1.0)
    first = -digits / (1.0 + lowest) - math.log(max(count, near))
    last = math.log(_EDGE)
    # The rule's error is |Gamma(1 + q + 2 pi i / spacing)| / Gamma(1 + q), doubled.
    spacing = math.pi**2 / (digits + (highest + 0.5) * math.log(digits))
    places = last - spacing * np.arange(math.ceil((last - first) / spacing) + 1)
    return ExponentialSum(step, near, np.exp(places), spacing)
