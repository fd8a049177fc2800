"""The regions into which lines divide the unit square: faces of a planar subdivision."""

from __future__ import annotations

import itertools
import math
from collections import defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from racs_bif.symbolic.field import Array

_SNAP = 1e-8
_JOIN = 5e-3
_DIGITS = 10
_BOX = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]])

Vertex = tuple[float, float]


@dataclass(frozen=True)
class Face:
    """A connected region.

    Parameters
    ----------
    outline : array (k, 2)
        Its outer boundary, counter-clockwise.
    holes : tuple of arrays (k, 2)
        What is cut out of it.
    """

    outline: Array
    holes: tuple[Array, ...]

    @property
    def area(self) -> float:
        """Its area, of the unit square's."""
        return signed_area(self.outline) + sum(map(signed_area, self.holes))

    def contains(self, places: Array) -> NDArray[np.bool_]:
        """Say which places (N, 2) are inside."""
        inside = _inside(self.outline, places)
        for hole in self.holes:
            inside &= ~_inside(hole, places)
        return inside

    @property
    def loops(self) -> tuple[Array, ...]:
        """The outline and the holes."""
        return (self.outline, *self.holes)


def divide(lines: Sequence[Array]) -> tuple[Face, ...]:
    """Divide the unit square along lines.

    Parameters
    ----------
    lines : sequence of arrays (k, 2)
        They may cross each other, be closed, or end within the square: an end close to another line
        is taken to end on it.

    Returns
    -------
    tuple of Face
        The largest first.
    """
    drawn = [_BOX, *(_tidy(line) for line in lines if len(line) > 1)]
    drawn = [drawn[0], *(_joined(k, drawn) for k in range(1, len(drawn)))]
    around = _graph(drawn)
    loops = [loop for loop in _walks(around) if abs(signed_area(loop)) > 1e-12]
    outlines = sorted(
        (loop for loop in loops if signed_area(loop) > 0.0), key=signed_area, reverse=True
    )
    holes: dict[int, list[Array]] = defaultdict(list)
    for loop in loops:
        if signed_area(loop) < 0.0:
            home = _home(loop, outlines)
            if home is not None:
                holes[home].append(loop)
    return tuple(Face(outline, tuple(holes[k])) for k, outline in enumerate(outlines))


def signed_area(loop: Array) -> float:
    """Return the area within a loop, positive where it runs counter-clockwise."""
    x, y = loop.T
    return 0.5 * float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))


def _inside(loop: Array, places: Array) -> NDArray[np.bool_]:
    x, y = places.T[:, :, None]
    (x0, y0), (x1, y1) = loop.T, np.roll(loop, -1, axis=0).T
    with np.errstate(divide="ignore", invalid="ignore"):
        crossed = ((y0 > y) != (y1 > y)) & (x < (x1 - x0) * (y - y0) / (y1 - y0) + x0)
    return np.asarray(np.count_nonzero(crossed, axis=1) % 2 == 1)


def _tidy(line: Array) -> Array:
    """Put points on the sides of the square that are there but for rounding."""
    line = np.where(np.abs(line) < _SNAP, 0.0, line)
    return np.where(np.abs(line - 1.0) < _SNAP, 1.0, line)


def _joined(k: int, lines: list[Array]) -> Array:
    """Return a line whose ends within the square are led on to what they almost reach."""
    line = lines[k]
    if np.array_equal(line[0], line[-1]):
        return line
    parts = [line]
    for place in (0, -1):
        end = line[place]
        if np.any((end == 0.0) | (end == 1.0)):
            continue
        others = [other for j, other in enumerate(lines) if j != k]
        targets = [_nearest(other, end) for other in others]
        best = min(targets, key=lambda target: float(np.hypot(*(target - end))))
        if 0.0 < np.hypot(*(best - end)) < _JOIN:
            # A little beyond, so that the two cross.
            further = best + 1e-3 * (best - end)
            parts = [further[None, :], *parts] if place == 0 else [*parts, further[None, :]]
    return np.vstack(parts)


def _nearest(line: Array, place: Array) -> Array:
    a, d = line[:-1], np.diff(line, axis=0)
    length = np.maximum((d**2).sum(axis=1), 1e-300)
    share = np.clip(((place - a) * d).sum(axis=1) / length, 0.0, 1.0)
    on = a + share[:, None] * d
    return np.asarray(on[int(np.argmin(np.hypot(*(on - place).T)))])


def _graph(lines: list[Array]) -> dict[Vertex, list[Vertex]]:
    """Return the neighbours of every vertex, after cutting all segments where they meet."""
    starts = np.vstack([line[:-1] for line in lines])
    ends = np.vstack([line[1:] for line in lines])
    neighbours: dict[Vertex, set[Vertex]] = defaultdict(set)
    for k in range(len(starts)):
        shares = _cuts(starts[k], ends[k], starts, ends)
        points = [_vertex(starts[k] + share * (ends[k] - starts[k])) for share in shares]
        for a, b in itertools.pairwise(points):
            if a != b:
                neighbours[a].add(b)
                neighbours[b].add(a)
    return {
        vertex: sorted(others, key=lambda o: math.atan2(o[1] - vertex[1], o[0] - vertex[0]))
        for vertex, others in neighbours.items()
    }


def _vertex(place: Array) -> Vertex:
    # Adding zero turns -0.0 into 0.0.
    return round(float(place[0]), _DIGITS) + 0.0, round(float(place[1]), _DIGITS) + 0.0


def _cuts(a: Array, b: Array, starts: Array, ends: Array) -> Array:
    """Return how far along a segment others meet it, its own ends included."""
    r, s, off = b - a, ends - starts, starts - a
    across = r[0] * s[:, 1] - r[1] * s[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = (off[:, 0] * s[:, 1] - off[:, 1] * s[:, 0]) / across
        along = (off[:, 0] * r[1] - off[:, 1] * r[0]) / across
    slack = 1e-9
    met = (share > 0.0) & (share < 1.0) & (along >= -slack) & (along <= 1.0 + slack)
    return np.unique(np.concatenate([[0.0, 1.0], share[met]]))


def _walks(around: dict[Vertex, list[Vertex]]) -> list[Array]:
    """Return the loops around all faces; those of a face's inside run counter-clockwise."""
    used: set[tuple[Vertex, Vertex]] = set()
    loops = []
    for start, others in sorted(around.items()):
        for other in others:
            if (start, other) in used:
                continue
            loop, a, b = [], start, other
            while (a, b) not in used:
                used.add((a, b))
                loop.append(a)
                turn = around[b]
                # The next edge clockwise from where we came keeps the face on the left.
                a, b = b, turn[turn.index(a) - 1]
            loops.append(np.array(loop))
    return loops


def _home(loop: Array, outlines: list[Array]) -> int | None:
    """Return the smallest outline around a loop that is not its own; None for the square itself."""
    inside = [
        k
        for k, outline in enumerate(outlines)
        if signed_area(outline) > abs(signed_area(loop)) * (1.0 + 1e-9)
        and bool(_inside(outline, loop[:1] + 0.0)[0])
    ]
    return max(inside) if inside else None
