"""Diffusive realisation with gains that are not negative: it relaxes, whatever the fit.

The relaxation function of a law Z(s) is completely monotone where Z is a complete Bernstein
function, the creep function where Z is a Stieltjes function (R. L. Schilling, R. Song, Z.
Vondracek, *Bernstein Functions*, chapters 2 and 6). On the upper side of the cut that shows in the
sign of the spectrum, Im Z(x exp(i pi)), the same for all x > 0. Then Z is a sum with gains >= 0 of

    1 and s / (s + r)   (relaxation),      1, 1/s and r / (s + r)   (creep),

and so is the realisation, found by `scipy.optimize.nnls`: it is passive where the law is. In the
first form the static gain is a term of its own. In the second the gains add up to Z(0); with h =
gains/Z(0), that is ``|A h - b|`` over h >= 0 with sum 1, which is ``|(A - b 1') h|**2 + (1' h -
1)**2`` over h >= 0 up to a factor of h (K. H. Haskell, R. J. Hanson, *Math. Program.* 21 (1981)
98-118).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import ParameterError, UsageError
from racs_bif.fractional.filter import Filter, Realisation
from racs_bif.fractional.residues import Relaxations, imaginary_axis, stack

if TYPE_CHECKING:
    from racs_bif.fractional.laws import Law
    from racs_bif.symbolic.field import Array

_NEGLIGIBLE = 1e-12


@dataclass(frozen=True, kw_only=True)
class NonNegative(Realisation):
    """Relaxations with gains from non-negative least squares.

    Rates whose gain is zero are kept: their number is the same for all parameters.

    Parameters
    ----------
    band : (float, float)
        Fitted frequencies [rad/s].
    order : int
        Number of relaxation rates; 0 takes 4.5 a decade.
    spread : float
        How far the rates reach beyond the band at either end, as a factor.

    Raises
    ------
    UsageError
        If the order or the spread cannot be used.
    """

    order: int = 0
    spread: float = 6.0

    def __post_init__(self) -> None:
        """Check the settings."""
        super().__post_init__()
        if self.order == 0:
            decades = math.log10(self.band[1] / self.band[0])
            object.__setattr__(self, "order", max(4, round(4.5 * decades)))
        if self.order < 2:
            msg = f"order {self.order} is too small; use at least 2 relaxation rates"
            raise UsageError(msg)
        if not 0.0 < self.spread < float("inf"):
            msg = f"spread {self.spread:g} is not usable; give a positive factor"
            raise UsageError(msg)

    @property
    def name(self) -> str:
        """Name on the command line."""
        return "nonnegative"

    @property
    def rates(self) -> Array:
        """Relaxation rates [rad/s] (order,)."""
        low, high = self.band
        return np.geomspace(low / self.spread, high * self.spread, self.order)

    def realise(self, law: Law) -> Filter:
        """Return the fitted filter; a law that integrates has one further state.

        Raises
        ------
        ParameterError
            If neither relaxation nor creep function is completely monotone.
        """
        from scipy.optimize import nnls

        s = imaginary_axis(self.band, max(200, 10 * self.order))
        target = law(s)
        weight = 1.0 / np.abs(target)
        basis = Relaxations.of(law, self.rates)
        if self._relaxes(law):
            rising = 1.0 - Relaxations(self.rates, integrates=False, feedthrough=False)(s)
            right = stack(weight * (target - law.static_gain))
            gains = nnls(stack(weight * rising), right)[0]
            return basis.filter(np.append(-gains, law.static_gain + gains.sum()))
        if law.integrates:
            return basis.filter(nnls(stack(weight * basis(s)), stack(weight * target))[0])
        matrix = stack(weight * (law.static_gain * basis(s) - target))
        matrix = np.vstack([matrix, np.ones(len(basis))])
        shares = nnls(matrix, np.append(np.zeros(len(matrix) - 1), 1.0))[0]
        return basis.filter(law.static_gain * shares / shares.sum())

    def derivative(self, law: Law, direction: Law) -> Filter:
        """Refuse: which gains are zero jumps.

        Raises
        ------
        UsageError
            Always.
        """
        del direction
        msg = (
            f"{self.name} cannot follow '{law.name}' while its orders or times move; "
            "use --realisation fitted, diffusive, matsuda or oustaloup"
        )
        raise UsageError(msg)

    def _relaxes(self, law: Law) -> bool:
        """Say whether the law relaxes (True) or creeps (False), refuse it where it does neither."""
        x = np.geomspace(self.band[0] * 1e-6, self.band[1] * 1e6, 1000)
        values = law((-x).astype(complex))
        spectrum = values.imag / np.abs(values)
        ends = law(x[[0, -1]].astype(complex)).real
        rises = bool(ends[1] > ends[0])
        wrong = spectrum < -_NEGLIGIBLE if rises else spectrum > _NEGLIGIBLE
        if _regular(law) and not np.any(wrong):
            return rises
        why = "it has a negative coefficient or an order above 1"
        if _regular(law):
            why = (
                f"its spectrum has the wrong sign at {x[wrong][0]:.3g} .. {x[wrong][-1]:.3g} rad/s"
            )
        msg = (
            f"{self.name} needs a completely monotone law, '{law.name}' is not: {why}; "
            "use --realisation fitted or diffusive"
        )
        raise ParameterError(msg)


def _regular(law: Law) -> bool:
    """Say whether numerator and denominator are Bernstein functions, without zeros off the cut."""
    return all(
        bool(np.all(side.coefficients >= 0.0) and np.all(side.exponents <= 1.0))
        for side in (law.numerator, law.denominator)
    )
