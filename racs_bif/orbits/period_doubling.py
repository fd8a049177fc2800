"""PD: a multiplier passes through -1."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from racs_bif.continuation.problem import Detector
from racs_bif.orbits.normal_forms import cycle_normal_form
from racs_bif.orbits.problem import OrbitProblem, describe

if TYPE_CHECKING:
    from racs_bif.continuation.points import Point

_NEAR: Final = 1e-2


class PeriodDoubling(Detector):
    """One multiplier is -1: an orbit of twice the period branches off."""

    label = "PD"
    crossings = 1

    def value(self, problem: OrbitProblem, point: Point) -> float:
        """Return the distance of the nearest multiplier from -1 with the sign of prod (mu + 1).

        Complex pairs contribute positive factors. Huge multipliers decide the sign but never the
        magnitude, so that one that overflows from one side to the other makes a jump, not a zero.
        """
        del problem
        others = point.spectrum[1:]
        if not len(others):
            return math.nan
        real = others[others.imag == 0.0].real
        sign = -1.0 if np.count_nonzero(real < -1.0) % 2 else 1.0
        return float(sign * np.abs(others + 1.0).min())

    def data(self, problem: OrbitProblem, point: Point) -> dict[str, Any] | None:
        """Return period, multipliers, normal form; None where no multiplier is at -1."""
        others = point.spectrum[1:]
        nearest = others[np.argmin(np.abs(others + 1.0))]
        if abs(nearest + 1.0) > _NEAR or nearest.imag != 0.0:
            return None
        return describe(problem, point) | cycle_normal_form(problem, point, self.label)
