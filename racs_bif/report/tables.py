"""The page's tables: special points, branches, and how all of it was made."""

from __future__ import annotations

import math
import shlex
from html import escape
from typing import TYPE_CHECKING

from racs_bif.markup import with_unit
from racs_bif.report.names import symbol, unit
from racs_bif.results.special import OPERATING
from racs_bif.results.stability import describe_stability
from racs_bif.units import after

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from racs_bif.results.branch import Branch
    from racs_bif.results.diagram import Diagram
    from racs_bif.results.provenance import SystemInfo
    from racs_bif.results.special import SpecialPoint


def special_table(diagram: Diagram) -> str:
    """Return the special points: where, the exact place and shift, frequency, normal form."""
    system = diagram.branches[0].system
    names = list(dict.fromkeys(name for branch in diagram for name in branch.parameters))
    heads = ["point", "kind", "on"]
    for name in names:
        head = _with_unit(name, system)
        heads += [head, f"exact {symbol(name)}", f"shift of {symbol(name)}"]
    omega = escape(with_unit("@", system.frequency_unit)).replace("@", "<i>ω</i>")
    period = escape(with_unit("period", system.time_unit))
    heads += [omega, "exact <i>ω</i>", "shift of <i>ω</i>", period]
    heads += ["<i>l</i><sub>1</sub>", "exact <i>l</i><sub>1</sub>", ""]
    rows = [
        _special_row(point, branch, names, number)
        for number, branch in enumerate(diagram)
        for point in branch.special
        if point.label not in OPERATING
    ]
    if not rows:
        return "<p>There is no special point in this span.</p>"
    return _table("special", heads, rows)


def branch_table(diagram: Diagram) -> str:
    """Return the branches: how many points, stability, and why they ended."""
    heads = ["branch", "kind", "by", "points", "stability along it", "why it ended"]
    rows = [
        _row(
            escape(branch.name),
            escape(branch.kind),
            escape(branch.method),
            str(len(branch)),
            escape(describe_stability(branch)),
            escape(branch.stopped),
        )
        for branch in diagram
    ]
    return _table("branches", heads, rows)


def origin_table(diagram: Diagram, command: Sequence[str] | None) -> str:
    """Return how the results were made: command, version, model, realisation."""
    system = diagram.branches[0].system
    made = "not known: no summary.json of this run beside it"
    rows = [
        ("command", _code(f"racs-bif {shlex.join(command)}") if command else made),
        ("racs_bif", escape(system.version)),
        ("model", escape(f"{system.model}: {system.title}" if system.title else system.model)),
    ]
    if system.variant:
        rows.append(("variant", escape(system.variant)))
    how = system.realisation
    if how is None:
        rows.append(("realisation", "none: the model has no fractional element"))
    else:
        settings = ", ".join(f"{name} {value:g}" for name, value in how.settings.items())
        told = (
            f"{how.name}, {how.states} states, {how.band[0]:g} to {how.band[1]:g}"
            f"{after(system.frequency_unit)}, largest error there {100.0 * how.error:.2g} %"
        )
        rows.append(("realisation", escape(f"{told}; {settings}" if settings else told)))
    rows.append(("equations", _code(system.equations[:16]) if system.equations else "-"))
    return _table("origin", None, [_row(f"<b>{head}</b>", told) for head, told in rows])


def parameter_table(diagram: Diagram) -> str:
    """Return the parameters; those that vary say between what."""
    system = diagram.branches[0].system
    ends: dict[str, list[float]] = {}
    for branch in diagram:
        for name, column in zip(branch.parameters, branch.values.T, strict=True):
            ends.setdefault(name, []).extend([float(column.min()), float(column.max())])
    rows = []
    for name, value in system.parameters.items():
        told = f"{value:.10g}"
        if name in ends:
            told = f"{min(ends[name]):.7g} to {max(ends[name]):.7g}"
        rows.append(_row(symbol(name), _code(name), told, unit(system.unit(name))))
    return _table("parameters", ["", "name", "value", "unit"], rows)


def notes(system: SystemInfo) -> str:
    """Return what a reader must be told, a paragraph a note."""
    return "".join(f"<p>{escape(note)}</p>" for note in system.notes)


def _special_row(point: SpecialPoint, branch: Branch, names: Sequence[str], number: int) -> str:
    exact = point.exact
    cells = [escape(point.name), escape(point.title), escape(branch.name)]
    for name in names:
        cells.append(_fixed(point.parameters.get(name)))
        cells.append(_fixed(exact.parameters.get(name)) if exact else "-")
        cells.append(_shift(exact.shift.get(name)) if exact else "-")
    cells.append(_fixed(point.data.get("omega")))
    cells.append(_fixed(exact.omega) if exact else "-")
    cells.append(_shift(exact.shift.get("omega")) if exact else "-")
    cells.append(_fixed(point.data.get("period")))
    cells.append(_fixed(point.data.get("l1"), 4))
    cells.append(_fixed(exact.l1, 4) if exact else "-")
    cells.append(escape(str(point.data.get("criticality", ""))))
    place = f' data-branch="{number}" data-index="{point.index}" tabindex="0"'
    return _row(*cells, attributes=place if point.index >= 0 else "")


def _table(name: str, heads: Sequence[str] | None, rows: Iterable[str]) -> str:
    head = ""
    if heads:
        head = f"<thead><tr>{''.join(f'<th>{text}</th>' for text in heads)}</tr></thead>"
    return f'<table id="{name}">{head}<tbody>{"".join(rows)}</tbody></table>'


def _row(*cells: str, attributes: str = "") -> str:
    return f"<tr{attributes}>{''.join(f'<td>{cell}</td>' for cell in cells)}</tr>"


def _with_unit(name: str, system: SystemInfo) -> str:
    units = unit(system.unit(name))
    return f"{symbol(name)} [{units}]" if units else symbol(name)


def _code(text: str) -> str:
    return f"<code>{escape(text)}</code>"


def _fixed(value: object, digits: int = 9) -> str:
    return f"{value:.{digits}g}" if isinstance(value, float) and math.isfinite(value) else "-"


def _shift(value: object) -> str:
    return f"{value:+.2e}" if isinstance(value, float) and math.isfinite(value) else "-"
