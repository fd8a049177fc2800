"""The branch of periodic orbits that is born at a Hopf point."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from racs_bif.continuation.points import Point, Trace
from racs_bif.continuation.points import SpecialPoint as RawPoint
from racs_bif.continuation.settings import StepSettings
from racs_bif.continuation.stopped import Stopped
from racs_bif.continuation.trace import trace
from racs_bif.errors import UsageError, nearest
from racs_bif.numerics.threads import single_threaded
from racs_bif.orbits.balance_settings import BalanceSettings
from racs_bif.orbits.balance_start import balanced_from_hopf
from racs_bif.orbits.branch_point import BranchPointOfCycles
from racs_bif.orbits.collocation_settings import CollocationSettings
from racs_bif.orbits.collocation_start import collocated_from_hopf
from racs_bif.orbits.cycles_fold import FoldOfCycles
from racs_bif.orbits.neimark_sacker import NeimarkSacker
from racs_bif.orbits.period_doubling import PeriodDoubling
from racs_bif.orbits.settings import OrbitSettings
from racs_bif.orbits.start import from_hopf
from racs_bif.results.branch import Branch, Profile
from racs_bif.results.provenance import describe
from racs_bif.results.special import SpecialPoint
from racs_bif.verbs import assemble
from racs_bif.verbs.equilibria import check_span
from racs_bif.verbs.origin import Origin

if TYPE_CHECKING:
    from collections.abc import Sequence

    from racs_bif.equilibria.hopf_form import HopfForm
    from racs_bif.orbits.orbit import Orbit
    from racs_bif.orbits.problem import OrbitProblem

METHODS: Final[dict[str, tuple[Callable[..., Any], type]]] = {
    "shooting": (from_hopf, OrbitSettings),
    "collocation": (collocated_from_hopf, CollocationSettings),
    "harmonic-balance": (balanced_from_hopf, BalanceSettings),
}
"""Discretisations of periodic orbits: how a branch starts from a Hopf point, and the settings."""
_STEPS = StepSettings(maximum=0.05, tolerance=1e-8)


@single_threaded
def continue_orbits(
    hopf: SpecialPoint,
    span: tuple[float, float] | None = None,
    *,
    method: str = "shooting",
    at: Sequence[float] = (),
    settings: StepSettings | None = None,
    orbit_settings: OrbitSettings | CollocationSettings | BalanceSettings | None = None,
    progress: Callable[[Point], None] | None = None,
) -> Branch:
    """Follow the periodic orbits born at a Hopf point through a span of the parameter.

    Folds of cycles (LPC), period doublings (PD) and Neimark-Sacker points (NS) are located.

    Parameters
    ----------
    hopf : SpecialPoint
        A Hopf point of a branch made in this process by `continue_equilibria`.
    span : (float, float), optional
        Interval of the parameter; that of the equilibria where left out.
    method : str
        ``shooting``: multiple shooting with the implicit Radau method. ``collocation``: orthogonal
        collocation at Gauss points on an adaptive mesh. ``harmonic-balance``: Fourier series on the
        exact fractional operator, from the exact Hopf point; multipliers still are those of the
        realisation, along the exact orbit.
    at : sequence of float
        Values of the parameter at which orbits are wanted exactly; they are labelled UZ.
    settings : StepSettings, optional
        Step control.
    orbit_settings : OrbitSettings, CollocationSettings or BalanceSettings, optional
        How orbits are resolved, as the method has it.
    progress : callable, optional
        Called with every new point.

    Returns
    -------
    Branch
        Named PO1, of kind ``orbit``; its first point is the Hopf point, an orbit of no amplitude.

    Raises
    ------
    UsageError
        If the point is no Hopf point or was loaded from a file, the method is unknown, or the
        settings are those of another.
    """
    if method not in METHODS:
        msg = f"unknown method '{method}'; {nearest(method, METHODS)}"
        raise UsageError(msg)
    begin, kind = METHODS[method]
    if not isinstance(orbit_settings, kind | None):
        msg = f"{method} takes {kind.__name__}, not {type(orbit_settings).__name__}"
        raise UsageError(msg)
    origin = hopf.origin
    if hopf.label != "H":
        msg = f"{hopf.name} is a {hopf.title}; periodic orbits start from Hopf points (H)"
        raise UsageError(msg)
    if not isinstance(origin, Origin):
        msg = f"{hopf.name} was loaded from a file; continue the equilibria again to start from it"
        raise UsageError(msg)
    system, raw = origin.system, origin.raw
    path = origin.problem.path  # type: ignore[attr-defined] # as all of ours have
    low, high = check_span(system, path.names[0], span or origin.span)
    if not low <= raw.z[-1] <= high:
        msg = f"{hopf.name} at {raw.z[-1]:g} is outside the span {low:g} to {high:g}; widen it"
        raise UsageError(msg)
    form: HopfForm = raw.data["form"]
    start = begin(system.field, path, raw.z, form.omega, form.q, form=form, settings=orbit_settings)
    found = trace(
        start.problem,
        start.z,
        (low, high),
        [FoldOfCycles(), BranchPointOfCycles(), PeriodDoubling(), NeimarkSacker()],
        settings or _STEPS,
        tangent=start.tangent,
        direction=1,
        targets=tuple(at),
        progress=progress,
    )
    return _branch(origin, start.problem, found, method)


def _branch(origin: Origin, problem: OrbitProblem, found: Trace, method: str) -> Branch:
    system = origin.system
    sentence, early = assemble.stopped(found)
    sentence += _beyond_band(origin, found, method)
    _adopt(found)
    special = []
    profiles = {}
    for raw in [*found.special, *_ends(found)]:
        orbit = problem.orbit(raw.z)
        point = _special(origin, problem, raw, orbit)
        special.append(point)
        own = len(system.states)
        profiles[point.name] = Profile(
            times=orbit.times, names=system.states, states=orbit.profile[:own].T
        )
    return Branch(
        name="PO1",
        kind="orbit",
        parameters=(hopf_parameter(origin),),
        measures=_shown(system.states, assemble.measures(found.points)),
        special=tuple(sorted(special, key=lambda point: point.index)),
        stopped=sentence,
        early=early,
        system=describe(system),
        method=method,
        profiles=profiles,
        **assemble.columns(found.points),
    )


def hopf_parameter(origin: Origin) -> str:
    """Return the active parameter's name."""
    return str(origin.problem.parameter)


def _beyond_band(origin: Origin, found: Trace, method: str) -> str:
    """Say where orbits are slower or faster than the realisation they were computed on is good."""
    system = origin.system
    if not system.fractional or method == "harmonic-balance":
        return ""
    low, high = system.settings.band
    out = [
        point.parameter
        for point in found.points
        if not low <= 2.0 * np.pi / max(point.measures.get("period", 1.0), 1e-300) <= high
    ]
    if not out:
        return ""
    name = hopf_parameter(origin)
    return (
        f" Between {name} = {min(out):.6g} and {max(out):.6g} the frequency of the orbits is "
        f"outside the realisation's band, {low:g} to {high:g} rad/s: do not trust them there; use "
        "--orbits harmonic-balance, or a wider --band."
    )


def _adopt(found: Trace) -> None:
    """Give the first point, which has no amplitude, the stability of the orbits born from it."""
    if len(found.points) > 1:
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


def _ends(found: Trace) -> list[RawPoint]:
    """Return the last point as a special one, so that its orbit is kept."""
    last = found.points[-1]
    if last.label or len(found.points) < 2:
        return []
    label = "EP" if found.stopped.complete else "MX"
    last.label = label if found.stopped is not Stopped.VANISHED else ""
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


def _special(origin: Origin, problem: OrbitProblem, raw: RawPoint, orbit: Orbit) -> SpecialPoint:
    own = origin.system.states
    data: dict[str, Any] = {
        "period": orbit.period,
        "trivial_error": orbit.trivial_error,
        "multipliers": np.asarray(orbit.multipliers),
    }
    data |= assemble.numbers(raw.data) | problem.remarks(raw.z)
    return SpecialPoint(
        label=raw.label,
        name=raw.name,
        branch="PO1",
        parameters={hopf_parameter(origin): raw.z[-1]},
        state=dict(zip(own, orbit.profile[: len(own), 0], strict=True)),
        data=data,
        index=raw.index,
        origin=Origin(origin.system, problem, raw, origin.span),
    )
