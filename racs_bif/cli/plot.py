"""``racs-bif plot``: pictures from a saved file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final

from racs_bif.cli.parser import Parser, choice
from racs_bif.errors import FileError, UsageError, nearest

if TYPE_CHECKING:
    from argparse import Namespace

    from racs_bif.results.branch import Branch

HELP: Final = "pictures of the orbits in a saved file"
DESCRIPTION: Final = (
    "Draw the orbits that a file holds, branches.nc of 'continue' or orbit.nc of 'orbit': their "
    "time profiles, phase portraits, multipliers along the branch or on the unit circle, or the "
    "period. Nothing is computed again."
)
KINDS: Final = ("profiles", "phase", "multipliers", "circle", "period", "orbit")
ENDINGS: Final = (".png", ".svg", ".pdf")


def configure(parser: Parser) -> None:
    """Add the verb's arguments."""
    parser.add_argument("file", type=Path, metavar="FILE", help="branches.nc or orbit.nc")
    parser.add_argument(
        "--what",
        type=choice(*KINDS),
        default=KINDS[0],
        metavar="KIND",
        help="profiles (default); phase, the plane of two states; multipliers, their moduli along "
        "the branch; circle, those of one orbit; period; orbit, all of one orbit",
    )
    parser.add_argument(
        "--branch", metavar="NAME", help="which branch; default the first one of orbits"
    )
    parser.add_argument(
        "--point",
        nargs="+",
        action="extend",
        default=[],
        metavar="NAME",
        help="which of its special points; default all, or the last where one is drawn",
    )
    parser.add_argument(
        "--to",
        type=Path,
        metavar="PICTURE",
        help="file of the picture, .png, .svg or .pdf; default KIND.png beside FILE",
    )


def run(arguments: Namespace) -> int:
    """Draw the picture."""
    from racs_bif.plots.orbit import orbit_picture, picture
    from racs_bif.plots.style import save_picture
    from racs_bif.results.files import load

    target: Path = arguments.to or arguments.file.parent / f"{arguments.what}.png"
    if target.suffix not in ENDINGS:
        msg = f"'{target.name}' is no picture; end it in {', '.join(ENDINGS)}"
        raise UsageError(msg)
    branch = _branch(load(arguments.file), arguments)
    names = tuple(arguments.point)
    for name in names:
        branch[name]
    if arguments.what == "orbit":
        figure = orbit_picture(branch, names[-1] if names else None)
    else:
        figure = picture(branch, arguments.what, names)
    try:
        save_picture(figure, target)
    except OSError as error:
        msg = f"'{target}' cannot be written: {error.strerror or error}; choose another place"
        raise FileError(msg) from error
    print(f"Wrote {target}")
    return 0


def _branch(loaded: object, arguments: Namespace) -> Branch:
    """Return the branch to draw.

    Raises
    ------
    UsageError
        If the file holds no branch of orbits, or none of this name.
    """
    from racs_bif.results.branch import Branch
    from racs_bif.results.diagram import Diagram

    branches = loaded.branches if isinstance(loaded, Diagram) else (loaded,)
    orbits = [b for b in branches if isinstance(b, Branch) and b.kind == "orbit"]
    if not orbits:
        msg = f"'{arguments.file}' holds no branch of orbits; give branches.nc or orbit.nc"
        raise UsageError(msg)
    if arguments.branch is None:
        return orbits[0]
    for branch in orbits:
        if branch.name == arguments.branch:
            return branch
    hint = nearest(arguments.branch, [branch.name for branch in orbits])
    msg = f"'{arguments.file}' has no branch of orbits '{arguments.branch}'; {hint}"
    raise UsageError(msg)
