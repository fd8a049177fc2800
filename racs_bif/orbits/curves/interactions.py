"""LPPD, LPNS, PDNS and NSNS: another multiplier reaches the unit circle along a curve."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from racs_bif.continuation.problem import Detector
from racs_bif.orbits.neimark_sacker import NeimarkSacker
from racs_bif.orbits.period_doubling import PeriodDoubling
from racs_bif.orbits.problem import describe

if TYPE_CHECKING:
    from racs_bif.continuation.points import Point
    from racs_bif.orbits.curves.problem import CycleCurve

_NEAR: Final = 1e-3


def _others(problem: CycleCurve, point: Point) -> Point:
    """Return a point whose multipliers are the trivial one and those that are not critical."""
    rest = problem.noncritical(point.spectrum)
    return replace(point, spectrum=np.concatenate((point.spectrum[:1], rest)))


class FoldBeside(Detector):
    """A further multiplier is 1."""

    crossings = 1

    def __init__(self, label: str, starts: str) -> None:
        self.label, self._starts = label, starts

    def value(self, problem: CycleCurve, point: Point) -> float:
        """Return the distance of the nearest multiplier from 1 with the sign of prod (mu - 1)."""
        others = problem.noncritical(point.spectrum)
        if not len(others):
            return float("nan")
        real = others[others.imag == 0.0].real
        sign = -1.0 if np.count_nonzero(real > 1.0) % 2 else 1.0
        return float(sign * np.abs(others - 1.0).min())

    def data(self, problem: CycleCurve, point: Point) -> dict[str, Any] | None:
        """Return period and multipliers; None where no multiplier is 1."""
        if abs(self.value(problem, point)) > _NEAR:
            return None
        return describe(problem, point) | {"starts": self._starts}


class DoublingBeside(Detector):
    """A further multiplier is -1."""

    crossings = 1

    def __init__(self, label: str, starts: str) -> None:
        self.label, self._starts = label, starts

    def value(self, problem: CycleCurve, point: Point) -> float:
        """Return the test function of a period doubling of the other multipliers."""
        return PeriodDoubling().value(problem, _others(problem, point))

    def data(self, problem: CycleCurve, point: Point) -> dict[str, Any] | None:
        """Return period and multipliers; None where no multiplier is -1."""
        if abs(self.value(problem, point)) > _NEAR:
            return None
        return describe(problem, point) | {"starts": self._starts}


class TorusBeside(Detector):
    """A further pair of complex multipliers is on the unit circle."""

    crossings = 2

    def __init__(self, label: str, starts: str) -> None:
        self.label, self._starts = label, starts

    def value(self, problem: CycleCurve, point: Point) -> float:
        """Return the test function of a Neimark-Sacker point of the other multipliers."""
        return NeimarkSacker().value(problem, _others(problem, point))

    def data(self, problem: CycleCurve, point: Point) -> dict[str, Any] | None:
        """Return angle, period and multipliers; None at a neutral saddle."""
        others = problem.noncritical(point.spectrum)
        upper = others[others.imag > 0.0]
        if not len(upper):
            return None
        nearest = upper[np.argmin(np.abs(np.abs(upper) - 1.0))]
        if abs(abs(nearest) - 1.0) > _NEAR:
            return None
        found = describe(problem, point)
        return found | {"angle": float(np.angle(nearest)), "starts": self._starts}
