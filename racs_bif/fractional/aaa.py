"""Poles by the AAA algorithm, gains by least squares.

Y. Nakatsukasa, O. Sete, L. N. Trefethen, *SIAM J. Sci. Comput.* 40 (2018) A1494-A1522, as
`scipy.interpolate.AAA` has it. A law is real for s > 0 and is sampled there: the poles are then
real or conjugate, and for a relaxing law real and negative until the samples' digits are used up.
They are checked; the gains are fitted on the imaginary axis, with the static gain exact.
"""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import ParameterError, UsageError
from racs_bif.fractional.filter import Filter, Realisation
from racs_bif.fractional.residues import checked_rates, fit_gains, imaginary_axis

if TYPE_CHECKING:
    from racs_bif.fractional.laws import Law

_SAMPLES_PER_DECADE = 60


@dataclass(frozen=True, kw_only=True)
class Aaa(Realisation):
    """AAA on the positive real axis.

    Parameters
    ----------
    band : (float, float)
        Where the law is sampled [rad/s].
    order : int
        Number of poles, besides one at 0 where the law integrates; 0 takes three a decade,
        at least 8.

    Raises
    ------
    UsageError
        If the order is below 1, or scipy is older than 1.15.
    """

    order: int = 0

    def __post_init__(self) -> None:
        """Check the settings."""
        super().__post_init__()
        if self.order == 0:
            decades = math.log10(self.band[1] / self.band[0])
            object.__setattr__(self, "order", max(8, round(3.0 * decades)))
        if self.order < 1:
            msg = f"order {self.order} is too small; use at least 1"
            raise UsageError(msg)

    @property
    def name(self) -> str:
        """Name on the command line."""
        return "aaa"

    def realise(self, law: Law) -> Filter:
        """Return the fitted filter.

        Raises
        ------
        ParameterError
            If a pole is not real, negative and simple, or there are fewer poles than asked for.
        """
        try:
            from scipy.interpolate import AAA
        except ImportError:
            msg = "aaa needs scipy 1.15 or newer; update scipy, or use --realisation fitted"
            raise UsageError(msg) from None

        count = math.ceil(_SAMPLES_PER_DECADE * math.log10(self.band[1] / self.band[0]))
        x = np.geomspace(*self.band, max(count, 4 * self.order))
        samples = law(x.astype(complex)).real
        if law.integrates:
            samples = x * samples
        elif law.feedthrough:
            # the poles have to serve the static gain too, which the gains below meet exactly
            samples = (samples - law.static_gain) / x
        with warnings.catch_warnings():
            # the order ends the iteration, not the tolerance: that it warns of this is no news
            warnings.simplefilter("ignore", RuntimeWarning)
            fitted = AAA(x, samples, rtol=0.0, max_terms=self.order + 1, clean_up=False)
        poles = fitted.poles()
        poles = poles[np.isfinite(poles)]
        if len(poles) != self.order:
            msg = (
                f"{self.name} finds {len(poles)} poles for '{law.name}', not {self.order}; "
                "lower its order, or use --realisation fitted or diffusive"
            )
            raise ParameterError(msg)
        rates = checked_rates(poles, self.name, law.name)
        return fit_gains(law, rates, imaginary_axis(self.band, len(x)))

    def derivative(self, law: Law, direction: Law) -> Filter:
        """Refuse: the choice of samples jumps.

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
