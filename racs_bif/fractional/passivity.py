"""Where a transfer law gives energy: frequency bands with a negative storage or loss modulus.

With Z = N/D the signs of Re Z and Im Z are those of the real and imaginary part of ``N conj(D)``,
which on the imaginary axis are sums of real powers of omega: all their zeros can be found.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.fractional.real_powers import positive_zeros

if TYPE_CHECKING:
    from racs_bif.fractional.laws import Law
    from racs_bif.symbolic.field import Array

Band = tuple[float, float]
"""Frequencies [rad/s] between which it holds; from 0 and up to infinity."""


@dataclass(frozen=True)
class Passivity:
    """Bands of frequency in which a law is not like a passive material's.

    Parameters
    ----------
    active : tuple of (float, float)
        Where the loss modulus Im Z(i omega) is negative: the element gives energy in every period.
    negative_stiffness : tuple of (float, float)
        Where the storage modulus Re Z(i omega) is negative.
    """

    active: tuple[Band, ...]
    negative_stiffness: tuple[Band, ...]

    @property
    def passive(self) -> bool:
        """Whether the element never gives energy in harmonic motion."""
        return not self.active

    def __str__(self) -> str:
        """Say it in a line."""
        if self.passive:
            return "passive"
        bands = ", ".join(_text(band) for band in self.active)
        return f"not passive: Im Z(i omega) < 0, the element gives energy, for omega {bands}"


def passivity(law: Law) -> Passivity:
    """Find the bands in which the storage or the loss modulus is negative.

    Parameters
    ----------
    law : Law
        The law in numbers, strain (or displacement) to stress (or force).

    Returns
    -------
    Passivity
        Edges are exact to about 1e-13, relative.
    """
    return Passivity(active=_bands(law, np.sin), negative_stiffness=_bands(law, np.cos))


def _bands(law: Law, part: np.ufunc) -> tuple[Band, ...]:
    n, d = law.numerator, law.denominator
    # (i omega)**a conj((i omega)**b) = omega**(a + b) exp(i (a - b) pi/2)
    angle = 0.5 * np.pi * (n.exponents[:, None] - d.exponents[None, :])
    weights = part(angle)
    weights[np.abs(weights) < 1e-15] = 0.0
    coefficients = (n.coefficients[:, None] * d.coefficients[None, :] * weights).ravel()
    exponents = (n.exponents[:, None] + d.exponents[None, :]).ravel()
    edges = positive_zeros(coefficients, exponents)
    inner = 0.5 * (edges[1:] + edges[:-1])
    if len(edges):
        middles = np.concatenate([[edges[0] - 1.0], inner, [edges[-1] + 1.0]])
    else:
        middles = np.zeros(1)
    limits = [0.0, *(float(x) for x in np.exp(edges)), float("inf")]
    negative = [_is_negative(coefficients, exponents, y) for y in middles]
    bands = zip(limits, limits[1:], negative, strict=False)
    return tuple((a, b) for a, b, is_negative in bands if is_negative)


def _is_negative(coefficients: Array, exponents: Array, y: float) -> bool:
    terms = coefficients * np.exp(exponents * y)
    return bool(terms.sum() < -1e-13 * np.abs(terms).sum())


def _text(band: Band) -> str:
    low, high = band
    if low == 0.0:
        return "at all frequencies" if np.isinf(high) else f"< {high:.4g} rad/s"
    return f"> {low:.4g} rad/s" if np.isinf(high) else f"in {low:.4g} .. {high:.4g} rad/s"
