"""Files that appear whole or not at all."""

from __future__ import annotations

import os
import re
import secrets
import shutil
import time
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Final

from racs_bif.errors import FileError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

_PART: Final = re.compile(r"\.(.+\.)?[0-9a-f]{8}\.part(\..+)?")
"""Names of what is being written."""
_STALE: Final = 3600.0
"""Seconds after which whatever was being written is a killed run's: writing takes a few."""


def write_atomically(path: Path, write: Callable[[Path], None]) -> None:
    """Write a file under a temporary name in its folder, then put it in place.

    Parameters
    ----------
    path : Path
        The file. If `write` fails, whatever was there before is still there, and nothing else.
    write : callable(path)
        Writes the file it is given.

    Raises
    ------
    FileError
        If the folder or the disk does not take the file.
    """
    part = path.with_name(f".{path.stem}.{secrets.token_hex(4)}.part{path.suffix}")
    _sweep(path.parent)
    try:
        write(part)
        _flush(part)
        part.replace(path)
    except OSError as error:
        raise FileError(_cannot_write(path, error)) from error
    finally:
        with suppress(OSError):  # it was not there, or nothing can be
            part.unlink()


def check_writable(folder: Path, names: tuple[str, ...] = ()) -> None:
    """Make sure that files could be written to a folder, which need not exist; leave no trace.

    Raises
    ------
    FileError
        If not.
    """
    there = folder
    while not (there.exists() or there.is_symlink()):
        there = there.parent
    probe = there / f".{secrets.token_hex(4)}.part"
    try:
        probe.mkdir()
        probe.rmdir()
    except OSError as error:
        raise FileError(_cannot_write(folder, error)) from error
    for name in names:
        if (folder / name).is_dir():
            msg = f"cannot write '{folder / name}': a folder has that name; choose another --out"
            raise FileError(msg)


@contextmanager
def staged(folder: Path) -> Iterator[Path]:
    """Give a temporary folder whose files are moved to `folder` together at the end.

    If the block fails, `folder` is as it was, or is not there if it was not.

    Raises
    ------
    FileError
        If the folder or the disk does not take the files.
    """
    missing = [path for path in (folder, *folder.parents) if not path.exists()]
    stage = folder / f".{secrets.token_hex(4)}.part"
    try:
        stage.mkdir(parents=True)
        _sweep(folder)
        yield stage
        for path in sorted(stage.iterdir()):
            path.replace(folder / path.name)
        missing = []
    except OSError as error:
        if isinstance(error, FileError):
            raise
        raise FileError(_cannot_write(folder, error)) from error
    finally:
        shutil.rmtree(stage, ignore_errors=True)
        with suppress(OSError):
            for path in missing:
                path.rmdir()


def write_text(path: Path, text: str) -> None:
    """Write a text file in UTF-8, whole or not at all.

    Raises
    ------
    FileError
        If the folder or the disk does not take it.
    """

    def write(part: Path) -> None:
        with part.open("w", encoding="utf-8", newline="\n") as file:
            file.write(text)

    write_atomically(path, write)


def _flush(path: Path) -> None:
    """Bring a file to the disk: its new name must not get there before what is in it."""
    with path.open("rb+") as file:
        os.fsync(file.fileno())


def _sweep(folder: Path) -> None:
    """Remove what killed runs were writing to a folder."""
    with suppress(OSError):
        for path in folder.iterdir():
            if not _PART.fullmatch(path.name) or time.time() - path.stat().st_mtime < _STALE:
                continue
            if path.is_dir():
                shutil.rmtree(path, ignore_errors=True)
            else:
                path.unlink()


def _cannot_write(path: Path, error: OSError) -> str:
    reason = (error.strerror or str(error)).lower()
    return f"cannot write '{path}': {reason}; choose another place"
