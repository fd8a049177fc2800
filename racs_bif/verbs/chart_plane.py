"""The plane of a chart, checked before anything is computed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from racs_bif.charts.plane import Plane
from racs_bif.errors import UsageError, nearest
from racs_bif.fractional.rational import RationalSystem
from racs_bif.results.chart_curve import ChartCurve, curve_of
from racs_bif.shelf.load import system_of
from racs_bif.verbs.equilibria import check_span

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from racs_bif.fractional.system import System
    from racs_bif.results.branch import Branch
    from racs_bif.symbolic.model import Model

    Span = tuple[float, float]

OPERATORS: Final = ("exact", "realised")


def plane_of(
    model: Model | System,
    names: tuple[str, str],
    spans: tuple[Span, Span],
    at: Mapping[str, float],
    operator: str,
) -> Plane:
    """Return the plane of a chart.

    Raises
    ------
    UsageError
        If the parameters are the same, move the same, or are held; a span is empty; or the operator
        is unknown.
    ParameterError
        If a parameter is unknown, or a span leaves the model's validity.
    """
    if operator not in OPERATORS:
        msg = f"unknown operator '{operator}'; {nearest(operator, OPERATORS)}"
        raise UsageError(msg)
    system = system_of(model)
    if names[0] == names[1]:
        msg = f"a chart needs two different parameters, not '{names[0]}' twice"
        raise UsageError(msg)
    low, high = (check_span(system, n, s) for n, s in zip(names, spans, strict=True))
    for name in at:
        if name in names:
            msg = f"'{name}' is varied, it cannot be held as well; leave it out"
            raise UsageError(msg)
    system = system.with_parameters(at) if at else system
    if operator == "realised" and system.fractional:
        system = RationalSystem.of(system)
    system.path(*names)  # refuses two that move the same
    return Plane(system, names, (low, high))


def check_marks(plane: Plane, marks: Mapping[str, Sequence[float]]) -> None:
    """Refuse values at which no boundary point can be wanted.

    Raises
    ------
    UsageError
        If one is of no parameter of the plane, or outside its span.
    """
    spans = dict(zip(plane.names, plane.spans, strict=True))
    for name, values in marks.items():
        if name not in spans:
            msg = f"points must be wanted at values of {' or '.join(plane.names)}, not of '{name}'"
            raise UsageError(msg)
        low, high = spans[name]
        for value in values:
            if not low <= value <= high:
                msg = f"{name} = {value:g} is outside its span {low:g} to {high:g}; widen the span"
                raise UsageError(msg)


def curves_over(plane: Plane, curves: Sequence[Branch | ChartCurve]) -> tuple[ChartCurve, ...]:
    """Return curves of two parameters as curves over a chart.

    Raises
    ------
    UsageError
        If one is not in the chart's plane, or was computed at other parameters.
    """
    compiled, system = plane.system.compiled, plane.system
    derived = {d.name: d.sets for d in compiled.derived}
    loose = {*derived, *(sets for name, sets in derived.items() if name in plane.names)}
    return tuple(
        curve
        if isinstance(curve, ChartCurve)
        else curve_of(curve, plane.names, system.parameters, loose=loose)
        for curve in curves
    )
