"""Curves of special cycles in two parameters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from racs_bif.continuation.settings import StepSettings
from racs_bif.continuation.trace import trace
from racs_bif.errors import UsageError
from racs_bif.orbits.curves.detectors import detectors
from racs_bif.orbits.curves.guess import predicted_cycle
from racs_bif.orbits.curves.kinds import KINDS, CycleKind
from racs_bif.orbits.curves.start import as_collocated, cycle_curve
from racs_bif.results.branch import Branch, Profile
from racs_bif.results.provenance import describe
from racs_bif.results.special import SpecialPoint
from racs_bif.verbs import assemble
from racs_bif.verbs.origin import Origin
from racs_bif.verbs.predictions import predict_orbits

if TYPE_CHECKING:
    from racs_bif.continuation.points import Point, Trace
    from racs_bif.continuation.points import SpecialPoint as RawPoint
    from racs_bif.fractional.system import System
    from racs_bif.orbits.collocation_settings import CollocationSettings
    from racs_bif.orbits.curves.problem import CycleCurve, Span
    from racs_bif.orbits.problem import OrbitProblem
    from racs_bif.symbolic.field import Array

STARTS: Final = {
    "lpc": ("LPC", "CPC", "R1", "LPPD", "LPNS", "GH"),
    "pd": ("PD", "GPD", "R2", "LPPD", "PDNS"),
    "ns": ("NS", "CH", "R1", "R2", "R3", "R4", "LPNS", "PDNS", "NSNS", "ZH", "HH"),
}
"""Which points can start which curve; the last ones are points of equilibria."""
PREDICTED: Final = ("GH", "ZH", "HH")
_NAMES: Final = {"lpc": "LPCC", "pd": "PDC", "ns": "NSC"}
_ANGLES: Final = {"R1": 0.0, "R2": np.pi, "R3": 2.0 * np.pi / 3.0, "R4": 0.5 * np.pi}
_SETTINGS: Final = StepSettings(maximum=1 / 40, angle=0.2, tolerance=1e-8)


def starts_cycles(point: SpecialPoint, kind: str | None) -> bool:
    """Say whether a curve of cycles is meant: by its kind, or by the point alone."""
    if kind is not None:
        return kind in STARTS
    labels = {label for labels in STARTS.values() for label in labels} - set(PREDICTED)
    return point.label in labels


def kind_of(point: SpecialPoint, wanted: str | None) -> CycleKind:
    """Return the kind of curve to start: by default the one that the point was not found on.

    Raises
    ------
    UsageError
        If the point cannot start it; the message says which can.
    """
    possible = [name for name, labels in STARTS.items() if point.label in labels]
    if wanted is None:
        own = getattr(getattr(point.origin, "problem", None), "kind", None)
        others = [name for name in possible if name != getattr(own, "name", None)]
        wanted = (others or possible)[0]
    if wanted not in possible:
        can = ", ".join(STARTS[wanted])
        msg = f"a {wanted} curve cannot start at {point.name} ({point.title}); these can: {can}"
        raise UsageError(msg)
    return KINDS[wanted.upper()]


def follow_cycles(
    origin: Origin,
    point: SpecialPoint,
    kind: CycleKind,
    plane: tuple[tuple[str, str], tuple[Span, Span]],
    *,
    size: float | None = None,
    settings: StepSettings | None = None,
    orbit_settings: CollocationSettings | None = None,
    progress: Callable[[Point], None] | None = None,
) -> Branch:
    """Follow special cycles in two parameters.

    Parameters
    ----------
    origin : Origin
        Where the point came from.
    point : SpecialPoint
        Where to start.
    kind : CycleKind
        What to follow.
    plane : tuple
        Names of the two parameters, and their spans.
    size : float, optional
        Amplitude of the first cycle, where a point of equilibria predicts it.
    settings : StepSettings, optional
        Step control.
    orbit_settings : CollocationSettings, optional
        How orbits are resolved.
    progress : callable, optional
        Called with every new point.

    Returns
    -------
    Branch
        Of kind ``curve``.

    Raises
    ------
    ConvergenceError
        If no cycle of this kind is found at the start.
    UsageError
        If the plane of a predicted cycle is another than that of its point.
    """
    names, spans = plane
    system = replace(origin.system, values=origin.parameters)
    if point.label in PREDICTED:
        problem, z = _predicted(origin, point, kind, plane, size, orbit_settings)
    else:
        active = np.array([system.parameters[name] for name in names])
        orbits: OrbitProblem = origin.problem  # type: ignore[assignment] # those of cycles
        orbit = as_collocated(orbits, origin.raw.z, orbit_settings)
        angle = float(np.real(point.data.get("angle", _ANGLES.get(point.label, 0.0))))
        path = system.path(*names)
        problem, z = cycle_curve(kind, orbit, path, spans, active, angle=angle)
    found = trace(
        problem,
        z,
        spans[1],
        detectors(kind.name),
        settings or _SETTINGS,
        progress=progress,
    )
    return _branch(system, problem, found)


def _predicted(
    origin: Origin,
    point: SpecialPoint,
    kind: CycleKind,
    plane: tuple[tuple[str, str], tuple[Span, Span]],
    size: float | None,
    settings: CollocationSettings | None,
) -> tuple[CycleCurve, Array]:
    names, spans = plane
    path = origin.problem.path  # type: ignore[attr-defined] # that of a curve
    if names != path.names:
        msg = (
            f"{point.name} predicts cycles in the plane of {' and '.join(path.names)}, in which "
            f"it was found; follow them there first, not in {' and '.join(names)}"
        )
        raise UsageError(msg)
    guess = predict_orbits(point, kind.name, size)[0]
    return predicted_cycle(guess, origin.system.field, path, spans, settings)  # type: ignore[arg-type] # of cycles


def _branch(system: System, problem: CycleCurve, found: Trace) -> Branch:
    sentence, early = assemble.stopped(found)
    own, name = system.states, f"{_NAMES[problem.kind.name]}1"
    special, profiles = [], {}
    for raw in found.special:
        orbit = problem.orbit(raw.z)
        point = _special(system, problem, raw, name)
        special.append(point)
        profiles[point.name] = Profile(
            times=orbit.times, names=own, states=orbit.profile[: len(own)].T
        )
    kept = {f"{end} {state}" for end in ("max", "min") for state in own}
    measures = {
        measure: column
        for measure, column in assemble.measures(found.points).items()
        if measure in kept or not measure.startswith(("max ", "min "))
    }
    columns = assemble.columns(found.points)
    columns |= {"values": np.array([p.z[-2:] for p in found.points])}
    return Branch(
        name=name,
        kind="curve",
        parameters=problem.path.names,
        measures=measures,
        special=tuple(special),
        stopped=sentence,
        early=early,
        system=describe(system),
        method=problem.name,
        profiles=profiles,
        **columns,
    )


def _special(system: System, problem: CycleCurve, raw: RawPoint, branch: str) -> SpecialPoint:
    data: dict[str, Any] = assemble.numbers(raw.data)
    start = problem.nodes(raw.z)[0, 0]
    return SpecialPoint(
        label=raw.label,
        name=raw.name,
        branch=branch,
        parameters=dict(zip(problem.path.names, raw.z[-2:], strict=True)),
        state=dict(zip(system.states, start, strict=False)),
        data=data,
        index=raw.index,
        origin=Origin(system, problem, raw, problem.spans[1]),
    )
