"""Looks for events along a branch as it grows, and puts them in their places."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from racs_bif.continuation.building import FAILURES, Builder
from racs_bif.continuation.counting import hides_others, unexplained
from racs_bif.continuation.locating import AT, Event, Locator, apart, at_zero, lowest_between
from racs_bif.continuation.points import Point, SpecialPoint
from racs_bif.continuation.stopped import Stopped
from racs_bif.continuation.targets import ParameterTarget

if TYPE_CHECKING:
    from racs_bif.continuation.scaling import Scaling
    from racs_bif.continuation.segment import Segment
    from racs_bif.continuation.settings import StepSettings

_ZERO = 1e-13
_FADING = 0.1
_FLOOR = 1e-6
_MOST_UNEXPLAINED = 20
_REACH = 1e-3

Node = tuple[Point, SpecialPoint | None]
"""A point of the branch and, where it is an event, what is known about it."""


@dataclass(slots=True)
class _Pending:
    """A segment whose next point is not known yet."""

    a: Point
    b: Point
    before: list[float]
    after: list[float]
    scaling: Scaling
    earlier: tuple[float, list[float]] | None = field(default=None)


class Watch:
    """Collects the points of one walk and the events between them.

    A sign counts only where its test function is not zero but for rounding; a point where it is
    carries the sign before it, so that an event there is found once, with the next sign that
    differs, and a function that merely touches zero makes none. One step behind the walk, because
    the next value tells what is rounding and where the function may have dipped through zero
    between two points.

    Parameters
    ----------
    builder : Builder
        Knows the detectors.
    scaling : Scaling
        The norm.
    settings : StepSettings
        How closely to locate.
    notes : list of str
        Where it enters what it could not explain.
    start : Point
        The first point.

    Attributes
    ----------
    nodes : list of Node
        The branch so far.
    first : list of int
        The first certain sign of each test function, 0 while there is none.
    signs : list of int
        The last one.
    doubtful : list of bool
        Which are zero, but for rounding, at the start.
    divided : bool
        Whether the last segment had to be divided to explain its spectrum.
    unexplained : list of (float, float)
        Intervals of the parameter in which a change of the spectrum is not explained.
    """

    def __init__(
        self,
        builder: Builder,
        scaling: Scaling,
        settings: StepSettings,
        notes: list[str],
        start: Point,
    ) -> None:
        self._builder, self._problem = builder, builder.problem
        self._locator = Locator(builder, scaling, settings, notes)
        self._notes = notes
        self._checked = any(detector.crossings for detector in builder.detectors)
        self._values = builder.values(start)
        self._places = range(len(self._values))
        self._wanted = [
            place for place in self._places if isinstance(builder.detectors[place], ParameterTarget)
        ]
        self._sizes = [abs(value) for value in self._values]
        self._pending: _Pending | None = None
        self._arrived: list[Point] = []
        self._critical_end = False
        self.nodes: list[Node] = [(start, None)]
        self.first = [0] * len(self._values)
        self.signs = [0] * len(self._values)
        self.doubtful = [False] * len(self._values)
        self.divided = False
        self.unexplained: list[tuple[float, float]] = []

    def feed(self, a: Point, b: Point, scaling: Scaling) -> None:
        """Take in the step from a, the last point fed, to b, made in the norm `scaling`."""
        self.divided = False
        self._arrived.append(b)
        values = self._builder.values(b)
        last = self._pending
        if last is None:
            for place in self._places:
                self.signs[place] = self._sign(place, self._values[place], values[place])
            self.doubtful = [
                not math.isnan(self._values[place])
                and (sign == 0 or at_zero(self._values[place], values[place], b, a))
                for place, sign in enumerate(self.signs)
            ]
            self.signs = [
                0 if doubt else sign for doubt, sign in zip(self.doubtful, self.signs, strict=True)
            ]
            self.first = list(self.signs)
            earlier = None
        else:
            self._settle(last, (b.arclength, values))
            earlier = (last.a.arclength, last.before)
        self._pending = _Pending(a, b, self._values, values, scaling, earlier)
        self._values = values

    def finish(self, stopped: Stopped | None) -> None:
        """Settle the last segment; a test function that is zero at an end has its event there."""
        if self._pending is None:
            return
        last = self._pending
        ending = [] if stopped is Stopped.CLOSED else self._ending(last, stopped is Stopped.SPAN)
        ending = [place for place in ending if self.signs[place]]
        for place in ending:
            last.after[place] = math.nan
        self._critical_end = any(self._builder.detectors[place].crossings for place in ending)
        self._settle(last, None)
        self._pending = None
        for place in ending:
            self.mark(place, len(self.nodes) - 1)

    def _ending(self, last: _Pending, landed: bool) -> list[int]:  # noqa: FBT001 - one caller
        """Return which test functions are zero at the end; at that of the span but for rounding."""
        found = []
        for place in self._places:
            value, before = last.after[place], last.before[place]
            rounded = landed and (
                self._sign(place, value, math.nan) == 0 or at_zero(value, before, last.a, last.b)
            )
            if value == 0.0 or (rounded and not math.isnan(value)):
                found.append(place)
        return found

    def abandon(self) -> None:
        """Keep the points not yet looked at, without their events."""
        self.nodes.extend((point, None) for point in self._arrived)
        self._arrived, self._pending = [], None

    def mark(self, place: int, index: int) -> None:
        """Make a special point of a node at which a test function is zero."""
        point, special = self.nodes[index]
        found = self._locator.describe(place, point, 0.0, _REACH)
        if found is None:
            return
        if special is None:
            self.nodes[index] = (found.point, found.special)
        else:
            self.nodes.insert(index + 1, (found.point, found.special))

    def _sign(self, place: int, value: float, following: float) -> int:
        """Return the sign of a value, 0 where it is zero beside the values around it."""
        size = self._sizes[place]
        for other in (value, following):
            if abs(other) > size or math.isnan(size):
                size = abs(other)
        if math.isnan(value) or abs(value) <= _ZERO * size:
            return 0
        return 1 if value > 0.0 else -1

    def _settle(self, last: _Pending, following: tuple[float, list[float]] | None) -> None:
        """Look for events in a segment, now that the value after it is known, and append it."""
        before, after = list(last.before), list(last.after)
        self._locator.scaling = last.scaling
        for place in self._places:
            value, beyond = after[place], following[1][place] if following else math.nan
            size = max(_FADING * self._sizes[place], abs(value))
            same = before[place] * value > 0.0 and self.signs[place] * value > _ZERO * size
            if same and not abs(beyond) * _ZERO >= abs(value):
                # Nothing changes, as nearly everywhere.
                self._sizes[place] = size
            else:
                self._cross(place, before, after, beyond)
        nodes = self._search(last, before, after, following)
        self.nodes.extend(nodes)
        self.nodes.append((last.b, None))
        self._arrived.remove(last.b)

    def _cross(self, place: int, before: list[float], after: list[float], following: float) -> None:
        """Bring one sign up to the end of a segment; blank values whose change is no event."""
        value = after[place]
        old, new = self.signs[place], self._sign(place, value, following)
        if not math.isnan(value):
            size = self._sizes[place]
            self._sizes[place] = max(abs(value), 0.0 if math.isnan(size) else _FADING * size)
            new = new or old
        self.signs[place] = new
        self.first[place] = self.first[place] or new
        if old * new < 0:
            if before[place] * old > 0.0:
                return
            self.mark(place, len(self.nodes) - 1)
        elif before[place] * value > 0.0 and old:
            return
        before[place] = after[place] = math.nan

    def _search(
        self,
        last: _Pending,
        before: list[float],
        after: list[float],
        following: tuple[float, list[float]] | None,
    ) -> list[Node]:
        """Return the events within a segment, split first where a function dips through zero."""
        a, b = last.a, last.b
        nodes: list[Node] = []
        for middle in self._splits(last, (before, after), following):
            values = self._between(middle, before)
            nodes += self._resolve(a, middle, before, values)
            nodes.append((middle, None))
            a, before = middle, values
        return _once(nodes + self._resolve(a, b, before, after))

    def _splits(
        self,
        last: _Pending,
        values: tuple[list[float], list[float]],
        following: tuple[float, list[float]] | None,
    ) -> list[Point]:
        """Return points at which a segment must be split for each sign change to be seen."""
        a, b = last.a, last.b
        dips = []
        for place, before, after in zip(self._places, *values, strict=True):
            if before * after > 0.0:
                ends = ((a.arclength, before), (b.arclength, after))
                outer = [
                    (other[0], other[1][place]) for other in (last.earlier, following) if other
                ]
                guess = lowest_between(ends, outer)
                if guess is not None:
                    dips.append((place, guess))
        turned = self._wanted and a.tangent[-1] * b.tangent[-1] < 0.0
        if not (dips or turned):
            return []
        segment = self._locator.segment(a, b)
        found = [self._locator.dip(segment, place, guess) for place, guess in dips]
        if turned:
            found.append(self._turned(segment, *values))
        return [segment.known(at) for at in apart([at for at in found if at is not None])]

    def _turned(self, segment: Segment, before: list[float], after: list[float]) -> float | None:
        """Return where the parameter turns back, if that is beyond a value wanted."""
        at = self._locator.turn(segment)
        if at is None:
            return None
        try:
            at, point = segment.point(at)
        except FAILURES:
            return None
        for place in self._wanted:
            value = self._builder.value(place, point)
            if before[place] * after[place] > 0.0 and value * before[place] < 0.0:
                return at
        return None

    def _between(self, point: Point, before: list[float]) -> list[float]:
        """Return the values at a point put between two others, zero with the sign before it."""
        values = self._builder.values(point)
        return [
            value if value != 0.0 else math.copysign(AT, old)
            for value, old in zip(values, before, strict=True)
        ]

    def _resolve(
        self,
        a: Point,
        b: Point,
        before: list[float],
        after: list[float],
    ) -> list[Node]:
        """Return the events between two points, dividing until they explain the spectrum."""
        segment: Segment | None = None
        events: list[Event] = []
        for place in self._places:
            if before[place] < 0.0 < after[place] or after[place] < 0.0 < before[place]:
                segment = segment or self._locator.segment(a, b)
                event = self._locator.locate(segment, place, before[place], after[place])
                if event is not None:
                    events.append(event)
        events.sort(key=lambda event: event.at)
        nodes: list[Node] = [(event.point, event.special) for event in events]
        at_start = a.arclength == self.nodes[0][0].arclength
        unchecked = not self._checked or len(self.unexplained) >= _MOST_UNEXPLAINED
        unchecked = unchecked or self._critical_end
        if unchecked or (at_start and self._critical_start()):
            return nodes
        reason = unexplained(self._problem, a, b, [event.crossings for event in events])
        found = [(event.point, event.crossings) for event in events]
        if not (reason or hides_others(self._problem, a, b, found)):
            return nodes
        middle = self._middle(segment or self._locator.segment(a, b))
        if middle is not None:
            self.divided = True
            values = self._between(middle, before)
            left = self._resolve(a, middle, before, values)
            return [*left, (middle, None), *self._resolve(middle, b, values, after)]
        # At the start itself an eigenvalue may be on the axis, within the floor.
        if reason and not at_start:
            self.unexplained.append((a.parameter, b.parameter))
            self._notes.append(
                f"The spectrum's change between {self._problem.parameter} = {a.parameter:.10g} and "
                f"{b.parameter:.10g} is unexplained: {reason}."
            )
        return nodes

    def _middle(self, segment: Segment) -> Point | None:
        """Return a point that halves a segment, unless it is too short."""
        if segment.length <= _FLOOR:
            return None
        try:
            return segment.point(0.5)[1]
        except FAILURES:
            return None

    def _critical_start(self) -> bool:
        """Whether eigenvalues are on the axis at the start: it counts for neither side."""
        detectors = self._builder.detectors
        return any(self.doubtful[place] and detectors[place].crossings for place in self._places)


def _once(nodes: list[Node]) -> list[Node]:
    """Leave out points at which there is an event besides."""
    events = {point.arclength for point, event in nodes if event}
    return [node for node in nodes if node[1] or node[0].arclength not in events]
