"""What is noted of many members while they are integrated."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from racs_bif.simulation.pieces import Piece
    from racs_bif.symbolic.field import Array

_HALVINGS: Final = 8


class Sampler:
    """States at given times.

    Parameters
    ----------
    times : array (m,)
        Rising [s].
    count, rows : int
        Number of members, and of their states that are kept.

    Attributes
    ----------
    values : array (N, m, rows)
        NaN where a member did not come.
    """

    def __init__(self, times: Array, count: int, rows: int) -> None:
        self.times = times
        self.values = np.full((count, len(times), rows), np.nan)
        self._next = np.zeros(count, dtype=np.intp)

    def begin(self, x: Array) -> None:
        """Take the states (n, N) at t = 0."""
        if self.times[0] == 0.0:
            self.values[:, 0] = x[: self.values.shape[2]].T
            self._next[:] = 1

    def watch(self, members: NDArray[np.intp], piece: Piece) -> None:
        """Note the states at the times within a step."""
        last = len(self.times) - 1
        end = piece.t + piece.h * (1.0 + 1e-14)
        place = np.arange(len(members))
        while len(place):
            at = self._next[members[place]]
            time = self.times[np.minimum(at, last)]
            due = (at <= last) & (time <= end[place])
            place, at, time = place[due], at[due], time[due]
            if not len(place):
                break
            now = piece.take(place)
            share = np.clip((time - now.t) / now.h, 0.0, 1.0)
            self.values[members[place], at] = now.at(share).T
            self._next[members[place]] += 1


class Extremes:
    """Least and greatest values of states in the quarters of a duration.

    Parameters
    ----------
    duration : float
        [s].
    count, rows : int
        Number of members, and of their states.

    Attributes
    ----------
    low, high : array (4, rows, N)
        Infinite where nothing was seen.
    """

    def __init__(self, duration: float, count: int, rows: int) -> None:
        self.duration = duration
        self.low = np.full((4, rows, count), np.inf)
        self.high = np.full((4, rows, count), -np.inf)

    def begin(self, x: Array) -> None:
        """Take the states (n, N) at t = 0."""
        self.low[0] = self.high[0] = x[: self.low.shape[1]]

    @property
    def half(self) -> Array:
        """Half the ranges (4, rows, N); not finite where nothing was seen."""
        with np.errstate(invalid="ignore"):
            return np.asarray(0.5 * (self.high - self.low))

    @property
    def middle(self) -> Array:
        """Middles of the ranges (4, rows, N)."""
        with np.errstate(invalid="ignore"):
            return np.asarray(0.5 * (self.high + self.low))

    def watch(self, members: NDArray[np.intp], piece: Piece) -> None:
        """See a step: its end, and where states turn within it."""
        quarter = np.minimum((4.0 * piece.t / self.duration).astype(int), 3)
        one = np.ones(len(members))
        end = piece.at(one)
        begin_slope, end_slope = piece.slope(0.0 * one), piece.slope(one)
        with np.errstate(all="ignore"):
            share = begin_slope / (begin_slope - end_slope)
            turns = (begin_slope * end_slope < 0.0) & np.isfinite(share)
        # Steps are short: where the slope is straight to it the value is right to fourth order.
        turned = np.where(turns, piece.at(np.where(turns, share, 1.0)), end)
        for values in (end, turned):
            seen_low, seen_high = self.low[quarter, :, members], self.high[quarter, :, members]
            self.low[quarter, :, members] = np.minimum(seen_low, values.T)
            self.high[quarter, :, members] = np.maximum(seen_high, values.T)


class Section:
    """Upward crossings of a level by one state, in the second half of a duration.

    Parameters
    ----------
    extremes : Extremes
        Watches too, before this; the level is the middle of the range in the second quarter.
    row : int
        The state.
    most : int
        Crossings that are kept of a member, the last ones.

    Attributes
    ----------
    points : array (N, most, rows)
        States there, in a ring.
    seen : int array (N,)
        How many crossings there were.
    """

    def __init__(self, extremes: Extremes, row: int, most: int) -> None:
        _, rows, count = extremes.low.shape
        self.extremes, self.row, self.most = extremes, row, most
        self.points = np.full((count, most, rows), np.nan)
        self.seen = np.zeros(count, dtype=np.intp)

    def watch(self, members: NDArray[np.intp], piece: Piece) -> None:
        """Note where the level is crossed."""
        late = piece.t >= 0.5 * self.extremes.duration
        level = self.extremes.middle[1, self.row, members]
        begin = piece.coefficients[0, self.row] - level
        end = piece.row(self.row).at(np.ones(len(members)))[0] - level
        crossed = np.flatnonzero(late & (begin < 0.0) & (end >= 0.0))
        if not len(crossed):
            return
        part = piece.take(crossed)
        share = begin[crossed] / (begin[crossed] - end[crossed])
        low, high = np.zeros(len(crossed)), np.ones(len(crossed))
        for _ in range(_HALVINGS):
            value = part.row(self.row).at(share)[0] - level[crossed]
            low, high = np.where(value < 0.0, share, low), np.where(value < 0.0, high, share)
            with np.errstate(all="ignore"):
                share = share - value / part.row(self.row).slope(share)[0]
            share = np.where((share > low) & (share < high), share, 0.5 * (low + high))
        who = members[crossed]
        self.points[who, self.seen[who] % self.most] = part.at(share).T
        self.seen[who] += 1

    def last(self, member: int) -> Array:
        """Return the points (k, rows) of a member that were kept, in order."""
        seen = int(self.seen[member])
        if seen <= self.most:
            return self.points[member, :seen]
        return np.roll(self.points[member], -(seen % self.most), axis=0)
