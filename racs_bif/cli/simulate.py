"""``racs-bif simulate``: one time history of the exact fractional operator or its realisation."""

from __future__ import annotations

import math
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Final

from racs_bif.cli.options import (
    add_model_options,
    add_output_options,
    add_realisation_options,
    open_system,
)
from racs_bif.cli.parser import Parser, assignment, choice, number
from racs_bif.errors import UsageError
from racs_bif.markup import with_unit
from racs_bif.units import after

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Callable

    from rich.table import Table

    from racs_bif.cli.terminal import Report, Task
    from racs_bif.fractional.system import System
    from racs_bif.results.history import TimeHistory

HELP: Final = "one time history, with the exact fractional operator or its realisation"
DESCRIPTION: Final = (
    "Integrate a model in time. The exact fractional operator remembers its whole past; the "
    "realised one is an ordinary differential equation. Writes history.nc, history.png, "
    "history.svg and summary.json."
)
FILES: Final = ("history.nc", "history.png", "history.svg", "summary.json")
DEFAULT_OUT: Final = "racs_bif_out"
OPERATORS: Final = ("exact", "realised")
METHODS: Final = ("bdf2", "l1", "fast", "lsoda", "radau")
HISTORIES: Final = ("rest", "constant", "equilibrium")


def configure(parser: Parser) -> None:
    """Add the verb's arguments."""
    parser.add_argument(
        "--time", type=number, required=True, metavar="T", help="how long, from t = 0 [s]"
    )
    parser.add_argument(
        "--operator",
        type=choice(*OPERATORS),
        default=OPERATORS[0],
        metavar="NAME",
        help="exact (default) or realised",
    )
    parser.add_argument(
        "--method",
        type=choice(*METHODS),
        metavar="NAME",
        help="exact: bdf2 (default), l1, or fast, whose steps do not get slower; realised: lsoda "
        "(default) or radau",
    )
    parser.add_argument(
        "--initial",
        action="append",
        default=[],
        type=assignment,
        metavar="NAME=VALUE",
        help="a state at t = 0; may be given several times. Others are zero after the history "
        "'rest', and at equilibrium otherwise",
    )
    parser.add_argument(
        "--history",
        type=choice(*HISTORIES),
        default=HISTORIES[0],
        metavar="NAME",
        help="what was before t = 0: rest (default), nothing; constant, the initial state; "
        "equilibrium",
    )
    parser.add_argument(
        "--change",
        nargs=2,
        action="append",
        default=[],
        metavar=("TIME", "NAME=VALUE"),
        help="a parameter that has another value from a time on; may be given several times",
    )
    parser.add_argument(
        "--step",
        type=number,
        metavar="H",
        help="largest step (exact) or distance of samples (realised), s; default: the exact "
        "operator's step is halved until the tolerance is reached",
    )
    parser.add_argument(
        "--tolerance",
        type=number,
        metavar="TOL",
        help="without --step, error relative to every state's range, default 1e-3; of a step of "
        "the realised model, default 1e-8",
    )
    parser.add_argument(
        "--extrapolate",
        action="store_true",
        help="combine the runs at the step and at twice the step (exact)",
    )
    add_model_options(parser)
    add_realisation_options(parser)
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(DEFAULT_OUT),
        metavar="DIR",
        help=f"where the files go; default ./{DEFAULT_OUT}",
    )
    parser.add_argument(
        "--state",
        nargs="+",
        action="extend",
        default=[],
        metavar="NAME",
        help="what the picture shows, a strip for each; default what the model suggests",
    )
    add_output_options(parser)


def run(arguments: Namespace) -> int:
    """Integrate, write the files and tell what was found."""
    from racs_bif.cli.terminal import progress, warn
    from racs_bif.results.atomic import check_writable
    from racs_bif.verbs.simulate import simulate

    inputs = _changes(arguments.change)
    check_writable(arguments.out, FILES)
    system = open_system(arguments)
    _check_names(arguments, system, inputs)
    with progress(arguments) as task:
        history = simulate(
            system,
            arguments.time,
            operator=arguments.operator,
            method=arguments.method,
            initial=dict(arguments.initial),
            history=arguments.history,
            inputs=inputs,
            step=arguments.step,
            tolerance=arguments.tolerance,
            extrapolate=arguments.extrapolate,
            progress=_reporter(task, arguments.time),
        )
    _tell(history, arguments, _write(history, arguments))
    if history.early:
        warn(f"ended early, saved what there is in {arguments.out}: {history.stopped}")
    return int(history.early)


def _changes(given: list[list[str]]) -> dict[str, dict[float, float]]:
    """Return the values that parameters take, by name and time.

    Raises
    ------
    UsageError
        If a text is no time or no assignment.
    """
    from argparse import ArgumentTypeError

    inputs: dict[str, dict[float, float]] = {}
    for time, text in given:
        try:
            at = number(time)
            name, value = assignment(text)
        except ArgumentTypeError as inner:
            msg = f"--change: {inner}"
            raise UsageError(msg) from None
        inputs.setdefault(name, {})[at] = value
    return inputs


def _check_names(
    arguments: Namespace, system: System, inputs: dict[str, dict[float, float]]
) -> None:
    """Refuse what would be found out only after computing."""
    known = (*system.states, *system.compiled.elements, *system.outputs, *inputs)
    for name in arguments.state:
        if name not in known:
            from racs_bif.errors import nearest

            msg = f"unknown state '{name}'; {nearest(name, known)}"
            raise UsageError(msg)


def _reporter(task: Task, duration: float) -> Callable[[float], None]:
    """Return what is called with the time; every run has its own bar."""
    report: Report | None = None
    last, runs = float("inf"), 0

    def told(time: float) -> None:
        nonlocal report, last, runs
        if time < last:
            runs += 1
            report = task(f"run {runs}", (0.0, duration))
        last = time
        if report is not None:
            report(SimpleNamespace(parameter=time))

    return told


def _write(history: TimeHistory, arguments: Namespace) -> str:
    """Write all files, whole or not at all, and return the summary's text."""
    from racs_bif import __version__
    from racs_bif.plots.history import picture
    from racs_bif.plots.style import save_picture
    from racs_bif.results.atomic import staged
    from racs_bif.results.files import save
    from racs_bif.results.history_summary import summarise_history
    from racs_bif.results.summary import to_text, write_summary

    summary = summarise_history(history, arguments.command, __version__)
    figure = picture(history, *arguments.state)
    with staged(arguments.out) as folder:
        save(history, folder / FILES[0])
        save_picture(figure, folder / FILES[1])
        save_picture(figure, folder / FILES[2])
        write_summary(summary, folder / FILES[3])
    return to_text(summary)


def _tell(history: TimeHistory, arguments: Namespace, summary: str) -> None:
    from racs_bif.cli.tables import heading
    from racs_bif.cli.terminal import console

    if arguments.json:
        print(summary, end="")
    screen = console(arguments)
    screen.print(heading(history.system))
    step = (
        f", step {history.step:g}{after(history.system.time_unit)}"
        if math.isfinite(history.step)
        else ""
    )
    screen.print(
        f"{history.operator} operator by {history.method}{step}, history '{history.history}', "
        f"{history.times[-1]:g}{after(history.system.time_unit)}"
    )
    screen.print(_table(history))
    for note in history.system.notes:
        screen.print(f"\nNote: {note}")
    screen.print(f"\nWrote {', '.join(FILES)} to {arguments.out.resolve()}", soft_wrap=True)


def _table(history: TimeHistory) -> Table:
    from racs_bif.cli.tables import titled_table
    from racs_bif.results.history_summary import column_summary

    table = titled_table("Range and period in the second half")
    table.add_column("", no_wrap=True)
    for title in (
        "least",
        "greatest",
        with_unit("period", history.system.time_unit),
        "at the end",
        "error",
    ):
        table.add_column(title, justify="right", no_wrap=True)
    for name in history.names:
        told = column_summary(history, name)
        unit = history.units[name]
        label = f"{name} [{unit}]" if unit else name
        numbers = [told["min"], told["max"], told["period"], told["last"]]
        error = told["error"]
        table.add_row(
            label,
            *(f"{x:.6g}" if isinstance(x, float) else "-" for x in numbers),
            f"{error:.1e}" if isinstance(error, float) else "-",
        )
    return table
