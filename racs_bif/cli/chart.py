"""``racs-bif chart``: the stability chart of a plane of two parameters."""

from __future__ import annotations

import argparse
import sys
from contextlib import contextmanager
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from racs_bif.cli.curve import Spans, default_span
from racs_bif.cli.options import add_model_options, add_output_options, check_span, open_system
from racs_bif.cli.parser import Parser, assignment, choice, count, count_or_none, number
from racs_bif.errors import UsageError

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Callable, Iterator

    from racs_bif.results.chart import Chart
    from racs_bif.results.chart_slices import ChartSlices

HELP: Final = "the stability chart of a plane of two parameters"
DESCRIPTION: Final = (
    "Trace the boundaries of stability of an equilibrium in the plane of PARAM1 and PARAM2 on the "
    "exact characteristic equation, and count the unstable roots in the regions between them. "
    "Writes chart.nc, chart.png, chart.svg and summary.json."
)
FILES: Final = ("chart.nc", "chart.png", "chart.svg", "summary.json")
TILES: Final = "tiles"


def configure(parser: Parser) -> None:
    """Add the verb's arguments."""
    parser.add_argument("first", metavar="PARAM1", help="the parameter along the axis")
    parser.add_argument("second", metavar="PARAM2", help="the parameter up the axis")
    parser.add_argument(
        "--span",
        dest="spans",
        nargs=3,
        action=Spans,
        default={},
        metavar=("NAME", "LOW", "HIGH"),
        help="the interval of a parameter, SI; default a tenth to ten times its value",
    )
    parser.add_argument(
        "--mark",
        dest="marks",
        action="append",
        default=[],
        type=assignment,
        metavar="NAME=VALUE",
        help="a value of PARAM1 or PARAM2 at which boundary points are wanted exactly; may be "
        "given several times",
    )
    parser.add_argument(
        "--slices",
        type=slices,
        metavar="NAME=V1,V2,...",
        help="a chart for each of these values of a third parameter, on one figure",
    )
    parser.add_argument(
        "--l1",
        dest="lyapunov",
        action="store_true",
        help="the first Lyapunov coefficient along Hopf boundaries, and where it changes sign (GH)",
    )
    parser.add_argument(
        "--map",
        dest="quantity",
        type=choice("count", "damping"),
        help="a map besides: 'count' of unstable roots, or 'damping' of the rightmost root",
    )
    parser.add_argument(
        "--cells",
        nargs=2,
        type=count,
        default=(200, 200),
        metavar=("N1", "N2"),
        help="cells of the map; default 200 200",
    )
    parser.add_argument(
        "--depth",
        type=count,
        default=7,
        metavar="N",
        help="cells that may hide an island are searched down to 1/2**N of a span; default 7",
    )
    parser.add_argument(
        "--workers",
        type=count_or_none,
        default=0,
        metavar="N",
        help="processes that compute the map; default 0, this one",
    )
    parser.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help="a Dask scheduler that computes the map, tcp://host:port (pip install "
        "'racs-bif[cluster]')",
    )
    parser.add_argument(
        "--resume", action="store_true", help="go on with the map of a run that was ended early"
    )
    add_model_options(parser)
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("racs_bif_out"),
        metavar="DIR",
        help="where the files go; default ./racs_bif_out",
    )
    add_output_options(parser)


def slices(text: str) -> tuple[str, tuple[float, ...]]:
    """Return the name and the values of ``NAME=V1,V2,...``.

    Raises
    ------
    argparse.ArgumentTypeError
        If the text is not of this form.
    """
    name, equals, values = text.partition("=")
    if not equals or not name.strip() or not values.strip():
        msg = f"'{text}' is not NAME=V1,V2,...; write for example u=10,15,20"
        raise argparse.ArgumentTypeError(msg)
    return name.strip(), tuple(number(value.strip()) for value in values.split(","))


def run(arguments: Namespace) -> int:
    """Compute the chart, write its files and tell what was found."""
    from racs_bif.charts.settings import ChartSettings
    from racs_bif.cli.terminal import warn
    from racs_bif.results.atomic import check_writable
    from racs_bif.verbs.chart import chart_slices, stability_chart

    names = (arguments.first, arguments.second)
    _check(arguments, names)
    check_writable(arguments.out, FILES)
    system = open_system(arguments)
    first, second = (arguments.spans.get(name) or default_span(system, name) for name in names)
    marks: dict[str, list[float]] = {}
    for name, value in arguments.marks:
        marks.setdefault(name, []).append(value)
    folder = arguments.out / TILES
    options: dict[str, Any] = {
        "marks": marks,
        "lyapunov": arguments.lyapunov,
        "quantity": arguments.quantity,
        "shape": tuple(arguments.cells),
        "workers": arguments.workers,
        "scheduler": arguments.scheduler,
        "tiles": folder if arguments.quantity else None,
        "resume": arguments.resume,
        "settings": ChartSettings(coarse=min(4, arguments.depth), depth=arguments.depth),
    }
    result: Chart | ChartSlices
    try:
        with _progress(arguments) as report:
            if arguments.slices is None:
                result = stability_chart(
                    system, *names, (first, second), progress=report, **options
                )
            else:
                result = chart_slices(
                    system, *names, (first, second), arguments.slices, progress=report, **options
                )
    except KeyboardInterrupt:
        if not arguments.quantity or not any(folder.glob("**/tile_*.npz")):
            raise
        warn(
            f"interrupted; the tiles so far are in {folder}: the same command with --resume goes on"
        )
        return 1
    summary = _write(result, arguments)
    _forget(folder)
    _tell(result, arguments, summary)
    if result.early:
        warn(f"saved in {arguments.out}, but it may lack something: {_troubles(result)}")
    return int(result.early)


def _check(arguments: Namespace, names: tuple[str, str]) -> None:
    """Refuse what contradicts itself, before anything is computed."""
    if names[0] == names[1]:
        msg = f"a chart needs two different parameters, not '{names[0]}' twice"
        raise UsageError(msg)
    for name in arguments.spans:
        if name not in names:
            msg = f"--span {name}: the plane is that of {names[0]} and {names[1]}"
            raise UsageError(msg)
        check_span(*arguments.spans[name])
    if arguments.resume and not arguments.quantity:
        msg = "--resume goes on with a map; give --map as in the run that was ended"
        raise UsageError(msg)
    if (arguments.workers or arguments.scheduler) and not arguments.quantity:
        msg = "--workers and --scheduler compute maps; give --map count or --map damping"
        raise UsageError(msg)


@contextmanager
def _progress(arguments: Namespace) -> Iterator[Callable[[str, int, int], None] | None]:
    """Show a progress bar on an interactive stderr."""
    if arguments.quiet or not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (TextColumn("{task.description}", markup=False), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(file=sys.stderr), transient=True) as bars:
        task = bars.add_task("searching", total=None)

        def report(what: str, done: int, of: int) -> None:
            text = f"{what}: {done} of {of} tiles" if of else what
            bars.update(task, description=text, completed=done, total=of or None)

        yield report


def _write(result: Chart | ChartSlices, arguments: Namespace) -> str:
    """Write all files, whole or not at all, and return the summary's text."""
    from racs_bif import __version__
    from racs_bif.plots.chart import picture, picture_slices
    from racs_bif.plots.style import save_picture
    from racs_bif.results.atomic import staged
    from racs_bif.results.chart import Chart
    from racs_bif.results.chart_summary import summarise_chart
    from racs_bif.results.files import save
    from racs_bif.results.summary import to_text, write_summary

    summary = summarise_chart(result, arguments.command, __version__)
    figure = picture(result) if isinstance(result, Chart) else picture_slices(result)
    with staged(arguments.out) as folder:
        save(result, folder / FILES[0])
        save_picture(figure, folder / FILES[1])
        save_picture(figure, folder / FILES[2])
        write_summary(summary, folder / FILES[3])
    return to_text(summary)


def _forget(folder: Path) -> None:
    """Remove tiles that are in the chart's file now."""
    from contextlib import suppress

    for path in sorted(folder.glob("**/*"), reverse=True):
        if path.is_dir():
            with suppress(OSError):
                path.rmdir()
        elif path.name == "map.json" or path.suffix in {".npz", ".part"}:
            path.unlink()
    with suppress(OSError):
        folder.rmdir()


def _tell(result: Chart | ChartSlices, arguments: Namespace, summary: str) -> None:
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
    from rich.table import Table

    from racs_bif.results.chart import describe_count
    from racs_bif.results.chart_summary import GRID

    table = Table(
        title="\nRegions",
        title_justify="left",
        title_style="bold",
        box=None,
        pad_edge=False,
        collapse_padding=True,
    )
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
    table = Table(
        title="\nBoundaries",
        title_justify="left",
        title_style="bold",
        box=None,
        pad_edge=False,
        collapse_padding=True,
    )
    for title in ("", "", *chart.parameters, "rad/s", "l1"):
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
    for remark in chart.remarks:
        screen.print(remark)


def _troubles(result: Chart | ChartSlices) -> str:
    from racs_bif.results.chart import Chart

    charts = [result] if isinstance(result, Chart) else list(result.charts)
    told = [trouble for chart in charts for trouble in chart.troubles]
    told += [b.stopped for chart in charts for b in chart.boundaries if not b.complete]
    return " | ".join(dict.fromkeys(told))
