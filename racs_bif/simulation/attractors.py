"""What many simulations settle on: amplitudes, and how often an orbit crosses a section."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.simulation.march import Limits, march
from racs_bif.simulation.watchers import Extremes, Section

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from racs_bif.simulation.batch_field import BatchField
    from racs_bif.symbolic.field import Array

SETTLED, UNSETTLED, FAILED, NOWHERE = range(4)
"""The number is certain; not yet constant at the end; given up; there is nowhere to start from."""
MOST_PERIODS: Final = 12
"""Orbits that do not repeat within so many crossings count as having many."""
_CHANGE: Final = 0.02
_REST: Final = 1e-3
_NOISE: Final = 10.0
_REPEATS: Final = 0.01
_KEPT: Final = 128
_MOST: Final = 60_000
_FAR: Final = 1e7


def limits_of(y: Array, tolerance: float) -> Limits:
    """Return limits for simulations whose own states begin at y (ny, N)."""
    far = _FAR * (1.0 + float(np.abs(y).max(initial=0.0, where=np.isfinite(y))))
    return Limits(tolerance=tolerance, rows=len(y), most=_MOST, bound=far)


@dataclass(frozen=True)
class Attractors:
    """What N members settled on.

    Parameters
    ----------
    value : array (N,)
        The amplitude, or the number of crossings in which the orbit repeats: 0 at rest, infinite
        where it does not repeat. NaN where it is not certain.
    error : array (N,)
        Of an amplitude how much it changed over the last quarter, or what is left of it at rest; of
        a number how far the crossings are from repeating, of the range.
    status : int array (N,)
        `SETTLED`, `UNSETTLED` or `FAILED`.
    steps : int array (N,)
        Steps that were made.
    """

    value: Array
    error: Array
    status: NDArray[np.int8]
    steps: NDArray[np.int64]


def amplitudes(
    field: BatchField,
    x: Array,
    duration: float,
    row: int,
    tolerance: float,
    *,
    progress: Callable[[float], None] | None = None,
) -> Attractors:
    """Return half the ranges of a state in the last quarter of simulations.

    Parameters
    ----------
    field : BatchField
        The equations.
    x : array (n, N)
        Where members begin.
    duration : float
        For how long [s].
    row : int
        Which of the model's states.
    tolerance : float
        Relative error of a step.
    progress : callable, optional
        Called with the mean time reached now and then.
    """
    seen = _simulate(field, x, duration, tolerance, None, progress)
    half, status = seen.extremes.half[:, row], seen.status
    settled = status == SETTLED
    value = np.where(seen.rests, 0.0, half[3])
    with np.errstate(invalid="ignore"):
        error = np.where(seen.rests, half[3], np.abs(half[3] - half[2]))
    return Attractors(
        np.where(settled, value, np.nan), np.where(settled, error, np.nan), status, seen.steps
    )


def periods(
    field: BatchField,
    x: Array,
    duration: float,
    row: int,
    tolerance: float,
    *,
    progress: Callable[[float], None] | None = None,
) -> Attractors:
    """Return in how many crossings of a section orbits repeat, from the second half of simulations.

    The section is where a state rises through the middle of its range.

    Parameters
    ----------
    field, x, duration, row, tolerance, progress
        As `amplitudes`.
    """
    seen = _simulate(field, x, duration, tolerance, row, progress)
    assert seen.section is not None  # a row was given
    count = x.shape[1]
    value, error = np.full(count, np.nan), np.full(count, np.nan)
    status = np.where(seen.status == FAILED, FAILED, UNSETTLED).astype(np.int8)
    scale = np.maximum(seen.extremes.half[2], seen.extremes.half[3])
    for k in np.flatnonzero(seen.status != FAILED):
        if seen.rests[k]:
            value[k], error[k], status[k] = 0.0, 0.0, SETTLED
            continue
        found = _repeats(seen.section.last(int(k)), 2.0 * scale[:, k])
        if found is not None:
            (value[k], error[k]), status[k] = found, SETTLED
    return Attractors(value, error, status, seen.steps)


def _repeats(points: Array, scale: Array) -> tuple[float, float] | None:
    """Return in how many points they repeat, and how closely; None where there are too few."""
    late = points[len(points) // 2 :]
    relative = late / np.where(scale > 0.0, scale, 1.0)
    apart = np.inf
    for p in range(1, MOST_PERIODS + 1):
        if len(late) < p + 2:
            return None
        off = float(np.abs(relative[p:] - relative[:-p]).max())
        if off <= _REPEATS:
            return float(p), off
        apart = min(apart, off)
    return np.inf, apart


@dataclass(frozen=True)
class _Seen:
    extremes: Extremes
    section: Section | None
    status: NDArray[np.int8]
    rests: NDArray[np.bool_]
    steps: NDArray[np.int64]


def _simulate(
    field: BatchField,
    x: Array,
    duration: float,
    tolerance: float,
    row: int | None,
    progress: Callable[[float], None] | None,
) -> _Seen:
    count = x.shape[1]
    extremes = Extremes(duration, count, field.ny)
    extremes.begin(x)
    section = None if row is None else Section(extremes, row, _KEPT)
    done = march(
        field,
        x,
        duration,
        limits_of(x[: field.ny], tolerance),
        watchers=(extremes,) if section is None else (extremes, section),
        progress=progress,
    )
    half = extremes.half
    with np.errstate(all="ignore"):
        # Down to what is left of it by the errors of the steps it need not fall further.
        falls = half[3] <= np.maximum(half[2], _NOISE * tolerance * half[0])
        rests = np.all((half[3] <= _REST * half[0]) & falls, axis=0)
        constant = np.all(np.abs(half[3] - half[2]) <= _CHANGE * half[3], axis=0)
    failed = np.array([bool(text) for text in done.stopped])
    status = np.where(rests | constant, SETTLED, UNSETTLED)
    return _Seen(
        extremes,
        section,
        np.where(failed, FAILED, status).astype(np.int8),
        rests & ~failed,
        done.steps,
    )
