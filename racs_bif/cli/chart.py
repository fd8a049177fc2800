"""``racs-bif chart``: the stability chart of a plane of two parameters."""

from __future__ import annotations

import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Final

from racs_bif.cli.chart_options import SIMULATED, configure
from racs_bif.cli.chart_told import FILES, tell, troubles
from racs_bif.cli.curve import default_span
from racs_bif.cli.options import check_span, open_system
from racs_bif.errors import UsageError

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Callable, Iterator, Sequence
    from pathlib import Path

    from racs_bif.results.branch import Branch
    from racs_bif.results.chart import Chart
    from racs_bif.results.chart_slices import ChartSlices

HELP: Final = "the stability chart of a plane of two parameters"
DESCRIPTION: Final = (
    "Trace the boundaries of stability of an equilibrium in the plane of PARAM1 and PARAM2 on the "
    "exact characteristic equation, and count the unstable roots in the regions between them. "
    "Writes chart.nc, chart.png, chart.svg and summary.json."
)
__all__ = ["DESCRIPTION", "FILES", "HELP", "configure", "run"]
TILES: Final = "tiles"


def run(arguments: Namespace) -> int:
    """Compute the chart, write its files and tell what was found."""
    from racs_bif.cli.terminal import warn
    from racs_bif.results.atomic import check_writable
    from racs_bif.verbs.chart import chart_slices, stability_chart

    names = (arguments.first, arguments.second)
    _check(arguments, names)
    check_writable(arguments.out, FILES)
    system = open_system(arguments)
    first, second = (arguments.spans.get(name) or default_span(system, name) for name in names)
    folder = arguments.out / TILES
    options = _options(arguments, names)
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
    tell(result, arguments, summary)
    if result.early:
        warn(f"saved in {arguments.out}, but it may lack something: {troubles(result)}")
    return int(result.early)


def _options(arguments: Namespace, names: tuple[str, str]) -> dict[str, Any]:
    """Return what `racs_bif.stability_chart` is to do besides."""
    from racs_bif.charts.settings import ChartSettings
    from racs_bif.verbs.chart_map import SweepSettings

    marks: dict[str, list[float]] = {}
    for name, value in arguments.marks:
        marks.setdefault(name, []).append(value)
    few = (40, 40) if arguments.quantity in SIMULATED else (200, 200)
    sweep = SweepSettings(
        duration=arguments.duration, watch=arguments.watch or "", start=dict(arguments.start)
    )
    return {
        "marks": marks,
        "lyapunov": arguments.lyapunov,
        "operator": arguments.operator,
        "curves": _curves(arguments.curves, names),
        "quantity": arguments.quantity,
        "shape": tuple(arguments.cells or few),
        "sweep": sweep,
        "workers": arguments.workers,
        "scheduler": arguments.scheduler,
        "tiles": arguments.out / TILES if arguments.quantity else None,
        "resume": arguments.resume,
        "settings": ChartSettings(coarse=min(4, arguments.depth), depth=arguments.depth),
    }


def _curves(paths: Sequence[Path], names: tuple[str, str]) -> list[Branch]:
    """Return the curves in the plane that were saved in files."""
    if not paths:
        return []
    from racs_bif.results.branch import Branch
    from racs_bif.results.diagram import Diagram
    from racs_bif.results.files import load

    found = []
    for path in paths:
        result = load(path)
        branches = [result] if isinstance(result, Branch) else getattr(result, "branches", [])
        mine = [branch for branch in branches if set(branch.parameters) == set(names)]
        if not mine or not isinstance(result, Branch | Diagram):
            msg = (
                f"'{path}' holds no curve in {names[0]} and {names[1]}; give one that "
                f"'racs-bif curve LABEL {names[0]} {names[1]}' saved"
            )
            raise UsageError(msg)
        found += mine
    return found


def _check(arguments: Namespace, names: tuple[str, str]) -> None:
    """Refuse what contradicts itself, before anything is computed."""
    if names[0] == names[1]:
        msg = f"a chart needs two different parameters, not '{names[0]}' twice"
        raise UsageError(msg)
    for name in arguments.spans:
        if name not in names:
            msg = f"--span {name}: the plane is that of {names[0]} and {names[1]}; name one of them"
            raise UsageError(msg)
        check_span(*arguments.spans[name])
    if arguments.resume and not arguments.quantity:
        msg = "--resume goes on with a map; give --map as in the run that was ended"
        raise UsageError(msg)
    shared = arguments.quantity or arguments.slices
    if (arguments.workers or arguments.scheduler) and not shared:
        msg = "--workers and --scheduler compute maps and slices; give --map or --slices"
        raise UsageError(msg)
    simulated = arguments.quantity in SIMULATED
    for option in ("duration", "watch", "start"):
        if getattr(arguments, option) and not simulated:
            msg = f"--{option} is for simulations; give --map {', '.join(SIMULATED)}"
            raise UsageError(msg)
    if arguments.cells and not arguments.quantity:
        msg = "--cells is for a map; give --map"
        raise UsageError(msg)


@contextmanager
def _progress(arguments: Namespace) -> Iterator[Callable[[str, int, int], None] | None]:
    """Show a progress bar on an interactive stderr."""
    from racs_bif.cli.terminal import interactive

    if not interactive(arguments):
        yield None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (TextColumn("{task.description}", markup=False), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(file=sys.stderr), transient=True) as bars:
        task = bars.add_task("searching", total=None)

        def report(what: str, done: int, of: int) -> None:
            text = f"{what}: {done} of {of}" if of else what
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
