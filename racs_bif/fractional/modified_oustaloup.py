r"""Xue's modified Oustaloup filter, its mid-band gain mended.

D. Xue, C. Zhao, Y. Chen, *Proc. IEEE Int. Conf. Mechatronics and Automation* (2006) 1043-1048.
With L = LOW, H = HIGH and the constants b = 10, d = 9,

.. math:: K(s) = \left(\frac{1 + b s/(d L)}{1 + d s/(b H)}\right)^a
               = \left(\frac{b s}{d L}\right)^a (1 + p(s))^a,
          \qquad p(s) = \frac{d (L H - s^2)}{d s^2 + b H s},

so that to first order in p ``s^a = (d L/b)^a K(s) / (1 + a p(s))``, and K is replaced by
alternating zeros and poles. The corners of K are d L/b and b H/d, so that K tends to the product

    prod (1 + s/z_k) / (1 + s/p_k)   with   prod p_k/z_k = (b^2 H / (d^2 L))^a

and ``(d L/b)^a prod p_k/z_k = (b H/d)^a``. As commonly coded the zeros and poles run over L .. H
instead, where prod p_k/z_k = (H/L)^a, while the factor (d L/b)^a stays: the gain in the middle of
the band is then (d/b)^a of what it should be, 0.93 for a = 0.7, and the vehicle's Hopf speed comes
out as 8.99 m/s instead of 10.2. Here zeros and poles run over the corners of K, and the gain is
right. Common code also writes d for d L H in p(s), which holds for L H = 1 only.
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

_RATIO = 10.0 / 9.0
"""Xue's b/d."""


@dataclass(frozen=True, kw_only=True)
class ModifiedOustaloup(PowerRealisation):
    """Modified Oustaloup filters for the powers of a law, two states more than sections each.

    Its zero at s = 0 makes static gains exact.
    """

    density = 2.0

    @property
    def name(self) -> str:
        """Name on the command line."""
        return "modified-oustaloup"

    def power(self, order: float) -> Side:
        """Return the filter of s**order."""
        return from_zeros_and_poles(*self._places(order))

    def power_slope(self, order: float) -> Side:
        """Return the derivative of `power` by the order."""
        zeros, poles, top = self._places(order)
        low, high = self._corners
        step = math.log(high / low) / (2.0 * self.sections)
        # (1-a) p^2 - H' p + a L' H' = 0 at the two poles p of the correction, H' = high, L' = low
        ends = poles[:2]
        turned = 2.0 * (1.0 - order) * ends - high
        ends_p = (ends**2 - self._product) / turned
        zeros_p = np.concatenate([np.zeros(2), -step * zeros[2:]])
        poles_p = np.concatenate([ends_p, step * poles[2:]])
        log_top_p = math.log(high) + 1.0 / (1.0 - order)
        return from_zeros_and_poles_slope(zeros, poles, top, zeros_p, poles_p, log_top_p)

    @property
    def _corners(self) -> tuple[float, float]:
        """Corners d L/b and b H/d of K."""
        return self.band[0] / _RATIO, self.band[1] * _RATIO

    @property
    def _product(self) -> float:
        return self.band[0] * self.band[1]

    def _places(self, order: float) -> tuple[Array, Array, float]:
        low, high = self._corners
        ratio = math.log(high / low) / self.sections
        k = np.arange(self.sections)
        # the slower root by the product of the two: it would cancel in the difference
        root = math.sqrt(high**2 - 4.0 * order * (1.0 - order) * self._product)
        fast = (high + root) / (2.0 * (1.0 - order))
        slow = order * self._product / ((1.0 - order) * fast)
        inner_zeros = low * np.exp(ratio * (k + 0.5 * (1.0 - order)))
        inner_poles = low * np.exp(ratio * (k + 0.5 * (1.0 + order)))
        zeros = np.concatenate([[0.0, high], inner_zeros])
        poles = np.concatenate([[slow, fast], inner_poles])
        return zeros, poles, high**order / (1.0 - order)
