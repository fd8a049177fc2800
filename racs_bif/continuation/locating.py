"""Events between two points of a branch: where a test function changes sign."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from racs_bif.continuation.building import FAILURES, Builder
from racs_bif.continuation.points import Point, SpecialPoint
from racs_bif.continuation.segment import Segment
from racs_bif.numerics.bracketing import Bracket, dip, root, vertex

if TYPE_CHECKING:
    from racs_bif.continuation.scaling import Scaling
    from racs_bif.continuation.settings import StepSettings

_JUMP = 0.1
_MANY = 16
_SAMPLES = 8
_WINDOW = 1e-3
_SHALLOW = 0.5
_REACH = 1e-3
_ROUNDING = 4e-16
_APART = 1e-9
_BEYOND = 1e-8
AT = math.ulp(0.0)
"""Stands for a value that is zero at a point put between two others."""

Sample = tuple[float, float]
"""Abscissa and value."""


@dataclass(slots=True)
class Event:
    """A special point found: its place on the segment, its point and what is known about it."""

    at: float
    point: Point
    special: SpecialPoint
    crossings: int


class Locator:
    """Finds the events of a problem's detectors.

    Parameters
    ----------
    builder : Builder
        Knows the problem and the detectors.
    scaling : Scaling
        The norm.
    settings : StepSettings
        How closely to locate.
    notes : list of str
        Where it enters what went wrong.
    """

    def __init__(
        self, builder: Builder, scaling: Scaling, settings: StepSettings, notes: list[str]
    ) -> None:
        self._builder, self.scaling, self._settings = builder, scaling, settings
        self._notes = notes

    def segment(self, a: Point, b: Point) -> Segment:
        """Return the branch between two points."""
        return Segment(self._builder, self.scaling, self._settings, a, b)

    def locate(self, segment: Segment, place: int, before: float, after: float) -> Event | None:
        """Return the event at a sign change of a detector, or None if it is not of its kind.

        Parameters
        ----------
        segment : Segment
            Where to look.
        place : int
            Which detector.
        before, after : float
            Its values at the ends, of opposite signs; `AT` before where it is zero there.
        """
        detectors = self._builder.detectors
        if detectors[place].dismisses(segment.a, segment.b):
            return None
        if abs(before) == AT:
            return self.describe(place, segment.a, 0.0, _REACH)
        seen = {0.0: before, 1.0: after}

        def test(at: float, low: float, high: float) -> tuple[float, float]:
            at, point = segment.point(at, low, high)
            seen[at] = self._builder.value(place, point)
            return at, seen[at]

        tolerance = max(self._settings.location / segment.length, _ROUNDING)
        bracket: Bracket | None
        try:
            bracket = root(test, (0.0, 1.0, before, after), tolerance)
        except FAILURES:
            bracket = _narrowest(seen, before)
            self._note(place, segment.a, "could be located only roughly near")
        if bracket is None:
            return None
        low, high, at_low, at_high = bracket
        jumps = min(abs(at_low), abs(at_high)) > _JUMP * min(abs(before), abs(after))
        suspicious = jumps or at_low == 0.0 or len(seen) > _MANY
        if suspicious and not self._steady(segment, place, bracket):
            return None
        at = low if abs(at_low) <= abs(at_high) else high
        interval = abs(segment.known(high).parameter - segment.known(low).parameter)
        found = self.describe(place, segment.known(at), interval, max(segment.length, _REACH))
        return found and replace(found, at=at)

    def _steady(self, segment: Segment, place: int, bracket: Bracket) -> bool:
        """Whether the signs on both sides of a bracket last: in rounding noise they do not."""
        low, high, _, _ = bracket
        before = self._builder.value(place, segment.a)
        try:
            for k in range(1, _SAMPLES + 1):
                share = _WINDOW * k / _SAMPLES
                left = segment.point(low - share * low)[1]
                right = segment.point(high + share * (1.0 - high))[1]
                if not self._builder.value(place, left) * before > 0.0:
                    return False
                if not self._builder.value(place, right) * before < 0.0:
                    return False
        except FAILURES:
            return False
        return True

    def describe(self, place: int, point: Point, interval: float, reach: float) -> Event | None:
        """Return the event at a point, polished within reach, or None if it is not of its kind."""
        detector, problem = self._builder.detectors[place], self._builder.problem
        try:
            data = detector.data(problem, point)
        except FAILURES as error:
            data = {}
            self._note(place, point, f"could not be described ({error}) at")
        if data is None:
            return None
        label = detector.label
        point = replace(point, label=label)
        special = SpecialPoint(
            label, "", -1, point.z, point.tangent, point.spectrum, data, interval
        )
        try:
            z = detector.refine(problem, special)
            scaling = self.scaling.fitting(problem.scales(point.z))
            if z is not None and scaling.norm(z - point.z) <= reach:
                polished = self._builder.point(z, point.tangent, point.arclength, point.iterations)
                data = detector.data(problem, polished)
                if data is not None:
                    point = replace(polished, label=label)
                    special = replace(special, z=z, spectrum=point.spectrum, data=data)
        except FAILURES as error:
            self._note(place, point, f"could not be polished ({error}) at")
        self._builder.values(point)
        return Event(0.0, point, special, detector.explains(special.data))

    def _note(self, place: int, point: Point, what: str) -> None:
        label, parameter = self._builder.detectors[place].label, self._builder.problem.parameter
        self._notes.append(f"{label} {what} {parameter} = {point.parameter:.10g}.")

    def dip(self, segment: Segment, place: int, guess: float) -> float | None:
        """Return a place where a test function that has one sign at both ends has the other.

        Parameters
        ----------
        segment : Segment
            Where to look.
        place : int
            Which detector.
        guess : float
            Where the function may be nearest to zero.
        """
        before = self._builder.value(place, segment.a)
        sign = math.copysign(1.0, before)

        def test(at: float, low: float, high: float) -> tuple[float, float]:
            at, point = segment.point(at, low, high)
            return at, sign * self._builder.value(place, point)

        after = sign * self._builder.value(place, segment.b)
        try:
            return dip(test, (0.0, 1.0, sign * before, after), guess)
        except FAILURES:
            return None

    def turn(self, segment: Segment) -> float | None:
        """Return the place at which the parameter turns back, by the cubic alone."""
        before, after = float(segment.a.tangent[-1]), float(segment.b.tangent[-1])
        if not before * after < 0.0:
            return None

        def slope(at: float, low: float, high: float) -> tuple[float, float]:
            del low, high
            return at, float(segment.interpolate(at)[1][-1])

        bracket = root(slope, (0.0, 1.0, before, after), 1e-9)
        return None if bracket is None or not 0.0 < bracket[0] < 1.0 else bracket[0]


def lowest_between(ends: tuple[Sample, Sample], outer: Iterable[Sample]) -> float | None:
    """Return where, between two samples of one sign, a function may dip through zero.

    Parameters
    ----------
    ends : tuple
        Abscissa and value at both ends.
    outer : iterable
        The samples beyond either end, as far as there are any.

    Returns
    -------
    float or None
        The vertex, as a share of the way between the ends, of a parabola through the ends and one
        of the others; None unless it is much nearer to zero than the ends.
    """
    (start, before), (stop, after) = ends
    width = stop - start
    sign = math.copysign(1.0, before)
    before, after = sign * before, sign * after
    lowest = _SHALLOW * min(before, after)
    for where, beyond in outer:
        value = sign * beyond
        if not value > 0.0 or width == 0.0:
            continue
        x = (where - start) / width
        at, least = (
            vertex((x, 0.0, 1.0), (value, before, after))
            if x < 0.0
            else vertex((0.0, 1.0, x), (before, after, value))
        )
        if 0.0 < at < 1.0 and least <= lowest:
            return at
    return None


def _narrowest(seen: dict[float, float], before: float) -> Bracket:
    """Return the narrowest bracket among the values seen."""
    # By signs: the product of two tiny values may vanish.
    low = max(at for at, value in seen.items() if value and (value > 0.0) == (before > 0.0))
    high = min(at for at, value in seen.items() if value and (value > 0.0) != (before > 0.0))
    return low, high, seen[low], seen[high]


def at_zero(value: float, other: float, a: Point, b: Point) -> bool:
    """Whether a function is zero at the end of a segment but for a negligible length beyond it."""
    length = abs(b.arclength - a.arclength)
    return abs(value) * length <= _BEYOND * abs(value - other)


def apart(places: list[float]) -> list[float]:
    """Return places in order, without those that nearly coincide."""
    kept: list[float] = []
    for at in sorted(places):
        if not kept or at - kept[-1] > _APART:
            kept.append(at)
    return kept
