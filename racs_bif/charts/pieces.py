"""The parts of boundaries that belong to the equilibrium of the chart, not to another one."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.charts.boundary import BETWEEN, Boundary
from racs_bif.charts.crossing import alike
from racs_bif.charts.ends import ENDS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from racs_bif.charts.lattice import Lattice
    from racs_bif.symbolic.field import Array

_NEAREST = 3
_PASSES_ON = "The boundary passes on to another equilibrium, where the two meet in a fold."


def own_pieces(lattice: Lattice, boundary: Boundary) -> list[Boundary]:
    """Return the parts of a boundary on which the chart's equilibrium is critical.

    Parameters
    ----------
    lattice : Lattice
        Equilibria of the chart.
    boundary : Boundary
        A boundary; one where the equilibrium ends is returned as it is.
    """
    if boundary.kind in ENDS or len(boundary.values) < 2:
        return [boundary]
    own = _belongs(lattice, boundary)
    if own.all():
        return [boundary]
    runs = np.flatnonzero(np.diff(np.concatenate([[False], own, [False]]).astype(int)))
    pieces = []
    for first, stop in runs.reshape(-1, 2):
        if stop - first >= 2:
            pieces.append(_piece(boundary, int(first), int(stop)))
    return pieces


def _piece(boundary: Boundary, first: int, stop: int) -> Boundary:
    part = slice(first, stop)
    return replace(
        boundary,
        values=boundary.values[part],
        states=boundary.states[part],
        omega=boundary.omega[part],
        l1=boundary.l1[part],
        gradient=boundary.gradient[part],
        line=boundary.line[BETWEEN * first : BETWEEN * (stop - 1) + 1],
        closed=False,
        stopped=_PASSES_ON,
        special=tuple(
            point
            for point in boundary.special
            if np.any(np.all(boundary.values[part] == point.values, axis=1))
        ),
    )


def _belongs(lattice: Lattice, boundary: Boundary) -> NDArray[np.bool_]:
    """Return which points are reached from the nearest nodes, by continuing their equilibria."""
    nodes = lattice.found
    places = np.array([node.place for node in nodes])
    at = lattice.plane.places(boundary.values.T)
    order = np.argsort(np.hypot(*(at[:, :, None] - places.T[:, None, :])), axis=1, kind="stable")
    own = np.zeros(at.shape[1], dtype=bool)
    for rank in range(min(_NEAREST, len(nodes))):
        rest = np.flatnonzero(~own)
        if not len(rest):
            break
        near = [nodes[k] for k in order[rest, rank]]
        X = np.array([node.X for node in near]).T
        start = np.array([node.place for node in near]).T
        # Where a real root is zero Newton's method does not converge: stop just short of it.
        end = start + (at[:, rest] - start) * (1.0 - 1e-3 * (boundary.kind == "static"))
        X, reached = lattice.sheet.follow(X, start, end)
        for k, place in enumerate(rest):
            same = alike(X[:, k], boundary.states[place], lattice.scale)
            own[place] = reached[k] == 1.0 and same
    return own


def away(line: Array, places: Array) -> Array:
    """Return distances (N,) of places (N, 2) to a line (k, 2)."""
    if len(line) < 2:
        return np.asarray(np.hypot(*(places - line[0]).T))
    a, d = line[:-1], np.diff(line, axis=0)
    length = np.maximum((d**2).sum(axis=1), 1e-300)
    share = np.clip(((places[:, None] - a) * d).sum(axis=2) / length, 0.0, 1.0)
    return np.asarray(
        np.hypot(*np.moveaxis(places[:, None] - a - share[..., None] * d, 2, 0)).min(axis=1)
    )
