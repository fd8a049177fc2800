"""Vector fitting with real poles.

B. Gustavsen, A. Semlyen, *IEEE Trans. Power Delivery* 14 (1999) 1052-1061, in the relaxed form of
B. Gustavsen, *IEEE Trans. Power Delivery* 21 (2006) 1587-1592: with sigma a rational function of
the present poles, sigma Z and sigma are fitted together, and the zeros of sigma are the next poles.
A pair of complex zeros is replaced by two real ones of the same product, an unstable zero by its
mirror image. The gains are fitted last, with the static gain exact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import UsageError
from racs_bif.fractional.filter import Filter, Realisation
from racs_bif.fractional.residues import (
    Relaxations,
    checked_rates,
    fit_gains,
    imaginary_axis,
    stack,
)

if TYPE_CHECKING:
    from racs_bif.fractional.laws import Complex, Law
    from racs_bif.symbolic.field import Array

_ROUNDS = 40
_SETTLED = 1e-9
_APART = 1.05
_HEAVY = 1e3


@dataclass(frozen=True, kw_only=True)
class VectorFitting(Realisation):
    """Poles and gains fitted to Z(i omega) over a band.

    Parameters
    ----------
    band : (float, float)
        Fitted frequencies [rad/s].
    order : int
        Number of poles, besides one at 0 where the law integrates; 0 takes 4.5 a decade,
        at least 4.

    Raises
    ------
    UsageError
        If the order is below 1.
    """

    order: int = 0

    def __post_init__(self) -> None:
        """Check the settings."""
        super().__post_init__()
        if self.order == 0:
            decades = math.log10(self.band[1] / self.band[0])
            object.__setattr__(self, "order", max(4, round(4.5 * decades)))
        if self.order < 1:
            msg = f"order {self.order} is too small; use at least 1"
            raise UsageError(msg)

    @property
    def name(self) -> str:
        """Name on the command line."""
        return "vector-fitting"

    def realise(self, law: Law) -> Filter:
        """Return the fitted filter.

        Raises
        ------
        ParameterError
            If two poles fall together.
        """
        s = imaginary_axis(self.band, max(200, 10 * self.order))
        rates = np.geomspace(*self.band, self.order)
        for _ in range(_ROUNDS):
            before, rates = rates, _relocate(law, rates, s)
            if np.max(np.abs(rates / before - 1.0)) < _SETTLED:
                break
        return fit_gains(law, checked_rates(-rates, self.name, law.name), s)

    def derivative(self, law: Law, direction: Law) -> Filter:
        """Refuse: the relocated poles are not differentiated.

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


def _relocate(law: Law, rates: Array, s: Complex) -> Array:
    """Return the next rates (k,), ascending."""
    target = law(s)
    weight = 1.0 / np.abs(target)
    size = float(np.exp(-np.log(weight).mean()))  # so that the law's unit does not matter
    whole = size * Relaxations.of(law, rates)(s)
    sigma = Relaxations(rates, integrates=False, feedthrough=True)(s)
    matrix = stack(weight * np.concatenate([whole, -target * sigma]))
    # keeps sigma from vanishing without naming the gain that must not
    row = np.concatenate([np.zeros(len(whole)), sigma.real.mean(axis=1)])
    matrix = np.vstack([_static_row(law, size * np.ones(len(whole)), rates), matrix, row])
    right = np.append(np.zeros(len(matrix) - 1), 1.0)
    gains = np.linalg.lstsq(matrix, right, rcond=None)[0][len(whole) :]
    zeros = np.linalg.eigvals(-np.diag(rates) - np.outer(rates, gains[:-1] / gains[-1]))
    return _made_real(np.asarray(zeros, dtype=np.complex128))


def _static_row(law: Law, whole: Array, rates: Array) -> Array:
    """Return the static gain as a heavy row (1, n), no row for a law that integrates."""
    if law.integrates:
        return np.zeros((0, len(whole) + len(rates) + 1))
    row = np.append(whole, -law.static_gain * np.ones(len(rates) + 1))
    return _HEAVY * row[None, :] / max(abs(law.static_gain), abs(complex(law(1j * rates[0]))))


def _made_real(zeros: Complex) -> Array:
    """Return positive rates, ascending and apart, in place of zeros anywhere."""
    logs = np.log(np.abs(zeros)) + np.where(zeros.real < 0.0, np.angle(-zeros), 0.0)
    rates = np.exp(np.sort(logs))
    for k in range(1, len(rates)):
        rates[k] = max(rates[k], _APART * rates[k - 1])
    return np.asarray(rates)
