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
_SEED: Final = 20240


class BranchPointOfCycles(Detector):
    """The matrix [jacobian; tangent] is singular."""

    label = "BPC"
    crossings = 1

    def value(self, problem: OrbitProblem, point: Point) -> float:
        """Return an estimate of its smallest singular value, with the sign of its determinant.

        The matrix is scaled by the magnitudes of the unknowns. The estimate is |r| / |A^-1 r| for a
        vector r that is always the same; it passes through zero linearly. The determinant keeps its
        sign from mesh to mesh.
        """
        z = point.z
        if problem.degenerate(z):
            return math.nan
        magnitudes = np.append(problem.scales(z), max(1.0, abs(z[-1])))
        row = point.tangent / magnitudes
        row /= np.linalg.norm(row)
        matrix = np.concatenate((problem.jacobian(z) * magnitudes, row[None]))
        sign = np.linalg.slogdet(matrix)[0]
        if sign == 0.0:
            return 0.0
        right = np.random.default_rng(_SEED).standard_normal(len(z))
        solution = np.linalg.solve(matrix, right)
        return float(sign * np.linalg.norm(right) / np.linalg.norm(solution))

    def data(self, problem: OrbitProblem, point: Point) -> dict[str, Any] | None:
        """Return period and multipliers; None unless a second multiplier is 1."""
        others = point.spectrum[1:]
        if not len(others) or np.abs(others - 1.0).min() > _NEAR:
            return None
        return describe(problem, point)
