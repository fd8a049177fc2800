"""Oustaloup's realisation of each power of s, with an exact static gain.

A. Oustaloup, F. Levron, B. Mathieu, F. M. Nanot, *IEEE Trans. Circuits Syst. I* 47 (2000) 25-39:
s**a on a band by alternating real zeros and poles. Its static gain is wrong (LOW**a, not zero),
which moves equilibria; here the slowest zero of each filter lies at s = 0, so that the static gain
of the law is exact, at the price of a phase error of about LOW/omega inside the band.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import ParameterError, UsageError
from racs_bif.fractional.filter import Filter, Realisation

if TYPE_CHECKING:
    from racs_bif.fractional.laws import Law, PowerSum
    from racs_bif.symbolic.field import Array


@dataclass(frozen=True, kw_only=True)
class Oustaloup(Realisation):
    """Oustaloup filters for the powers in numerator and denominator of a law.

    Parameters
    ----------
    band : (float, float)
        Band of the filters [rad/s]; choose it wide: the error falls with the width of the band,
        not with the number of sections.
    sections : int
        Number of sections of each power; 0 takes two a decade.
    """

    sections: int = 0

    def __post_init__(self) -> None:
        """Check the settings."""
        super().__post_init__()
        if self.sections == 0:
            decades = math.log10(self.band[1] / self.band[0])
            object.__setattr__(self, "sections", max(3, round(2.0 * decades)))
        if self.sections < 1:
            msg = f"{self.sections} sections are too few; use at least 1"
            raise UsageError(msg)

    @property
    def name(self) -> str:
        """Name on the command line."""
        return "oustaloup"

    def realise(self, law: Law) -> Filter:
        """Return the filter of a law, its powers in parallel, the denominator's in feedback.

        Raises
        ------
        ParameterError
            For a strictly proper law inside a loop, or an order that is not between 0 and 1.
        """
        if not law.feedthrough:
            msg = (
                f"oustaloup leaves '{law.name}' a direct feedthrough, but its law vanishes at high "
                "frequency; use --realisation diffusive"
            )
            raise ParameterError(msg)
        above, below = self._parts(law.numerator, law), self._parts(law.denominator, law)
        return _close(above, below)

    def derivative(self, law: Law, direction: Law) -> Filter:
        """Return the exact derivative of the filter."""
        above, below = self._parts(law.numerator, law), self._parts(law.denominator, law)
        above_p = self._slopes(law.numerator, direction.numerator, law)
        below_p = self._slopes(law.denominator, direction.denominator, law)
        return _close_slope(above, below, above_p, below_p)

    def power(self, order: float) -> tuple[Array, Array, float]:
        """Return rates (k,), gains (k,) and feedthrough of s**order = D + sum g r / (s + r).

        Parameters
        ----------
        order : float
            Between 0 and 1.
        """
        zeros, poles, top = self._zeros_poles(order)
        gains = top * self._residues(zeros, poles) / poles
        return poles, gains, top

    def power_slope(self, order: float) -> tuple[Array, Array, float]:
        """Return the derivative of `power` by the order."""
        zeros, poles, top = self._zeros_poles(order)
        residues = self._residues(zeros, poles)
        step = math.log(self.band[1] / self.band[0]) / (2.0 * self.sections)
        zeros_p, poles_p = -step * zeros, step * poles
        top_p = math.log(self.band[1])
        apart = zeros[None, :] - poles[:, None]
        change = ((zeros_p[None, :] - poles_p[:, None]) / apart).sum(axis=1)
        other = poles[None, :] - poles[:, None] + np.eye(len(poles))
        change -= ((poles_p[None, :] - poles_p[:, None]) / other).sum(axis=1)
        gains = top * residues / poles
        return poles_p, gains * (top_p + change - poles_p / poles), top * top_p

    def _zeros_poles(self, order: float) -> tuple[Array, Array, float]:
        low, high = self.band
        k = np.arange(self.sections)
        ratio = math.log(high / low) / self.sections
        zeros = low * np.exp(ratio * (k + 0.5 * (1.0 - order)))
        poles = low * np.exp(ratio * (k + 0.5 * (1.0 + order)))
        zeros[0] = 0.0
        return zeros, poles, high**order

    @staticmethod
    def _residues(zeros: Array, poles: Array) -> Array:
        """Return the residues of prod (s + z)/(s + p), each at its pole -p."""
        apart = zeros[None, :] - poles[:, None]
        other = poles[None, :] - poles[:, None] + np.eye(len(poles))
        return np.asarray(np.prod(apart / other, axis=1))

    def _parts(self, powers: PowerSum, law: Law) -> _Side:
        constant, rates, gains = 0.0, [], []
        for c, order in zip(powers.coefficients, powers.exponents, strict=True):
            if order == 0.0:
                constant += float(c)
                continue
            if not 0.0 < order < 1.0:
                msg = f"oustaloup realises orders between 0 and 1, '{law.name}' has {order:g}"
                raise ParameterError(msg)
            r, g, d = self.power(float(order))
            constant += float(c) * d
            rates.append(r)
            gains.append(c * g)
        return _Side(constant, _join(rates), _join(gains))

    def _slopes(self, powers: PowerSum, direction: PowerSum, law: Law) -> _Side:
        del law
        constant, rates, gains = 0.0, [], []
        terms = zip(
            powers.coefficients,
            powers.exponents,
            direction.coefficients,
            direction.exponents,
            strict=True,
        )
        for c, order, c_p, order_p in terms:
            if order == 0.0:
                constant += float(c_p)
                continue
            _, g, d = self.power(float(order))
            r_p, g_p, d_p = self.power_slope(float(order))
            constant += float(c_p * d + c * d_p * order_p)
            rates.append(r_p * order_p)
            gains.append(c_p * g + c * g_p * order_p)
        return _Side(constant, _join(rates), _join(gains))


@dataclass(frozen=True)
class _Side:
    """One side of the law: constant + sum gains * rates / (s + rates)."""

    constant: float
    rates: Array
    gains: Array


def _join(parts: list[Array]) -> Array:
    return np.concatenate(parts) if parts else np.zeros(0)


def _close(above: _Side, below: _Side) -> Filter:
    """Return the filter w of ``below(w) = above(e)``."""
    C = np.concatenate([above.gains, -below.gains]) / below.constant
    D = above.constant / below.constant
    rates = np.concatenate([above.rates, below.rates])
    feedback = np.concatenate([np.zeros_like(above.rates), below.rates])
    A = np.diag(-rates) + np.outer(feedback, C)
    B = np.concatenate([above.rates, below.rates * D])
    return Filter(A, B, C, D)


def _close_slope(above: _Side, below: _Side, above_p: _Side, below_p: _Side) -> Filter:
    """Return the derivative of `_close`."""
    whole = _close(above, below)
    shrink = below_p.constant / below.constant
    C = np.concatenate([above_p.gains, -below_p.gains]) / below.constant - shrink * whole.C
    D = above_p.constant / below.constant - shrink * whole.D
    zeros = np.zeros_like(above.rates)
    feedback, feedback_p = np.append(zeros, below.rates), np.append(zeros, below_p.rates)
    A = np.diag(-np.concatenate([above_p.rates, below_p.rates]))
    A += np.outer(feedback_p, whole.C) + np.outer(feedback, C)
    B = np.concatenate([above_p.rates, below_p.rates * whole.D + below.rates * D])
    return Filter(A, B, C, D)
