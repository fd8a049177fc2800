"""``racs-bif spectrum``: the exact characteristic roots of an equilibrium."""

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
from racs_bif.cli.parser import Parser, number
from racs_bif.markup import with_unit
from racs_bif.units import cycles_unit, frequency_unit, rate_unit

if TYPE_CHECKING:
    from argparse import Namespace

    from racs_bif.verbs.spectrum import Spectrum

HELP: Final = "the exact characteristic roots of an equilibrium"
DESCRIPTION: Final = (
    "Find all roots of the exact characteristic equation right of a line, with s**alpha on its "
    "principal branch, and compare them with the eigenvalues of the realisation. Writes "
    "spectrum.png, spectrum.svg and summary.json."
)
FILES: Final = ("spectrum.png", "spectrum.svg", "summary.json")


def configure(parser: Parser) -> None:
    """Add the verb's arguments."""
    parser.add_argument(
        "--above",
        type=number,
        default=-1.0,
        metavar="RE",
        help="roots with a real part above this are found, 1/s; default -1",
    )
    add_model_options(parser)
    add_realisation_options(parser)
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("racs_bif_out"),
        metavar="DIR",
        help="where the files go; default ./racs_bif_out",
    )
    add_output_options(parser)


def run(arguments: Namespace) -> int:
    """Find the roots, write the files and print a table."""
    from racs_bif.cli.terminal import working
    from racs_bif.plots.spectrum import picture
    from racs_bif.plots.style import save_picture
    from racs_bif.results.atomic import check_writable, staged
    from racs_bif.results.summary import to_text, write_summary
    from racs_bif.verbs.spectrum import spectrum

    check_writable(arguments.out, FILES)
    system = open_system(arguments)
    with working(arguments, "searching for roots"):
        found = spectrum(system, above=arguments.above)
    summary = _summary(found, arguments)
    figure = picture(found)
    with staged(arguments.out) as folder:
        save_picture(figure, folder / FILES[0])
        save_picture(figure, folder / FILES[1])
        write_summary(summary, folder / FILES[2])
    if arguments.json:
        print(to_text(summary), end="")
    _tell(found, arguments)
    return 0


def _summary(found: Spectrum, arguments: Namespace) -> dict:  # type: ignore[type-arg]
    from racs_bif.results.summary import to_json

    roots = found.roots
    whole = {
        "schema": 1,
        "version": found.system.version,
        "command": arguments.command,
        "model": found.system.model,
        "variant": found.system.variant,
        "parameters": dict(found.system.parameters),
        "state": dict(found.state),
        "above": roots.above,
        "roots": [[root.real, root.imag] for root in roots.roots.tolist()],
        "errors": roots.errors,
        "multiplicities": roots.multiplicities,
        "unstable": roots.unstable,
        "on_axis": list(roots.on_axis),
        "zero_order": roots.zero_order,
        "on_cut": roots.on_cut,
        "eigenvalues": [[v.real, v.imag] for v in found.eigenvalues.tolist()],
    }
    return {key: to_json(value) for key, value in whole.items()}


def _tell(found: Spectrum, arguments: Namespace) -> None:
    from rich.table import Table

    from racs_bif.cli.tables import heading
    from racs_bif.cli.terminal import console

    screen = console(arguments)
    screen.print(heading(found.system))
    roots = found.roots
    table = Table(
        title=f"\nExact roots with Re s > {roots.above:g}", title_justify="left", box=None
    )
    time = found.system.time_unit
    parts = with_unit("Re s", rate_unit(time)), with_unit("Im s", frequency_unit(time))
    cycles = cycles_unit(time) or "Im s/2pi"
    for title in (*parts, cycles, "last correction", "realisation off by"):
        table.add_column(title, justify="right")
    rows = zip(roots.roots.tolist(), roots.errors.tolist(), found.shifts.tolist(), strict=True)
    for root, error, shift in rows:
        hertz = abs(root.imag) / (2.0 * math.pi)
        table.add_row(
            f"{root.real:.8g}", f"{root.imag:.8g}", f"{hertz:.5g}", f"{error:.0e}", f"{shift:.1e}"
        )
    if roots.roots.size:
        screen.print(table)
    else:
        screen.print(f"\nNo root with Re s > {roots.above:g}.")
    if roots.on_cut.size:
        values = ", ".join(f"{v:.8g}" for v in roots.on_cut.tolist())
        screen.print(f"\nOn both lips of the branch cut, so on no sheet: {values}")
    if roots.at_zero:
        screen.print(f"\ns = 0 is a root: det Delta vanishes like s**{roots.zero_order:.3g}.")
    verdict = f"unstable, roots with Re s > 0: {roots.unstable}" if roots.unstable else "stable"
    screen.print(
        f"\nThe equilibrium is {verdict}. The argument principle counts {roots.count_checked} with "
        f"Re s > {roots.above:g}, as found."
    )
    screen.print(f"\nWrote {', '.join(FILES)} to {arguments.out.resolve()}", soft_wrap=True)
