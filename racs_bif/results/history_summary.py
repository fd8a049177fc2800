"""The summary of a time history as JSON."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import UsageError
from racs_bif.results.summary import SCHEMA, Json, to_json

if TYPE_CHECKING:
    from collections.abc import Sequence

    from racs_bif.results.history import TimeHistory


def summarise_history(
    history: TimeHistory, command: Sequence[str], version: str
) -> dict[str, Json]:
    """Return the summary of a time history.

    Parameters
    ----------
    history : TimeHistory
        What is told of.
    command : sequence of str
        The arguments it was computed with.
    version : str
        The racs_bif that computed it.

    Returns
    -------
    dict
        ``schema, version, command, model, variant, parameters, units, realisation, notes`` as for a
        diagram, and ``simulation``: how it was computed; ``columns``: for each its unit, last
        value, estimated error, and over the second half of the time its range and mean period.
    """
    system = history.system
    how = system.realisation
    whole: dict[str, object] = {
        "schema": SCHEMA,
        "version": version,
        "command": list(command),
        "model": system.model,
        "variant": system.variant,
        "parameters": dict(system.parameters),
        "units": dict(system.units),
        "realisation": None
        if how is None
        else {"name": how.name, "states": how.states, "band": list(how.band), "error": how.error},
        "notes": list(system.notes),
        "simulation": {
            "duration": float(history.times[-1]),
            "samples": len(history),
            "operator": history.operator,
            "method": history.method,
            "history": history.history,
            "step": history.step,
            "order": history.order,
            "extrapolated": history.extrapolated,
            "stopped": history.stopped,
            "early": history.early,
        },
        "columns": {name: column_summary(history, name) for name in history.names},
    }
    return {key: to_json(value) for key, value in whole.items()}


def column_summary(history: TimeHistory, name: str) -> dict[str, object]:
    """Return what is told of one column: unit, last value, error; range and period at the end."""
    told: dict[str, object] = {
        "unit": history.units[name],
        "last": float(history.column(name)[-1]),
        "error": history.errors.get(name),
    }
    after = 0.5 * float(history.times[-1])
    try:
        low, high = history.extremes(name, after=after)
        told |= {"min": low, "max": high, "period": history.period(name, after=after)}
    except UsageError:  # too few samples for a curve through them
        kept = history.column(name)[history.times >= after]
        told |= {"min": float(np.min(kept)), "max": float(np.max(kept)), "period": None}
    return told
