"""Finished tiles in a folder, so that a killed run goes on where it stopped."""

from __future__ import annotations

import json
import zipfile
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import FileError, UsageError

if TYPE_CHECKING:
    from pathlib import Path

    from racs_bif.charts.maps import MapJob, Tile

_MANIFEST = "map.json"


class TileStore:
    """The tiles of one map; each file appears whole or not at all.

    Parameters
    ----------
    folder : Path
        Where; made if need be.
    job : MapJob
        The map.
    resume : bool
        Keep the tiles that are there already. Otherwise they are removed.

    Raises
    ------
    UsageError
        If those tiles are of another map.
    FileError
        If the folder cannot be used.
    """

    def __init__(self, folder: Path, job: MapJob, *, resume: bool) -> None:
        self.folder, self.job = folder, job
        manifest = folder / _MANIFEST
        try:
            folder.mkdir(parents=True, exist_ok=True)
            if resume and manifest.exists():
                known = json.loads(manifest.read_text(encoding="utf-8"))
                if known.get("fingerprint") != job.fingerprint:
                    msg = (
                        f"the tiles in '{folder}' are of another map, model or parameters; choose "
                        "another --out, or leave --resume out to begin anew"
                    )
                    raise UsageError(msg)
            else:
                self.clear()
                folder.mkdir(parents=True, exist_ok=True)
            told = {"fingerprint": job.fingerprint, "tiles": job.tiles, "shape": list(job.shape)}
            part = folder / f".{_MANIFEST}.part"
            part.write_text(json.dumps(told), encoding="utf-8")
            part.replace(manifest)
        except OSError as error:
            msg = f"cannot use '{folder}' for tiles: {error}; choose another --out"
            raise FileError(msg) from error

    def _path(self, index: int) -> Path:
        return self.folder / f"tile_{index:06d}.npz"

    def read(self) -> dict[int, Tile]:
        """Return the tiles that are there and whole."""
        found = {}
        for index in range(self.job.tiles):
            path = self._path(index)
            if not path.exists():
                continue
            try:
                with path.open("rb") as file, np.load(file, allow_pickle=False) as arrays:
                    found[index] = {name: arrays[name] for name in arrays.files}
            except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
                path.unlink()  # damaged: it is computed again
        return found

    def write(self, index: int, tile: Tile) -> None:
        """Write one tile.

        Raises
        ------
        FileError
            If the disk does not take it.
        """
        path = self._path(index)
        part = path.with_name(f".{path.name}.part")
        try:
            with part.open("wb") as file:
                np.savez(file, allow_pickle=False, **tile)
            part.replace(path)
        except OSError as error:
            part.unlink(missing_ok=True)
            msg = f"cannot write '{path}': {error}; make room, then go on with --resume"
            raise FileError(msg) from error

    def clear(self) -> None:
        """Remove the tiles, and the folder if nothing else is in it."""
        for path in (*self.folder.glob("tile_*.npz"), *self.folder.glob(".*.part")):
            path.unlink()
        (self.folder / _MANIFEST).unlink(missing_ok=True)
        if self.folder.is_dir() and not any(self.folder.iterdir()):
            self.folder.rmdir()
