"""A figure with its caption and the numbers behind it, as files that belong together."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from racs_bif.errors import FileError
from racs_bif.plots.style import save_picture
from racs_bif.results.atomic import staged, write_text
from racs_bif.results.summary import to_json, to_text

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from matplotlib.figure import Figure

    from racs_bif.fractional.system import System
    from racs_bif.results.summary import Json


_MATHTEXT: Final = str.maketrans("", "", "$\\{}")


@dataclass(frozen=True, eq=False)
class Plate:
    """A figure, what is to be said of it, and the numbers that this rests on.

    Parameters
    ----------
    title : str
        One line.
    caption : tuple of str
        Paragraphs of plain text: what is shown, what the paper says, what was found.
    numbers : mapping of str to object
        Numbers by name, SI; arrays and None are allowed.
    """

    title: str
    caption: tuple[str, ...]
    numbers: Mapping[str, object] = field(default_factory=dict)


def plain(title: str) -> str:
    r"""Return a title with mathtext as plain text.

    Examples
    --------
    >>> plain(r"$\delta_{f}$ = 0.1 rad, $C_s$ = 3 N/rad")
    'delta_f = 0.1 rad, C_s = 3 N/rad'
    """
    return title.translate(_MATHTEXT)


def stated(system: System, *names: str) -> str:
    """Return values of parameters with their units, as captions state them."""
    units = {parameter.name: parameter.unit for parameter in system.parameter_table}
    return ", ".join(
        f"{name} = {system.parameters[name]:.6g} {units[name]}".rstrip() for name in names
    )


def write_plate(out: Path, name: str, figure: Figure, plate: Plate) -> Path:
    """Write NAME.png, NAME.svg, NAME.md and NAME.json, all or none; return the path of the first.

    Parameters
    ----------
    out : Path
        Folder; made where it is not there.
    name : str
        Of the files, without ending.
    figure : Figure
        The picture.
    plate : Plate
        Caption and numbers.

    Raises
    ------
    FileError
        If the folder does not take the files.
    """
    about: dict[str, Json] = {
        "schema": 1,
        "title": plate.title,
        "caption": list(plate.caption),
        "numbers": {key: to_json(value) for key, value in plate.numbers.items()},
    }
    lines = [f"# {plate.title}", "", f"![{plate.title}]({name}.png)"]
    for paragraph in plate.caption:
        lines += ["", paragraph]
    with staged(out) as folder:
        save_picture(figure, folder / f"{name}.png")
        save_picture(figure, folder / f"{name}.svg")
        write_text(folder / f"{name}.md", "\n".join(lines) + "\n")
        write_text(folder / f"{name}.json", to_text(about))
    return out / f"{name}.png"


def read_plate(out: Path, name: str) -> Plate | None:
    """Return what was written beside a picture; None where there is no such file.

    Raises
    ------
    FileError
        If there is one of another kind.
    """
    path = out / f"{name}.json"
    if not (path.is_file() and (out / f"{name}.png").is_file()):
        return None
    try:
        about = json.loads(path.read_text(encoding="utf-8"))
        return Plate(str(about["title"]), tuple(about["caption"]), dict(about["numbers"]))
    except (KeyError, TypeError, ValueError) as error:
        msg = f"'{path}' describes no figure ({error}); remove it and run '{name}' again"
        raise FileError(msg) from error
