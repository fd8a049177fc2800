"""One turn of an orbit from the tail of a time history: its period by the return map."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.errors import UsageError
from racs_bif.simulation.poincare import Section, poincare_section

if TYPE_CHECKING:
    from racs_bif.symbolic.field import Array

_TAIL: Final = 0.5
"""Share of the history, its end, that is looked at."""
_REST: Final = 1e-4
"""Range of the last tenth over that of all, below which the tail is at rest."""
_RETURN: Final = 0.05
"""Largest distance between a crossing and its return, relative to the range of the states."""
_ALIKE: Final = 3.0
"""A return counts that is at most so many times farther off than the nearest of all."""
_MOST: Final = 32
"""Most crossings of the section in one turn."""
_SAMPLES: Final = 2001


@dataclass(frozen=True, eq=False)
class Turn:
    """One turn.

    Attributes
    ----------
    times : array (m,)
        Over one turn, from 0.
    states : array (n, m)
        The states there.
    crossings : int
        How often it crosses the section upwards.
    mismatch : float
        Distance between its ends, relative to the range of each state.
    """

    times: Array
    states: Array
    crossings: int
    mismatch: float


def last_turn(times: Array, states: Array, names: tuple[str, ...]) -> Turn:
    """Return the last turn of a time history that has settled on an orbit.

    The section is where the state that oscillates most simply passes the middle of its range
    upwards; the turn is the smallest number of crossings after which the states return.

    Parameters
    ----------
    times : array (nt,)
        Rising times.
    states : array (nt, n)
        The states.
    names : tuple of str
        Their names, for messages.

    Raises
    ------
    UsageError
        If the tail is at rest or does not repeat itself.
    """
    from scipy.interpolate import CubicSpline

    tail = times >= times[-1] - _TAIL * (times[-1] - times[0])
    t, x = times[tail], states[tail]
    ranges = np.ptp(x, axis=0)
    last = x[-max(8, len(x) // 10) :]
    still = np.ptp(last, axis=0) <= _REST * np.ptp(states, axis=0) + 1e-12 * np.abs(x).max(axis=0)
    if still.all():
        raise UsageError("the history is at rest in the end: no orbit; start it somewhere else")
    section = _section(t, x, ranges, names)
    scales = np.maximum(ranges, 1e-4 * ranges.max())
    back = min(_MOST, len(section.points) - 1)
    away = np.abs(section.points[-1] - section.points[-1 - back : -1][::-1]) / scales
    mismatches = away.max(axis=1)
    nearest = float(mismatches.min())
    if nearest > _RETURN:
        raise UsageError(
            f"the history does not repeat itself: after {int(mismatches.argmin()) + 1} crossings "
            f"it comes back to within {100.0 * nearest:.2g} % of its range at best; integrate "
            "longer, or it is no orbit"
        )
    enough = max(_ALIKE * nearest, 1e-3)
    count = int(np.flatnonzero(mismatches <= min(enough, _RETURN))[0]) + 1
    begin, end = section.times[-1 - count], section.times[-1]
    at = np.linspace(begin, end, _SAMPLES)
    return Turn(
        times=at - begin,
        states=np.ascontiguousarray(CubicSpline(t, x, axis=0)(at).T),
        crossings=count,
        mismatch=float(mismatches[count - 1]),
    )


def _section(t: Array, x: Array, ranges: Array, names: tuple[str, ...]) -> Section:
    """Return the crossings of the state that has fewest of them, but at least two."""
    best: Section | None = None
    for k in np.flatnonzero(ranges > 0.0):
        level = 0.5 * float(x[:, k].max() + x[:, k].min())
        found = poincare_section(t, x, x[:, k], level=level)
        if len(found.times) > 1 and (best is None or len(found.times) < len(best.times)):
            best = found
    if best is None:
        raise UsageError(
            f"no state of {', '.join(names)} passes the middle of its range twice in the second "
            "half of the history: integrate longer"
        )
    return best
