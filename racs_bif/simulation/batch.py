"""Many independent simulations of the realised model at once.

Members differ in parameters, in their starts, or both. Each has its own steps, so that none waits
for another; one that grows without bound is marked and the others go on.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from racs_bif.errors import UsageError
from racs_bif.simulation.batch_field import BatchField
from racs_bif.simulation.march import Limits, march
from racs_bif.simulation.watchers import Sampler
from racs_bif.symbolic.compiled_path import assign, check_values

if TYPE_CHECKING:
    import xarray as xr

    from racs_bif.fractional.system import System
    from racs_bif.symbolic.field import Array

Reals = NDArray[np.float64]
_ROUGHER: Final = 10.0
_TOGETHER: Final = 1024
"""Members integrated side by side: more need more memory and are no faster."""


@dataclass(frozen=True, kw_only=True)
class BatchSettings:
    """How many simulations are made.

    Parameters
    ----------
    tolerance : float
        Relative error of a step.
    samples : int
        Number of times that are kept, equidistant from `after` to the end.
    after : float
        From when on states are kept [s].
    estimate : bool
        Estimate the errors, by simulating everything again with ten times the tolerance.
    most : int
        Steps after which a member is given up.

    Raises
    ------
    UsageError
        If a setting is out of its range.
    """

    tolerance: float = 1e-6
    samples: int = 1001
    after: float = 0.0
    estimate: bool = True
    most: int = 1_000_000

    def __post_init__(self) -> None:
        """Check the ranges."""
        if not 0.0 < self.tolerance <= 0.01:
            msg = f"the tolerance of a batch must be above 0 and at most 0.01, not {self.tolerance}"
            raise UsageError(msg)
        if self.samples < 2 or self.most < 1:
            msg = (
                f"a batch must keep at least 2 samples and make at least 1 step, "
                f"not {self.samples} and {self.most}"
            )
            raise UsageError(msg)
        if not 0.0 <= self.after < np.inf:
            msg = f"'after' of a batch must be a finite time from 0 on, not {self.after:g} s"
            raise UsageError(msg)


@dataclass(frozen=True, kw_only=True, eq=False)
class BatchHistory:
    """Time histories of N members.

    Parameters
    ----------
    times : array (m,)
        Equidistant [s].
    states : array (N, m, own)
        The model's own states, SI; NaN from when on a member failed.
    names : tuple of str
        Those states.
    values : dict of str to array (N,)
        The parameters in which members differ.
    failed : bool array (N,)
        Which members did not come to the end.
    stopped : tuple of str
        Why, for each member; empty where it did.
    reached : array (N,)
        How far each came [s].
    error : array (N,)
        Estimate of the largest error of any state, of its range; NaN where none was made.
    final : array (N, n)
        Where each ended, memory states included, in the order of ``system.field.states``.
    steps : int array (N,)
        How many steps each took.
    """

    times: Reals
    states: Reals
    names: tuple[str, ...]
    values: Mapping[str, Reals]
    failed: NDArray[np.bool_]
    stopped: tuple[str, ...]
    reached: Reals
    error: Reals
    final: Reals
    steps: NDArray[np.int64]

    def __len__(self) -> int:
        """Return the number of members."""
        return len(self.states)

    def __repr__(self) -> str:
        """Return one line."""
        return (
            f"<{len(self)} simulations of {', '.join(self.names)} to {self.times[-1]:g} s, "
            f"{int(self.failed.sum())} failed>"
        )

    def column(self, name: str) -> Reals:
        """Return a state (N, m) by name.

        Raises
        ------
        UsageError
            If there is no such state.
        """
        from racs_bif.errors import nearest

        if name not in self.names:
            msg = f"the batch has no '{name}'; {nearest(name, self.names)}"
            raise UsageError(msg)
        return self.states[:, :, self.names.index(name)]

    def to_xarray(self) -> xr.Dataset:
        """Return the states over ``member`` and ``time``; members' parameters are coordinates."""
        import xarray as xr

        data = {name: (("member", "time"), self.column(name)) for name in self.names}
        members = {name: ("member", values) for name, values in self.values.items()}
        return xr.Dataset(data, {"time": ("time", self.times, {"units": "s"}), **members})


def run_batch(
    system: System,
    *,
    values: Mapping[str, Array],
    starts: Array | None,
    duration: float,
    settings: BatchSettings | None = None,
    progress: Callable[[float], None] | None = None,
) -> BatchHistory:
    """Simulate the realised model for many parameter sets, starts, or both.

    Parameters
    ----------
    system : System
        The model; its own parameters hold but for `values`.
    values : mapping of str to array (N,)
        Parameters in which members differ, base or derived; empty where only starts do.
    starts : array (N, own) or (N, n), optional
        The model's own states at t = 0, the filters at rest as if these had been held for ever;
        or all states. Zero by default.
    duration : float
        For how long [s].
    settings : BatchSettings, optional
        Tolerance, samples.
    progress : callable, optional
        Called with the mean time reached now and then.

    Raises
    ------
    UsageError
        If arrays do not fit together, or the duration cannot be used.
    ParameterError
        If a parameter is unknown or a value outside the model's validity.
    """
    settings = settings or BatchSettings()
    if not settings.after < duration < np.inf:
        msg = (
            f"the duration is {duration:g} s; give a finite one above {settings.after:g} s, from "
            "when on samples are kept"
        )
        raise UsageError(msg)
    P = members(system, values, None if starts is None else len(starts))
    given = None if starts is None else np.asarray(starts, dtype=float)
    times = np.linspace(settings.after, duration, settings.samples)
    parts = []
    for k in range(0, P.shape[1], _TOGETHER):
        part = slice(k, k + _TOGETHER)
        beyond = k * duration / P.shape[1]
        share = min(_TOGETHER, P.shape[1] - k) / P.shape[1]

        def tell(t: float, beyond: float = beyond, share: float = share) -> None:
            if progress is not None:
                progress(beyond + share * t)

        field = BatchField(system, np.ascontiguousarray(P[:, part]))
        x = initial(field, None if given is None else given[part])
        parts.append(_run(field, x, times, settings, tell))
    return BatchHistory(
        times=times,
        names=system.states,
        values={name: np.array(v, dtype=float) for name, v in values.items()},
        states=np.concatenate([p.states for p in parts]),
        failed=np.concatenate([p.failed for p in parts]),
        stopped=tuple(text for p in parts for text in p.stopped),
        reached=np.concatenate([p.reached for p in parts]),
        error=np.concatenate([p.error for p in parts]),
        final=np.concatenate([p.final for p in parts]),
        steps=np.concatenate([p.steps for p in parts]),
    )


def members(system: System, values: Mapping[str, Array], count: int | None = None) -> Array:
    """Return base parameters (np, N) of members that differ in some parameters.

    Parameters
    ----------
    system : System
        The model; its own parameters hold but for `values`.
    values : mapping of str to array (N,)
        Base or derived parameters.
    count : int, optional
        N, where it is known already; 1 where nothing tells it.

    Raises
    ------
    UsageError
        If the arrays are not of one length.
    ParameterError
        If a parameter is unknown, or a value outside the model's validity.
    """
    columns = {name: np.atleast_1d(np.asarray(v, dtype=float)) for name, v in values.items()}
    lengths = {len(column) for column in columns.values() if column.ndim == 1}
    lengths |= set() if count is None else {count}
    if len(lengths) > 1 or any(column.ndim != 1 for column in columns.values()):
        told = ", ".join(f"{name} {column.shape}" for name, column in columns.items())
        msg = f"parameters and starts of a batch must be of one length N: {told or 'none'}, {count}"
        raise UsageError(msg)
    number = lengths.pop() if lengths else 1
    if number < 1:
        msg = "a batch needs at least one member, but its parameters or starts are empty"
        raise UsageError(msg)
    for name, column in columns.items():
        for value in (column.min(), column.max()):
            check_values(system.compiled, {name: float(value)})
    rows = np.repeat(system.values[:, None], number, axis=1)
    base = [p.name for p in system.compiled.parameters]
    if all(name in base for name in columns):
        for name, column in columns.items():
            rows[base.index(name)] = column
        return rows
    for k in range(number):
        wanted = {name: float(column[k]) for name, column in columns.items()}
        rows[:, k] = assign(system.compiled, system.values, wanted)
    return rows


def initial(field: BatchField, starts: Array | None) -> Array:
    """Return where members begin (n, N), from their own or all states (N, own) or (N, n)."""
    count = field.P.shape[1]
    if starts is None:
        return field.at_rest(np.zeros((field.ny, count)))
    if starts.ndim != 2 or starts.shape[1] not in {field.ny, field.size}:
        msg = (
            f"starts of a batch must have shape (N, {field.ny}), or (N, {field.size}) with memory "
            f"states, not {starts.shape}"
        )
        raise UsageError(msg)
    if starts.shape[1] == field.ny:
        return field.at_rest(np.ascontiguousarray(starts.T))
    return field.from_states(np.ascontiguousarray(starts.T))


@dataclass(frozen=True)
class _Part:
    states: Reals
    failed: NDArray[np.bool_]
    stopped: tuple[str, ...]
    reached: Reals
    error: Reals
    final: Reals
    steps: NDArray[np.int64]


def _run(
    field: BatchField,
    x: Array,
    times: Array,
    settings: BatchSettings,
    tell: Callable[[float], None],
) -> _Part:
    count, ny = x.shape[1], field.ny
    tolerance = np.full(count, settings.tolerance)
    twice = np.arange(count)
    if settings.estimate:
        # The rougher runs go along: side by side they cost little.
        twice = np.concatenate([twice, twice])
        tolerance = np.concatenate([tolerance, np.minimum(_ROUGHER * tolerance, 0.1)])
    sampler = Sampler(times, len(twice), ny)
    start = np.ascontiguousarray(x[:, twice])
    sampler.begin(start)
    done = march(
        field.take(twice) if settings.estimate else field,
        start,
        float(times[-1]),
        Limits(tolerance=tolerance, rows=ny, most=settings.most),
        watchers=(sampler,),
        progress=tell,
    )
    stopped = done.stopped[:count]
    error = np.full(count, np.nan)
    if settings.estimate:
        error = _difference(sampler.values[:count], sampler.values[count:])
    return _Part(
        states=sampler.values[:count].copy(),
        failed=np.array([bool(text) for text in stopped]),
        stopped=stopped,
        reached=done.times[:count],
        error=error,
        final=field.to_states(np.ascontiguousarray(done.x[:, :count])).T.copy(),
        steps=done.steps[:count],
    )


def _difference(fine: Array, rough: Array) -> Array:
    """Return the largest difference (N,) of any state of its range; NaN where neither came."""
    both = np.isfinite(fine) & np.isfinite(rough)
    off = np.where(both, np.abs(fine - rough), 0.0).max(axis=1)
    high = np.where(both, fine, -np.inf).max(axis=1)
    low = np.where(both, fine, np.inf).min(axis=1)
    with np.errstate(all="ignore"):
        share = np.where(high > low, off / (high - low), 0.0).max(axis=1, initial=0.0)
    return np.where(np.any(np.all(both, axis=2), axis=1), share, np.nan)
