"""Tables of a diagram for the terminal; they fit 80 columns."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from rich.table import Table

from racs_bif.results.special import OPERATING
from racs_bif.results.stability import describe_stability
from racs_bif.units import after, cycles_unit

if TYPE_CHECKING:
    from racs_bif.results.branch import Branch
    from racs_bif.results.diagram import Diagram
    from racs_bif.results.provenance import SystemInfo
    from racs_bif.results.special import SpecialPoint

_NONE: Final = "-"
_ROUNDING: Final = 1e-12


def heading(system: SystemInfo) -> str:
    """Return the lines above the tables: which model, and how it was realised."""
    variant = f", variant {system.variant}" if system.variant else ""
    title = f": {system.title}" if system.title else ""
    lines = [f"{system.model}{variant}{title}"]
    if system.realisation is not None:
        how = system.realisation
        lines.append(
            f"realisation {how.name}, {how.states} states, {how.band[0]:g} to {how.band[1]:g}"
            f"{after(system.frequency_unit)}, largest error there {100 * how.error:.2g} %"
        )
    return "\n".join(lines)


def special_table(diagram: Diagram) -> Table:
    """Return the special points: where, how far from the exact one, frequency, criticality."""
    system = diagram.branches[0].system
    name = diagram.branches[0].parameters[0]
    table = titled_table("Special points")
    table.add_column("point", no_wrap=True)
    table.add_column("on", no_wrap=True)
    times = system.frequency_unit or "omega", cycles_unit(system.time_unit) or "omega/2pi"
    exact = ("exact", "shift") if system.realisation is not None else ()
    for title in (_with_unit(name, system), *exact, *times, "l1"):
        table.add_column(title, justify="right", no_wrap=True)
    table.add_column("")
    for branch in diagram:
        for point in branch.special:
            if point.label not in OPERATING:
                table.add_row(*_special_row(point, branch, name, exact=bool(exact)))
    return table


def operating_table(diagram: Diagram) -> Table:
    """Return the points the user asked for: state or range, period, stability."""
    system = diagram.branches[0].system
    name, shown = diagram.branches[0].parameters[0], system.shown or system.states[0]
    table = titled_table("Points asked for")
    table.add_column("point", no_wrap=True)
    table.add_column("on", no_wrap=True)
    for title in (
        _with_unit(name, system),
        _with_unit(shown, system),
        _with_unit("period", system),
    ):
        table.add_column(title, justify="right", no_wrap=True)
    table.add_column("", no_wrap=True)
    for branch in diagram:
        for point in branch.special:
            if point.label == "UZ":
                table.add_row(*_operating_row(point, branch, name, shown))
    return table


def branch_table(diagram: Diagram) -> Table:
    """Return the branches: how many points, stability, and why they ended."""
    table = titled_table("Branches")
    table.add_column("branch", no_wrap=True)
    table.add_column("points", justify="right", no_wrap=True)
    table.add_column(f"stability along {diagram.branches[0].parameters[0]}, and why it ended")
    for branch in diagram:
        told = describe_stability(branch)
        table.add_row(branch.name, str(len(branch)), f"{told}\n{branch.stopped}")
    return table


def titled_table(title: str) -> Table:
    """Return an empty table with a heading, as the terminal shows all of them."""
    return Table(
        title=f"\n{title}",
        title_justify="left",
        title_style="bold",
        box=None,
        pad_edge=False,
        collapse_padding=True,
    )


def _special_row(point: SpecialPoint, branch: Branch, name: str, *, exact: bool) -> list[str]:
    omega, there = _frequency(point, branch), point.exact
    size = float(abs(branch.parameter).max())
    shift = [
        _near_zero(there.parameters.get(name), size) if there else _NONE,
        _short(there.shift.get(name)) if there else _NONE,
    ]
    return [
        point.name,
        point.branch,
        _near_zero(point.parameters.get(name), size),
        *(shift if exact else ()),
        _fixed(omega),
        _fixed(omega / (2 * math.pi), 5),
        _fixed(point.data.get("l1"), 4),
        str(point.data.get("criticality", point.title)),
    ]


def _frequency(point: SpecialPoint, branch: Branch) -> float:
    """Return the frequency of a Hopf point, or of the orbit itself; NaN if there is none."""
    if "period" in branch.measures and point.index >= 0:
        return 2 * math.pi / float(branch.measures["period"][point.index])
    omega = point.data.get("omega")
    return omega if isinstance(omega, float) else math.nan


def _operating_row(point: SpecialPoint, branch: Branch, name: str, shown: str) -> list[str]:
    k = point.index
    if f"max {shown}" in branch.measures:
        low, high = branch.column(f"min {shown}")[k], branch.column(f"max {shown}")[k]
        value = f"{_fixed(low)} to {_fixed(high)}"
    elif shown in branch.state_names or shown in branch.measures:
        value = _fixed(float(branch.column(shown)[k]))
    else:
        value = _NONE
    unstable = int(branch.unstable[k])
    told = {-1: _NONE, 0: "stable"}.get(unstable, f"unstable ({unstable})")
    period = branch.measures["period"][k] if "period" in branch.measures else None
    return [
        point.name,
        branch.name,
        _fixed(point.parameters.get(name)),
        value,
        _fixed(period),
        told,
    ]


def _with_unit(name: str, system: SystemInfo) -> str:
    unit = system.unit(name)
    return f"{name} [{unit}]" if unit else name


def _fixed(value: object, digits: int = 7) -> str:
    return f"{value:.{digits}g}" if isinstance(value, float) and math.isfinite(value) else _NONE


def _near_zero(value: object, size: float) -> str:
    """Return a number as `_fixed` does; 0 where it is rounding beside `size`."""
    rounded = isinstance(value, float) and abs(value) <= _ROUNDING * size
    return "0" if rounded else _fixed(value)


def _short(value: object) -> str:
    return f"{value:.1e}" if isinstance(value, float) and math.isfinite(value) else _NONE
