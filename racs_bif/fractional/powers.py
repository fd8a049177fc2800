"""Realisations that replace every power of s in a law by a filter of its own."""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from racs_bif.errors import UsageError, ValidityError
from racs_bif.fractional.filter import Filter, Realisation

if TYPE_CHECKING:
    from racs_bif.fractional.laws import Law, PowerSum
    from racs_bif.symbolic.field import Array


@dataclass(frozen=True)
class Side:
    """One side of a law: ``constant + sum gains * rates / (s + rates)``."""

    constant: float
    rates: Array
    gains: Array


@dataclass(frozen=True, kw_only=True)
class PowerRealisation(Realisation):
    """Filters for the powers in numerator and denominator, the denominator's in feedback.

    Every filter of a power vanishes at s = 0, so that the static gain of the law is exact.

    Parameters
    ----------
    band : (float, float)
        Band of the filters [rad/s].
    sections : int
        Number of sections of each power; 0 takes `density` a decade, at least 3.

    Raises
    ------
    UsageError
        If there are no sections.
    """

    sections: int = 0
    density: ClassVar[float]
    """Sections a decade where their number is left out."""

    def __post_init__(self) -> None:
        """Check the settings."""
        super().__post_init__()
        if self.sections == 0:
            decades = math.log10(self.band[1] / self.band[0])
            object.__setattr__(self, "sections", max(3, round(self.density * decades)))
        if self.sections < 1:
            msg = f"{self.sections} sections are too few; use at least 1"
            raise UsageError(msg)

    @abstractmethod
    def power(self, order: float) -> Side:
        """Return the filter of s**order, 0 < order < 1, zero at s = 0."""

    @abstractmethod
    def power_slope(self, order: float) -> Side:
        """Return the derivative of `power` by the order."""

    def realise(self, law: Law) -> Filter:
        """Return the filter of a law.

        Raises
        ------
        ParameterError
            For a law that vanishes at high frequency, or an order that is not between 0 and 1.
        """
        return _close(*self._sides(law))

    def derivative(self, law: Law, direction: Law) -> Filter:
        """Return the exact derivative of the filter."""
        above, below = self._sides(law)
        above_p = self._side_slope(law.numerator, direction.numerator)
        below_p = self._side_slope(law.denominator, direction.denominator)
        return _close_slope(above, below, above_p, below_p)

    def _sides(self, law: Law) -> tuple[Side, Side]:
        if not law.feedthrough:
            msg = (
                f"{self.name} leaves '{law.name}' a direct feedthrough, but its law vanishes at "
                "high frequency; use --realisation fitted or diffusive"
            )
            raise ValidityError(msg)
        for order in (*law.numerator.exponents, *law.denominator.exponents):
            if not 0.0 <= order < 1.0:
                msg = (
                    f"{self.name} realises orders between 0 and 1, '{law.name}' has {order:g}; "
                    "use --realisation fitted or diffusive"
                )
                raise ValidityError(msg)
        return self._side(law.numerator), self._side(law.denominator)

    def _side(self, powers: PowerSum) -> Side:
        constant, rates, gains = 0.0, [np.zeros(0)], [np.zeros(0)]
        for c, order in zip(powers.coefficients, powers.exponents, strict=True):
            if order == 0.0:
                constant += float(c)
                continue
            part = self.power(float(order))
            constant += float(c) * part.constant
            rates.append(part.rates)
            gains.append(c * part.gains)
        return Side(constant, np.concatenate(rates), np.concatenate(gains))

    def _side_slope(self, powers: PowerSum, direction: PowerSum) -> Side:
        constant, rates, gains = 0.0, [np.zeros(0)], [np.zeros(0)]
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
            part, slope = self.power(float(order)), self.power_slope(float(order))
            constant += float(c_p * part.constant + c * slope.constant * order_p)
            rates.append(slope.rates * order_p)
            gains.append(c_p * part.gains + c * slope.gains * order_p)
        return Side(constant, np.concatenate(rates), np.concatenate(gains))


def from_zeros_and_poles(zeros: Array, poles: Array, top: float) -> Side:
    """Return partial fractions of ``top * prod (s + zeros) / (s + poles)``, of equal numbers."""
    return Side(top, poles, top * _residues(zeros, poles) / poles)


def from_zeros_and_poles_slope(
    zeros: Array, poles: Array, top: float, zeros_p: Array, poles_p: Array, log_top_p: float
) -> Side:
    """Return the derivative of `from_zeros_and_poles`; `log_top_p` is that of log(top)."""
    apart = zeros[None, :] - poles[:, None]
    change = ((zeros_p[None, :] - poles_p[:, None]) / apart).sum(axis=1)
    other = poles[None, :] - poles[:, None] + np.eye(len(poles))
    change -= ((poles_p[None, :] - poles_p[:, None]) / other).sum(axis=1)
    gains = top * _residues(zeros, poles) / poles
    return Side(top * log_top_p, poles_p, gains * (log_top_p + change - poles_p / poles))


def _residues(zeros: Array, poles: Array) -> Array:
    """Return the residues of prod (s + zeros) / (s + poles), each at its pole."""
    apart = zeros[None, :] - poles[:, None]
    other = poles[None, :] - poles[:, None] + np.eye(len(poles))
    return np.asarray(np.prod(apart / other, axis=1))


def _close(above: Side, below: Side) -> Filter:
    """Return the filter w of ``below(w) = above(e)``."""
    C = np.concatenate([above.gains, -below.gains]) / below.constant
    D = above.constant / below.constant
    rates = np.concatenate([above.rates, below.rates])
    feedback = np.concatenate([np.zeros_like(above.rates), below.rates])
    A = np.diag(-rates) + np.outer(feedback, C)
    B = np.concatenate([above.rates, below.rates * D])
    return Filter(A, B, C, D)


def _close_slope(above: Side, below: Side, above_p: Side, below_p: Side) -> Filter:
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
