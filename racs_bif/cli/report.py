"""``racs-bif report``: one page of HTML to look around in what ``continue`` computed."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final

from racs_bif.errors import FileError

if TYPE_CHECKING:
    from argparse import Namespace

    from racs_bif.cli.parser import Parser
    from racs_bif.results.diagram import Diagram

HELP: Final = "a page of HTML to look around in what 'continue' computed"
DESCRIPTION: Final = (
    "Write the diagram that 'continue' or 'curve' saved in DIR as one self-contained page: a click "
    "on a point shows its eigenvalues or multipliers, time history and phase portrait, a slider "
    "moves along the branch, and the vehicle swings as the orbit does. Nothing is computed again, "
    "and the page needs no network. Needs pip install 'racs-bif[report]'."
)
DIAGRAM: Final = "branches.nc"
CHART: Final = "chart.nc"
SUMMARY: Final = "summary.json"
PAGE: Final = "report.html"


def configure(parser: Parser) -> None:
    """Add the verb's arguments."""
    parser.add_argument("folder", type=Path, metavar="DIR", help="where 'continue' wrote its files")
    parser.add_argument(
        "--state",
        metavar="NAME",
        help="what the page shows on its vertical axis first; default what the model suggests",
    )
    parser.add_argument(
        "--to", type=Path, metavar="FILE", help=f"file of the page; default DIR/{PAGE}"
    )
    parser.add_argument("--quiet", action="store_true", help="print nothing but errors")


def run(arguments: Namespace) -> int:
    """Write the page."""
    from racs_bif.report.page import page, plotly_script
    from racs_bif.results.atomic import write_text

    plotly_script()  # complain before anything is read
    diagram = _load(arguments.folder)
    text = page(diagram, _command(arguments.folder / SUMMARY, diagram), arguments.state)
    target: Path = arguments.to or arguments.folder / PAGE
    write_text(target, text)
    if not arguments.quiet:
        print(f"Wrote {target.resolve()}")
    return 0


def _load(folder: Path) -> Diagram:
    """Return the diagram in a folder.

    Raises
    ------
    FileError
        If the folder has none.
    """
    from racs_bif.results.branch import Branch
    from racs_bif.results.diagram import Diagram
    from racs_bif.results.files import load

    path = folder / DIAGRAM
    if not folder.is_dir():
        msg = f"there is no folder '{folder}'; give the one that 'continue --out DIR' wrote"
        raise FileError(msg)
    if not path.exists():
        if (folder / CHART).exists():
            msg = f"'{folder}' holds a chart: see its chart.svg; reports show what 'continue' saves"
            raise FileError(msg)
        msg = f"'{folder}' has no {DIAGRAM}; run 'racs-bif continue ... --out {folder}' first"
        raise FileError(msg)
    found = load(path)
    if isinstance(found, Branch):
        return Diagram(found)
    if not isinstance(found, Diagram):
        msg = f"'{path}' holds no branches; give the folder that 'continue' wrote"
        raise FileError(msg)
    return found


def _command(path: Path, diagram: Diagram) -> list[str] | None:
    """Return the command that a summary tells of, if it is the summary of this diagram."""
    import json

    try:
        summary = json.loads(path.read_text(encoding="utf-8"))
        told = [(branch["name"], branch["points"]) for branch in summary["branches"]]
        command = [str(word) for word in summary["command"]]
    except (OSError, ValueError, KeyError, TypeError):
        return None
    return command if told == [(branch.name, len(branch)) for branch in diagram] else None
