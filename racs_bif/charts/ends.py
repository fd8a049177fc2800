"""Where an edge meets the end of its equilibrium: a fold, or a mass matrix that is singular."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.charts.boundary import Seed
from racs_bif.charts.sheet import SHORTEST
from racs_bif.errors import ConvergenceError
from racs_bif.fractional.exact_fold import solve_fold
from racs_bif.numerics.bracketing import root

if TYPE_CHECKING:
    from racs_bif.charts.edges import Edge
    from racs_bif.symbolic.field import Array

ENDS: Final = ("fold", "singular")
"""Kinds of boundaries behind which there is no equilibrium of the chart."""
_BEYOND = 1e-6
_NARROW = 1e-9


def end_seed(edge: Edge) -> Seed | None:
    """Return where the equilibrium of an edge's start ends, None where that is not found."""
    X, reached = edge.follow(np.ones(1))
    if reached[0] == 1.0:
        return None
    share = float(reached[0])
    return _singular(edge, X[:, 0], share) or _fold(edge, X[:, 0], share)


def _fold(edge: Edge, X: Array, share: float) -> Seed | None:
    try:
        fold = solve_fold(edge.lattice.plane.system.exact, edge.path, X, share)
    except (ConvergenceError, ArithmeticError, np.linalg.LinAlgError):
        return None
    if not -_BEYOND <= fold.value <= 1.0 + _BEYOND:
        return None
    return Seed("fold", fold.X, edge.place(fold.value))


def _singular(edge: Edge, X: Array, share: float) -> Seed | None:
    """Return where the determinant of the mass matrix changes its sign just ahead."""
    sheet = edge.lattice.sheet
    if not sheet.compiled.has_inertia:
        return None

    def inertia(at: float, low: float, high: float) -> tuple[float, float]:
        del low, high
        p = sheet.plane.vectors(edge.place(at)[:, None])
        there, found, _ = sheet.newton(X[:, None], p)
        return at, float(sheet.inertia(there, p)[0]) if found[0] else float("nan")

    ahead = min(share + 2.0 * SHORTEST, 1.0)
    ends = inertia(share, share, ahead)[1], inertia(ahead, share, ahead)[1]
    if not ends[0] * ends[1] < 0.0:
        return None
    found = root(inertia, (share, ahead, *ends), _NARROW)
    if found is None:
        return None
    place = edge.place(0.5 * (found[0] + found[1]))
    there, _, _ = sheet.newton(X[:, None], sheet.plane.vectors(place[:, None]))
    return Seed("singular", there[:, 0], place)
