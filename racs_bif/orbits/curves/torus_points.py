"""CH and the strong resonances R1 to R4 on a curve of Neimark-Sacker points."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from racs_bif.continuation.problem import Detector
from racs_bif.orbits.problem import describe

if TYPE_CHECKING:
    from racs_bif.continuation.points import Point
    from racs_bif.orbits.curves.problem import CycleCurve

_STARTS: Final = {"R1": "ns, lpc", "R2": "ns, pd", "R3": "ns", "R4": "ns"}
_STRONG: Final = 1e-3
_ZERO: Final = 1e-4


class TorusResonance(Detector):
    """R1 to R4: the critical multipliers are a first to fourth root of 1.

    Parameters
    ----------
    label : str
        "R1", "R2", "R3" or "R4".
    kappa : float
        Cosine of the angle there: 1, -1, -1/2, 0.
    """

    def __init__(self, label: str, kappa: float) -> None:
        self.label, self._kappa = label, kappa

    def value(self, problem: CycleCurve, point: Point) -> float:
        """Return the distance of the cosine."""
        return float(problem.layout.further_of(point.z)[0]) - self._kappa

    def data(self, problem: CycleCurve, point: Point) -> dict[str, Any] | None:
        """Return period and multipliers."""
        return describe(problem, point) | {"starts": _STARTS[self.label]}


class Chenciner(Detector):
    """CH: the real part of the coefficient d vanishes; folds of tori end here."""

    label = "CH"

    def value(self, problem: CycleCurve, point: Point) -> float:
        """Return Re d; NaN at neutral saddles and near strong resonances, where d has poles."""
        kappa = float(problem.layout.further_of(point.z)[0])
        resonant = min(abs(kappa - strong) for strong in (1.0, -1.0, -0.5, 0.0)) < _STRONG
        if abs(kappa) > 1.0 or resonant:
            return float("nan")
        return problem.coefficient(point.z).value.real

    def data(self, problem: CycleCurve, point: Point) -> dict[str, Any] | None:
        """Return angle, period and multipliers; None where Re d has a pole."""
        found = problem.coefficient(point.z)
        if not abs(found.value.real) < _ZERO * found.size:
            return None
        angle = float(np.arccos(problem.layout.further_of(point.z)[0]))
        return describe(problem, point) | {"angle": angle, "starts": "ns"}
