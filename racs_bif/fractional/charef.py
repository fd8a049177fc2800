"""Charef's realisation of each power of s.

A. Charef, H. H. Sun, Y. Y. Tsao, B. Onaral, *IEEE Trans. Autom. Control* 37 (1992) 1465-1470: the
fractional pole ``1/(1 + s/LOW)**m`` follows its straight line in a Bode diagram by alternating
poles and zeros, within y decibels. Here ``s**a = s * s**-m`` with m = 1 - a, so that the zero at s
= 0 is exact and with it the static gain of the law; y = 10 m (1-m) lg(HIGH/LOW) / sections is what
fills the band evenly, and makes places and gain smooth in the order.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.fractional.powers import (
    PowerRealisation,
    Side,
    from_zeros_and_poles,
    from_zeros_and_poles_slope,
)

if TYPE_CHECKING:
    from racs_bif.symbolic.field import Array


@dataclass(frozen=True, kw_only=True)
class Charef(PowerRealisation):
    """Charef's alternating poles and zeros for the powers of a law."""

    density = 2.0

    @property
    def name(self) -> str:
        """Name on the command line."""
        return "charef"

    def power(self, order: float) -> Side:
        """Return the filter of s**order."""
        return from_zeros_and_poles(*self._places(order))

    def power_slope(self, order: float) -> Side:
        """Return the derivative of `power` by the order."""
        zeros, poles, top = self._places(order)
        step = 0.5 * self._ratio
        log_top_p = math.log(self.band[0]) + step * (2.0 * self.sections - 1.0)
        return from_zeros_and_poles_slope(zeros, poles, top, -step * zeros, step * poles, log_top_p)

    @property
    def _ratio(self) -> float:
        return math.log(self.band[1] / self.band[0]) / self.sections

    def _places(self, order: float) -> tuple[Array, Array, float]:
        low, ratio, k = self.band[0], self._ratio, np.arange(self.sections)
        poles = low * np.exp(ratio * (k + 0.5 * order))
        zeros = low * np.exp(ratio * (k - 0.5 * order))
        zeros[0] = 0.0
        # LOW**-m from the fractional pole; prod poles / prod zeros at high frequency
        log_top = (order - 1.0) * math.log(low)
        log_top += float(np.log(poles).sum() - np.log(zeros[1:]).sum())
        return zeros, poles, math.exp(log_top)
