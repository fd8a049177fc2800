"""BPC: points where two branches of periodic orbits cross."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from racs_bif.continuation.problem import Detector
from racs_bif.orbits.problem import OrbitProblem, describe

if TYPE_CHECKING:
    from racs_bif.continuation.points import Point

_NEAR: Final = 0.05


class BranchPointOfCycles(Detector):
    """The matrix [jacobian; tangent] is singular."""

    label = "BPC"
    crossings = 1

    def value(self, problem: OrbitProblem, point: Point) -> float:
        """Return `OrbitProblem.singularity`; not defined where the branch begins."""
        if problem.degenerate(point.z):
            return math.nan
        return problem.singularity(point.z, point.tangent)

    def data(self, problem: OrbitProblem, point: Point) -> dict[str, Any] | None:
        """Return period and multipliers; None unless a second multiplier is 1."""
        others = point.spectrum[1:]
        if not len(others) or np.abs(others - 1.0).min() > _NEAR:
            return None
        return describe(problem, point)
