"""Which files are models and analyses, and which of them a name means.

Three places are looked at: the folders that the wheel carries (``racs_bif/_models``), or in a
checkout the folders beside the package (``models/``); then every folder that ``RACS_BIF_PATH``
names, in its subfolders ``models/`` and ``analyses/`` and in itself.
"""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

from racs_bif.errors import UsageError, nearest

if TYPE_CHECKING:
    from collections.abc import Iterator

VARIABLE: Final = "RACS_BIF_PATH"
"""Environment variable with further folders, separated like ``PATH``."""
_PACKAGE: Final = Path(__file__).resolve().parents[1]


@dataclass(frozen=True, kw_only=True)
class Kind:
    """One kind of file on the shelf.

    Parameters
    ----------
    one : str
        What people call one of them.
    endings : tuple of str
        How the name of such a file may end where it is given as a path.
    function : str
        The function that such a file has to define.
    """

    one: str
    endings: tuple[str, ...]
    function: str


KINDS: Final = {
    "models": Kind(one="model", endings=(".py", ".toml"), function="model"),
    "analyses": Kind(one="analysis", endings=(".py",), function="run"),
}
"""The kinds of files, by the name of their folders."""


def folders(kind: str) -> list[Path]:
    """List the folders that hold files of one kind, the package's own first.

    Parameters
    ----------
    kind : {"models", "analyses"}
        The kind of files.

    Returns
    -------
    list of Path
        Absolute paths of the folders that exist, each once.
    """
    carried = _PACKAGE / f"_{kind}"
    own = carried if carried.is_dir() else _PACKAGE.parent / kind
    candidates = [own]
    for entry in _entries():
        candidates += [entry / kind, entry]
    existing = (folder.resolve() for folder in candidates if folder.is_dir())
    return list(dict.fromkeys(existing))


def names(kind: str) -> dict[str, Path]:
    """List the files of one kind by name; those that start with an underscore are helpers.

    Parameters
    ----------
    kind : {"models", "analyses"}
        The kind of files.

    Returns
    -------
    dict of str to Path
        Sorted by name.

    Raises
    ------
    UsageError
        If a name is found twice.
    """
    return {name: _only(kind, name, files) for name, files in sorted(_files(kind).items())}


def find(kind: str, name: str) -> Path:
    """Return the file that a name or a path means.

    Parameters
    ----------
    kind : {"models", "analyses"}
        The kind of file.
    name : str
        A name on the shelf, or a path that ends in ``.py``, for a model also in ``.toml``.

    Raises
    ------
    UsageError
        If there is no such name or file, or if the name is found twice.
    """
    files = _files(kind)
    if is_file_name(kind, name):
        path = Path(name).expanduser().resolve()
        if path.is_file():
            return path
        hint = f"did you mean the {KINDS[kind].one} '{path.stem}'?"
        mend = hint if path.stem in files else "check the path"
        msg = f"there is no file '{name}': {mend}"
        raise UsageError(msg)
    if name not in files:
        missing = [str(entry) for entry in _entries() if not entry.is_dir()]
        lost = f" ({VARIABLE} names {', '.join(missing)}: no such folder)" if missing else ""
        msg = f"unknown {KINDS[kind].one} '{name}': {nearest(name, sorted(files))}{lost}"
        raise UsageError(msg)
    return _only(kind, name, files[name])


def is_file_name(kind: str, name: object) -> bool:
    """Say whether a name is the path of a file and not a name on the shelf."""
    if not isinstance(name, str):
        msg = f"{name!r} is no name of a {KINDS[kind].one}; give a word in quotes"
        raise UsageError(msg)
    return name.endswith(KINDS[kind].endings)


def _entries() -> list[Path]:
    """Return what the user's variable names, whether it exists or not."""
    parts = os.environ.get(VARIABLE, "").split(os.pathsep)
    return [Path(part).expanduser() for part in parts if part.strip()]


def _files(kind: str) -> dict[str, list[Path]]:
    """Return every listed file of one kind by its name, in the order of the folders."""
    found: dict[str, list[Path]] = {}
    for folder in folders(kind):
        for file in _listed(kind, folder):
            found.setdefault(file.stem, []).append(file)
    return found


def _listed(kind: str, folder: Path) -> Iterator[Path]:
    """Yield the files of one kind in a folder.

    In a folder called ``models`` every file is a model, so that one with a mistake is reported. In
    a folder of any other name only those files are that define the kind's function.
    """
    mixed = folder.name.lstrip("_") != kind
    for file in sorted(folder.glob("*.py")):
        if file.name.startswith("_") or not file.is_file():
            continue
        if not mixed or _defines(file, KINDS[kind].function):
            yield file


def _defines(file: Path, function: str) -> bool:
    """Tell whether a file defines, assigns or imports a function, without running it."""
    text = file.read_text(encoding="utf-8", errors="replace")
    pattern = rf"^(def\s+{function}\s*\(|{function}\s*=|from\s.*\bimport\b.*\b{function}\b)"
    return re.search(pattern, text, re.MULTILINE) is not None


def _only(kind: str, name: str, files: list[Path]) -> Path:
    if len(files) > 1:
        msg = (
            f"the {KINDS[kind].one} '{name}' is found twice, in {files[0]} and {files[1]}: "
            "rename one, or give the path of the one that is meant"
        )
        raise UsageError(msg)
    return files[0]
