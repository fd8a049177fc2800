"""Files as modules, under names that any process can import again.

A function is pickled by the name of its module, so that name must lead a freshly spawned worker to
the same file. A file on the shelf is ``racs_bif.shelf.models.racs``: it moves with the package,
also to another machine. Any other file carries its quoted path in its name, as in
``racs_bif.shelf.files./home/ann/duffing%2Epy``.
"""

from __future__ import annotations

import importlib
import sys
import traceback
from importlib.machinery import ModuleSpec, SourceFileLoader
from importlib.util import spec_from_file_location
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from racs_bif.errors import ModelError
from racs_bif.shelf.folders import KINDS, folders

if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import ModuleType

_SHELF = __name__.rpartition(".")[0]


def load_module(path: str | Path) -> ModuleType:
    """Import the file of a model or an analysis; one that was edited since is imported anew.

    Parameters
    ----------
    path : str or Path
        The file, as `racs_bif.shelf.folders.find` returns it.

    Returns
    -------
    module
        What it defines can be pickled and reached from any process.

    Raises
    ------
    ModelError
        If there is no such file, or if it raises: one line with the file, the line and the reason.
    """
    file = Path(path).resolve()
    if not file.is_file():
        msg = f"there is no file '{path}': check the path"
        raise ModelError(msg)
    name = _module_name(file)
    spec = getattr(sys.modules.get(name), "__spec__", None)
    if spec is not None and spec.loader_state != _stamp(file):
        del sys.modules[name]
    try:
        return importlib.import_module(name)
    except (Exception, SystemExit) as error:  # the file is the user's: anything may come out of it
        raise ModelError(complaint(file, error)) from error


def complaint(file: Path, error: BaseException) -> str:
    """Say in one line where in a file an exception came from, and what it says.

    Parameters
    ----------
    file : Path
        The file that was run.
    error : exception
        What it raised.

    Examples
    --------
    >>> complaint(Path("duffing.py"), ZeroDivisionError("division by zero"))
    'duffing.py cannot be used, it raises ZeroDivisionError: division by zero; mend the file'
    """
    lines = [
        frame.lineno
        for frame in traceback.extract_tb(error.__traceback__)
        if frame.filename == str(file)
    ]
    if isinstance(error, SyntaxError) and error.filename == str(file):
        lines.append(error.lineno)
    place = f"line {lines[-1]}" if lines else "it"
    text = error.msg if isinstance(error, SyntaxError) else " ".join(str(error).split())
    told = f"{type(error).__name__}: {text}".rstrip(": ")
    return f"{file} cannot be used, {place} raises {told}; mend the file"


class _Finder:
    """Finds the modules of the three packages ``models``, ``analyses`` and ``files``."""

    @classmethod
    def find_spec(
        cls,
        fullname: str,
        path: Sequence[str] | None = None,
        target: ModuleType | None = None,
    ) -> ModuleSpec | None:
        """Return how to import a file of the shelf (see `importlib.abc.MetaPathFinder`)."""
        del path, target
        package, _, name = fullname.rpartition(".")
        home, _, kind = package.rpartition(".")
        if home != _SHELF:
            return None
        file = Path(_unquoted(name)) if kind == "files" else _first(kind, name)
        if file is None or not file.is_file():
            return None
        loader = _FreshLoader(fullname, str(file))
        spec = spec_from_file_location(fullname, file, loader=loader)
        if spec is not None:
            spec.loader_state = _stamp(file)
        return spec


class _FreshLoader(SourceFileLoader):
    """Reads the source every time.

    Python's bytecode cache takes a file for unchanged that was edited within one second and kept
    its length, which is what a script does that rewrites one number of a model.
    """

    def path_stats(self, path: str) -> NoReturn:
        """Refuse, which switches the bytecode cache off."""
        raise OSError(path)


def _module_name(file: Path) -> str:
    for kind in KINDS:
        if _first(kind, file.stem) == file and "." not in file.stem:
            return f"{_SHELF}.{kind}.{file.stem}"
    return f"{_SHELF}.files.{_quoted(str(file))}"


def _first(kind: str, stem: str) -> Path | None:
    if kind not in KINDS:
        return None
    candidates = (folder / f"{stem}.py" for folder in folders(kind))
    return next((file for file in candidates if file.is_file()), None)


def _quoted(path: str) -> str:
    """Take the dots out of a path, because they separate packages."""
    return path.replace("%", "%25").replace(".", "%2E")


def _unquoted(name: str) -> str:
    return name.replace("%2E", ".").replace("%25", "%")


def _stamp(file: Path) -> tuple[int, int]:
    status = file.stat()
    return status.st_mtime_ns, status.st_size


sys.meta_path.append(_Finder)
