"""``racs-bif certify``: check saved equilibria on the exact operator, up to a proof."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final

from racs_bif.cli.options import add_output_options
from racs_bif.cli.parser import Parser, number

if TYPE_CHECKING:
    from argparse import Namespace

    from racs_bif.results.certificate import Certificate

HELP: Final = "check saved special points on the exact operator, up to a proof"
DESCRIPTION: Final = (
    "Check the branches of equilibria in a file on the exact model, without the realisation of its "
    "fractional elements: Hopf points and folds are solved again, and the exact unstable roots are "
    "counted at every point and on both sides of every special point. With --proof, interval "
    "arithmetic proves that exactly one point lies in a box. Exit status: 0 all checks hold, 1 one "
    "fails, 2 wrong usage or input."
)


def configure(parser: Parser) -> None:
    """Add the verb's arguments."""
    parser.add_argument(
        "file", metavar="FILE", type=Path, help="branches.nc of 'racs-bif continue', or any saved"
    )
    parser.add_argument(
        "--proof",
        action="store_true",
        help="prove by interval arithmetic; needs pip install 'racs-bif[proof]'",
    )
    parser.add_argument(
        "--tolerance",
        type=number,
        default=0.01,
        metavar="SHIFT",
        help="largest relative shift to the exact point that is accepted; default 0.01",
    )
    parser.add_argument(
        "--model",
        metavar="NAME|FILE.py",
        help="the model, where it is no longer where it was when the file was made",
    )
    add_output_options(parser)


def run(arguments: Namespace) -> int:
    """Certify, print what was found and return whether all of it holds."""
    from racs_bif.cli.terminal import warn, working
    from racs_bif.results.summary import to_text
    from racs_bif.verbs.certify import certify

    with working(arguments, f"certifying {arguments.file.name}"):
        found = certify(
            arguments.file,
            "proof" if arguments.proof else "complete",
            model=arguments.model,
            tolerance=arguments.tolerance,
        )
    if arguments.json:
        print(to_text(_summary(found, arguments)), end="")
    _tell(found, arguments)
    for check in found.failures:
        warn(f"not certified, {check.subject} ({check.strength}): {check.finding}")
    return 0 if found.holds else 1


def _summary(found: Certificate, arguments: Namespace) -> dict:  # type: ignore[type-arg]
    from dataclasses import asdict

    from racs_bif import __version__
    from racs_bif.results.summary import to_json

    whole = {
        "schema": 1,
        "version": __version__,
        "command": arguments.command,
        "file": str(arguments.file),
        "model": found.system.model,
        "variant": found.system.variant,
        "parameter": found.parameter,
        "strength": found.strength,
        "holds": found.holds,
        "checks": [asdict(check) for check in found.checks],
        "notes": list(found.notes),
    }
    return {key: to_json(value) for key, value in whole.items()}


def _tell(found: Certificate, arguments: Namespace) -> None:
    from rich.table import Table

    from racs_bif.cli.tables import heading
    from racs_bif.cli.terminal import console

    screen = console(arguments)
    screen.print(heading(found.system))
    table = Table(title="\nCertificate", title_justify="left", box=None, pad_edge=False)
    for title in ("of", "on", "check", ""):
        table.add_column(title, no_wrap=True)
    table.add_column("found")
    for check in found.checks:
        verdict = "holds" if check.holds else "FAILS"
        table.add_row(check.subject, check.branch, check.strength, verdict, check.finding)
    screen.print(table)
    if found.strength == "proof":
        screen.print("\nA proof's box bounds the states too: see 'box' in what --json prints.")
    for note in found.notes:
        screen.print(f"\nNote: {note}")
    total = len(found.checks)
    told = f"All {total} checks hold" if found.holds else f"{len(found.failures)} of {total} fail"
    screen.print(f"\n{told}.")
