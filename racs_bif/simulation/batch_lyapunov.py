"""The largest Lyapunov exponents of many members at once.

Each is integrated together with its exact linearisation for one direction, whose growth is added
up; see `racs_bif.simulation.lyapunov` for the source. Standard errors are those of batch means.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.simulation.attractors import FAILED, SETTLED, Attractors, limits_of
from racs_bif.simulation.march import march

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from racs_bif.simulation.batch_field import BatchField, BatchLinear
    from racs_bif.simulation.pieces import Piece
    from racs_bif.symbolic.field import Array

_BATCHES: Final = 16
_TRANSIENT: Final = 0.5
"""Share of the duration before growth is counted."""


class Tangents:
    """Members (x, v) with v' the linearisation at x; (2 n, M).

    Parameters
    ----------
    field : BatchField
        The equations of x.
    """

    def __init__(self, field: BatchField) -> None:
        self.field = field
        self.bend = field.compiled.kernel("core_xx").bind(field.padded)

    def take(self, which: NDArray[np.intp]) -> Tangents:
        """Return those of some members."""
        return Tangents(self.field.take(which))

    def gather(self, z: Array) -> Array:
        """Return what of both counts for the error."""
        n = self.field.size
        return np.concatenate([self.field.gather(z[:n]), self.field.gather(z[n:])])

    def rate(self, z: Array) -> Array:
        """Return (x', v')."""
        n = self.field.size
        return np.concatenate([self.field.rate(z[:n]), self.field.moved(z[:n], z[n:])])

    def linear(self, z: Array, shift: Array) -> TangentsLinear:
        """Return the linearisation of both."""
        n = self.field.size
        return TangentsLinear(self, z, self.field.linear(z[:n], shift))


class TangentsLinear:
    """Solves first for x, then for v, which depends on it.

    Parameters
    ----------
    tangents : Tangents
        The equations.
    z : array (2 n, M)
        Where.
    single : BatchLinear
        The linearisation of x' = f(x) there.
    """

    def __init__(self, tangents: Tangents, z: Array, single: BatchLinear) -> None:
        n = tangents.field.size
        self.tangents, self.single = tangents, single
        self.X, self.V = tangents.field.gather(z[:n]), tangents.field.gather(z[n:])

    def solve(self, right: Array) -> Array:
        """Return (kx, kv)."""
        field = self.tangents.field
        kx = self.single.solve(right[: field.size])
        bent = field.spread(self.tangents.bend(self.X, self.V, field.gather(kx)))
        return np.concatenate([kx, self.single.solve(right[field.size :] + bent)])


class _Growth:
    """Adds up logarithms of how much directions grew, and notes them in regular intervals."""

    def __init__(self, size: int, duration: float, count: int) -> None:
        self.size = size
        self.edges = np.linspace(_TRANSIENT * duration, duration, _BATCHES + 1)
        self.edges[-1] *= 1.0 - 1e-12
        self.total, self.before = np.zeros(count), np.zeros(count)
        self.sums = np.full((_BATCHES + 1, count), np.nan)
        self.begin, self.end = np.zeros(count), np.zeros(count)
        self._next = np.zeros(count, dtype=np.intp)

    def rescale(self, who: NDArray[np.intp], z: Array) -> None:
        """Give the directions unit length again."""
        v = z[self.size :]
        length = np.sqrt((v * v).sum(axis=0))
        good = np.isfinite(length) & (length > 0.0)
        v /= np.where(good, length, 1.0)
        self.before[who] = self.total[who]
        self.total[who] += np.log(np.where(good, length, 1.0))
        due = who
        while True:
            due = due[self._next[due] <= _BATCHES]
            due = due[self.edges[self._next[due]] <= self.end[due]]
            if not len(due):
                return
            # A step of one at rest may be longer than an interval.
            edge = self.edges[self._next[due]]
            share = (edge - self.begin[due]) / (self.end[due] - self.begin[due])
            grown = self.before[due] + share * (self.total[due] - self.before[due])
            self.sums[self._next[due], due] = grown
            self._next[due] += 1

    def watch(self, members: NDArray[np.intp], piece: Piece) -> None:
        """Note how far members came."""
        self.begin[members], self.end[members] = piece.t, piece.t + piece.h


def largest_exponents(
    field: BatchField,
    x: Array,
    duration: float,
    tolerance: float,
    *,
    progress: Callable[[float], None] | None = None,
) -> Attractors:
    """Return the largest Lyapunov exponents over the second half of simulations.

    Parameters
    ----------
    field : BatchField
        The equations.
    x : array (n, N)
        Where members begin.
    duration : float
        For how long [s].
    tolerance : float
        Relative error of a step.
    progress : callable, optional
        Called with the mean time reached now and then.

    Returns
    -------
    Attractors
        Exponents and their standard errors [1/s].
    """
    n, count = x.shape
    start = np.random.default_rng(0).normal(size=(n, 1))
    v = np.repeat(start / np.linalg.norm(start), count, axis=1)
    growth = _Growth(n, duration, count)
    done = march(
        Tangents(field),
        np.concatenate([x, v]),
        duration,
        limits_of(x[: field.ny], tolerance),
        watchers=(growth,),
        rescale=growth.rescale,
        progress=progress,
    )
    failed = np.array([bool(text) for text in done.stopped])
    lengths = np.diff(growth.edges).reshape(-1, 1)
    means: Array = np.diff(growth.sums, axis=0) / lengths
    value = means.mean(axis=0)
    error = means.std(axis=0, ddof=1) / np.sqrt(_BATCHES)
    known = ~failed & np.isfinite(value)
    return Attractors(
        np.where(known, value, np.nan),
        np.where(known, error, np.nan),
        np.where(known, SETTLED, FAILED).astype(np.int8),
        done.steps,
    )
