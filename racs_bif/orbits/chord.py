"""The inner iteration of the implicit integrator."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from racs_bif.orbits.radau import StageFactors
    from racs_bif.symbolic.field import Array

_TOLERANCE: Final = 1e-13
_STAGNATION: Final = 1e-9
"""Changes of the stages below this that no longer shrink are rounding errors."""
_SLOW: Final = 0.2
"""Contraction per chord iteration above which the factors are renewed."""
_LOST: Final = 1e3
"""Change of the stages, relative to their size, at which an iteration is given up."""


class Chord:
    """Newton's method on the stages with factors kept as long as they contract.

    Parameters
    ----------
    factors : StageFactors, optional
        Factors from a solution near by.
    maps : array (N, 3, n, n), optional
        Their derivatives of the stages by the starts of the steps.

    Attributes
    ----------
    failed : bool
        Whether it diverges.
    """

    def __init__(self, factors: StageFactors | None = None, maps: Array | None = None) -> None:
        self._factors = factors
        self._maps = maps
        self._last = np.inf
        self.failed = False

    @property
    def stale(self) -> bool:
        """Whether factors are wanted."""
        return self._factors is None

    def renew(self, factors: StageFactors) -> None:
        """Take new factors."""
        self._factors, self._maps = factors, None

    def step(self, residual: Array, segments: int) -> Array:
        """Return the change of the stages (N, 3, n) of all steps, chained within the segments."""
        assert self._factors is not None
        own: Array = self._factors.solve(residual[..., None])[..., 0]
        steps, _, size = own.shape
        if steps == segments:
            return own
        if self._maps is None:
            self._maps = self._factors.sensitivities()
        last = own[:, -1].reshape(segments, -1, size, 1)
        maps = self._maps[:, -1].reshape(segments, -1, size, size)
        shifts = np.zeros_like(last)
        for k in range(last.shape[1] - 1):
            shifts[:, k + 1] = last[:, k] + maps[:, k] @ shifts[:, k]
        spread: Array = (self._maps @ shifts.reshape(steps, 1, size, 1))[..., 0]
        return own + spread

    def judge(self, change: float) -> bool:
        """Return whether the iteration has converged; renew the factors when it is slow."""
        known = np.isfinite(self._last)
        rate = change / self._last if known else 1.0
        if change <= _TOLERANCE or (rate < 1.0 and rate * change <= _TOLERANCE):
            return True
        if known and rate > 0.5 and change <= _STAGNATION:
            return True
        if not np.isfinite(change) or change > _LOST:
            self.failed = True
        if (known and rate > _SLOW) or change > 1.0:
            self._factors = None
        self._last = change
        return False
