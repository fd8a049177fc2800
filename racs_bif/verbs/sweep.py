"""A brute-force sweep: where simulations at many values of a parameter end, as textbooks draw it.

It finds only what attracts its own starts, and knows no boundary; it is drawn under the branches.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.errors import UsageError
from racs_bif.numerics.threads import single_threaded
from racs_bif.results.provenance import SystemInfo, describe
from racs_bif.shelf.load import system_of
from racs_bif.simulation.batch import BatchSettings
from racs_bif.verbs.simulate_batch import simulate_batch

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from racs_bif.fractional.system import System
    from racs_bif.symbolic.field import Array
    from racs_bif.symbolic.model import Model

_RATE: Final = 50.0
"""Samples a second; between them extremes are those of parabolas."""
_OSCILLATES: Final = 0.02
"""Share of the sweep's largest range below which a member counts as at rest, or creeping."""
_DYING: Final = 0.9


@dataclass(frozen=True, kw_only=True, eq=False)
class Sweep:
    """What simulations at N values of a parameter did at their end.

    Parameters
    ----------
    parameter : str
        What was swept.
    values : array (N,)
        Its values, SI.
    quantity : str
        The state that was watched.
    low, high : array (N,)
        Its least and greatest values over the stretch that was kept; NaN where a member failed.
    turns : tuple of array
        Its local extremes there, or its last value where it has none.
    ways : tuple of str
        What each did: ``rest`` (or creeping, its range below a fiftieth of the largest of all),
        ``oscillating``, or ``dying`` out, its range in the second half of the stretch smaller by a
        tenth or more than in the first.
    duration, kept : float
        How long was simulated, and the length of the stretch at the end that was kept [s].
    system : SystemInfo
        What was simulated.
    """

    parameter: str
    values: Array
    quantity: str
    low: Array
    high: Array
    turns: tuple[Array, ...]
    ways: tuple[str, ...]
    duration: float
    kept: float
    system: SystemInfo

    def __len__(self) -> int:
        """Return the number of simulations."""
        return len(self.values)

    @property
    def amplitude(self) -> Array:
        """Half the range (N,)."""
        return np.asarray(0.5 * (self.high - self.low))

    @property
    def stretches(self) -> list[tuple[float, float, str]]:
        """First and last value of each run of members that did the same, and what."""
        edges = [k for k in range(1, len(self)) if self.ways[k] != self.ways[k - 1]]
        return [
            (float(self.values[a]), float(self.values[b - 1]), self.ways[a])
            for a, b in pairwise([0, *edges, len(self)])
        ]


@single_threaded
def sweep(
    model: Model | System,
    parameter: str,
    values: Sequence[float] | Array,
    *,
    quantity: str | None = None,
    initial: Mapping[str, float] | None = None,
    duration: float = 60.0,
    kept: float = 20.0,
    progress: Callable[[float], None] | None = None,
) -> Sweep:
    """Simulate a realised model at many values of a parameter, each from the same start.

    Parameters
    ----------
    model : Model or System
        What is simulated.
    parameter : str
        What is swept, base or derived.
    values : array (N,)
        Its values, SI.
    quantity : str, optional
        The state that is watched; what the model suggests where left out.
    initial : mapping of str to float, optional
        States at t = 0, SI; those left out are zero.
    duration, kept : float
        How long is simulated, and the stretch at the end that is looked at [s].
    progress : callable, optional
        Told the share that is done.

    Returns
    -------
    Sweep

    Raises
    ------
    UsageError
        If the quantity is no state, or the stretch is longer than the duration.
    ParameterError
        If the parameter is unknown or a value outside the model's validity.
    """
    system = system_of(model)
    watched = quantity or describe(system).shown
    if watched not in system.states or not 0.0 < kept <= duration:
        msg = (
            f"a sweep must watch a state ({', '.join(system.states)}), over a stretch no longer "
            f"than its duration; not '{watched}' over {kept:g} of {duration:g} s"
        )
        raise UsageError(msg)
    settings = BatchSettings(
        tolerance=1e-5,
        samples=max(16, round(_RATE * kept)) + 1,
        after=duration - kept,
        estimate=False,
    )
    done = simulate_batch(
        system,
        duration,
        values={parameter: np.asarray(values, dtype=float)},
        initial={name: float(value) for name, value in (initial or {}).items()},
        settings=settings,
        progress=None if progress is None else lambda t: progress(t / duration),
    )
    columns = np.asarray(done.column(watched))
    turns = tuple(turning_points(column) for column in columns)
    low = np.array([t.min() if len(t) else np.nan for t in turns])
    high = np.array([t.max() if len(t) else np.nan for t in turns])
    low, high = np.fmin(low, columns.min(axis=1)), np.fmax(high, columns.max(axis=1))
    going = high - low > _OSCILLATES * np.nanmax(high - low, initial=0.0)
    going &= np.array([len(t) > 2 for t in turns])
    first, second = (np.ptp(half, axis=1) for half in np.array_split(columns, 2, axis=1))
    dying = second < _DYING * first
    return Sweep(
        parameter=parameter,
        values=np.asarray(values, dtype=float),
        quantity=watched,
        low=low,
        high=high,
        turns=turns,
        ways=tuple(
            ("dying" if d else "oscillating") if g else "rest"
            for g, d in zip(going, dying, strict=True)
        ),
        duration=float(duration),
        kept=float(kept),
        system=describe(system),
    )


def turning_points(samples: Array) -> Array:
    """Return the local extremes of equidistant samples, by parabolas; the last where there is none.

    Parameters
    ----------
    samples : array (m,)
        At least three; where one is not a number there are no extremes.

    Examples
    --------
    >>> print(turning_points(np.sin(np.linspace(0.0, 6.0, 601))).round(6))
    [ 1. -1.]
    """
    if not np.all(np.isfinite(samples)):
        return np.empty(0)
    left, middle, right = samples[:-2], samples[1:-1], samples[2:]
    rise, fall = middle - left, middle - right
    at = rise * fall > 0.0
    bend, slope = (rise + fall)[at], (fall - rise)[at]
    peaks = middle[at] + 0.125 * slope**2 / bend
    return np.asarray(peaks if len(peaks) else samples[-1:])
