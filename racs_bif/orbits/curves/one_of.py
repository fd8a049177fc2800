"""A path along one of two active parameters."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from racs_bif.symbolic.paths import ParameterPath

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from racs_bif.symbolic.field import Array


class OneOf(ParameterPath):
    """One of two active parameters, the other held.

    Parameters
    ----------
    path : ParameterPath
        Both.
    index : int
        Which one is active.
    held : float
        The other's value.
    """

    def __init__(self, path: ParameterPath, index: int, held: float) -> None:
        self._path, self._index, self._held = path, index, held
        self.names = (path.names[index],)

    def _both(self, active: ArrayLike) -> Array:
        one = float(np.asarray(active, dtype=float).reshape(-1)[0])
        return np.array((one, self._held) if self._index == 0 else (self._held, one))

    def vector(self, active: ArrayLike) -> Array:
        """Return the base parameters (np,)."""
        return self._path.vector(self._both(active))

    def direction(self, active: ArrayLike, index: int = 0) -> Array:
        """Return the derivative (np,) of `vector`."""
        del index
        return self._path.direction(self._both(active), self._index)
