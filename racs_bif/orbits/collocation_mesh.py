"""Adaptation of the mesh of collocation between steps along a branch."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.orbits.mesh import Mesh, equidistributed

if TYPE_CHECKING:
    from racs_bif.orbits.collocation_settings import CollocationSettings
    from racs_bif.orbits.piecewise import Piecewise
    from racs_bif.symbolic.field import Array

_UNEVEN: Final = 1.6
"""Largest share of an interval over the mean share at which the mesh points stay where they are."""
_SPARE: Final = 1.25
"""How many more intervals are taken than the tolerance asks for."""
_TOO_MANY: Final = 2.0
"""Intervals are given back when there are so many times more than needed, ..."""
_HEALTHY: Final = 1e-3
"""... and the error of the trivial multiplier is this far below its bound: with half as many
intervals it is 2**(2 NCOL) times as large."""


def better_intervals(
    curve: Piecewise, scales: Array, settings: CollocationSettings, *, health: float
) -> Mesh | None:
    """Return a better mesh for an orbit, or None where the present one will do.

    Mesh points move when the intervals' shares of the error have become uneven; their number
    follows the tolerance, and is doubled when the trivial multiplier is off (`Floquet.health`).
    """
    mesh, order = curve.mesh, curve.gauss.degree + 1
    errors = curve.errors(scales)
    share = errors ** (1.0 / order)
    count = _count(mesh.steps, share, settings, health)
    uneven = float(share.max()) > _UNEVEN * float(share.mean())
    if count == mesh.steps and not (uneven and float(errors.max()) > 0.1 * settings.tolerance):
        return None
    return equidistributed(mesh, errors, order, count, mesh.segments)


def _count(steps: int, share: Array, settings: CollocationSettings, health: float) -> int:
    order = settings.degree + 1
    needed = _SPARE * float(share.sum()) / settings.tolerance ** (1.0 / order)
    wanted = steps
    if needed > steps:
        wanted = int(np.ceil(_SPARE * needed))
    elif health > settings.trivial:
        wanted = 2 * steps
    elif _TOO_MANY * needed < steps and health < _HEALTHY * settings.trivial:
        wanted = int(np.ceil(_SPARE * needed))
    return min(max(wanted, settings.intervals), settings.most_intervals)
