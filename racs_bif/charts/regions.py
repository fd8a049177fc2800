"""What the regions of a chart hold."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.charts.faces import Face, divide
from racs_bif.charts.lattice import NOTHING, UNCOUNTED, Lattice
from racs_bif.charts.pieces import away

if TYPE_CHECKING:
    from racs_bif.charts.boundary import Boundary
    from racs_bif.symbolic.field import Array

_SAMPLES = 60
_ALMOST = 0.95
_SLIVER = 1e-6
_EDGE = 1e-7
_ON = 1e-4
"""Nodes nearer than this to a region's outline are on it, as near as it is drawn."""
_MIXED = 0.1
"""Share of nodes with another count from which a region has none: nothing parts its equilibria."""


@dataclass(frozen=True)
class Region:
    """A region.

    Parameters
    ----------
    face : Face
        Where, in the unit square.
    count : int
        Unstable roots; `racs_bif.charts.lattice.NOTHING` where no equilibrium was found, negative
        too behind a singular mass matrix, and where it cannot be told.
    place : array (2,)
        Well inside it.
    nodes, disagreeing : int
        How many nodes of the lattice are in it, and how many of them have another count than
        the one farthest from its outline.
    """

    face: Face
    count: int
    place: Array
    nodes: int
    disagreeing: int


def regions(lattice: Lattice, boundaries: list[Boundary]) -> tuple[Region, ...]:
    """Return the regions between boundaries, the largest first.

    Parameters
    ----------
    lattice : Lattice
        Nodes with their counts.
    boundaries : list of Boundary
        What parts them.
    """
    lines = [boundary.line for boundary in boundaries]
    nodes = [*lattice.nodes.values(), *lattice.beside]
    places = np.clip([node.place for node in nodes], _EDGE, 1.0 - _EDGE)
    counts = np.array([node.count for node in nodes])
    found = []
    for face in divide(lines):
        if face.area < _SLIVER:
            continue
        inside = np.flatnonzero(face.contains(places))
        place = _middle(face)
        room = _room(face, places[inside])
        count = (
            int(counts[inside[int(np.argmax(room))]]) if len(inside) else _counted(lattice, place)
        )
        # on a boundary a node may belong to either side
        known = counts[inside[room > _ON]]
        known = known[known != UNCOUNTED]
        lost = known[known <= NOTHING]
        if count <= NOTHING and len(lost):
            # why an equilibrium was not found cannot be told as surely as that it was not
            count = int(np.median(lost))
            known = np.where(known <= NOTHING, count, known)
        wrong = int(np.count_nonzero(known != count))
        if wrong > _MIXED * len(inside):
            count = UNCOUNTED
        found.append(Region(face, count, place, len(inside), wrong))
    return tuple(found)


def _middle(face: Face) -> Array:
    """Return a place well inside a face."""
    low, high = face.outline.min(axis=0), face.outline.max(axis=0)
    for samples in (_SAMPLES, 4 * _SAMPLES):
        share = (np.arange(samples) + 0.5) / samples
        x, y = np.meshgrid(*(low[:, None] + share * (high - low)[:, None]))
        places = np.column_stack([x.ravel(), y.ravel()])
        places = places[face.contains(places)]
        if len(places):
            room = _room(face, places)
            roomy = places[room >= _ALMOST * room.max()]
            central = np.hypot(*(roomy - roomy.mean(axis=0)).T).argmin()
            return np.asarray(roomy[int(central)])
    return np.asarray(face.outline.mean(axis=0))


def _room(face: Face, places: Array) -> Array:
    """Return distances (N,) of places (N, 2) to a face's outline and holes."""
    loops = (np.vstack([loop, loop[:1]]) for loop in face.loops)
    return np.asarray(np.min([away(loop, places) for loop in loops], axis=0))


def _counted(lattice: Lattice, place: Array) -> int:
    """Return the count at a place, continued from the nearest node that leads there."""
    nodes = sorted(lattice.found, key=lambda node: float(np.hypot(*(node.place - place))))
    for node in nodes[:4]:
        at = place[:, None]
        X, reached = lattice.sheet.follow(node.X[:, None], node.place[:, None], at)
        if reached[0] == 1.0:
            return int(lattice.counter(X, lattice.plane.vectors(at))[0].unstable[0])
    return NOTHING
