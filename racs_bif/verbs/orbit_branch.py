"""From a trace of orbits, as the engine makes it, to a branch, as users keep it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from racs_bif.continuation.points import SpecialPoint as RawPoint
from racs_bif.continuation.stopped import Stopped
from racs_bif.results.branch import Branch, Profile
from racs_bif.results.provenance import describe
from racs_bif.results.special import SpecialPoint
from racs_bif.units import after, frequency_unit
from racs_bif.verbs import assemble
from racs_bif.verbs.origin import Origin

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from racs_bif.continuation.points import Point, Trace
    from racs_bif.fractional.system import System
    from racs_bif.orbits.orbit import Orbit
    from racs_bif.orbits.problem import OrbitProblem

NAME = "PO1"
_SAMPLED = 40
"""Most orbits that are kept along a branch, those at special points not counted."""
_FINE, _TIMES = 1000, 200
"""Steps in time that an orbit is computed at, and those that are kept."""


@dataclass(frozen=True, eq=False)
class Followed:
    """A branch of orbits as it was traced.

    Attributes
    ----------
    system : System
        The system.
    problem : OrbitProblem
        The problem.
    method : str
        The discretisation.
    span : (float, float)
        The parameter's span.
    found : Trace
        The trace, settled at its ends.
    """

    system: System
    problem: OrbitProblem
    method: str
    span: tuple[float, float]
    found: Trace

    @property
    def orbits(self) -> tuple[Point, ...]:
        """The points that have unknowns: not a Hopf point that the branch arrived at."""
        return tuple(point for point in self.found.points if np.all(np.isfinite(point.z)))

    @property
    def parameter(self) -> str:
        """The active parameter."""
        return self.problem.parameter


@dataclass(frozen=True, eq=False)
class End:
    """What else there is to say of the end of a branch.

    Attributes
    ----------
    told : str
        A sentence, or nothing.
    data : dict
        Numbers and arrays about it.
    """

    told: str
    data: dict[str, Any]


def orbit_branch(followed: Followed, end: End) -> Branch:
    """Return a traced branch of orbits as a result.

    Parameters
    ----------
    followed : Followed
        The trace and where it comes from.
    end : End
        What else there is to say of its end.
    """
    system, found = followed.system, followed.found
    sentence, early = assemble.stopped(found)
    sentence = f"{sentence} {end.told}".strip() + _beyond_band(followed)
    _adopt(found)
    special = []
    profiles = {}
    last = _end(found)
    for raw in [*found.special, *last]:
        orbit = followed.problem.orbit(raw.z)
        point = _special(followed, raw, orbit, end.data if raw in last else {})
        special.append(point)
        p = followed.problem.path.vector(orbit.value)
        profiles[point.name] = Profile(
            times=orbit.times, names=system.own, states=system.own_state(orbit.profile, p).T
        )
    return Branch(
        name=NAME,
        kind="orbit",
        parameters=(followed.parameter,),
        measures=_shown(system.own, assemble.measures(found.points)),
        special=tuple(sorted(special, key=lambda point: point.index)),
        stopped=sentence,
        early=early,
        system=describe(system),
        method=followed.method,
        profiles=profiles,
        samples=_samples(followed),
        origin=followed,
        **assemble.columns(found.points),
    )


def _samples(followed: Followed) -> dict[int, Profile]:
    """Return profiles of orbits along a branch, at most every second one, evenly spaced."""
    system, problem, points = followed.system, followed.problem, followed.found.points
    there = [k for k, point in enumerate(points) if np.all(np.isfinite(point.z))]
    count = min(_SAMPLED, (len(there) + 1) // 2)
    places = np.linspace(0, len(there) - 1, count).round().astype(int)
    fractions = np.linspace(0.0, 1.0, _FINE + 1)
    samples = {}
    for k in (there[place] for place in places):
        z = points[k].z
        p = problem.path.vector(float(z[-1]))
        states = system.own_state(problem.sample(z, fractions), p)
        kept = _telling(states)
        samples[k] = Profile(
            times=fractions[kept] * problem.period(z), names=system.own, states=states[:, kept].T
        )
    return samples


def _telling(states: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the places (m,) that are evenly spaced along the graph of an orbit (n, times).

    Every state counts by its range and time by the period: relaxation oscillations have corners.
    """
    spans = np.ptp(states, axis=1, keepdims=True)
    steps = np.diff(states, axis=1) / np.where(spans > 0.0, spans, 1.0)
    lengths = np.sqrt((steps**2).sum(axis=0) + 1.0 / steps.shape[1] ** 2)
    along = np.concatenate([[0.0], np.cumsum(lengths)])
    wanted = np.linspace(0.0, along[-1], _TIMES + 1)
    return np.unique(np.interp(wanted, along, np.arange(len(along))).round().astype(np.int64))


def _beyond_band(followed: Followed) -> str:
    """Say where orbits are slower or faster than the realisation they were computed on is good."""
    system = followed.system
    balanced = getattr(followed.problem, "operator", "realised") == "exact"
    if not system.fractional or balanced:
        return ""
    low, high = system.settings.band
    out = [
        point.parameter
        for point in followed.found.points
        if not low <= 2.0 * np.pi / max(point.measures.get("period", 1.0), 1e-300) <= high
    ]
    if not out:
        return ""
    unit = after(frequency_unit(system.time_unit))
    return (
        f" Between {followed.parameter} = {min(out):.6g} and {max(out):.6g} the frequency of the "
        f"orbits is outside the realisation's band, {low:g} to {high:g}{unit}: do not trust "
        "them there; use --orbits harmonic-balance, or a wider --band."
    )


def _adopt(found: Trace) -> None:
    """Give a first point that is no proper orbit the stability of the orbits born from it."""
    if len(found.points) > 1 and not len(found.points[0].spectrum):
        first, born = found.points[:2]
        first.stable, first.unstable = born.stable, born.unstable


def _shown(own: tuple[str, ...], columns: dict[str, Any]) -> dict[str, Any]:
    """Leave out the extremes of memory states."""
    kept = {f"{end} {name}" for end in ("max", "min") for name in own}
    return {
        name: column
        for name, column in columns.items()
        if name in kept or not name.startswith(("max ", "min "))
    }


def _end(found: Trace) -> list[RawPoint]:
    """Return the last point as a special one, so that its orbit is kept.

    A branch that closed, or arrived at a Hopf point, has no last orbit of its own.
    """
    last = found.points[-1]
    none = found.stopped in {Stopped.CLOSED, Stopped.HOPF}
    if last.label or len(found.points) < 2 or none:
        return []
    label = last.label = "EP" if found.stopped.complete else "MX"
    raw = RawPoint(
        label=label,
        name=f"{label}1",
        index=len(found.points) - 1,
        z=last.z,
        tangent=last.tangent,
        spectrum=last.spectrum,
        data={},
        interval=0.0,
    )
    return [raw]


def _special(followed: Followed, raw: RawPoint, orbit: Orbit, more: dict[str, Any]) -> SpecialPoint:
    system, problem = followed.system, followed.problem
    start = system.own_state(orbit.profile[:, 0], problem.path.vector(raw.z[-1]))
    data: dict[str, Any] = {
        "period": orbit.period,
        "trivial_error": orbit.trivial_error,
        "multipliers": np.asarray(orbit.multipliers),
    }
    data |= assemble.numbers(raw.data) | problem.remarks(raw.z) | more
    return SpecialPoint(
        label=raw.label,
        name=raw.name,
        branch=NAME,
        parameters={followed.parameter: raw.z[-1]},
        state=dict(zip(system.own, start, strict=True)),
        data=data,
        index=raw.index,
        origin=Origin(system, problem, raw, followed.span),
    )
