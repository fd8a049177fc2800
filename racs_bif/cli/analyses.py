"""``racs-bif analyses``: the studies there are."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING, Final

from racs_bif.cli.options import add_output_options

if TYPE_CHECKING:
    from argparse import Namespace

    from racs_bif.cli.parser import Parser

HELP: Final = "list the analyses that 'run' can run"
DESCRIPTION: Final = "List the analyses: studies in one file each, to be run, read and changed."


def configure(parser: Parser) -> None:
    """Add the verb's arguments."""
    add_output_options(parser)


def run(arguments: Namespace) -> int:
    """Print names and first lines."""
    from racs_bif.cli.terminal import console
    from racs_bif.results.summary import to_text
    from racs_bif.shelf import names

    found = {}
    for name, path in names("analyses").items():
        text = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
        found[name] = text.partition("\n")[0]
    if arguments.json:
        print(to_text({"analyses": dict(found)}), end="")
    screen = console(arguments)
    for name, title in found.items():
        screen.print(f"{name}  {title}")
    screen.print("\nracs-bif run NAME --out DIR runs one of them.")
    return 0
