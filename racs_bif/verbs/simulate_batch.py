"""Many time histories of the realised model at once."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import UsageError, nearest
from racs_bif.numerics.threads import single_threaded
from racs_bif.shelf.load import system_of
from racs_bif.simulation.batch import BatchHistory, BatchSettings, run_batch

if TYPE_CHECKING:
    from racs_bif.fractional.system import System
    from racs_bif.symbolic.field import Array
    from racs_bif.symbolic.model import Model

    Numbers = float | Sequence[float] | Array


@single_threaded
def simulate_batch(
    model: Model | System,
    duration: float,
    *,
    values: Mapping[str, Numbers] | None = None,
    initial: Mapping[str, Numbers] | None = None,
    settings: BatchSettings | None = None,
    progress: Callable[[float], None] | None = None,
) -> BatchHistory:
    """Simulate a realised model for many parameter sets, many starts, or both.

    Parameters
    ----------
    model : Model or System
        What is simulated.
    duration : float
        For how long [s].
    values : mapping of str to float or array (N,), optional
        Parameters, base or derived, SI.
    initial : mapping of str to float or array (N,), optional
        States at t = 0, SI; those left out are zero. The filters are at rest as if the states had
        been held for ever.
    settings : BatchSettings, optional
        Tolerance, samples, whether errors are estimated.
    progress : callable, optional
        Called with the mean time reached now and then.

    Returns
    -------
    BatchHistory
        ``states`` (N, m, own); members that fail are marked, the others go on.

    Raises
    ------
    UsageError
        If a state is unknown, or arrays differ in length.
    ParameterError
        If a parameter is unknown, or a value outside the model's validity.

    Examples
    --------
    >>> import racs_bif as rb
    >>> decay = rb.model_from_strings("decay", {"x": "-k*x"}, parameters={"k": 1.0})
    >>> done = rb.simulate_batch(decay, 1.0, values={"k": [1.0, 2.0]}, initial={"x": 1.0})
    >>> print(done.column("x")[:, -1].round(5))
    [0.36788 0.13534]
    """
    system = system_of(model)
    for name in initial or {}:
        if name not in system.states:
            msg = f"unknown state '{name}'; {nearest(name, system.states)}"
            raise UsageError(msg)
    count = _length({**(values or {}), **(initial or {})})
    wide = {name: _wide(v, count) for name, v in (values or {}).items()}
    starts = np.zeros((count, len(system.states)))
    for name, v in (initial or {}).items():
        starts[:, system.states.index(name)] = _wide(v, count)
    return run_batch(
        system,
        values=wide,
        starts=starts,
        duration=float(duration),
        settings=settings,
        progress=progress,
    )


def _length(given: Mapping[str, Numbers]) -> int:
    """Return the number of members."""
    lengths = {name: np.size(v) for name, v in given.items() if np.ndim(v)}
    if len(set(lengths.values())) > 1 or 0 in lengths.values():
        told = ", ".join(f"{name} has {n}" for name, n in lengths.items())
        msg = f"values of a batch must be single numbers or of one length: {told}"
        raise UsageError(msg)
    return next(iter(lengths.values()), 1)


def _wide(value: Numbers, count: int) -> Array:
    return np.broadcast_to(np.asarray(value, dtype=float), (count,)).copy()
