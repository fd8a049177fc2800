"""A map from its tiles: those of an earlier run, and those that are computed now."""

from __future__ import annotations

from typing import TYPE_CHECKING

from racs_bif.charts.backends import Backend, InProcess
from racs_bif.charts.store import TileStore

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from racs_bif.charts.maps import MapJob, Tile


def run_map(
    job: MapJob,
    backend: Backend | None = None,
    *,
    folder: Path | None = None,
    resume: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> Tile:
    """Compute a map.

    Parameters
    ----------
    job : MapJob
        The map.
    backend : Backend, optional
        Where tiles are computed; here by default.
    folder : Path, optional
        Where finished tiles are written as they come; nowhere by default.
    resume : bool
        Go on with the tiles in the folder.
    progress : callable, optional
        Told how many tiles are done, and of how many.

    Returns
    -------
    dict of arrays (n1, n2)
        See `racs_bif.charts.maps.compute_tile`. They are the same whichever backend computed them,
        in whatever order, at once or in several runs.

    Raises
    ------
    UsageError, FileError, ConvergenceError
        If the folder, the backend or its workers cannot be used.
    """
    store = None if folder is None else TileStore(folder, job, resume=resume)
    whole = job.empty()
    ready = {} if store is None else store.read()
    for index, tile in ready.items():
        _put(job, whole, index, tile)
    tell = progress or (lambda _done, _of: None)
    tell(len(ready), job.tiles)
    missing = [index for index in range(job.tiles) if index not in ready]
    done = len(ready)
    for index, tile in (backend or InProcess()).run(job, missing):
        if store is not None:
            store.write(index, tile)
        _put(job, whole, index, tile)
        done += 1
        tell(done, job.tiles)
    return whole


def _put(job: MapJob, whole: Tile, index: int, tile: Tile) -> None:
    window = job.window(index)
    for name, part in tile.items():
        whole[name][window] = part
