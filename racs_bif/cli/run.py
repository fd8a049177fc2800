"""``racs-bif run``: run an analysis."""

from __future__ import annotations

import inspect
import sys
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from racs_bif.cli.options import add_output_options
from racs_bif.cli.parser import Parser, assignment
from racs_bif.errors import RacsBifError, UsageError, nearest

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Callable, Iterator

HELP: Final = "run an analysis"
DESCRIPTION: Final = (
    "Run an analysis by name, or the file of one; see 'racs-bif analyses'. What it writes goes "
    "into the folder of --out."
)


def configure(parser: Parser) -> None:
    """Add the verb's arguments."""
    parser.add_argument(
        "analysis", metavar="NAME|FILE.py", help="an analysis's name, or a path that ends in .py"
    )
    parser.add_argument(
        "--set",
        dest="values",
        action="append",
        default=[],
        type=assignment,
        metavar="NAME=VALUE",
        help="the value of one of the analysis's own numbers, for example vehicles=10",
    )
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("racs_bif_out"),
        metavar="DIR",
        help="where the files go; default ./racs_bif_out",
    )
    add_output_options(parser)


def run(arguments: Namespace) -> int:
    """Run the analysis and say where its results are."""
    from racs_bif.cli.terminal import console
    from racs_bif.results.atomic import check_writable
    from racs_bif.shelf import complaint, find, load_module

    path = find("analyses", arguments.analysis)
    check_writable(arguments.out, ())
    function = getattr(load_module(path), "run", None)
    if not callable(function):
        msg = f"{path} defines no function 'run'; add 'def run(out, ...)'"
        raise UsageError(msg)
    options = _options(function, dict(arguments.values), path)
    try:
        with _progress(arguments, path.stem) as report:
            if "progress" in inspect.signature(function).parameters:
                options["progress"] = report
            result = function(arguments.out, **options)
    except (RacsBifError, KeyboardInterrupt):
        raise
    except Exception as error:  # the file may be the user's: anything may come out of it
        raise UsageError(complaint(path, error)) from error
    console(arguments).print(f"Wrote {result}", soft_wrap=True)
    return 0


def _options(function: Callable[..., Any], values: dict[str, float], path: Path) -> dict[str, Any]:
    """Return the numbers that the user sets, of the type of their defaults."""
    known = {
        name: p.default
        for name, p in inspect.signature(function).parameters.items()
        if p.default is not inspect.Parameter.empty and isinstance(p.default, int | float)
    }
    options: dict[str, Any] = {}
    for name, value in values.items():
        if name not in known:
            msg = f"analysis '{path.stem}' has no number '{name}'; {nearest(name, known)}"
            raise UsageError(msg)
        whole = isinstance(known[name], int)
        if whole and value != int(value):
            msg = f"'{name}' of analysis '{path.stem}' must be a whole number, not {value:g}"
            raise UsageError(msg)
        options[name] = int(value) if whole else value
    return options


@contextmanager
def _progress(arguments: Namespace, title: str) -> Iterator[Callable[[float], None] | None]:
    """Show a bar on an interactive stderr."""
    from racs_bif.cli.terminal import interactive

    if not interactive(arguments):
        yield None
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(file=sys.stderr), transient=True) as bars:
        task = bars.add_task(title, total=1.0)
        yield lambda share: bars.update(task, completed=share)
