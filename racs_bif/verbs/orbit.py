"""One periodic orbit: from a simulation's tail, or by continuation from the nearest Hopf point."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.continuation.points import Point, Trace
from racs_bif.continuation.points import SpecialPoint as RawPoint
from racs_bif.continuation.stopped import Stopped
from racs_bif.errors import ConvergenceError, RacsBifError, UsageError, nearest
from racs_bif.numerics.threads import single_threaded
from racs_bif.orbits.memory_states import with_memory
from racs_bif.orbits.methods import METHODS
from racs_bif.orbits.return_map import last_turn
from racs_bif.orbits.same_orbit import distance, loop_of, loop_through
from racs_bif.orbits.settled import settled
from racs_bif.shelf.load import system_of
from racs_bif.symbolic.model import find_parameter
from racs_bif.verbs.all_equilibria import all_equilibria
from racs_bif.verbs.orbit_branch import End, Followed, orbit_branch
from racs_bif.verbs.orbits import continue_orbits
from racs_bif.verbs.rebuild import rebuild_from
from racs_bif.verbs.simulate import simulate

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from racs_bif.fractional.system import System
    from racs_bif.orbits.methods import Method, Settings
    from racs_bif.results.branch import Branch
    from racs_bif.results.history import TimeHistory
    from racs_bif.results.special import SpecialPoint
    from racs_bif.symbolic.model import Model

STARTS: Final = ("hopf", "simulate")
_ELSEWHERE: Final = 0.2
"""Largest distance from the tail of a simulation to the orbit found from it."""
_STEADY: Final = 1e-9
_BEYOND: Final = 0.5
"""How far beyond a Hopf point its orbits may go, over the way to the value wanted."""
_TURNS: Final = 60.0
"""Length of a simulation, in periods of the least damped oscillation."""
_FOLDS: Final = 12.0
"""How many times it grows by e besides, if it grows."""
_LONGEST: Final = 2000.0
_FINE: Final = 40_000
"""Samples of a simulation, so that what moves in bursts is caught."""
_PUSH: Final = 1e-2


@single_threaded
def orbit_from_history(
    history: TimeHistory,
    parameter: str | None = None,
    *,
    method: str = "collocation",
    model: Model | System | str | None = None,
    settings: Settings | None = None,
) -> Branch:
    """Solve for the orbit that a time history has settled on.

    Its period comes from the return map of a section through the tail. Memory states of fractional
    elements are those in steady response to the tail; Newton's method then corrects all.

    Parameters
    ----------
    history : TimeHistory
        From `simulate`; it must have come close to an orbit.
    parameter : str, optional
        Active parameter of the result; the model's first where left out. Any other may be chosen
        when the orbit is continued.
    method : str
        ``collocation``, ``shooting`` or ``harmonic-balance``.
    model : Model, System or str, optional
        The model, where it was made in Python.
    settings : OrbitSettings, CollocationSettings or BalanceSettings, optional
        How the orbit is resolved.

    Returns
    -------
    Branch
        Of one point, UZ1, which `continue_orbits` starts from.

    Raises
    ------
    UsageError
        If the tail does not repeat itself, a parameter still moves there, or the model is unknown.
    ConvergenceError
        If no orbit is found near the tail.
    """
    system = rebuild_from(history.system, model).with_parameters(_final(history))
    names = [p.name for p in system.parameter_table]
    name = find_parameter(parameter, names) if parameter is not None else names[0]
    turn = last_turn(history.times, history.states, history.state_names)
    kind, path, value = _method(method), system.path(name), system.parameters[name]
    states = with_memory(system.field, path, turn.times, turn.states, value)
    begun = kind.from_samples(system.field, path, turn.times, states, value, settings=settings)
    z, tangent = settled(begun.problem, begun.z)
    own = len(system.states)
    apart = distance(loop_through(turn.times, turn.states), loop_of(begun.problem, z, own))
    if apart > _ELSEWHERE:
        msg = (
            "Newton's method left the tail of the history for another orbit, "
            f"{100.0 * apart:.2g} % of its range away; integrate longer"
        )
        raise ConvergenceError(msg)
    told = (
        f"Found from the tail of a simulation by {history.method}, {100.0 * apart:.2g} % of the "
        "range of a state away from it."
    )
    problem = begun.problem
    spectrum = problem.spectrum(z)
    point = Point(
        z=z,
        tangent=tangent,
        spectrum=spectrum,
        stable=problem.stable(spectrum),
        unstable=problem.unstable(spectrum),
        measures=problem.measures(z),
        arclength=0.0,
        iterations=0,
        label="UZ",
    )
    raw = RawPoint("UZ", "UZ1", 0, z, tangent, spectrum, {"tail": apart}, 0.0)
    found = Trace([point], [raw], Stopped.SPAN)
    span = (value - abs(value) - 1.0, value + abs(value) + 1.0)
    branch = orbit_branch(Followed(system, problem, method, span, found), End("", {}))
    return replace(branch, stopped=told)


@single_threaded
def find_orbit(  # noqa: PLR0913 - each is one choice of the user's
    model: Model | System,
    parameter: str,
    value: float | None = None,
    *,
    start: str | None = None,
    method: str = "collocation",
    span: tuple[float, float] | None = None,
    duration: float | None = None,
    initial: Mapping[str, float] | None = None,
    settings: Settings | None = None,
    progress: Callable[[Point], None] | None = None,
) -> Branch:
    """Find a periodic orbit at a value of a parameter.

    Parameters
    ----------
    model : Model or System
        The model.
    parameter : str
        The parameter along which it is looked for.
    value : float, optional
        Where the orbit is wanted; the model's own value where left out.
    start : {"hopf", "simulate"}, optional
        ``hopf``: follow the orbits born at the nearest Hopf point until the value is reached.
        ``simulate``: integrate and take the tail. By default the first, and the second where that
        leads nowhere.
    method : str
        ``collocation``, ``shooting`` or ``harmonic-balance``.
    span : (float, float), optional
        Where Hopf points are looked for; a tenth to ten times the value by default.
    duration : float, optional
        Length of the simulation [s]; from the eigenvalues at the equilibrium by default.
    initial : mapping of str to float, optional
        States at its beginning; beside the equilibrium by default.
    settings : OrbitSettings, CollocationSettings or BalanceSettings, optional
        How the orbit is resolved.
    progress : callable, optional
        Called with every new point of the branches that are followed.

    Returns
    -------
    Branch
        Of one point, UZ1, which `continue_orbits` starts from. There may be other orbits.

    Raises
    ------
    UsageError
        If an option is unknown.
    ConvergenceError
        If no orbit is found.

    Examples
    --------
    >>> import racs_bif as rb
    >>> orbit = rb.find_orbit(rb.load_model("racs"), "u", 12.0)
    >>> round(orbit["UZ1"].period, 4)
    0.7394
    """
    system = system_of(model)
    find_parameter(parameter, [p.name for p in system.parameter_table])
    if start is not None and start not in STARTS:
        msg = f"unknown start '{start}'; {nearest(start, STARTS)}"
        raise UsageError(msg)
    _method(method)
    if value is not None:
        system = system.with_parameters({parameter: value})
    value = system.parameters[parameter]
    troubles = []
    if start != "simulate":
        try:
            return _from_hopf(system, (parameter, value), span, method, settings, progress)
        except RacsBifError as error:
            if start == "hopf" or isinstance(error, UsageError):
                raise
            troubles.append(str(error))
    try:
        history = _simulated(system, duration, initial)
        return orbit_from_history(
            history, parameter, method=method, model=system, settings=settings
        )
    except RacsBifError as error:
        told = " | ".join([*troubles, f"simulated: {error}"])
        msg = f"no orbit found at {parameter} = {value:g} ({told}); give another start"
        raise ConvergenceError(msg) from error


def _method(name: str) -> Method:
    """Return a discretisation by its name."""
    if name not in METHODS:
        msg = f"unknown method '{name}'; {nearest(name, METHODS)}"
        raise UsageError(msg)
    return METHODS[name]


def _final(history: TimeHistory) -> dict[str, float]:
    """Return the parameters that moved, as they are in the second half."""
    final = {}
    for name, column in history.inputs.items():
        tail = column[len(column) // 2 :]
        if np.ptp(tail) > _STEADY * max(1.0, float(np.abs(tail).max())):
            msg = (
                f"'{name}' still moves in the second half of the history, where no orbit lasts; "
                "let it rest for longer"
            )
            raise UsageError(msg)
        final[name] = float(tail[-1])
    return final


def _from_hopf(
    system: System,
    wanted: tuple[str, float],
    span: tuple[float, float] | None,
    method: str,
    settings: Settings | None,
    progress: Callable[[Point], None] | None,
) -> Branch:
    """Follow orbits from the nearest Hopf points until one has them at the value."""
    name, value = wanted
    low, high = span or _around(system, name, value)
    equilibria = all_equilibria(system, name, (low, high), probes=0, progress=progress)
    points = [point for point in equilibria.special_points if point.label == "H"]
    points.sort(key=lambda point: abs(point.parameters[name] - value))
    tried = []
    for point in points:
        try:
            branch = continue_orbits(
                point,
                _towards(system, name, point.parameters[name], value),
                method=method,
                orbit_settings=settings,
                known=[*equilibria],
                progress=progress,
            )
        except ConvergenceError as error:
            tried.append(f"{point.name}: {error}")
            continue
        if len(branch) > 1 and branch.parameter[-1] == value:
            at = point.parameters[name]
            return single(branch, f"Followed from {point.name} at {name} = {at:.8g}.")
        tried.append(f"{point.name}: {branch.stopped}")
    told = " | ".join(tried) or f"there is no Hopf point from {low:g} to {high:g}"
    msg = f"no orbit followed to {name} = {value:g} ({told}); simulate from another start"
    raise ConvergenceError(msg)


def _around(system: System, name: str, value: float) -> tuple[float, float]:
    """Return a tenth to ten times a value, within the model's validity."""
    valid = next(p.valid for p in system.parameter_table if p.name == name)
    reach = abs(value) or 1.0
    low, high = (0.1 * value, 10.0 * value) if value > 0.0 else (value - reach, value + reach)
    margin = 1e-3 * reach
    return max(min(low, high), valid[0] + margin), min(max(low, high), valid[1] - margin)


def _towards(system: System, name: str, begin: float, end: float) -> tuple[float, float]:
    """Return the span from a Hopf point to a value, and some way beyond the Hopf point.

    A branch that sets off the wrong way may fold back; one born at the value has to leave it.
    """
    valid = next(p.valid for p in system.parameter_table if p.name == name)
    way = abs(end - begin) or 1e-3 * (abs(end) or 1.0)
    far = max(_BEYOND * way, 0.1 * abs(begin))
    if end >= begin:
        return max(begin - far, 0.5 * (valid[0] + begin) if np.isfinite(valid[0]) else -np.inf), end
    return end, min(begin + far, 0.5 * (valid[1] + begin) if np.isfinite(valid[1]) else np.inf)


def single(branch: Branch, told: str) -> Branch:
    """Return the last orbit of a branch as a branch of its own."""
    k = len(branch) - 1
    last = next(point for point in branch.special if point.index == k)
    point: SpecialPoint = replace(last, label="UZ", name="UZ1", index=0)
    return replace(
        branch,
        values=branch.values[k:],
        arclength=np.zeros(1),
        stable=branch.stable[k:],
        unstable=branch.unstable[k:],
        spectrum=branch.spectrum[k:],
        labels=("UZ",),
        measures={name: column[k:] for name, column in branch.measures.items()},
        special=(point,),
        profiles={"UZ1": branch.profiles[last.name]},
        stopped=told,
        early=False,
    )


def _simulated(
    system: System, duration: float | None, initial: Mapping[str, float] | None
) -> TimeHistory:
    """Integrate the realised model from beside its equilibrium until it has settled."""
    x = system.equilibrium()
    values, vectors = np.linalg.eig(system.field.f_x(x, system.values))
    swinging = np.flatnonzero((np.abs(values.imag) > 0.0) | (values.real > 0.0))
    k = int(swinging[np.argmax(values[swinging].real)]) if len(swinging) else -1
    if duration is None:
        if k < 0:
            msg = "nothing swings at the equilibrium, so that no time suggests itself; give one"
            raise ConvergenceError(msg)
        rate = float(values[k].real)
        period = 2.0 * np.pi / (abs(values[k].imag) or float(np.abs(values[swinging]).min()))
        duration = min(_TURNS * period + (_FOLDS / rate if rate > 0.0 else 0.0), _LONGEST * period)
    begin = dict(initial or {})
    if not begin:
        own = len(system.states)
        push = vectors[:own, k].real if k >= 0 else np.ones(own)
        size = _PUSH * (np.linalg.norm(x[:own]) or 1.0) / np.linalg.norm(push)
        begin = dict(zip(system.states, x[:own] + size * push, strict=True))
    return simulate(
        system,
        duration,
        operator="realised",
        initial=begin,
        history="equilibrium",
        step=duration / _FINE,
    )
