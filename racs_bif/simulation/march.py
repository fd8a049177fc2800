"""Many members integrated side by side, each at its own pace."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Protocol, Self

import numpy as np

from racs_bif.simulation.pieces import Piece
from racs_bif.simulation.rosenbrock import ORDER, Equations, step

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from racs_bif.symbolic.field import Array

_SAFETY, _SLOWEST, _FASTEST = 0.9, 0.2, 4.0
_NOW, _BEFORE = 0.7 / ORDER, 0.4 / ORDER
"""Exponents of the errors of this step and the last one (K. Gustafsson, ACM TOMS 17 (1991))."""
_STUCK: Final = 1e-13
_SMALL: Final = 1e-3  # states smaller than this, SI, are held to an absolute tolerance
_REPORT: Final = 50
UNDEFINED: Final = "The equations are not finite where it starts."
GONE: Final = "It grows without bound, or leaves where the equations are defined."
TIRED: Final = "It needs more steps than allowed; raise 'most', or the tolerance."


class Members(Equations, Protocol):
    """Equations of members, some of which can be picked."""

    def take(self, which: NDArray[np.intp]) -> Self:
        """Return the equations of some members."""

    def gather(self, x: Array) -> Array:
        """Return what of x or of its error counts, (k, M)."""


class Watcher(Protocol):
    """What looks on."""

    def watch(self, members: NDArray[np.intp], piece: Piece) -> None:
        """See a step of some members."""


@dataclass(frozen=True)
class Marched:
    """How N members ended.

    Parameters
    ----------
    x : array (n, N)
        Where they are.
    times : array (N,)
        How far they came [s].
    stopped : tuple of str
        Why they did not come to the end; empty where they did.
    steps : int array (N,)
        How many steps each made.
    """

    x: Array
    times: Array
    stopped: tuple[str, ...]
    steps: NDArray[np.int64]


@dataclass(frozen=True, kw_only=True)
class Limits:
    """How accurate steps are, and when a member is given up.

    Parameters
    ----------
    tolerance : array (N,) or float
        Relative error of a step.
    rows : int
        How many of the first states watchers see, and `bound` holds for.
    most : int
        Steps that a member may try.
    bound : float
        Magnitude of a state from which on it counts as growing without bound.
    """

    tolerance: Array | float
    rows: int = 0
    most: int = 1_000_000
    bound: float = np.inf


def march(
    members: Members,
    x: Array,
    duration: float,
    limits: Limits,
    *,
    watchers: tuple[Watcher, ...] = (),
    rescale: Callable[[NDArray[np.intp], Array], None] | None = None,
    progress: Callable[[float], None] | None = None,
) -> Marched:
    """Integrate all members from t = 0.

    Parameters
    ----------
    members : Members
        Their equations.
    x : array (n, N)
        Where they begin.
    duration : float
        For how long [s].
    limits : Limits
        Accuracy, and when members are given up.
    watchers : tuple of Watcher
        Told of every step.
    rescale : callable, optional
        Told of members and x (n, M) after each step; may change it.
    progress : callable, optional
        Called with the mean time reached now and then.
    """
    count = x.shape[1]
    done = Marched(x.copy(), np.zeros(count), tuple([""] * count), np.zeros(count, dtype=np.int64))
    run = _Run(members, x, duration, limits)
    why = [""] * count
    rounds = 0
    while len(run.who):
        run.attempt(watchers)
        if rescale is not None:
            rescale(run.who, run.x)
        ended = run.ended()
        if ended.any():
            out = run.who[ended]
            done.x[:, out], done.times[out] = run.x[:, ended], run.t[ended]
            done.steps[out] = run.steps[ended]
            for k, reason in zip(out, run.reasons[ended], strict=True):
                why[k] = str(reason)
            run.keep(np.flatnonzero(~ended))
        rounds += 1
        if progress is not None and rounds % _REPORT == 0:
            over = float(done.times.sum() + run.t.sum())
            progress(over / count)
    return Marched(done.x, done.times, tuple(why), done.steps)


class _Run:
    """Members under way."""

    def __init__(self, members: Members, x: Array, duration: float, limits: Limits) -> None:
        self.members, self.duration, self.limits = members, duration, limits
        count = x.shape[1]
        self.who = np.arange(count)
        self.x = np.array(x, dtype=float)
        self.tolerance = np.broadcast_to(limits.tolerance, (count,)).copy()
        self.t, self.steps = np.zeros(count), np.zeros(count, dtype=np.int64)
        self.last = np.full(count, 1e-4)
        self.tries = np.zeros(count, dtype=np.int64)
        self.reasons = np.full(count, "", dtype=object)
        with np.errstate(all="ignore"):
            rate = members.rate(self.x)
            finite = np.isfinite(self.x).all(axis=0) & np.isfinite(rate).all(axis=0)
            self.h = self._first(rate)
        self.reasons[~finite] = UNDEFINED

    def _scale(self, values: Array) -> Array:
        return np.asarray(self.tolerance * (_SMALL + np.abs(values)))

    def _first(self, rate: Array) -> Array:
        """Return careful first steps (E. Hairer, S. P. Norsett, G. Wanner, II.4)."""
        scale = self._scale(self.members.gather(self.x))
        size = _norm(self.members.gather(self.x) / scale)
        speed = _norm(self.members.gather(rate) / scale)
        h = 0.01 * np.maximum(size, 1e-3 / self.tolerance) / np.maximum(speed, 1e-300)
        return np.asarray(np.clip(h, 1e-9 * self.duration, 0.01 * self.duration))

    def attempt(self, watchers: tuple[Watcher, ...]) -> None:
        """Try a step of every member, and keep those that are accurate enough."""
        left = self.duration - self.t
        h = np.minimum(self.h, left)
        # No sliver is left over for the last step.
        h = np.where((left > h) & (left < 2.0 * h), 0.5 * left, h)
        with np.errstate(all="ignore"):
            tried = step(self.members, self.x, h)
            before, after = self.members.gather(self.x), self.members.gather(tried.x)
            size = np.maximum(np.abs(before), np.abs(after))
            error = _norm(self.members.gather(tried.error) / self._scale(size))
            error = np.where(np.isfinite(error), np.maximum(error, 1e-10), 1e10)
            good = error <= 1.0
            factor = _SAFETY * error**-_NOW * np.where(good, self.last, 1.0) ** _BEFORE
            factor = np.where(good, factor, np.minimum(_SAFETY * error ** (-1.0 / ORDER), 0.9))
        self.h = h * np.clip(factor, _SLOWEST, _FASTEST)
        self.last = np.where(good, np.maximum(error, 1e-4), self.last)
        self.tries += 1
        if watchers and good.any():
            piece = Piece.of(self.t, h, self.x, tried, self.limits.rows)
            every = good.all()
            for watcher in watchers:
                watcher.watch(
                    self.who if every else self.who[good], piece if every else piece.take(good)
                )
        self.x = np.where(good, tried.x, self.x)
        self.t = np.where(good, self.t + h, self.t)
        self.steps += good

    def ended(self) -> NDArray[np.bool_]:
        """Return which members are done or cannot go on, and note why."""
        over = self.t >= self.duration * (1.0 - 1e-14)
        stuck = ~over & ~(self.h > _STUCK * self.duration) & (self.reasons == "")
        with np.errstate(invalid="ignore"):
            far = np.any(np.abs(self.x[: self.limits.rows]) > self.limits.bound, axis=0)
        self.reasons[stuck | (far & ~over)] = GONE
        tired = ~over & (self.tries >= self.limits.most) & (self.reasons == "")
        self.reasons[tired] = TIRED
        return np.asarray(over | (self.reasons != ""))

    def keep(self, which: NDArray[np.intp]) -> None:
        """Go on with some members only."""
        self.members = self.members.take(which)
        self.x = np.ascontiguousarray(self.x[:, which])
        for name in ("who", "tolerance", "t", "steps", "last", "tries", "reasons", "h"):
            setattr(self, name, getattr(self, name)[which])


def _norm(values: Array) -> Array:
    """Return root mean squares (M,)."""
    return np.asarray(np.sqrt(np.mean(values * values, axis=0)))
