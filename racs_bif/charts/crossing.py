"""Where straight lines cross boundaries, and whether states belong together there."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from racs_bif.charts.boundary import BETWEEN

if TYPE_CHECKING:
    from racs_bif.charts.boundary import Boundary
    from racs_bif.symbolic.field import Array

_SAME_STATE = 0.02
_BEYOND = 1e-6


def alike(a: Array, b: Array, scale: Array) -> bool:
    """Say whether two states are those of the same equilibrium, but for interpolation."""
    return bool(np.all(np.abs(a - b) <= _SAME_STATE * scale))


def between(rows: Array, at: float) -> Array:
    """Return a row (or number) between two rows, `at` counted in rows."""
    k = min(int(at), len(rows) - 2)
    return np.asarray((1.0 - (at - k)) * rows[k] + (at - k) * rows[k + 1])


def intersections(start: Array, end: Array, boundary: Boundary) -> list[tuple[float, float]]:
    """Return how far along a straight line a boundary crosses it, and where that is on it.

    The latter is counted in the boundary's points.
    """
    line = boundary.line
    if len(line) < 2:
        return []
    line, shift = _beyond_box(line, closed=boundary.closed)
    q, s = line[:-1], np.diff(line, axis=0)
    r = end - start
    across = r[0] * s[:, 1] - r[1] * s[:, 0]
    off = q - start
    with np.errstate(divide="ignore", invalid="ignore"):
        share = (off[:, 0] * s[:, 1] - off[:, 1] * s[:, 0]) / across
        along = (off[:, 0] * r[1] - off[:, 1] * r[0]) / across
    hit = (share >= 0.0) & (share <= 1.0) & (along >= 0.0) & (along < 1.0)
    found = []
    for k in np.flatnonzero(hit):
        at = (int(k) - shift + float(along[k])) / BETWEEN
        found.append((float(share[k]), min(max(at, 0.0), len(boundary.values) - 1.0)))
    return found


def _beyond_box(line: Array, *, closed: bool) -> tuple[Array, int]:
    """Return a line that goes on a little beyond the box where it ends at it."""
    if closed:
        return line, 0
    parts, shift = [line], 0
    for place, inner in ((0, 1), (-1, -2)):
        end = line[place]
        if np.any((end <= 1e-9) | (end >= 1.0 - 1e-9)):
            out = end - line[inner]
            further = (end + _BEYOND * out / max(float(np.hypot(*out)), 1e-300))[None, :]
            if place == 0:
                parts.insert(0, further)
                shift = 1
            else:
                parts.append(further)
    return np.vstack(parts), shift
