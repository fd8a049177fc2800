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
_AT_ONCE = 200_000
"""Pairs of a line and a stretch of a boundary that are looked at together: some megabytes."""


def alike(a: Array, b: Array, scale: Array) -> bool:
    """Say whether two states are those of the same equilibrium, but for interpolation."""
    return bool(np.all(np.abs(a - b) <= _SAME_STATE * scale))


def between(rows: Array, at: float) -> Array:
    """Return a row (or number) between two rows, `at` counted in rows."""
    k = min(int(at), len(rows) - 2)
    return np.asarray((1.0 - (at - k)) * rows[k] + (at - k) * rows[k + 1])


def intersections(start: Array, end: Array, boundary: Boundary) -> tuple[np.ndarray, Array, Array]:
    """Return where a boundary crosses straight lines.

    Parameters
    ----------
    start, end : array (2, N)
        Ends of the lines, in the unit square.
    boundary : Boundary
        What may cross them.

    Returns
    -------
    (array (k,), array (k,), array (k,))
        Which line is crossed, in order, how far along it, and where on the boundary, counted in
        its points.
    """
    if len(boundary.line) < 2:
        return np.zeros(0, dtype=int), np.zeros(0), np.zeros(0)
    line, shift = _beyond_box(boundary.line, closed=boundary.closed)
    at_once = max(_AT_ONCE // len(line), 1)
    parts = []
    for first in range(0, start.shape[1], at_once):
        chosen = slice(first, first + at_once)
        which, k, share, along = _hits(start[:, chosen], end[:, chosen], line)
        parts.append((which + first, share, (k - shift + along) / BETWEEN))
    which, share, at = (np.concatenate(each) for each in zip(*parts, strict=True))
    return which, share, np.clip(at, 0.0, len(boundary.values) - 1.0)


def _hits(start: Array, end: Array, line: Array) -> tuple[np.ndarray, np.ndarray, Array, Array]:
    """Return which lines are crossed by which stretches, and how far along both that is."""
    q, s = line[:-1].T, np.diff(line, axis=0).T
    r = (end - start)[:, :, None]
    off = q[:, None] - start[:, :, None]
    across = r[0] * s[1] - r[1] * s[0]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = (off[0] * s[1] - off[1] * s[0]) / across
        along = (off[0] * r[1] - off[1] * r[0]) / across
    hit = (share >= 0.0) & (share <= 1.0) & (along >= 0.0) & (along < 1.0)
    which, k = np.nonzero(hit)
    return which, k, share[hit], along[hit]


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
