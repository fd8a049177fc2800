"""The scaled norm in which lengths along a branch are measured."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from racs_bif.continuation.points import Array

ZERO = 1e-7
"""Unknowns below this are taken to be zero."""
_FORESEEN = 10.0
_GROWTH = 0.5
_SLOPE = 1e-3
_VAST = 1e5
_STILL = 1e-6


class Scaling:
    """A weighted Euclidean norm, the same for every problem whatever its units.

    The parameter counts in units of the span. The unknowns count by the root of their mean square,
    each in units of the largest magnitude it had so far, so that the norm does not grow with their
    number.

    Parameters
    ----------
    width : float
        Width of the span.
    magnitudes : array (n,)
        Typical magnitudes of the unknowns.

    Attributes
    ----------
    weights : array (n + 1,)
        The norm of v is ``sqrt(sum(weights * v**2))``.
    """

    def __init__(self, width: float, magnitudes: Array) -> None:
        self._width = width
        self.restart(magnitudes)

    def copy(self) -> Scaling:
        """Return a norm of its own that begins like this one."""
        twin = Scaling(self._width, self._seen)
        twin._raise(self._magnitudes)
        twin._largest = self._largest
        return twin

    def fitting(self, magnitudes: Array) -> Scaling:
        """Return this norm; where the dimension is another, a new one of these magnitudes."""
        same = len(magnitudes) == len(self._magnitudes)
        return self if same else Scaling(self._width, magnitudes)

    def restart(self, magnitudes: Array) -> None:
        """Begin anew, such as after a change of the dimension."""
        self._seen = np.array(magnitudes, dtype=float)
        self._magnitudes = self._seen.copy()
        self._largest = float(self._seen.max())
        self._update()

    def _update(self) -> None:
        inverse = np.empty(len(self._magnitudes) + 1)
        inverse[:-1] = 1.0 / self._magnitudes
        inverse[-1] = 1.0 / self._width
        self._inverse = inverse
        self.weights = inverse * inverse
        self.weights[:-1] /= len(self._magnitudes)

    def grow(self, magnitudes: Array) -> bool:
        """Take in magnitudes (n,) newly seen; return whether that changed the norm."""
        if not (magnitudes > self._seen).any():
            return False
        np.maximum(self._seen, magnitudes, out=self._seen)
        return self._raise(magnitudes)

    def foresee(self, tangent: Array) -> bool:
        """Take in how far a straight branch would carry the unknowns over the span.

        Only a small part of it counts: it is for unknowns that are zero at the start. And only so
        far as the others grow tenfold: beside a fold the branch is nothing like straight.
        """
        if tangent[-1] == 0.0:
            return False
        motion = _SLOPE * self._width * tangent / tangent[-1]
        known = self._seen > ZERO
        growth = np.abs(motion[:-1][known]) / self._seen[known]
        return self.suppose(motion / max(float(growth.max(initial=0.0)) / _FORESEEN, 1.0))

    def bend(self, before: Array, after: Array) -> float:
        """Return how far the parameter went, in the small parts of its span of `foresee`."""
        return abs(float(after[-1] - before[-1])) / (_SLOPE * self._width)

    def suppose(self, motion: Array) -> bool:
        """Take a motion (n + 1,) of the unknowns for their typical magnitude."""
        magnitudes = np.abs(motion[:-1])
        self._largest = max(self._largest, float(magnitudes.max()))
        return self._raise(magnitudes)

    def _raise(self, magnitudes: Array) -> bool:
        if not (magnitudes > self._magnitudes).any():
            return False
        np.maximum(self._magnitudes, magnitudes, out=self._magnitudes)
        self._update()
        return True

    def outgrown(self, z: Array, tangent: Array) -> bool:
        """Say whether a branch runs to infinity with the parameter all but standing still.

        That is so where an unknown is far beyond all scales of the start, and would grow e-fold
        before the parameter has gone a millionth of its span.
        """
        k = int(np.argmax(np.abs(z[:-1])))
        if not abs(z[k]) > _VAST * self._largest:
            return False
        growing = z[k] * tangent[k] > 0.0
        return bool(growing and abs(tangent[-1] * z[k]) < _STILL * self._width * abs(tangent[k]))

    def norm(self, v: Array) -> float:
        """Return the scaled norm of v (n+1,)."""
        return math.sqrt(self.weights.dot(v * v))

    def longest(self, z: Array, tangent: Array, maximum: float) -> float:
        """Return the longest step from z that moves nothing by more than ``maximum`` of its scale.

        An unknown that is growing beyond all it was may grow by half of that: what its range
        will be is not known yet.
        """
        motion = np.abs(tangent * self._inverse)
        step = maximum / float(motion.max())
        outward = np.abs(z[:-1] + step * tangent[:-1]) > self._seen
        if outward.any():
            motion[:-1][outward] *= maximum / max(_GROWTH, maximum)
            step = maximum / float(motion.max())
        return step
