"""Results in a notebook, as small tables with units; from the data alone."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.markup import card, paragraph, table, with_unit
from racs_bif.units import SECONDS, after, frequency_unit

if TYPE_CHECKING:
    from racs_bif.results.branch import Branch
    from racs_bif.results.chart import Chart
    from racs_bif.results.diagram import Diagram
    from racs_bif.results.history import TimeHistory
    from racs_bif.results.provenance import SystemInfo
    from racs_bif.results.special import SpecialPoint

_MOST_NUMBERS: Final = 8
"""Numbers of an array that are printed; of a longer one, its shape is."""


def point_card(point: SpecialPoint) -> str:
    """Return a special point as HTML: where it is, what was found, the exact check."""
    units = _units_of(point)
    rows: list[tuple[object, ...]] = []
    exact = point.exact
    for name, value in point.parameters.items():
        solved = None if exact is None else exact.parameters.get(name)
        rows.append((with_unit(name, units.get(name, "")), value, solved))
    rows += [(with_unit(n, units.get(n, "")), v, None) for n, v in point.state.items()]
    for name, found in point.data.items():
        solved = getattr(exact, name, None) if name in {"omega", "l1"} else None
        unit = units.get(name) or units.get(name.removeprefix("max ").removeprefix("min "), "")
        rows.append((with_unit(name, unit), _value(found), solved))
    place = f" on {point.branch}" if point.branch else ""
    head = ("", "value", "on the exact operator")
    return card(f"{point.name}: {point.title}{place}", table(head, rows))


def branch_card(branch: Branch) -> str:
    """Return a branch as HTML: extent, stability, special points, why it ended."""
    return card(
        f"{branch.name}: branch of {_KINDS.get(branch.kind, branch.kind)}, {len(branch)} points",
        paragraph(_of(branch.system)),
        _extent(branch),
        _points(branch, named=False),
        paragraph(branch.stopped),
    )


def diagram_card(diagram: Diagram) -> str:
    """Return a diagram as HTML: its branches and all special points."""
    rows: list[tuple[object, ...]] = []
    for branch in diagram:
        ends = branch.parameter[[0, -1]] if len(branch) else [np.nan, np.nan]
        rows.append((branch.name, branch.kind, len(branch), *map(float, ends), branch.stopped))
    name = diagram.branches[0].parameters[0]
    unit = diagram.branches[0].system.unit(name)
    first = with_unit(f"{name}, first", unit)
    head = ("branch", "kind", "points", first, with_unit("last", unit), "ended")
    return card(
        f"diagram of {len(diagram)} branches",
        paragraph(_of(diagram.branches[0].system)),
        table(head, rows),
        *(_points(branch, named=True) for branch in diagram),
    )


def chart_card(chart: Chart) -> str:
    """Return a stability chart as HTML: its plane, regions and boundaries."""
    from racs_bif.results.chart import describe_count

    units = [chart.system.unit(name) for name in chart.parameters]
    plane = [
        (name, low, high, unit)
        for name, (low, high), unit in zip(chart.parameters, chart.spans, units, strict=True)
    ]
    places = [with_unit(f"at {n}", u) for n, u in zip(chart.parameters, units, strict=True)]
    regions = [
        (describe_count(r.unstable), f"{100.0 * r.area:.3g} %", *map(float, r.place))
        for r in chart.regions
    ]
    boundaries = [
        (b.kind, len(b), b.closed, *_range(b.omega), ", ".join(p.label for p in b.points))
        for b in chart.boundaries
    ]
    omega = with_unit("omega from", chart.system.frequency_unit)
    head = ("boundary", "points", "closed", omega, "to", "marked")
    return card(
        f"stability chart over {' and '.join(chart.parameters)}, {chart.operator} operator",
        paragraph(_of(chart.system)),
        table(("parameter", "from", "to", "unit"), plane),
        table(("region", "share", *places), regions),
        table(head, boundaries),
        *(paragraph(text) for text in (*chart.troubles, *chart.remarks)),
    )


def history_card(history: TimeHistory) -> str:
    """Return a time history as HTML: the range and the error of every column."""
    rows = []
    for name, unit in history.units.items():
        low, high = _range(history.column(name))
        rows.append((with_unit(name, unit), low, high, history.errors.get(name)))
    end = f"{history.times[-1]:g}{after(history.system.time_unit)}"
    return card(
        f"time history to {end}, {len(history)} samples",
        paragraph(_of(history.system)),
        paragraph(f"{history.operator} operator by {history.method}; before: {history.history}"),
        table(("", "least", "greatest", "estimated error"), rows),
        paragraph(history.stopped),
    )


_KINDS: Final = {"equilibrium": "equilibria", "orbit": "periodic orbits", "curve": "a curve"}


def _of(system: SystemInfo) -> str:
    words = system.title or system.model
    if system.variant:
        words += f", variant {system.variant}"
    how = system.realisation
    if how is not None:
        words += f"; realised by {how.name} with {how.states} states (error {how.error:.2g})"
    return words


def _extent(branch: Branch) -> str:
    if not len(branch):
        return ""
    named = dict(zip(branch.parameters, branch.values.T, strict=True))
    for name in branch.system.states:
        if name in branch.state_names:
            named[name] = branch.column(name)
    named |= dict(branch.measures)
    rows = [(with_unit(n, branch.system.unit(n)), *_range(column)) for n, column in named.items()]
    if branch.kind != "curve":
        rows.append(("unstable", *_range(branch.unstable.astype(float))))
    return table(("", "least", "greatest"), rows)


def _points(branch: Branch, *, named: bool) -> str:
    system = branch.system
    heads = [with_unit(name, system.unit(name)) for name in branch.parameters]
    rows: list[tuple[object, ...]] = []
    for p in branch.special:
        where = [p.parameters.get(name) for name in branch.parameters]
        exact = None if p.exact is None else p.exact.parameters.get(branch.parameters[0])
        found = [p.data.get(key) for key in ("omega", "period", "criticality")]
        rows.append((branch.name, p.name, p.title, *where, exact, *found))
    units = {"omega": system.frequency_unit, "period": system.time_unit}
    times = [with_unit(key, unit) for key, unit in units.items()]
    head = ("branch", "point", "kind", *heads, f"{heads[0]}, exact", *times)
    shown = rows if named else [(None, *row[1:]) for row in rows]
    return table((*head, "criticality"), shown)


def _units_of(point: SpecialPoint) -> dict[str, str]:
    """Return units where the point knows its system; one from a file does not."""
    system = getattr(point.origin, "system", None)
    if system is None:
        return {}
    time = getattr(system, "time_unit", SECONDS)
    ours = {"period": time, "omega": frequency_unit(time)}
    table = getattr(system, "parameter_table", ())
    return ours | dict(getattr(system, "state_units", {})) | {p.name: p.unit for p in table}


def _value(value: object) -> object:
    if not isinstance(value, np.ndarray):
        return value if not isinstance(value, complex) else f"{value:.6g}"
    if value.size > _MOST_NUMBERS or value.dtype.kind not in "fc":
        return f"array {value.shape}"
    return ", ".join(f"{number:.6g}" for number in value.ravel())


def _range(column: np.ndarray) -> tuple[float, float]:
    known = column[np.isfinite(column)]
    return (float(known.min()), float(known.max())) if known.size else (np.nan, np.nan)
