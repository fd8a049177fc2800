"""What ``racs-bif chart`` tells on the screen."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING, Any, Final

from racs_bif.units import after

if TYPE_CHECKING:
    from argparse import Namespace

    from racs_bif.results.chart import Chart
    from racs_bif.results.chart_map import ChartMap
    from racs_bif.results.chart_slices import ChartSlices

FILES: Final = ("chart.nc", "chart.png", "chart.svg", "summary.json")


def tell(result: Chart | ChartSlices, arguments: Namespace, summary: str) -> None:
    """Tell what was found, and where it was written."""
    from racs_bif.cli.tables import heading
    from racs_bif.cli.terminal import console
    from racs_bif.results.chart import Chart

    if arguments.json:
        print(summary, end="")
    screen = console(arguments)
    charts = [result] if isinstance(result, Chart) else list(result.charts)
    screen.print(heading(charts[0].system).splitlines()[0])
    for chart in charts:
        if not isinstance(result, Chart):
            value = chart.system.parameters[result.parameter]
            screen.print(f"\n{result.parameter} = {value:g}", style="bold")
        _tell_chart(chart, screen)
    for note in charts[0].system.notes:
        screen.print(f"\nNote: {note}")
    screen.print(f"\nWrote {', '.join(FILES)} to {arguments.out.resolve()}", soft_wrap=True)


def _tell_chart(chart: Chart, screen: Any) -> None:  # noqa: ANN401 - rich's console
    from racs_bif.cli.tables import titled_table
    from racs_bif.results.chart import describe_count
    from racs_bif.results.chart_summary import GRID

    table = titled_table("Regions")
    table.add_column("", no_wrap=True)
    for title in ("% of plane", *(f"at {name}" for name in chart.parameters)):
        table.add_column(title, justify="right", no_wrap=True)
    for region in chart.regions:
        table.add_row(
            describe_count(region.unstable),
            f"{100 * region.area:.3g}",
            *(f"{value:.5g}" for value in region.place),
        )
    screen.print(table)
    table = titled_table("Boundaries")
    for title in ("", "", *chart.parameters, chart.system.frequency_unit or "omega", "l1"):
        table.add_column(title, justify="left" if not title else "right", no_wrap=True)
    for k, boundary in enumerate(chart.boundaries):
        shape = "closed" if boundary.closed else f"{len(boundary)} points"
        table.add_row(f"{k + 1} {boundary.kind}", shape)
        for name, at in (("first", 0), ("last", len(boundary) - 1)):
            numbers = (*boundary.values[at], boundary.omega[at], boundary.l1[at])
            table.add_row("", name, *(f"{x:.7g}" if isfinite(x) else "-" for x in numbers))
        for point in boundary.points:
            numbers = (*point.parameters.values(), point.data.get("omega", float("nan")))
            table.add_row("", point.label, *(f"{x:.7g}" if isfinite(x) else "-" for x in numbers))
    screen.print(table if chart.boundaries else "\nNo boundary in this plane.")
    ratio = chart.per_count * GRID**2 / max(chart.evaluations, 1)
    screen.print(
        f"\n{chart.evaluations} characteristic evaluations, {chart.seconds:.1f} s; "
        f"a {GRID} x {GRID} grid takes {ratio:.0f} times as many."
    )
    if chart.map is not None:
        screen.print(_map(chart, chart.map))
    for remark in chart.remarks:
        screen.print(remark)


def _map(chart: Chart, found: ChartMap) -> str:
    """Return what a map tells in words."""
    cells = "{} x {} cells".format(*found.unstable.shape)
    if found.sweep is None:
        return f"\nMap of {found.quantity}, {cells}, {found.unknown} unknown."
    sweep = found.sweep
    known = [float(value) for value in sweep.value.flat if isfinite(value)]
    unit = found.unit(chart.system)
    range_ = f"{min(known):.4g} to {max(known):.4g} {unit}".rstrip() if known else "nothing"
    tally = ", ".join(f"{n} {text}" for text, n in sweep.tally.items() if n)
    of = "" if found.quantity == "lyapunov" else f" of {sweep.watch}"
    each = f"{sweep.duration:.4g}{after(chart.system.time_unit)} each"
    return f"\nMap of {found.quantity}{of}, {cells}, {each}: {range_}; {tally}."


def troubles(result: Chart | ChartSlices) -> str:
    """Return in one line what may be missing."""
    from racs_bif.results.chart import Chart

    charts = [result] if isinstance(result, Chart) else list(result.charts)
    told = [trouble for chart in charts for trouble in chart.troubles]
    told += [b.stopped for chart in charts for b in chart.boundaries if not b.complete]
    return " | ".join(dict.fromkeys(told))
