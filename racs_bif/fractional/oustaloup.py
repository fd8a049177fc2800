"""Oustaloup's realisation of each power of s, with an exact static gain.

A. Oustaloup, F. Levron, B. Mathieu, F. M. Nanot, *IEEE Trans. Circuits Syst. I* 47 (2000) 25-39:
s**a on a band by alternating real zeros and poles. Its static gain is wrong (LOW**a instead of
zero), which moves equilibria; here the slowest zero of each filter lies at s = 0, so that the
static gain of the law is exact, at the price of a phase error of about LOW/omega in the band.
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
class Oustaloup(PowerRealisation):
    """Oustaloup filters for the powers in numerator and denominator of a law.

    Choose the band wide: the error falls with its width, not with the number of sections.
    """

    density = 2.0

    @property
    def name(self) -> str:
        """Name on the command line."""
        return "oustaloup"

    def power(self, order: float) -> Side:
        """Return the filter of s**order."""
        return from_zeros_and_poles(*self._places(order))

    def power_slope(self, order: float) -> Side:
        """Return the derivative of `power` by the order."""
        zeros, poles, top = self._places(order)
        step = math.log(self.band[1] / self.band[0]) / (2.0 * self.sections)
        return from_zeros_and_poles_slope(
            zeros, poles, top, -step * zeros, step * poles, math.log(self.band[1])
        )

    def _places(self, order: float) -> tuple[Array, Array, float]:
        low, high = self.band
        k = np.arange(self.sections)
        ratio = math.log(high / low) / self.sections
        zeros = low * np.exp(ratio * (k + 0.5 * (1.0 - order)))
        poles = low * np.exp(ratio * (k + 0.5 * (1.0 + order)))
        zeros[0] = 0.0
        return zeros, poles, high**order
