"""From traces, as the engine makes them, to branches, as users keep them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from racs_bif.continuation.stopped import Stopped

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from racs_bif.continuation.points import Point, Trace


_NOTES = 2
"""Notes of a trace that are shown; they tend to repeat themselves."""


def columns(points: Sequence[Point]) -> dict[str, Any]:
    """Return the columns of a `Branch` that every kind of branch has."""
    width = max((len(p.spectrum) for p in points), default=0)
    spectrum = np.full((len(points), width), np.nan, dtype=complex)
    for k, p in enumerate(points):
        spectrum[k, : len(p.spectrum)] = p.spectrum
    known = [p.stable is not None for p in points]
    return {
        "values": np.array([[p.parameter] for p in points]),
        "arclength": np.array([p.arclength for p in points]),
        "stable": np.array([bool(p.stable) for p in points]),
        "unstable": np.array([p.unstable if k else -1 for p, k in zip(points, known, strict=True)]),
        "spectrum": spectrum,
        "labels": tuple(p.label for p in points),
    }


def measures(points: Sequence[Point]) -> dict[str, NDArray[np.float64]]:
    """Return the measures of all points, NaN where a point lacks one."""
    names = dict.fromkeys(name for p in points for name in p.measures)
    return {name: np.array([p.measures.get(name, np.nan) for p in points]) for name in names}


def stopped(trace: Trace) -> tuple[str, bool]:
    """Return why a branch ended, both ends if they differ, and whether that was early.

    An end of the span needs no words beside another reason.
    """
    ends = [trace.stopped]
    sentences = [trace.stopped.value]
    if trace.stopped_backward is not None and trace.stopped_backward is not trace.stopped:
        ends.insert(0, trace.stopped_backward)
        places = ("At its beginning", "At its end")
        sentences = [
            f"{place}: {end.value}"
            for place, end in zip(places, ends, strict=True)
            if end is not Stopped.SPAN
        ]
    notes = trace.message.splitlines()
    sentences += notes[:_NOTES]
    if len(notes) > _NOTES:
        sentences.append(f"(And {len(notes) - _NOTES} more notes like these.)")
    return " ".join(sentences), any(not end.complete for end in ends)


def numbers(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return what a detector found without the objects that only solvers use."""
    kept = (bool, int, float, complex, str, np.ndarray, np.generic)
    return {key: value for key, value in data.items() if isinstance(value, kept)}


def interrupted(trace: Trace) -> bool:
    """Say whether the user ended a trace."""
    return Stopped.INTERRUPTED in {trace.stopped, trace.stopped_backward}
