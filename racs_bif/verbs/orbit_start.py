"""Where a branch of orbits starts: a Hopf point, a point of another branch, or a saved orbit."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.equilibria.hopf_form import hopf_form
from racs_bif.errors import UsageError, nearest
from racs_bif.orbits.memory_states import with_memory
from racs_bif.orbits.methods import METHODS, crossed, name_of
from racs_bif.orbits.problem import OrbitProblem
from racs_bif.orbits.settled import settled
from racs_bif.results.saved import Saved
from racs_bif.symbolic.model import find_parameter
from racs_bif.verbs.origin import Origin
from racs_bif.verbs.rebuild import rebuild

if TYPE_CHECKING:
    from racs_bif.equilibria.problem import EquilibriumProblem
    from racs_bif.fractional.system import System
    from racs_bif.orbits.methods import Begun, Settings
    from racs_bif.results.special import SpecialPoint
    from racs_bif.symbolic.field import Array
    from racs_bif.symbolic.model import Model

DEFAULT: Final = "shooting"
_SAMPLES: Final = 2001
"""Samples by which an orbit of another method is taken over."""


@dataclass(frozen=True, eq=False)
class Beginning:
    """A branch ready to be followed.

    Attributes
    ----------
    system : System
        The system, its parameters those at the start.
    begun : Begun
        Problem, first point, and direction where the start decides it.
    method : str
        The discretisation.
    direction : int or None
        1 to follow it one way only, None for both.
    span : (float, float) or None
        Span of the branch that it starts from, where that has the same parameter.
    """

    system: System
    begun: Begun
    method: str
    direction: int | None
    span: tuple[float, float] | None

    @property
    def value(self) -> float:
        """The active parameter at the start."""
        return float(self.begun.z[-1])


def beginning(
    point: SpecialPoint,
    parameter: str | None,
    method: str | None,
    settings: Settings | None,
    model: Model | System | str | None = None,
) -> Beginning:
    """Return the start of the branch of orbits that leaves a point.

    Parameters
    ----------
    point : SpecialPoint
        H, or an orbit: at PD the doubled branch leaves it, at BPC the other one; every other point
        is an orbit to go through.
    parameter : str, optional
        Active parameter; that of the point's own branch where left out.
    method : str, optional
        Discretisation; that of the point's own branch where left out.
    settings : OrbitSettings, CollocationSettings or BalanceSettings, optional
        How orbits are resolved, as the method has it.
    model : Model, System or str, optional
        The model of a point that was loaded from a file, where that was made in Python.

    Raises
    ------
    UsageError
        If no orbits start at the point, or method or settings cannot be used there.
    ConvergenceError
        If the orbit is not found again.
    """
    origin = point.origin
    if point.label == "H" and isinstance(origin, Origin) and not _is_orbit(origin):
        return _from_hopf(origin, parameter, _checked(method or DEFAULT, settings), settings)
    if isinstance(origin, Origin) and _is_orbit(origin):
        own = name_of(origin.problem)
        return _from_orbit(point, origin, parameter, _checked(method or own, settings), settings)
    if isinstance(origin, Saved):
        return _from_saved(point, origin, (parameter, method), settings, model)
    if isinstance(origin, Origin) or point.label not in {"H", "UZ", "EP", "MX"}:
        msg = (
            f"{point.name} is a {point.title}; start from a Hopf point (H) or from a point "
            "of a branch of orbits"
        )
        raise UsageError(msg)
    msg = f"{point.name} was loaded from a file; continue the equilibria again to start from it"
    raise UsageError(msg)


def _checked(method: str, settings: Settings | None) -> str:
    """Return the method if it is one and the settings are its own."""
    if method not in METHODS:
        msg = f"unknown method '{method}'; {nearest(method, METHODS)}"
        raise UsageError(msg)
    kind = METHODS[method].settings
    if not isinstance(settings, kind | None):
        msg = f"{method} needs {kind.__name__}, not {type(settings).__name__}; give settings of it"
        raise UsageError(msg)
    return method


def _is_orbit(origin: Origin) -> bool:
    return isinstance(origin.problem, OrbitProblem)


def _named(origin: Origin, parameter: str | None) -> tuple[System, str]:
    """Return the system with its parameters at the point, and the active parameter."""
    system = replace(origin.system, values=origin.parameters)
    if parameter is not None:
        find_parameter(parameter, [p.name for p in system.parameter_table])
    return system, parameter or origin.problem.parameter


def _from_hopf(
    origin: Origin, parameter: str | None, method: str, settings: Settings | None
) -> Beginning:
    system, name = _named(origin, parameter)
    problem: EquilibriumProblem = origin.problem  # type: ignore[assignment] # those have H
    path, z, form = problem.path, origin.raw.z, origin.raw.data["form"]
    span: tuple[float, float] | None = origin.span
    if name != problem.parameter:
        path, span = system.path(name), None
        z = np.append(z[:-1], system.parameters[name])
        p, dp = path.vector(z[-1]), path.direction(z[-1])
        form = hopf_form(system.field, z[:-1], p, dp, form.omega, len(system.states))
    begun = METHODS[method].from_hopf(
        system.field, path, z, form.omega, form.q, form=form, settings=settings
    )
    return Beginning(system, begun, method, 1, span)


def _from_orbit(
    point: SpecialPoint,
    origin: Origin,
    parameter: str | None,
    method: str,
    settings: Settings | None,
) -> Beginning:
    """Start from a point of a branch of orbits made in this process."""
    system, name = _named(origin, parameter)
    problem: OrbitProblem = origin.problem  # type: ignore[assignment] # asked for before
    raw, same = origin.raw, name == origin.problem.parameter
    if problem.degenerate(raw.z):
        msg = f"{point.name} is no proper orbit: start from the point that its branch was born at"
        raise UsageError(msg)
    kind, alike = METHODS[method], method == name_of(problem) and settings is None
    if same and point.label == "BPC":
        if not alike:
            msg = (
                f"{point.name} is left by the method that found it, {name_of(problem)}, with its "
                "settings; leave out method and settings"
            )
            raise UsageError(msg)
        other = crossed(problem, raw.z, raw.tangent)
        begun: Begun = _Begun(other.problem, other.z, other.direction)
        return Beginning(system, begun, method, 1 if other.symmetric else None, origin.span)
    span = origin.span if same else None
    path = system.path(name)
    if same and point.label == "PD" and alike:
        begun = kind.doubled(problem, raw.z, raw.tangent)
        return Beginning(system, begun, method, 1, span)
    value = float(raw.z[-1]) if same else system.parameters[name]
    if method == name_of(problem):
        begun = kind.through(problem, raw.z, path, value, settings)
    else:
        fractions = np.linspace(0.0, 1.0, _SAMPLES)
        times, profile = fractions * problem.period(raw.z), problem.sample(raw.z, fractions)
        begun = kind.from_samples(system.field, path, times, profile, value, settings=settings)
    return _turned(Beginning(system, begun, method, None, span), point if same else None)


def _from_saved(
    point: SpecialPoint,
    saved: Saved,
    wanted: tuple[str | None, str | None],
    settings: Settings | None,
    model: Model | System | str | None,
) -> Beginning:
    """Start from an orbit of a file: its profile has the model's own states, and no memory."""
    branch = saved.branch
    parameter, method = wanted
    profile = branch.profiles.get(saved.name)
    if profile is None or point.label == "BPC":
        what = "is a branch point" if profile is not None else "has no profile there"
        msg = f"{point.name} was loaded from a file and {what}; continue its branch again"
        raise UsageError(msg)
    system = rebuild(branch, model)
    active = [point.parameters[name] for name in branch.parameters]
    system = replace(system, values=system.path(*branch.parameters).vector(active))
    name = parameter or branch.parameters[0]
    find_parameter(name, [p.name for p in system.parameter_table])
    known = branch.method if branch.method in METHODS else DEFAULT
    method = _checked(method or known, settings)
    path, value = system.path(name), system.parameters[name]
    states = with_memory(system.field, path, profile.times, profile.states.T, value)
    begun = METHODS[method].from_samples(
        system.field, path, profile.times, states, value, settings=settings
    )
    same = point if name == branch.parameters[0] else None
    return _turned(Beginning(system, begun, method, None, None), same)


def _turned(through: Beginning, point: SpecialPoint | None) -> Beginning:
    """Return the doubled branch where the orbit of a start is a period doubling, taken over."""
    if point is None or point.label != "PD":
        return through
    begun = through.begun
    z, tangent = settled(begun.problem, begun.z)
    doubled = METHODS[through.method].doubled(begun.problem, z, tangent)
    return replace(through, begun=doubled, direction=1)


@dataclass(frozen=True, eq=False)
class _Begun:
    problem: OrbitProblem
    z: Array
    tangent: Array | None
