"""The straight line between two places of a plane, as a path of one parameter."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from racs_bif.symbolic.paths import ParameterPath

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from racs_bif.charts.plane import Plane
    from racs_bif.symbolic.field import Array


class EdgePath(ParameterPath):
    """The straight line between two places of a plane, its parameter from 0 to 1."""

    def __init__(self, plane: Plane, start: Array, end: Array) -> None:
        self.names = ("the place between two nodes",)
        self._path = plane.path
        self._start, self._end = plane.values(start), plane.values(end)

    def _at(self, active: ArrayLike) -> Array:
        share = float(np.atleast_1d(np.asarray(active, dtype=float))[0])
        return np.asarray((1.0 - share) * self._start + share * self._end)

    def vector(self, active: ArrayLike) -> Array:
        """Return the base parameters (np,)."""
        return self._path.vector(self._at(active))

    def direction(self, active: ArrayLike, index: int = 0) -> Array:
        """Return their derivative (np,)."""
        del index
        at, moved = self._at(active), self._end - self._start
        parts = [moved[k] * self._path.direction(at, k) for k in range(2) if moved[k]]
        return np.asarray(sum(parts))
