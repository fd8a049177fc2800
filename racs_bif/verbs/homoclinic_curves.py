"""Curves of homoclinic orbits in two parameters, as orbits of one long period."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.continuation.settings import StepSettings
from racs_bif.continuation.trace import trace
from racs_bif.errors import UsageError
from racs_bif.orbits.collocation_settings import CollocationSettings
from racs_bif.orbits.collocation_start import collocated_from_samples
from racs_bif.orbits.curves.long_orbits import LongOrbits
from racs_bif.orbits.curves.one_of import OneOf
from racs_bif.orbits.curves.start import as_collocated
from racs_bif.orbits.history import reference_of
from racs_bif.results.branch import Branch
from racs_bif.results.provenance import describe
from racs_bif.verbs import assemble
from racs_bif.verbs.predictions import predict_orbits

if TYPE_CHECKING:
    from collections.abc import Callable

    from racs_bif.continuation.points import Point, Trace
    from racs_bif.fractional.system import System
    from racs_bif.orbits.piecewise import Piecewise
    from racs_bif.results.special import SpecialPoint
    from racs_bif.symbolic.field import Array
    from racs_bif.verbs.origin import Origin

KIND: Final = "homoclinic"
_SETTINGS: Final = StepSettings(maximum=1 / 40, angle=0.2, tolerance=1e-8)
_ORBITS: Final = CollocationSettings(intervals=80)
_TAIL: Final = 9.0
"""Half a period of the orbit predicted at BT, in units of 1 / epsilon: e^-9 is left of the bell."""
_SAMPLES: Final = 801
_EPSILON: Final = 0.2

Span = tuple[float, float]


def follow_homoclinic(
    origin: Origin,
    point: SpecialPoint,
    plane: tuple[tuple[str, str], tuple[Span, Span]],
    *,
    size: float | None = None,
    settings: StepSettings | None = None,
    orbit_settings: CollocationSettings | None = None,
    progress: Callable[[Point], None] | None = None,
) -> Branch:
    """Follow a homoclinic orbit in two parameters, as the orbit of one long period near it.

    Parameters
    ----------
    origin : Origin
        Where the point came from.
    point : SpecialPoint
        An orbit of long period, or a Bogdanov-Takens point of a curve in the same plane.
    plane : tuple
        Names of the two parameters, and their spans.
    size : float, optional
        epsilon of the orbit predicted at a Bogdanov-Takens point.
    settings : StepSettings, optional
        Step control.
    orbit_settings : CollocationSettings, optional
        How orbits are resolved.
    progress : callable, optional
        Called with every new point.

    Returns
    -------
    Branch
        Of kind ``curve``, named HOM1. Measure ``shift``: how far the first parameter is from the
        homoclinic orbit's, by the exponential approach; ``saddle quantity``.

    Raises
    ------
    UsageError
        If the point is neither.
    ConvergenceError
        If no such orbit is found at the start.
    """
    (names, spans), system = plane, replace(origin.system, values=origin.parameters)
    path = system.path(*names)
    chosen = orbit_settings or _ORBITS
    if point.label == "BT":
        curve, scales, period, active = _predicted(origin, point, path, size, chosen)
    elif "period" in point.data:
        problem, z = as_collocated(origin.problem, origin.raw.z, orbit_settings)  # type: ignore[arg-type] # of orbits
        curve, scales = problem.curve(z), problem.reference(z).scales
        period = problem.period(z)
        active = np.array([system.parameters[name] for name in names])
        chosen = orbit_settings or problem.settings
    else:
        msg = (
            f"a homoclinic curve must start at an orbit of long period or at BT, not {point.name} "
            f"({point.title})"
        )
        raise UsageError(msg)
    first = reference_of(curve, scales), curve
    long = LongOrbits(system.field, path, first, period, spans, chosen)
    z = long.join(curve.nodes, float(active[0]), float(active[1]))
    found = trace(long, z, spans[1], [], settings or _SETTINGS, progress=progress)
    return _branch(system, long, found)


def _predicted(
    origin: Origin,
    point: SpecialPoint,
    path: object,
    size: float | None,
    settings: CollocationSettings,
) -> tuple[Piecewise, Array, float, Array]:
    """Return the orbit that a Bogdanov-Takens point predicts, its period and parameters."""
    names = origin.problem.path.names  # type: ignore[attr-defined] # that of a curve
    if names != path.names:  # type: ignore[attr-defined] # a path
        plane = " and ".join(names)
        msg = f"{point.name} predicts homoclinic orbits in the plane of {plane} only; give these"
        raise UsageError(msg)
    guess = predict_orbits(point, KIND, _EPSILON if size is None else size)[0]
    half = _TAIL / guess.epsilon  # type: ignore[union-attr] # homoclinic
    times = np.linspace(-half, half, _SAMPLES)
    profile = guess.states(times)
    active = np.asarray(guess.parameters, dtype=float)
    one = OneOf(path, 0, float(active[1]))  # type: ignore[arg-type] # a path
    start = collocated_from_samples(
        origin.system.field, one, times + half, profile, float(active[0]), settings=settings
    )
    curve = start.problem.curve(start.z)
    return curve, start.problem.reference(start.z).scales, 2.0 * half, active


def _branch(system: System, problem: LongOrbits, found: Trace) -> Branch:
    sentence, early = assemble.stopped(found)
    own = system.states
    kept = {f"{end} {state}" for end in ("max", "min") for state in own}
    measures = {
        measure: column
        for measure, column in assemble.measures(found.points).items()
        if measure in kept or not measure.startswith(("max ", "min "))
    }
    values = np.array([(p.z[-3], p.z[-1]) for p in found.points])
    shift = np.abs(measures["shift"])
    if np.isfinite(shift).any():
        sentence += (
            f" The first parameter is within {np.nanmax(shift):.2g} of the homoclinic orbit's, by "
            "its approach with growing period."
        )
    return Branch(
        name="HOM1",
        kind="curve",
        parameters=problem.path.names,
        measures=measures,
        stopped=sentence,
        early=early,
        system=describe(system),
        method=problem.name,
        **(assemble.columns(found.points) | {"values": values}),
    )
