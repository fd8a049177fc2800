"""How a branch of orbits ends: at which Hopf point, on which branch, towards which connection."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.continuation.points import Point
from racs_bif.continuation.stopped import Stopped
from racs_bif.errors import ConvergenceError
from racs_bif.fractional.exact_hopf import solve_hopf
from racs_bif.fractional.realised_hopf import solve_realised_hopf
from racs_bif.orbits.endings import Endings, Track
from racs_bif.orbits.harmonic_balance import HarmonicBalanceProblem
from racs_bif.verbs.orbit_branch import End, Followed

if TYPE_CHECKING:
    from collections.abc import Sequence

    from racs_bif.continuation.points import Trace
    from racs_bif.fractional.system import System
    from racs_bif.orbits.connections import Connection
    from racs_bif.orbits.problem import OrbitProblem
    from racs_bif.results.branch import Branch
    from racs_bif.results.special import SpecialPoint
    from racs_bif.symbolic.field import Array

_SAMPLES: Final = 64
_STEPS: Final = 5.0
"""How many of the last steps away a Hopf point may be at which a branch arrives."""
_FREQUENCY: Final = 0.2
"""How far, relative, its frequency may be from that of the last orbit."""
_SAME: Final = 1e-6
_ZERO: Final = 1e-10
_LONG: Final = frozenset(
    {Stopped.CONNECTION, Stopped.PERIOD, Stopped.ACCURACY, Stopped.STEP, Stopped.TURN}
)
"""Ends near which a connection may be the reason."""


def tracks(system: System, known: Sequence[Branch]) -> tuple[Track, ...]:
    """Return the known branches of orbits that were made in this process, of the same system."""
    return tuple(
        Track(branch.name, branch.origin.problem, branch.origin.orbits)
        for branch in known
        if isinstance(branch.origin, Followed) and branch.origin.system.name == system.name
    )


def settle(
    found: Trace, system: System, endings: Endings, known: Sequence[Branch]
) -> tuple[Trace, End]:
    """Bring the end of a branch to where it is, and say what is there.

    Parameters
    ----------
    found : Trace
        The branch as it was traced.
    system : System
        The system at the start.
    endings : Endings
        What watched it.
    known : sequence of Branch
        Branches whose points may be met: equilibria with their Hopf points, and orbits.

    Returns
    -------
    tuple
        The branch without what lies beyond its end, and what is said of it.
    """
    found, last = _settle_last(found, system, endings, known)
    if found.stopped_backward is None:
        return found, last
    turned, first = _settle_last(_reversed(found), system, endings, known)
    told = f"At its beginning: {first.told}" if first.told else ""
    if last.told:
        told = f"{told} At its end: {last.told}".strip()
    return _reversed(turned), End(
        told, {f"first_{k}": v for k, v in first.data.items()} | last.data
    )


def _settle_last(
    found: Trace, system: System, endings: Endings, known: Sequence[Branch]
) -> tuple[Trace, End]:
    """Settle the end of a branch at its last point."""
    if found.stopped is Stopped.VANISHED:
        return _at_hopf(found, system, endings.problem, known)
    if found.stopped is Stopped.HALVED:
        return _halved(found, endings.problem, known)
    walk = endings.walk_to(found.points[-1])
    if walk is None:
        return found, End("", {})
    if found.stopped is Stopped.CLOSED and np.isfinite(walk.closing):
        found = _closed(found, walk.closing)
    end = End("", {})
    if found.stopped is Stopped.KNOWN:
        end = End(f"It is {walk.met} from there on.", {"met": walk.met})
    elif walk.connection is not None and found.stopped in _LONG:
        end = _connected(walk.connection, system, endings.problem.parameter)
    return found, end


def _reversed(found: Trace) -> Trace:
    """Return a branch the other way round."""
    length, count = found.points[-1].arclength, len(found.points)
    points = [
        replace(point, arclength=length - point.arclength, tangent=-point.tangent)
        for point in reversed(found.points)
    ]
    special = [
        replace(event, index=count - 1 - event.index, tangent=-event.tangent)
        for event in reversed(found.special)
    ]
    assert found.stopped_backward is not None
    return replace(
        found,
        points=points,
        special=special,
        stopped=found.stopped_backward,
        stopped_backward=found.stopped,
    )


def _closed(found: Trace, closing: float) -> Trace:
    """Leave out what was traced twice, and end where the branch began."""
    kept = [point for point in found.points if point.arclength < closing]
    special = [event for event in found.special if event.index < len(kept)]
    points = [*kept, replace(found.points[0], arclength=closing, label="")]
    return replace(found, points=points, special=special)


def _at_hopf(
    found: Trace, system: System, problem: OrbitProblem, known: Sequence[Branch]
) -> tuple[Trace, End]:
    """Replace an orbit that is none by the Hopf point that the branch arrives at."""
    last = _without_last(found)
    point = last.points[-1]
    place = _arrival(last, system, problem)
    if place is None:
        told = f"The last orbit is at {problem.parameter} = {point.parameter:.10g}."
        return replace(last, stopped=Stopped.COLLAPSED), End(told, {})
    value, omega, x = place
    names = problem.field.states
    measures = dict.fromkeys(point.measures, np.nan) | {"period": 2.0 * np.pi / omega}
    for name, level in zip(names, x, strict=False):
        measures |= {f"max {name}": float(level), f"min {name}": float(level)}
    length = float(found.points[-1].arclength)
    # there is no orbit any more, and so no unknowns: only what is plotted
    born = Point(
        z=np.append(np.full(len(point.z) - 1, np.nan), value),
        tangent=np.zeros(len(point.z)),
        spectrum=np.empty(0, dtype=complex),
        stable=point.stable,
        unstable=point.unstable,
        measures={name: measures[name] for name in point.measures},
        arclength=max(length, point.arclength),
        iterations=0,
    )
    name = _hopf_name(known, problem.parameter, value, omega)
    what = name or "a Hopf point"
    told = f"It is {what}, {problem.parameter} = {value:.10g}, omega = {omega:.8g}."
    data = {"arrived": name or "H", "arrived_at": value, "arrived_omega": omega}
    at_hopf = replace(last, points=[*last.points, born], stopped=Stopped.HOPF)
    return at_hopf, End(told, data)


def _arrival(
    last: Trace, system: System, problem: OrbitProblem
) -> tuple[float, float, Array] | None:
    """Return parameter, frequency and state of the Hopf point that the last orbits close in on."""
    if len(last.points) < 3:
        return None
    before, point = last.points[-2:]
    value = _extrapolated(problem, before, point)
    omega = 2.0 * np.pi / problem.period(point.z)
    states = problem.sample(point.z, np.arange(_SAMPLES) / _SAMPLES).mean(axis=1)
    path = problem.path
    X = system.exact_point(states, path.vector(value))
    try:
        if isinstance(problem, HarmonicBalanceProblem):
            exact = solve_hopf(system.exact, path, X, value, omega)
            at, frequency, x = exact.value, exact.omega, exact.X
        else:
            realised = solve_realised_hopf(system, path, X, value, omega)
            at, frequency, x = realised.value, realised.omega, realised.x
    except (ConvergenceError, np.linalg.LinAlgError):
        return None
    reach = _STEPS * abs(point.parameter - before.parameter)
    near = abs(at - point.parameter) <= max(reach, abs(value - point.parameter) * 2.0)
    if not near or abs(frequency / omega - 1.0) > _FREQUENCY:
        return None
    return at, frequency, x


def _extrapolated(problem: OrbitProblem, before: Point, point: Point) -> float:
    """Return the parameter at which the square of the amplitude, linear in it, is zero."""
    squares = []
    for one in (before, point):
        high, low = problem.extrema(one.z)
        squares.append(float(np.sum((high - low) ** 2)))
    slope = squares[0] - squares[1]
    if slope <= 0.0:
        return point.parameter
    return point.parameter + squares[1] / slope * (point.parameter - before.parameter)


def _halved(found: Trace, problem: OrbitProblem, known: Sequence[Branch]) -> tuple[Trace, End]:
    """Leave out the orbit that is run through twice, and say at which doubling the branch ends."""
    last = _without_last(found)
    point = last.points[-1]
    reach = _STEPS * abs(found.points[-1].parameter - point.parameter)
    near = [
        one
        for one in _special(known, "PD")
        if abs(one.parameters.get(problem.parameter, np.inf) - point.parameter) < reach
        and abs(2.0 * one.period / problem.period(point.z) - 1.0) < _FREQUENCY
    ]
    if not near:
        told = f"It is near {problem.parameter} = {point.parameter:.8g}."
        return last, End(told, {})
    one = min(near, key=lambda p: abs(p.parameters[problem.parameter] - point.parameter))
    told = f"It is {one.name} of {one.branch}, {problem.parameter} = "
    told += f"{one.parameters[problem.parameter]:.10g}."
    return last, End(told, {"arrived": one.name})


def _without_last(found: Trace) -> Trace:
    """Leave out the last point, which is no orbit of the branch."""
    count = len(found.points) - 1
    special = [event for event in found.special if event.index < count]
    return replace(found, points=found.points[:count], special=special)


def _special(known: Sequence[Branch], label: str) -> list[SpecialPoint]:
    return [point for branch in known for point in branch.special if point.label == label]


def _hopf_name(known: Sequence[Branch], parameter: str, value: float, omega: float) -> str:
    for point in _special(known, "H"):
        at = point.parameters.get(parameter, np.nan)
        close = abs(at - value) <= _SAME * max(1.0, abs(value))
        if close and abs(point.omega / omega - 1.0) < _SAME * 100.0:
            return point.name
    return ""


def _rounded(value: float) -> float:
    """Return zero for what is zero but for rounding."""
    return 0.0 if abs(value) < _ZERO else value


def _connected(connection: Connection, system: System, parameter: str) -> End:
    """Say in words what orbits of growing period approach."""
    own = len(system.states)
    places = []
    for saddle in connection.saddles:
        state = zip(system.states, saddle.state[:own], strict=True)
        places.append(", ".join(f"{name} = {_rounded(value):.6g}" for name, value in state))
    what = (
        f"an orbit homoclinic to the saddle at {places[0]}"
        if connection.homoclinic
        else f"a heteroclinic cycle of the saddles at {'; '.join(places)}"
    )
    digits = int(np.clip(np.ceil(-np.log10(connection.error)) + 1, 4, 12))
    told = (
        f"It approaches {what}: {parameter} -> {connection.limit:.{digits}f} +- "
        f"{connection.error:.1e}, saddle quantity {connection.quantity:.5g}. The period grows by "
        f"{connection.growth:.4g} when the distance falls by e, "
        f"{connection.ratio:.3g} times what the eigenvalues foretell."
    )
    leading = [value for saddle in connection.saddles for value in saddle.leading]
    return End(
        told,
        {
            "connection": "homoclinic" if connection.homoclinic else "heteroclinic",
            "limit": connection.limit,
            "limit_error": connection.error,
            "saddle_quantity": connection.quantity,
            "leading": np.array(leading),
            "saddles": np.array([saddle.state[:own] for saddle in connection.saddles]),
            "distance": max(saddle.distance for saddle in connection.saddles),
            "growth_ratio": connection.ratio,
        },
    )
