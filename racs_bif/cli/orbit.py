"""``racs-bif orbit``: one periodic orbit, its period, extremes, multipliers and picture."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Final

from racs_bif.cli.options import (
    add_model_options,
    add_output_options,
    add_realisation_options,
    open_system,
)
from racs_bif.cli.parser import Parser, assignment, choice, number
from racs_bif.errors import UsageError
from racs_bif.units import after

if TYPE_CHECKING:
    from argparse import Namespace

    from rich.table import Table

    from racs_bif.fractional.system import System
    from racs_bif.results.branch import Branch

HELP: Final = "one periodic orbit: period, extremes, multipliers, picture"
DESCRIPTION: Final = (
    "Find the periodic orbit of a model at its parameters, as in 'orbit --set u=12'. It is "
    "followed from the nearest Hopf point along the parameter that is set first; where that leads "
    "nowhere, a simulation is left to settle on it. Writes orbit.nc, orbit.png, orbit.svg and "
    "summary.json."
)
FILES: Final = ("orbit.nc", "orbit.png", "orbit.svg", "summary.json")
DEFAULT_OUT: Final = "racs_bif_out"
METHODS: Final = ("collocation", "shooting", "harmonic-balance")
STARTS: Final = ("hopf", "simulate")
_MEMORY: Final = 0.95
"""Least modulus of a multiplier that is taken for the memory's, not the model's."""
_ROWS: Final = 12


def configure(parser: Parser) -> None:
    """Add the verb's arguments."""
    parser.add_argument(
        "--along",
        metavar="PARAM",
        help="the parameter along which it is looked for; default the first that is --set",
    )
    parser.add_argument(
        "--method",
        type=choice(*METHODS),
        default=METHODS[0],
        metavar="METHOD",
        help="collocation (default), shooting, or harmonic-balance on the exact operator",
    )
    parser.add_argument(
        "--start",
        type=choice(*STARTS),
        metavar="WAY",
        help="hopf, from the nearest Hopf point, or simulate; default the first, then the second",
    )
    parser.add_argument(
        "--span",
        nargs=2,
        type=number,
        metavar=("LOW", "HIGH"),
        help="where Hopf points are looked for; default a tenth to ten times the value",
    )
    parser.add_argument("--time", type=number, metavar="T", help="length of the simulation, s")
    parser.add_argument(
        "--initial",
        action="append",
        default=[],
        type=assignment,
        metavar="NAME=VALUE",
        help="a state at the beginning of the simulation; may be given several times",
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
        metavar="NAME",
        help="horizontal axis of the phase portrait; default what the model suggests",
    )
    add_output_options(parser)


def run(arguments: Namespace) -> int:
    """Find the orbit, write its files and tell what was found."""
    from racs_bif.cli.options import check_span
    from racs_bif.cli.terminal import progress
    from racs_bif.results.atomic import check_writable
    from racs_bif.verbs.orbit import find_orbit

    if arguments.span is not None:
        check_span(*arguments.span)
    check_writable(arguments.out, FILES)
    system = open_system(arguments)
    name = _along(arguments, system)
    value = system.parameters[name]
    with progress(arguments) as task:
        orbit = find_orbit(
            system,
            name,
            start=arguments.start,
            method=arguments.method,
            span=None if arguments.span is None else (arguments.span[0], arguments.span[1]),
            duration=arguments.time,
            initial=dict(arguments.initial),
            progress=task(f"towards {name} = {value:g}", (0.1 * value, max(value, 1e-300))),
        )
    _tell(orbit, arguments, _write(orbit, arguments))
    return 0


def _along(arguments: Namespace, system: System) -> str:
    """Return the parameter along which the orbit is looked for; refuse unknown names."""
    from racs_bif.errors import nearest
    from racs_bif.symbolic.model import find_parameter

    if arguments.state is not None and arguments.state not in system.own:
        msg = f"unknown state '{arguments.state}'; {nearest(arguments.state, system.own)}"
        raise UsageError(msg)
    names = [p.name for p in system.parameter_table]
    if arguments.along is not None:
        return find_parameter(arguments.along, names)
    if not arguments.values:
        msg = "along which parameter? Say --set NAME=VALUE or --along NAME, for example --set u=12"
        raise UsageError(msg)
    first: str = arguments.values[0][0]
    return find_parameter(first, names)


def _write(orbit: Branch, arguments: Namespace) -> str:
    """Write all files, whole or not at all, and return the summary's text."""
    from racs_bif import __version__
    from racs_bif.plots.orbit import orbit_picture
    from racs_bif.plots.style import save_picture
    from racs_bif.results.atomic import staged
    from racs_bif.results.diagram import Diagram
    from racs_bif.results.files import save
    from racs_bif.results.summary import summarise, to_text, write_summary

    summary = summarise(Diagram(orbit), arguments.command, __version__)
    figure = orbit_picture(orbit, state=arguments.state)
    with staged(arguments.out) as folder:
        save(orbit, folder / FILES[0])
        save_picture(figure, folder / FILES[1])
        save_picture(figure, folder / FILES[2])
        write_summary(summary, folder / FILES[3])
    return to_text(summary)


def _tell(orbit: Branch, arguments: Namespace, summary: str) -> None:
    from racs_bif.cli.tables import heading
    from racs_bif.cli.terminal import console

    if arguments.json:
        print(summary, end="")
    screen = console(arguments)
    screen.print(heading(orbit.system))
    point = orbit.special[-1]
    name = orbit.parameters[0]
    unstable = int(orbit.unstable[-1])
    stability = {-1: "stability not known", 0: "stable"}.get(unstable, f"unstable ({unstable})")
    screen.print(
        f"\nOrbit at {name} = {point.parameters[name]:.8g} by {orbit.method}: period "
        f"{point.period:.8g}{after(orbit.system.time_unit)}, "
        f"{2.0 * math.pi / point.period:.6g}{after(orbit.system.frequency_unit)}, {stability}"
    )
    screen.print(orbit.stopped)
    for table in (extremes_table(orbit), multiplier_table(orbit)):
        screen.print(table)
    _tell_memory(orbit, screen.print)
    for note in orbit.system.notes:
        screen.print(f"\nNote: {note}")
    screen.print(f"\nWrote {', '.join(FILES)} to {arguments.out.resolve()}", soft_wrap=True)


def _tell_memory(orbit: Branch, say: object) -> None:
    """Say that slow multipliers of a fractional model are those of its realised memory."""
    others = abs(orbit.spectrum[-1][1:])
    slow = int(((others > _MEMORY) & (others < 1.0)).sum())
    if orbit.system.realisation is not None and slow and callable(say):
        say(
            f"\n{slow} multipliers between {_MEMORY:g} and 1: slow ones like these belong to the "
            "realisation's memory, not to the model."
        )


def extremes_table(orbit: Branch) -> Table:
    """Return least and greatest values of the states of one orbit, and its mean sign of health."""
    table = _table("Extremes", ("state", "least", "greatest"))
    for name in orbit.profiles[orbit.special[-1].name].names:
        unit = orbit.system.unit(name)
        low, high = orbit.column(f"min {name}")[-1], orbit.column(f"max {name}")[-1]
        table.add_row(f"{name} [{unit}]" if unit else name, f"{low:.8g}", f"{high:.8g}")
    return table


def multiplier_table(orbit: Branch) -> Table:
    """Return the multipliers of one orbit, the trivial one first, then by falling modulus."""
    row = orbit.spectrum[-1]
    values = [value for value in row if not math.isnan(abs(value))]  # NaN fills the row
    table = _table("Multipliers", ("", "real", "imaginary", "modulus", ""))
    for k, value in enumerate(values[:_ROWS]):
        size = abs(value)
        told = "trivial" if k == 0 else "unstable" if size > 1.0 else ""
        table.add_row(str(k + 1), f"{value.real:.7g}", f"{value.imag:.7g}", f"{size:.7g}", told)
    if len(values) > _ROWS:
        table.add_row("", "", "", "", f"and {len(values) - _ROWS} smaller ones")
    return table


def _table(title: str, columns: tuple[str, ...]) -> Table:
    from racs_bif.cli.tables import titled_table

    table = titled_table(title)
    table.add_column(columns[0], no_wrap=True)
    for column in columns[1:]:
        table.add_column(column, justify="right" if column else "left", no_wrap=True)
    return table
