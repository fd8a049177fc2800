"""CPC and R1 on a curve of folds of cycles."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from racs_bif.continuation.problem import Detector
from racs_bif.orbits.curves.singularity import pairing, quadratic
from racs_bif.orbits.problem import describe

if TYPE_CHECKING:
    from racs_bif.continuation.points import Point
    from racs_bif.orbits.curves.problem import CycleCurve

_ZERO: Final = 1e-4


class CuspOfCycles(Detector):
    """CPC: the quadratic coefficient of the fold vanishes; two folds of cycles meet in a cusp."""

    label = "CPC"

    def value(self, problem: CycleCurve, point: Point) -> float:
        """Return `singularity.quadratic`; NaN where no amplitude is left, as at GH."""
        return float("nan") if problem.degenerate(point.z) else quadratic(problem, point.z)

    def data(self, problem: CycleCurve, point: Point) -> dict[str, Any] | None:
        """Return period and multipliers; None where the coefficient has a pole: at R1."""
        if abs(pairing(problem, point.z)) < _ZERO:
            return None
        return describe(problem, point) | {"starts": "lpc"}


class FoldResonance(Detector):
    """R1: the multiplier 1 has a Jordan chain of length 3."""

    label = "R1"
    crossings = 1

    def value(self, problem: CycleCurve, point: Point) -> float:
        """Return `singularity.pairing`."""
        return pairing(problem, point.z)

    def data(self, problem: CycleCurve, point: Point) -> dict[str, Any] | None:
        """Return period and multipliers; None where the pairing jumps."""
        if abs(pairing(problem, point.z)) > _ZERO:
            return None
        return describe(problem, point) | {"starts": "lpc, ns"}
