"""Pseudo-arclength steps along a branch (H. B. Keller, 1977), with step control."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from racs_bif.continuation.building import FAILURES, Builder
from racs_bif.continuation.checking import CONTRACTION, judge
from racs_bif.continuation.segment import Segment
from racs_bif.continuation.stopped import Stopped
from racs_bif.continuation.told import LOG
from racs_bif.errors import ConvergenceError, ValidityError
from racs_bif.numerics.newton import Corrected, NotFiniteError, newton

if TYPE_CHECKING:
    from racs_bif.continuation.points import Array, Point
    from racs_bif.continuation.problem import Bound
    from racs_bif.continuation.scaling import Scaling
    from racs_bif.continuation.settings import StepSettings

_FIRST_CLOSABLE = 4
_SAME = 1e-6
_SAME_DIRECTION = 0.99
_STRETCH = 1.1
_ROUNDED = 1e-12


def _cause(error: Exception) -> Stopped:
    """Say whether Newton's method failed, the equations did, or the model no longer holds."""
    if isinstance(error, ValidityError):
        return Stopped.VALIDITY
    newton_failed = isinstance(error, ConvergenceError | np.linalg.LinAlgError)
    if newton_failed and not isinstance(error, NotFiniteError):
        return Stopped.STEP
    return Stopped.FAILED


class Stepper:
    """Walks along a branch, one accepted point after another.

    Parameters
    ----------
    builder : Builder
        Makes the points.
    scaling : Scaling
        The norm; grown on the way.
    start : Point
        A solution with its tangent.
    span : tuple of float
        Where the parameter may go.
    settings : StepSettings
        Of the step control.
    sense : int
        +1 to walk along the start's tangent, -1 against it: arclengths then fall, and tangents
        still point along the branch, away from the walk.

    Attributes
    ----------
    point : Point
        Where the walk is, as the next step begins: on the new mesh where the mesh was adapted.
    step : float
        The next step.
    stopped : Stopped or None
        Why the walk ended; None while it can go on.
    message : str
        More about the end.
    """

    def __init__(
        self,
        builder: Builder,
        scaling: Scaling,
        start: Point,
        span: tuple[float, float],
        settings: StepSettings,
        sense: int = 1,
    ) -> None:
        self._builder, self._problem = builder, builder.problem
        self.scaling = scaling
        self._start = self.point = start
        self._tangent = start.tangent * sense
        self._bounds = ((-1, *span), *builder.problem.bounds())
        self._settings = settings
        self._sense = sense
        self.step = settings.initial
        self.stopped: Stopped | None = None
        self.message = ""
        self._accepted = 0
        self._curvature = math.inf
        self._refreshed = False

    def advance(self) -> Point | None:
        """Take one step; return the new point, or None if the walk has ended."""
        if self.stopped is None and self._exit()[0] <= 0.0:
            self.stopped = Stopped.SPAN
        if self.stopped is None and self._accepted >= self._settings.points:
            self.stopped = Stopped.POINTS
        cause, reason = Stopped.STEP, ""
        with np.errstate(all="ignore"):
            while self.stopped is None:
                try:
                    point = self._attempt()
                except FAILURES as error:
                    point, cause = None, _cause(error)
                    reason = str(error) or type(error).__name__
                    self.step *= 0.5
                    LOG.debug("      rejected, next step %.3E: %s", self.step, reason)
                else:
                    if point is not None:
                        return point
                    cause, reason = Stopped.TURN, "the tangent turned too much"
                if self.step < self._settings.minimum:
                    self._retry(cause, reason)
        return None

    def _retry(self, cause: Stopped, reason: str) -> None:
        """Try once more from a fresh tangent, then give up."""
        if not self._refreshed:
            self._refreshed = True
            self.step = self._settings.initial
            try:
                fresh = self._correct(self.point.z, self.scaling.weights * self._tangent, 0.5)
            except FAILURES:
                pass
            else:
                tangent = fresh.tangent / self.scaling.norm(fresh.tangent)
                if np.isfinite(tangent).all():
                    self._tangent = tangent
                    return
        self.stopped = cause
        self.message = (
            f"{self._problem.name} ended at {self._problem.parameter} = "
            f"{self.point.parameter:.10g}: {reason}"
        )

    def _exit(self) -> tuple[float, Bound]:
        """Return the step at which the tangent leaves the spans, and which of them."""
        steps = []
        for bound in self._bounds:
            place, low, high = bound
            speed, at = float(self._tangent[place]), float(self.point.z[place])
            end = high if speed > 0.0 else low
            steps.append((math.inf if speed == 0.0 else (end - at) / speed, bound))
        return min(steps, key=_first)

    def _correct(self, z: Array, row: Array, contraction: float) -> Corrected:
        return newton(
            self._problem,
            z,
            row,
            self.scaling.weights,
            tolerance=self._settings.tolerance,
            iterations=self._settings.iterations,
            contraction=contraction,
        )

    def _attempt(self) -> Point | None:
        """Try the present step; None if it does not look right."""
        z, tangent = self.point.z, self._tangent
        longest = self.scaling.longest(z, tangent, self._settings.maximum)
        step = self.step = min(self.step, longest)
        name, at = self._problem.parameter, self.point.parameter
        LOG.debug("      trial step %.3E from %s = %.10g", step, name, at)
        leaving, bound = self._exit()
        if leaving <= _STRETCH * step:
            # The last step is solved with the parameter held at the end of the span.
            return self._land(z + leaving * tangent, bound)
        corrected = self._correct(z + step * tangent, self.scaling.weights * tangent, CONTRACTION)
        passed = [
            (self._overshot(corrected, bound), bound)
            for bound in self._bounds
            if not bound[1] <= corrected.z[bound[0]] <= bound[2]
        ]
        if passed:
            (_, prediction), bound = min(passed, key=_first)
            return self._land(prediction, bound)
        return self._accept(corrected, held=None)

    def _overshot(self, corrected: Corrected, bound: Bound) -> tuple[float, Array]:
        """Return where the branch leaves a span, between here and beyond it: share and solution."""
        a, b = self.point, corrected
        place, low, high = bound
        end = high if b.z[place] > high else low
        share = float((end - a.z[place]) / (b.z[place] - a.z[place]))
        beyond = replace(a, z=b.z, tangent=b.tangent * self._sense)
        segment = Segment(self._builder, self.scaling, self._settings, a, beyond)
        for _ in range(4):
            z, direction = segment.interpolate(share)
            along_chord = direction[place] * segment.length * self._sense
            if along_chord == 0.0:
                break
            share = min(max(share + float(end - z[place]) / along_chord, 0.0), 1.0)
        return share, segment.interpolate(share)[0]

    def _land(self, prediction: Array, bound: Bound) -> Point | None:
        """Solve at the end of a span nearest to a prediction; shorten the step if that fails."""
        place, low, high = bound
        end = high if prediction[place] - low > high - prediction[place] else low
        prediction = prediction.copy()
        prediction[place] = end
        row = np.zeros(len(prediction))
        row[place] = 1.0 / (high - low)
        self.step = min(self.step, self.scaling.norm(prediction - self.point.z))
        try:
            corrected = self._correct(prediction, row, CONTRACTION)
        except FAILURES:
            if not self._solved(prediction):
                raise
        else:
            corrected.z[place] = end
            along_branch = self.scaling.weights.dot(self._tangent * corrected.tangent)
            if along_branch < 0.0:
                corrected.tangent = -corrected.tangent
            if self._outside(corrected.z):
                self.step *= 0.5
                LOG.debug("      rejected, next step %.3E: beyond another bound", self.step)
                return None
            point = self._accept(corrected, held=end)
            if point is not None or not self._solved(prediction):
                return point
        # Where branches cross exactly at the end of the span no matrix is regular.
        return self._accept(Corrected(prediction, self._tangent.copy(), 0, 0.0), held=end)

    def _solved(self, z: Array) -> bool:
        """Whether a prediction is a solution as it is: by its residual and the curvature."""
        if self._curvature * self.scaling.norm(z - self.point.z) ** 2 > _ROUNDED:
            return False
        residual = self._problem.residual(z)
        return bool(np.all(np.abs(residual) <= _ROUNDED * self._problem.terms(z)))

    def _outside(self, z: Array) -> bool:
        """Whether a solution on one bound is beyond another."""
        return any(not low <= z[place] <= high for place, low, high in self._bounds)

    def _accept(self, corrected: Corrected, *, held: float | None) -> Point | None:
        """Judge a corrected step; make it the present point if it passes."""
        before, scaling = self.point, self.scaling
        tangent = corrected.tangent / scaling.norm(corrected.tangent)
        verdict = judge(
            scaling,
            (before.z, corrected.z),
            (self._tangent, tangent),
            (corrected.iterations, corrected.contraction),
            self._settings.angle,
        )
        if not verdict.accepted:
            self.step *= verdict.factor
            LOG.debug("      rejected, next step %.3E: %s", self.step, verdict.reason)
            return None
        point = self._builder.point(
            corrected.z,
            tangent * self._sense,
            before.arclength + self._sense * verdict.length,
            corrected.iterations,
        )
        closed = self._closed(point, verdict.length)
        self.step *= verdict.factor
        self._refreshed = False
        self._accepted += 1
        self._curvature = scaling.norm(tangent - self._tangent) / verdict.length
        if closed is not None:
            self.stopped = Stopped.CLOSED
            self.point = closed
            return closed
        self._go_on(point, tangent)
        if held is not None and self.stopped is None:
            self.stopped = Stopped.SPAN
        return point

    def _go_on(self, point: Point, tangent: Array) -> None:
        """Make ready for the next step."""
        scaling, problem = self.scaling, self._problem
        self.stopped = problem.ends(point)
        if self.stopped is None and scaling.outgrown(point.z, tangent):
            self.stopped = Stopped.INFINITY
        adapted = problem.adapt(point.z, tangent) if self.stopped is None else None
        if adapted is not None:
            z, tangent = adapted
            if len(z) != len(point.z):
                scaling.restart(problem.scales(z))
            scaling.grow(problem.scales(z))
            tangent = tangent / scaling.norm(tangent)
            point = replace(point, z=z, tangent=tangent * self._sense)
        elif scaling.grow(problem.scales(point.z)):
            tangent = tangent / scaling.norm(tangent)
        self.point, self._tangent = point, tangent

    def _closed(self, point: Point, length: float) -> Point | None:
        """Return the start, with its new arclength, if this step passed it again."""
        before, start, scaling = self.point, self._start, self.scaling
        if self._accepted < _FIRST_CLOSABLE or len(start.z) != len(point.z):
            return None
        reach = _STRETCH * length
        _, low, high = self._bounds[0]
        if abs(start.z[-1] - point.z[-1]) > reach * (high - low):
            return None
        if scaling.norm(start.z - point.z) > reach:
            return None
        chord = point.z - before.z
        share = float((scaling.weights * chord).dot(start.z - before.z)) / length**2
        if not 0.0 < share <= 1.0 + 1e-9:
            return None
        segment = Segment(self._builder, scaling, self._settings, before, point)
        z, tangent = segment.correct(share)[:2] if share < 1.0 else (point.z, point.tangent)
        direction = scaling.weights.dot(tangent * start.tangent)
        direction /= scaling.norm(tangent) * scaling.norm(start.tangent)
        if scaling.norm(z - start.z) > _SAME or direction < _SAME_DIRECTION:
            return None
        return replace(start, arclength=segment.arclength(share))


def _first(pair: tuple[Any, ...]) -> Any:  # noqa: ANN401 - numbers, or tuples of them
    return pair[0]
