"""Compiled models on disk, under a key that holds everything they depend on.

An entry is a text whose first line is the digest of the rest; what does not match is rebuilt, never
trusted. Writing is by renaming a whole file, and a folder that cannot be written costs speed only.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import logging
import os
import platform
import sys
import tempfile
import time
from pathlib import Path

_LOG = logging.getLogger(__name__)
_HEADER = "# sha256 "
_WRITING = ".writing-"
_STALE = 3600.0
"""Seconds after which an entry that is being written is a killed run's."""


def folder() -> Path:
    """Return the cache's folder: ``RACS_BIF_CACHE``, or the user's own cache folder."""
    chosen = os.environ.get("RACS_BIF_CACHE")
    if chosen:
        return Path(chosen)
    if sys.platform == "win32":
        base = os.environ.get("LOCALAPPDATA") or str(Path.home() / "AppData" / "Local")
    elif sys.platform == "darwin":
        base = str(Path.home() / "Library" / "Caches")
    else:
        base = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    return Path(base) / "racs_bif"


@functools.cache
def generator() -> str:
    """Return a digest of all that turns a model into code: this package and the versions used."""
    import numpy as np

    digest = hashlib.sha256()
    for file in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(file.name.encode())
        digest.update(file.read_bytes())
    digest.update(f"{platform.python_implementation()} {sys.version} {np.__version__}".encode())
    digest.update(_sympy_version().encode())
    return digest.hexdigest()


def _sympy_version() -> str:
    """Return sympy's version without importing it."""
    from importlib.metadata import version

    return version("sympy")


def key(*parts: str) -> str:
    """Return the key of an entry made from `parts` by this generator."""
    digest = hashlib.sha256(generator().encode())
    for part in parts:
        data = part.encode()
        digest.update(f"{len(data)}:".encode())
        digest.update(data)
    return digest.hexdigest()[:40]


def read(name: str) -> str | None:
    """Return the text of an entry, None if there is none or it is damaged."""
    try:
        text = (folder() / name).read_text(encoding="utf-8")
    except (OSError, UnicodeError, RuntimeError):  # the last where there is no home folder
        return None
    head, _, body = text.partition("\n")
    if head != _HEADER + hashlib.sha256(body.encode()).hexdigest():
        _LOG.info("cache entry %s is damaged and will be rebuilt", name)
        return None
    return body


def write(name: str, body: str) -> None:
    """Store an entry; a folder that cannot be written is noted in the log and passed over."""
    text = f"{_HEADER}{hashlib.sha256(body.encode()).hexdigest()}\n{body}"
    temporary = None
    try:
        target = folder() / name
        target.parent.mkdir(parents=True, exist_ok=True)
        _sweep(target.parent)
        handle, temporary = tempfile.mkstemp(dir=target.parent, prefix=_WRITING)
        with os.fdopen(handle, "w", encoding="utf-8") as stream:
            stream.write(text)
        os.replace(temporary, target)  # noqa: PTH105 - the two paths are strings already
        temporary = None
    except (OSError, RuntimeError) as error:
        _LOG.info("cache entry %s was not written: %s", name, error)
    finally:  # also when the user interrupts
        if temporary is not None:
            with contextlib.suppress(OSError):
                os.unlink(temporary)  # noqa: PTH108 - as above


def _sweep(place: Path) -> None:
    """Remove what killed runs were writing."""
    for path in place.glob(f"{_WRITING}*"):
        with contextlib.suppress(OSError):  # another run was faster, or may not be disturbed
            if time.time() - path.stat().st_mtime > _STALE:
                path.unlink()
