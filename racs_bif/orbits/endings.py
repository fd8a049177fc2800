"""Where a branch of orbits ends of itself: closed, on a known branch, or towards a connection."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.continuation.stopped import Stopped
from racs_bif.errors import ConvergenceError
from racs_bif.orbits.connections import Connection, connection
from racs_bif.orbits.polishing import polished
from racs_bif.orbits.same_orbit import SAME, Loop, distance, loop_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from racs_bif.continuation.points import Point
    from racs_bif.orbits.problem import OrbitProblem
    from racs_bif.symbolic.field import Array

_FIRST_CLOSABLE: Final = 4
"""Steps that a closed branch has at least."""
_BESIDE: Final = 0.5
"""How far from a chord, in units of it, an orbit may be and still lie between its ends."""
_BEYOND: Final = 0.2
_ROUNDS: Final = 6
_IN_A_ROW: Final = 2
"""Orbits of a known branch met one after another: one alone may be where branches cross."""
_CLOSE: Final = 1e-6
"""Motion of the parameter still to come, over its span, at which a connection is reached."""
_SETTLED: Final = 1e-8
"""Uncertainty of the parameter of one orbit, over the span; that of a connection when the walk to
it ends is no more than twice this."""
_FAILURES: Final = (ConvergenceError, np.linalg.LinAlgError)


@dataclass(frozen=True, eq=False)
class Track:
    """A branch of orbits that is known already.

    Attributes
    ----------
    name : str
        What messages call it.
    problem : OrbitProblem
        The problem.
    points : sequence of Point
        Its orbits in order.
    """

    name: str
    problem: OrbitProblem
    points: Sequence[Point]


@dataclass
class Walk:
    """One direction of a branch.

    Attributes
    ----------
    points : list of Point
        The orbits so far, from the start on.
    met : str
        The known branch that it ran onto.
    closing : float
        Arclength at which it closed.
    connection : Connection or None
        What it tends to.
    """

    points: list[Point]
    met: str = ""
    closing: float = np.nan
    connection: Connection | None = None
    in_a_row: dict[int, int] = field(default_factory=dict)
    first: Loop | None = None


@dataclass
class Endings:
    """Watches the steps of a branch of orbits; given to `trace` as its `until`.

    Orbits are compared as functions of time, wherever they begin: parameter and period alone do not
    tell two of them apart.

    Attributes
    ----------
    problem : OrbitProblem
        The problem.
    names : tuple of str
        The model's own states.
    width : float
        Width of the parameter's span.
    known : tuple of Track
        Branches that it may run onto.
    walks : list of Walk
        The directions in which it was walked.
    """

    problem: OrbitProblem
    names: tuple[str, ...]
    width: float
    known: tuple[Track, ...] = ()
    walks: list[Walk] = field(default_factory=list)

    def __call__(self, before: Point, point: Point) -> Stopped | None:
        """Return why the branch ends with this step, or None."""
        if before.arclength == 0.0 or not self.walks:
            self.walks.append(Walk([before]))
        walk = self.walks[-1]
        walk.points.append(point)
        if self.problem.degenerate(point.z):
            return None
        if self._closes(walk, before, point):
            return Stopped.CLOSED
        if self._is_known(walk, point):
            return Stopped.KNOWN
        return self._connects(walk)

    def walk_to(self, point: Point) -> Walk | None:
        """Return the walk that ended at a point; None where that did not get anywhere."""
        for walk in self.walks:
            if np.array_equal(walk.points[-1].z, point.z):
                return walk
        return None

    # ------------------------------------------------------------------------------- closed

    def _closes(self, walk: Walk, before: Point, point: Point) -> bool:
        """Say whether the first orbit lies between two others, and note where."""
        start = walk.points[0]
        if len(walk.points) <= _FIRST_CLOSABLE or self.problem.degenerate(start.z):
            return False
        share = self._between(before, point, start)
        if share is None:
            return False
        if walk.first is None:
            walk.first = loop_of(self.problem, start.z, len(self.names))
        try:
            share, z = self._solved(before, point, start, share)
        except _FAILURES:
            return False
        loop = loop_of(self.problem, z, len(self.names))
        if not (0.0 <= share <= 1.0 and distance(walk.first, loop) < SAME):
            return False
        walk.closing = before.arclength + share * (point.arclength - before.arclength)
        return True

    def _solved(self, a: Point, b: Point, wanted: Point, share: float) -> tuple[float, Array]:
        """Return the orbit between two others at which the parameter is that of a third.

        Near a fold of the parameter the period takes its place.
        """
        chord = b.z - a.z
        chord[-2] = 0.0
        steep = abs(chord[-1]) / self.width > abs(chord[-3]) / abs(b.z[-3])
        place = -1 if steep else -3
        z = a.z
        for _ in range(_ROUNDS):
            z = polished(self.problem, a.z + share * chord, chord)
            miss = float(wanted.z[place] - z[place])
            if abs(miss) < 1e-9 * abs(float(chord[place])) or chord[place] == 0.0:
                break
            share += miss / float(chord[place])
        return share, z

    # -------------------------------------------------------------------------------- known

    def _is_known(self, walk: Walk, point: Point) -> bool:
        """Say whether the last orbits are all those of one known branch, and note which."""
        for place, track in enumerate(self.known):
            count = walk.in_a_row.get(place, 0) + 1 if self._is_on(track, point) else 0
            walk.in_a_row[place] = count
            if count >= _IN_A_ROW:
                walk.met = track.name
                return True
        return False

    def _is_on(self, track: Track, point: Point) -> bool:
        wanted = loop_of(self.problem, point.z, len(self.names))
        for before, after in zip(track.points[:-1], track.points[1:], strict=True):
            share = self._between(before, after, point)
            if share is None or track.problem.degenerate(after.z):
                continue
            there = _at_parameter(track.problem, after, point.parameter)
            if there is not None:
                loop = loop_of(track.problem, there, len(self.names))
                if distance(wanted, loop) < SAME:
                    return True
        return False

    def _between(self, a: Point, b: Point, wanted: Point) -> float | None:
        """Return the share of the chord from a to b at which a third orbit is nearest; or None.

        By parameter, period and extremes: a rough test that costs nothing.
        """
        first, last, third = (self._numbers(point, b) for point in (a, b, wanted))
        chord = last - first
        length = float(chord @ chord)
        if length == 0.0:
            return None
        share = float(chord @ (third - first)) / length
        if not -_BEYOND <= share <= 1.0 + _BEYOND:
            return None
        beside = third - first - share * chord
        return share if float(beside @ beside) < _BESIDE**2 * length else None

    def _numbers(self, point: Point, scale: Point) -> Array:
        measures, sizes = point.measures, scale.measures
        numbers = [point.parameter / self.width, np.log(abs(measures["period"]) + 1e-300)]
        for name in self.names:
            high, low = sizes[f"max {name}"], sizes[f"min {name}"]
            range_ = max(high - low, 1e-6 * max(abs(high), abs(low)), 1e-300)
            numbers += [measures[f"max {name}"] / range_, measures[f"min {name}"] / range_]
        return np.array(numbers)

    # --------------------------------------------------------------------------- connection

    def _connects(self, walk: Walk) -> Stopped | None:
        """Say whether the parameter has come to rest at that of a connection."""
        found = walk.connection = self.tends_to(walk)
        if found is None:
            return None
        left = abs(found.limit - walk.points[-1].parameter)
        there = left < _CLOSE * self.width and found.error < 2.0 * _SETTLED * self.width
        return Stopped.CONNECTION if there else None

    def tends_to(self, walk: Walk) -> Connection | None:
        """Return the connection that the last orbits tend to, None where there is none."""
        proper = [point for point in walk.points if len(point.spectrum)]
        accuracy = _SETTLED * self.width
        return connection(self.problem, proper, len(self.names), accuracy)


def _at_parameter(problem: OrbitProblem, near: Point, value: float) -> Array | None:
    """Return the orbit of a branch at a value of the parameter, from one near it; or None."""
    speed = float(near.tangent[-1])
    if speed == 0.0:
        return None
    held = np.zeros(len(near.z))
    held[-1] = 1.0
    z = near.z + (value - near.parameter) / speed * near.tangent
    z[-2], z[-1] = near.z[-2], value
    try:
        return polished(problem, z, held)
    except _FAILURES:
        return None
