"""Points from solutions: what the problem and the detectors say about them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.continuation.points import Array, Point

if TYPE_CHECKING:
    from collections.abc import Sequence

    from racs_bif.continuation.problem import Detector, Problem

FAILURES = (ArithmeticError, np.linalg.LinAlgError)
"""What says that there is no solution here, rather than that something is wrong."""


class Builder:
    """Makes points of one problem.

    Parameters
    ----------
    problem : Problem
        What is solved.
    detectors : sequence of Detector
        Whose test functions are evaluated; those from ``own`` on are not entered in the points.
    own : int
        How many detectors the caller gave.
    """

    def __init__(self, problem: Problem, detectors: Sequence[Detector], own: int) -> None:
        self.problem = problem
        self.detectors = tuple(detectors)
        self._own = own

    def point(self, z: Array, tangent: Array, arclength: float, iterations: int) -> Point:
        """Return the point at a solution, without its test functions."""
        problem = self.problem
        spectrum = problem.spectrum(z)
        return Point(
            z=z,
            tangent=tangent,
            spectrum=spectrum,
            stable=problem.stable(spectrum),
            unstable=problem.unstable(spectrum),
            measures=problem.measures(z),
            arclength=arclength,
            iterations=iterations,
        )

    def value(self, place: int, point: Point) -> float:
        """Return one test function; NaN where it could not be evaluated."""
        try:
            value = float(self.detectors[place].value(self.problem, point))
        except FAILURES:
            return math.nan
        return value if math.isfinite(value) else math.nan

    def values(self, point: Point) -> list[float]:
        """Return all test functions and enter the caller's in the point."""
        values = [self.value(place, point) for place in range(len(self.detectors))]
        own = self.detectors[: self._own]
        point.tests = {detector.label: value for detector, value in zip(own, values, strict=False)}
        return values
