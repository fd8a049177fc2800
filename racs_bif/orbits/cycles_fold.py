"""LPC: folds of a branch of periodic orbits."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from racs_bif.continuation.problem import Detector
from racs_bif.orbits.branch_point import BranchPointOfCycles
from racs_bif.orbits.normal_forms import cycle_normal_form
from racs_bif.orbits.problem import OrbitProblem, describe

if TYPE_CHECKING:
    from racs_bif.continuation.points import Point

_NEAR: Final = 0.05
_SINGULAR: Final = 1e-6
_STILL: Final = 1e-9
_STEEP: Final = 1e-5


class FoldOfCycles(Detector):
    """The tangent has no component along the parameter; a second multiplier is 1.

    The Hopf point that a branch of orbits starts from has such a tangent too, and is none.
    """

    label = "LPC"
    crossings = 1

    def value(self, problem: OrbitProblem, point: Point) -> float:
        """Return the tangent's component along the parameter."""
        return math.nan if problem.degenerate(point.z) else float(point.tangent[-1])

    def dismisses(self, before: Point, after: Point) -> bool:
        """Return whether the parameter stands still: the orbits around a centre, no folds."""
        size = max(1.0, abs(before.parameter))
        steepest = max(abs(point.tangent[-1]) for point in (before, after))
        moved = abs(after.parameter - before.parameter)
        return bool(steepest <= _STEEP * size and moved <= _STILL * size)

    def data(self, problem: OrbitProblem, point: Point) -> dict[str, Any] | None:
        """Return period, multipliers, normal form; None where it is none or branches cross.

        A branch born at a symmetry-breaking branch point runs through it with the tangent of a
        fold, but its matrix is singular there, which that of a fold is not.
        """
        others = point.spectrum[1:]
        if not len(others) or np.abs(others - 1.0).min() > _NEAR:
            return None
        if abs(BranchPointOfCycles().value(problem, point)) < _SINGULAR:
            return None
        return describe(problem, point) | cycle_normal_form(problem, point, self.label)
