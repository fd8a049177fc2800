"""Curves of special equilibria in two parameters."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from racs_bif.continuation.settings import StepSettings
from racs_bif.continuation.trace import trace
from racs_bif.equilibria.bogdanov_takens import BogdanovTakensOnFold, BogdanovTakensOnHopf
from racs_bif.equilibria.cusp import Cusp
from racs_bif.equilibria.double_hopf import DoubleHopf
from racs_bif.equilibria.generalised_hopf import GeneralisedHopf
from racs_bif.equilibria.zero_hopf import PairOnFold, ZeroOnHopf
from racs_bif.errors import UsageError
from racs_bif.numerics.threads import single_threaded
from racs_bif.results.branch import Branch
from racs_bif.results.provenance import describe
from racs_bif.results.special import SpecialPoint
from racs_bif.symbolic.model import find_parameter
from racs_bif.verbs import assemble
from racs_bif.verbs.curve_start import CurveStart, frequency_of
from racs_bif.verbs.cycle_curves import STARTS, follow_cycles, kind_of, starts_cycles
from racs_bif.verbs.equilibria import check_span
from racs_bif.verbs.homoclinic_curves import KIND, follow_homoclinic
from racs_bif.verbs.origin import Origin, origin_of

if TYPE_CHECKING:
    from racs_bif.continuation.points import Point, Trace
    from racs_bif.continuation.points import SpecialPoint as RawPoint
    from racs_bif.continuation.problem import Detector
    from racs_bif.equilibria.curve_problem import CurveProblem, Span
    from racs_bif.fractional.system import System
    from racs_bif.orbits.collocation_settings import CollocationSettings

_KINDS: Final = {
    "hopf": ("H", "GH", "BT", "ZH", "HH"),
    "fold": ("LP", "CP", "BT", "ZH"),
    "bp": ("BP",),
}
"""Which points can start which curve."""
_NAMES: Final = {"hopf": "HC", "fold": "LC", "bp": "BC"}
_SETTINGS: Final = StepSettings(maximum=1 / 40, angle=0.2)
"""Steps in a plane turn less than along a branch, so that pictures of curves are smooth."""
_REACH: Final = 1e-3
_OPERATORS: Final = ("realised", "exact")


@single_threaded
def continue_curve(  # noqa: PLR0913 - each is one choice of the user's
    point: SpecialPoint,
    parameters: tuple[str, str],
    spans: tuple[Span | None, Span | None] | Mapping[str, Span] | None = None,
    *,
    kind: str | None = None,
    operator: str = "realised",
    size: float | None = None,
    settings: StepSettings | None = None,
    orbit_settings: CollocationSettings | None = None,
    progress: Callable[[Point], None] | None = None,
) -> Branch:
    """Follow a special equilibrium or a special cycle in two parameters.

    Codimension-two points are located: CP, BT and ZH on a fold curve; BT, GH, ZH and HH on a Hopf
    curve. Beyond BT a Hopf curve goes on as a curve of neutral saddles, measure ``neutral`` 1.
    On curves of cycles, which are followed by collocation on the realisation: CPC, R1, LPPD and
    LPNS on one of folds (lpc); GPD, R2, LPPD and PDNS on one of period doublings (pd); R1 to R4,
    CH, LPNS, PDNS and NSNS on one of Neimark-Sacker points (ns).

    Parameters
    ----------
    point : SpecialPoint
        Where to start, a point of `continue_equilibria`, `continue_orbits` or of another curve.
    parameters : (str, str)
        Active parameters, base or derived.
    spans : pair or mapping of (float, float), optional
        Their intervals, SI. Where left out: that of the branch that the point lies on, or a tenth
        to ten times the value at the point, within the model's validity.
    kind : {"hopf", "fold", "bp", "lpc", "pd", "ns", "homoclinic"}, optional
        Which curve; by default the one of the point's label, and at a point where two meet the
        one that it was not found on. ``"hopf2"`` is the other Hopf curve through a double Hopf
        point. GH starts "lpc", ZH and HH start "ns", at a cycle that their normal form predicts.
        "homoclinic" starts at an orbit of long period, or at BT: see `follow_homoclinic`.
    operator : {"realised", "exact"}
        What equilibria of a model with fractional elements are followed on: its realisation, or
        the exact characteristic matrix.
    size : float, optional
        Amplitude of the cycle that GH, ZH or HH predicts, in the units of the states; epsilon of
        the homoclinic orbit at BT.
    orbit_settings : CollocationSettings, optional
        How cycles are resolved.
    settings : StepSettings, optional
        Step control.
    progress : callable, optional
        Called with every new point.

    Returns
    -------
    Branch
        Of kind ``curve``; its points carry omega and l1 of a Hopf curve as measures.

    Raises
    ------
    UsageError
        If no such curve starts at the point, or a span is empty or cannot be guessed.
    ParameterError
        If a parameter is unknown or a span leaves the model's validity.
    ConvergenceError
        If no solution is found at the start.
    """
    if operator not in _OPERATORS:
        msg = f"unknown operator '{operator}'; there are: {', '.join(_OPERATORS)}"
        raise UsageError(msg)
    origin = origin_of(point)
    system = replace(origin.system, values=origin.parameters)
    if kind == KIND:
        return follow_homoclinic(
            origin,
            point,
            ((parameters[0], parameters[1]), _spans(system, origin, parameters, spans)),
            size=size,
            settings=settings,
            orbit_settings=orbit_settings,
            progress=progress,
        )
    if starts_cycles(point, kind):
        followed = kind_of(point, kind)
        plane = (parameters[0], parameters[1]), _spans(system, origin, parameters, spans)
        return follow_cycles(
            origin,
            point,
            followed,
            plane,
            size=size,
            settings=settings,
            orbit_settings=orbit_settings,
            progress=progress,
        )
    chosen = _kind(point, kind)
    first, second = _spans(system, origin, parameters, spans)
    start = CurveStart(system, origin.equilibrium, parameters, first, frequency_of(point, kind))
    problem, z = start.problem(chosen, operator)
    detectors = _detectors(chosen, operator)
    found = trace(problem, z, second, detectors, settings or _SETTINGS, progress=progress)
    return _branch(system, problem, found, second)


def _kind(point: SpecialPoint, wanted: str | None) -> str:
    """Return the kind of curve to start.

    Raises
    ------
    UsageError
        If the point cannot start it; the message says which can.
    """
    possible = [kind for kind, labels in _KINDS.items() if point.label in labels]
    if not possible:
        every = [*_KINDS.values(), *STARTS.values()]
        labels = ", ".join(sorted({label for labels in every for label in labels}))
        msg = f"no curve starts at {point.name} ({point.title}); these can: {labels}"
        raise UsageError(msg)
    if wanted is None:
        own = getattr(origin_of(point).problem, "kind", None)
        others = [kind for kind in possible if kind != own]
        return (others or possible)[0]
    plain = wanted.removesuffix("2")
    if plain not in _KINDS:
        msg = f"unknown kind of curve '{wanted}'; there are: {', '.join((*_KINDS, *STARTS, KIND))}"
        raise UsageError(msg)
    if plain not in possible or (wanted != plain and point.label != "HH"):
        can = ", ".join(("HH",) if wanted == "hopf2" else _KINDS[plain])
        msg = f"a {wanted} curve cannot start at {point.name} ({point.title}); these can: {can}"
        raise UsageError(msg)
    return plain


def _spans(
    system: System,
    origin: Origin,
    parameters: Sequence[str],
    spans: tuple[Span | None, Span | None] | Mapping[str, Span] | None,
) -> tuple[Span, Span]:
    if len(parameters) != 2 or parameters[0] == parameters[1]:
        msg = f"a curve needs two different parameters, not {', '.join(parameters)}"
        raise UsageError(msg)
    if isinstance(spans, Mapping):
        given = [spans.get(name) for name in parameters]
    else:
        given = list(spans or (None, None))
    names = origin.problem.path.names  # type: ignore[attr-defined] # as all of ours have
    found = []
    for name, span in zip(parameters, given, strict=True):
        find_parameter(name, [p.name for p in system.parameter_table])
        known = origin.span if len(names) == 1 and name == names[0] else None
        low, high = check_span(system, name, span or known or _guessed(system, name))
        value = system.parameters[name]
        if not low <= value <= high:
            msg = (
                f"the span {low:g} to {high:g} of '{name}' leaves out the start at {value:g}; "
                "widen it"
            )
            raise UsageError(msg)
        found.append((low, high))
    return found[0], found[1]


def _guessed(system: System, name: str) -> Span:
    value = system.parameters[name]
    if not np.isfinite(value) or value == 0.0:
        msg = f"'{name}' is {value:g}, which gives no span to follow it over; give its span"
        raise UsageError(msg)
    valid = next(p.valid for p in system.parameter_table if p.name == name)
    margin = 1e-3 * abs(value)
    low, high = sorted((0.1 * value, 10.0 * value))
    return max(low, valid[0] + margin), min(high, valid[1] - margin)


def _detectors(kind: str, operator: str) -> list[Detector]:
    if kind == "hopf":
        further = [BogdanovTakensOnHopf()] if operator == "realised" else []
        return [*further, GeneralisedHopf(), ZeroOnHopf(), DoubleHopf()]
    if kind == "fold":
        return [Cusp(), BogdanovTakensOnFold(), PairOnFold()]
    return []


def _branch(system: System, problem: CurveProblem, found: Trace, span: Span) -> Branch:
    sentence, early = assemble.stopped(found)
    name = f"{_NAMES[problem.kind]}1"
    columns = assemble.columns(found.points) | {
        "values": np.array([p.z[-2:] for p in found.points])
    }
    return Branch(
        name=name,
        kind="curve",
        parameters=problem.path.names,
        state_names=system.field.states,
        states=np.array([problem.realised(p.z)[1] for p in found.points]),
        measures=assemble.measures(found.points),
        special=tuple(_special(system, problem, raw, span, name) for raw in found.special),
        stopped=sentence,
        early=early,
        system=describe(system),
        method=problem.name,
        **columns,
    )


def _special(
    system: System, problem: CurveProblem, raw: RawPoint, span: Span, branch: str
) -> SpecialPoint:
    x = problem.realised(raw.z)[1]
    data: dict[str, Any] = assemble.numbers(raw.data)
    return SpecialPoint(
        label=raw.label,
        name=raw.name,
        branch=branch,
        parameters=dict(zip(problem.path.names, raw.z[-2:], strict=True)),
        state=dict(zip(system.states, x, strict=False)),
        data=data,
        index=raw.index,
        origin=Origin(system, problem, raw, span),
    )
