"""How many harmonics an orbit needs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.orbits.fourier import harmonics_of, resized, tails

if TYPE_CHECKING:
    from racs_bif.orbits.balance_settings import BalanceSettings
    from racs_bif.symbolic.field import Array

_GROWTH: Final = 1.3
_SPARE: Final = 1e-2
"""Harmonics are given back where even two thirds of them leave a tail this far below the bound."""


def wanted_harmonics(series: Array, settings: BalanceSettings) -> int:
    """Return how many harmonics an orbit should have, by the tail of its series (2H + 1, m)."""
    count = harmonics_of(series)
    if float(tails(series).max()) > settings.tail:
        return min(int(np.ceil(_GROWTH * count)), settings.most_harmonics)
    fewer = 2 * count // 3
    if fewer >= settings.harmonics:
        tail = float(tails(resized(series, fewer)).max())
        if tail < _SPARE * settings.tail:
            return fewer
    return count
