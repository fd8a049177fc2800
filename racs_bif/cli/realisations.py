"""``racs-bif realisations``: all realisations of a model's fractional elements in a table."""

from __future__ import annotations

import argparse
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from racs_bif.cli.options import add_model_options, add_output_options, open_system
from racs_bif.cli.parser import Parser, count, number
from racs_bif.units import after

if TYPE_CHECKING:
    from argparse import Namespace

    from racs_bif.fractional.compare import Comparison
    from racs_bif.verbs.realisations import RealisationTable

HELP: Final = "compare the realisations of a model's fractional elements"
DESCRIPTION: Final = (
    "Compare all realisations of a model's fractional elements: states, static gain, error over "
    "the band, poles, passivity and, with --along, the Hopf point that each of them yields. "
    "Writes realisations.png, realisations.svg and summary.json."
)
FILES: Final = ("realisations.png", "realisations.svg", "summary.json")


class _Along(argparse.Action):
    """Read a parameter's name and two numbers."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: Namespace,
        values: Any,  # noqa: ANN401 - as argparse has it
        *_: object,
    ) -> None:
        """Store (name, low, high)."""
        try:
            setattr(namespace, self.dest, (values[0], number(values[1]), number(values[2])))
        except argparse.ArgumentTypeError as error:
            parser.error(f"--along: {error}")


def configure(parser: Parser) -> None:
    """Add the verb's arguments."""
    parser.add_argument(
        "--along",
        nargs=3,
        action=_Along,
        metavar=("PARAM", "LOW", "HIGH"),
        help="compare by the first Hopf point as PARAM goes from LOW to HIGH, too",
    )
    parser.add_argument(
        "--band",
        nargs=2,
        type=number,
        metavar=("LOW", "HIGH"),
        help="band of the realisations, rad/s; default the model's",
    )
    parser.add_argument(
        "--sections",
        type=count,
        metavar="N",
        help="order or sections of each realisation; default each one's own",
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


def run(arguments: Namespace) -> int:
    """Compare, write the files and print the table."""
    from racs_bif.cli.terminal import working
    from racs_bif.plots.realisations import picture
    from racs_bif.plots.style import save_picture
    from racs_bif.results.atomic import check_writable, staged
    from racs_bif.results.summary import to_json, to_text, write_summary
    from racs_bif.verbs.realisations import compare_realisations

    check_writable(arguments.out, FILES)
    band = None if arguments.band is None else (arguments.band[0], arguments.band[1])
    system = open_system(arguments)
    with working(arguments, "comparing realisations"):
        table = compare_realisations(
            system, along=arguments.along, band=band, order=arguments.sections or 0
        )
    whole = {
        "schema": 1,
        "version": table.system.version,
        "command": arguments.command,
        "model": table.system.model,
        "variant": table.system.variant,
        "parameters": dict(table.system.parameters),
        "hopf": dict(table.hopf),
        "realisations": [asdict(row) for row in table.rows],
    }
    summary = {key: to_json(value) for key, value in whole.items()}
    figure = picture(table)
    with staged(arguments.out) as folder:
        save_picture(figure, folder / FILES[0])
        save_picture(figure, folder / FILES[1])
        write_summary(summary, folder / FILES[2])
    if arguments.json:
        print(to_text(summary), end="")
    _tell(table, arguments)
    return 0


def _tell(table: RealisationTable, arguments: Namespace) -> None:
    from rich.table import Table

    from racs_bif.cli.terminal import console

    screen = console(arguments)
    title = f"Realisations of {table.system.model}"
    if table.hopf:
        place = ", ".join(f"{name} = {value:.8g}" for name, value in table.hopf.items())
        title += f"; exact Hopf point at {place}{after(table.system.frequency_unit)}"
    screen.print(title)
    shown = Table(box=None, pad_edge=False, collapse_padding=True)
    shown.add_column("realisation", no_wrap=True)
    for column in ("states", "Z(0) off", "in band", "Hopf off", "slowest"):
        shown.add_column(column, justify="right", no_wrap=True)
    shown.add_column("")
    for row in table.rows:
        shown.add_row(*_row(row))
    screen.print(shown)
    screen.print(
        "\n'in band': largest error of the law over the band, relative; 'slowest': rate of "
        "its slowest relaxation, rad/s."
    )
    screen.print(f"\nWrote {', '.join(FILES)} to {arguments.out.resolve()}", soft_wrap=True)


def _row(row: Comparison) -> list[str]:
    if row.refused:
        return [row.name, "-", "-", "-", "-", "-", row.refused]
    remarks = [] if row.real_poles else ["poles not real"]
    remarks += [] if row.passive else ["not passive"]
    return [
        row.name,
        str(row.states),
        f"{row.static_error:.0e}",
        f"{row.error:.1e}",
        "-" if row.hopf_error is None else f"{row.hopf_error:.1e}",
        f"{abs(row.largest_pole):.3g}",
        ", ".join(remarks),
    ]
