"""The L1 scheme: exact memory of what is interpolated by straight lines.

For s**q, q < 1, a piecewise linear function is differentiated (or integrated, q < 0) exactly: for
0 < q < 1 that is the L1 scheme of order 2 - q, for q < 0 the product trapezoidal rule of order 2.
A law N/D is divided by its denominator's highest power first, so that every power is below one;
then the power series of both are divided by each other. Sources: K. B. Oldham, J. Spanier, *The
Fractional Calculus*, Academic Press 1974, section 8.2; for its starting correction Y. Yan, M. Khan,
N. J. Ford, *An analysis of the modified L1 scheme*, SIAM J. Numer. Anal. 56 (2018) 210-227.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from racs_bif.fractional.convolution_quadrature import circle, quotient

if TYPE_CHECKING:
    from racs_bif.fractional.laws import Complex, Law, PowerSum
    from racs_bif.symbolic.field import Array

_EXPANDED = 24  # from this place on, differences are expanded: subtracting would lose digits


def l1_series(order: float, step: float, count: int) -> Array:
    """Return the weights of s**order.

    Parameters
    ----------
    order : float
        At most 1.
    step : float
        Distance of times [s].
    count : int
        Number of weights.

    Examples
    --------
    >>> print(l1_series(-1.0, 0.5, 4))
    [0.25 0.5  0.5  0.5 ]
    """
    from scipy.special import binom, rgamma

    a = 1.0 - order
    j = np.arange(count, dtype=float)
    near = np.arange(1, min(count, _EXPANDED), dtype=float)
    before = np.where(near > 1.0, (near - 1.0) ** a, 0.0)
    differences = np.ones(count)
    differences[1:_EXPANDED] = (near + 1.0) ** a - 2.0 * near**a + before
    far = j[_EXPANDED:]
    even = np.arange(2, 16, 2)
    terms = binom(a, even) * far[:, None] ** (a - even)
    differences[_EXPANDED:] = 2.0 * terms.sum(axis=1)
    return np.asarray(differences * rgamma(1.0 + a) * step**-order)


def l1_order(law: Law) -> float:
    """Return the scheme's order of convergence for a law."""
    growth = float(law.numerator.exponents.max() - law.denominator.exponents.max())
    return 2.0 - growth if growth > 0.0 else 2.0


def l1_weights(law: Law, step: float, count: int) -> Array:
    """Return the weights (count,) of a law, of the present input first.

    Raises
    ------
    ParameterError
        If the law has an unstable pole.
    """
    highest = float(law.denominator.exponents.max())
    numerator = _on_circle(law.numerator, highest, step, count)
    return quotient(law, numerator, _on_circle(law.denominator, highest, step, count), count)


def _on_circle(powers: PowerSum, highest: float, step: float, count: int) -> Complex:
    radius, points = circle(count)
    series = np.zeros(points)
    for c, e in zip(powers.coefficients, powers.exponents, strict=True):
        series += c * l1_series(float(e) - highest, step, points)
    return np.asarray(np.conj(np.fft.rfft(series * radius ** np.arange(points, dtype=float))))
