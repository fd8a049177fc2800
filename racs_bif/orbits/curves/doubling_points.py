"""GPD and R2 on a curve of period doublings."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from racs_bif.continuation.problem import Detector
from racs_bif.orbits.curves.singularity import pairing
from racs_bif.orbits.problem import describe

if TYPE_CHECKING:
    from racs_bif.continuation.points import Point
    from racs_bif.orbits.curves.problem import CycleCurve

_ZERO: Final = 1e-4


class GeneralisedPeriodDoubling(Detector):
    """GPD: the coefficient c of the period doubling vanishes; folds of doubled cycles end here."""

    label = "GPD"

    def value(self, problem: CycleCurve, point: Point) -> float:
        """Return c, MatCont's sign: negative where the doubled cycle is stable."""
        return problem.coefficient(point.z).value.real

    def data(self, problem: CycleCurve, point: Point) -> dict[str, Any] | None:
        """Return period and multipliers; None where c has a pole: at R2 and LPPD."""
        found = problem.coefficient(point.z)
        if not abs(found.value) < _ZERO * found.size:
            return None
        return describe(problem, point) | {"starts": "pd"}


class DoublingResonance(Detector):
    """R2: the multiplier -1 has a Jordan chain of length 2."""

    label = "R2"
    crossings = 1

    def value(self, problem: CycleCurve, point: Point) -> float:
        """Return `singularity.pairing`."""
        return pairing(problem, point.z)

    def data(self, problem: CycleCurve, point: Point) -> dict[str, Any] | None:
        """Return period and multipliers; None where the pairing jumps."""
        if abs(pairing(problem, point.z)) > _ZERO:
            return None
        return describe(problem, point) | {"starts": "pd, ns"}
