"""Convolution quadrature based on BDF2: weights of a transfer law for equidistant times.

A law Z(s) becomes the power series of ``Z(delta(zeta) / h)`` with the symbol of the second-order
backward difference, ``delta(zeta) = (1 - zeta) (3 - zeta) / 2``; its coefficients weigh the past
inputs. Nothing but Z itself is needed, whatever its orders. Source: Ch. Lubich, *Convolution
quadrature and discretized operational calculus I*, Numer. Math. 52 (1988) 129-145.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import ParameterError

if TYPE_CHECKING:
    from racs_bif.fractional.laws import Complex, Law
    from racs_bif.symbolic.field import Array

BDF2 = (1.5, -2.0, 0.5)
"""Coefficients of ``delta(zeta)``."""
_ALIASED = 1e-16  # radius**points: what the finite number of points lets through
_OVERSAMPLED = 8  # points for each coefficient; rounding grows by no more than 1e2
_HIGHEST = 2.0


def check_orders(law: Law) -> None:
    """Refuse a law whose orders the integrators are not made for.

    Raises
    ------
    ParameterError
        If a power of s in it, the least one taken as s**0, is above 2.
    """
    highest = max(law.numerator.exponents.max(), law.denominator.exponents.max())
    if highest > _HIGHEST:
        msg = (
            f"the law of '{law.name}' spans s**{highest:g}, orders up to {_HIGHEST:g} can be "
            "integrated; split it into several elements or states"
        )
        raise ParameterError(msg)


def difference_symbol(zeta: Complex) -> Complex:
    """Return ``delta(zeta)``."""
    return np.asarray((1.0 - zeta) * (3.0 - zeta) / 2.0)


def circle(count: int) -> tuple[float, int]:
    """Return radius and number of points of the circle on which `count` coefficients are found."""
    points = 1 << (_OVERSAMPLED * count - 1).bit_length()
    return _ALIASED ** (1.0 / points), points


def upper_half(count: int) -> Complex:
    """Return the points of the circle with non-negative imaginary part."""
    radius, points = circle(count)
    return np.asarray(radius * np.exp(2j * np.pi * np.arange(points // 2 + 1) / points))


def coefficients(values: Complex, count: int) -> Array:
    """Return the first coefficients of a real power series from its values.

    Parameters
    ----------
    values : complex array
        At `upper_half` of the same count.
    count : int
        How many.

    Returns
    -------
    array (count,)
        To about 1e-14 of the largest, where the series converges in the unit disc.
    """
    radius, points = circle(count)
    scaled = np.fft.irfft(np.conj(values), points)[:count]
    return np.asarray(scaled * radius ** -np.arange(count, dtype=float))


def quotient(law: Law, numerator: Complex, denominator: Complex, count: int) -> Array:
    """Return the coefficients of N/D from the values of both at `upper_half`.

    Raises
    ------
    ParameterError
        If D vanishes within the circle: the law has a pole that grows by itself.
    """
    turns = np.angle(denominator[1:] / denominator[:-1]).sum() / np.pi
    if round(float(turns)) != 0:
        msg = (
            f"the law of '{law.name}' has an unstable pole, its memory grows too fast for this "
            "method; use 'fast', or write the element as s**-q with its output in the input"
        )
        raise ParameterError(msg)
    return coefficients(np.asarray(numerator / denominator), count)


def quadrature_weights(law: Law, step: float, count: int) -> Array:
    """Return the weights of a law.

    Parameters
    ----------
    law : Law
        Z(s) = N(s) / D(s).
    step : float
        Distance of times, h [s].
    count : int
        Number of weights.

    Returns
    -------
    array (count,)
        Of the present input first.

    Raises
    ------
    ParameterError
        If the law has an unstable pole.

    Examples
    --------
    >>> from racs_bif.fractional.laws import PowerSum, Law
    >>> one, s = PowerSum(np.ones(1), np.zeros(1)), PowerSum(np.ones(1), np.ones(1))
    >>> print(quadrature_weights(Law(s, one), 0.5, 4).round(12) + 0.0)
    [ 3. -4.  1.  0.]
    """
    s = difference_symbol(upper_half(count)) / step
    return quotient(law, law.numerator(s), law.denominator(s), count)
