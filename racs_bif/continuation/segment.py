"""The branch between two of its points: a cubic through them, corrected where it matters."""

from __future__ import annotations

import math
from bisect import bisect
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.continuation.building import FAILURES, Builder
from racs_bif.errors import ConvergenceError
from racs_bif.numerics.newton import newton

if TYPE_CHECKING:
    from racs_bif.continuation.points import Array, Point
    from racs_bif.continuation.scaling import Scaling
    from racs_bif.continuation.settings import StepSettings

_TRUSTED = 1e-11
_ALIKE, _SOUND = 1e-3, 1e-6
_TELLING = 0.05
_NOISE = 1e-12
_ELSEWHERE = (0.0, 0.17, -0.17, 0.31, -0.31)


@dataclass(slots=True)
class _Node:
    at: float
    z: Array
    slope: Array


class Segment:
    """The piece of a branch between two points, as a graph over the chord between them.

    A place on it is a number from 0 to 1, the share of the chord. A point there is predicted by the
    cubic Hermite interpolant through the nearest points known and corrected in the hyperplane
    orthogonal to the chord, so that it cannot leave its place. Very near a branch point the
    correction is worse than the prediction, rounding being magnified by a nearly singular matrix:
    there the prediction stands once its error is known to be small.

    Parameters
    ----------
    builder : Builder
        Makes the points.
    scaling : Scaling
        The norm.
    settings : StepSettings
        For the correction.
    a, b : Point
        The ends.

    Attributes
    ----------
    length : float
        Scaled length of the chord.
    """

    def __init__(
        self, builder: Builder, scaling: Scaling, settings: StepSettings, a: Point, b: Point
    ) -> None:
        self.a, self.b = a, b
        self._builder, self._scaling, self._settings = builder, scaling, settings
        chord = b.z - a.z
        self.length = scaling.norm(chord)
        self._row = scaling.weights * chord / max(self.length, math.ulp(0.0))
        self._sense = math.copysign(1.0, self._row.dot(a.tangent))
        self._points = {0.0: a, 1.0: b}
        self._nodes = [_Node(0.0, a.z, self._slope(a.tangent))]
        self._nodes.append(_Node(1.0, b.z, self._slope(b.tangent)))
        self._coefficient: float | None = None

    def _slope(self, tangent: Array) -> Array:
        along = float(self._row.dot(tangent))
        floor = 0.1 * self._scaling.norm(tangent)
        if abs(along) < floor:
            along = math.copysign(floor, self._sense)
        return np.asarray(tangent * (self.length / along))

    def _around(self, at: float) -> int:
        place = bisect(self._nodes, at, key=lambda node: node.at)
        return min(max(place, 1), len(self._nodes) - 1)

    def interpolate(self, at: float) -> tuple[Array, Array]:
        """Return the cubic (n+1,) and its unit tangent (n+1,) at a place."""
        place = self._around(at)
        left, right = self._nodes[place - 1], self._nodes[place]
        gap = right.at - left.at
        u = (at - left.at) / gap
        jump = right.z - left.z
        m, k = gap * left.slope, gap * right.slope
        bend, twist = 3.0 * jump - 2.0 * m - k, m + k - 2.0 * jump
        z = left.z + u * (m + u * (bend + u * twist))
        tangent = m + u * (2.0 * bend + 3.0 * u * twist)
        return z, tangent * (self._sense / self._scaling.norm(tangent))

    def _expected(self, at: float) -> float:
        """Return the error of the cubic, by what it was before; infinity while that is unknown."""
        if self._coefficient is None:
            return math.inf
        place = self._around(at)
        left, right = self._nodes[place - 1].at, self._nodes[place].at
        return self._coefficient * ((at - left) * (right - at)) ** 2 + _NOISE

    def correct(self, at: float) -> tuple[Array, Array, int]:
        """Return the solution, the unit tangent and the iterations taken at a place.

        Raises
        ------
        ConvergenceError, numpy.linalg.LinAlgError
            If the correction fails where the cubic is not good enough.
        """
        z, tangent = self.interpolate(at)
        expected = self._expected(at)
        try:
            corrected = newton(
                self._builder.problem,
                z,
                self._row,
                self._scaling.weights,
                tolerance=min(self._settings.location, self._settings.tolerance),
                iterations=self._settings.iterations,
                noise=1e3 * self._settings.tolerance,
            )
        except FAILURES:
            if expected > _TRUSTED:
                raise
            return z, tangent, 0
        moved = self._scaling.norm(corrected.z - z)
        unit = corrected.tangent * (self._sense / self._scaling.norm(corrected.tangent))
        doubt = self._scaling.norm(unit - tangent) if expected <= _TRUSTED else 0.0
        if doubt > _ALIKE or (doubt > 0.0 and moved > 100.0 * expected):
            return z, tangent, 0
        if not moved <= 0.5 * self.length:
            msg = "a trial point left its segment of the branch"
            raise ConvergenceError(msg)
        if doubt <= _SOUND:
            # A tangent from a nearly singular matrix would only spoil the cubic.
            self._learn(at, corrected.z, unit, moved)
        return corrected.z, unit, corrected.iterations

    def _learn(self, at: float, z: Array, tangent: Array, moved: float) -> None:
        place = self._around(at)
        left, right = self._nodes[place - 1].at, self._nodes[place].at
        if right - left >= _TELLING and min(at - left, right - at) > 0.0:
            seen = moved / ((at - left) * (right - at)) ** 2
            self._coefficient = max(self._coefficient or 0.0, seen)
        self._nodes.insert(place, _Node(at, z, self._slope(tangent)))

    def point(self, at: float, low: float = 0.0, high: float = 1.0) -> tuple[float, Point]:
        """Return a point between two places, at the one wanted or, if that fails, near it.

        Raises
        ------
        ConvergenceError
            If no trial converges.
        """
        for share in _ELSEWHERE:
            place = at + share * ((high - at) if share > 0.0 else (at - low))
            if place in self._points:
                return place, self._points[place]
            try:
                z, tangent, iterations = self.correct(place)
                point = self._builder.point(z, tangent, self.arclength(place), iterations)
            except FAILURES:
                continue
            self._points[place] = point
            return place, point
        msg = "no trial point between two points of the branch converged"
        raise ConvergenceError(msg)

    def known(self, at: float) -> Point:
        """Return the point computed before at exactly this place."""
        return self._points[at]

    def arclength(self, at: float) -> float:
        """Return the arclength at a place."""
        return self.a.arclength + at * (self.b.arclength - self.a.arclength)
