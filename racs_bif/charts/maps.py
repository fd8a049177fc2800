"""Maps over a plane, computed tile by tile."""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.charts.counting import UNKNOWN, count_right
from racs_bif.charts.damping import rightmost
from racs_bif.charts.lattice import NOTHING, Lattice
from racs_bif.charts.sheet import Sheet
from racs_bif.charts.sums import LARGEST, expand
from racs_bif.errors import UsageError
from racs_bif.numerics.threads import single_threaded

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from racs_bif.charts.plane import Plane
    from racs_bif.symbolic.field import Array

QUANTITIES: Final = ("count", "damping")
Tile = dict[str, "NDArray[np.generic]"]
_SIDE: Final = 64
_NEAREST: Final = 3
_AXIS: Final = 1e-9
_SHORTEST: Final = 2.0**-16


@dataclass(frozen=True, eq=False)
class MapJob:
    """A map to compute: what every worker needs to know.

    Parameters
    ----------
    plane : Plane
        The plane.
    shape : (int, int)
        Cells along the first and the second parameter; values are those at their middles.
    quantity : {"count", "damping"}
        Number of unstable roots only, or the rightmost root besides.
    places, states : arrays (2, m) and (size, m)
        Where equilibria are known already, and what they are.
    """

    plane: Plane
    shape: tuple[int, int]
    quantity: str
    places: Array
    states: Array

    @classmethod
    def over(cls, lattice: Lattice, shape: tuple[int, int], quantity: str) -> MapJob:
        """Return the job over a plane that was searched.

        Raises
        ------
        UsageError
            If the shape or the quantity cannot be used.
        """
        if min(shape) < 1:
            msg = f"a map needs at least one cell each way, not {shape[0]} x {shape[1]}"
            raise UsageError(msg)
        if quantity not in QUANTITIES:
            msg = f"unknown map '{quantity}'; there are: {', '.join(QUANTITIES)}"
            raise UsageError(msg)
        size = lattice.plane.system.compiled.size
        if size > LARGEST:
            msg = (
                f"maps are for models with up to {LARGEST} states and elements, here {size}; "
                "draw the chart without one"
            )
            raise UsageError(msg)
        nodes = [node for node in lattice.nodes.values() if node.count != NOTHING]
        places = np.array([node.place for node in nodes]).T
        return cls(lattice.plane, shape, quantity, places, np.array([n.X for n in nodes]).T)

    @property
    def tiles(self) -> int:
        """Number of tiles."""
        return len(self._corners)

    @cached_property
    def _corners(self) -> list[tuple[int, int]]:
        rows, columns = (range(0, n, _SIDE) for n in self.shape)
        return [(i, j) for i in rows for j in columns]

    def window(self, index: int) -> tuple[slice, slice]:
        """Return the cells of a tile, along both parameters."""
        i, j = self._corners[index]
        return (
            slice(i, min(i + _SIDE, self.shape[0])),
            slice(j, min(j + _SIDE, self.shape[1])),
        )

    @cached_property
    def fingerprint(self) -> str:
        """Digest of everything that the map depends on."""
        from racs_bif import __version__

        system, plane = self.plane.system, self.plane
        told = (__version__, system.compiled.digest, plane.names, plane.spans, self.shape)
        digest = hashlib.sha256(repr((*told, self.quantity, _SIDE)).encode())
        for array in (system.values, self.places, self.states):
            digest.update(np.ascontiguousarray(array).tobytes())
        return digest.hexdigest()

    def empty(self) -> Tile:
        """Return the arrays of the whole map, with nothing known."""
        whole: Tile = {
            "unstable": np.full(self.shape, NOTHING, dtype=np.int8),
            "evaluations": np.zeros(self.shape, dtype=np.int32),
        }
        if self.quantity == "damping":
            whole["sigma"] = np.full(self.shape, np.nan)
            whole["omega"] = np.full(self.shape, np.nan)
        return whole


@single_threaded
def compute_tile(job: MapJob, index: int) -> Tile:
    """Compute one tile of a map.

    Parameters
    ----------
    job : MapJob
        The map.
    index : int
        Which tile.

    Returns
    -------
    dict of arrays (rows, columns)
        ``unstable`` (-1 where roots cannot be counted, -2 where there is no equilibrium),
        ``evaluations``; and ``sigma`` [1/s] and ``omega`` [rad/s] of the rightmost root, NaN where
        it is not certain.
    """
    window = job.window(index)
    first, second = (
        (np.arange(part.start, part.stop) + 0.5) / n
        for part, n in zip(window, job.shape, strict=True)
    )
    places = np.array([a.ravel() for a in np.meshgrid(first, second, indexing="ij")])
    X, there = _equilibria(job, places)
    cells = np.flatnonzero(there)
    unstable = np.full(places.shape[1], NOTHING, dtype=np.int8)
    evaluations = np.zeros(places.shape[1], dtype=np.int32)
    root = np.full(places.shape[1], np.nan, dtype=complex)
    if len(cells):
        P = job.plane.vectors(places[:, cells])
        sheet = Sheet(job.plane)
        sums = expand(sheet.core(X[:, cells], P), sheet.laws(P))
        counts = count_right(sums)
        unstable[cells] = counts.unstable
        evaluations[cells] = counts.evaluations
        if job.quantity == "damping":
            found = rightmost(job.plane.system.exact, sums, X[:, cells], P)
            evaluations[cells] += found.evaluations
            # Two ways to the same: a root right of the axis, and a count above zero.
            with np.errstate(invalid="ignore"):
                doubtful = (found.root.real > 0.0) != (counts.unstable > 0)
                near = np.abs(found.root.real) <= _AXIS * np.abs(found.root)
            wrong = doubtful & ~near & np.isfinite(found.root.real) & (counts.unstable >= 0)
            unstable[cells[wrong]] = UNKNOWN
            root[cells] = np.where(wrong, np.nan, found.root)
    shape = (len(first), len(second))
    tile: Tile = {
        "unstable": unstable.reshape(shape),
        "evaluations": evaluations.reshape(shape),
    }
    if job.quantity == "damping":
        tile["sigma"], tile["omega"] = root.real.reshape(shape), root.imag.reshape(shape)
    return tile


def _equilibria(job: MapJob, places: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Return equilibria at places (2, N), each continued from a node nearby, and where they are."""
    count = places.shape[1]
    X, there = np.full((len(job.states), count), np.nan), np.zeros(count, dtype=bool)
    middle = places.mean(axis=1, keepdims=True)
    reach = np.hypot(*(places - middle)).max() + 3.0 * _spacing(job.places)
    near = np.flatnonzero(np.hypot(*(job.places - middle)) <= reach)
    if not len(near):
        near = np.argsort(np.hypot(*(job.places - middle)), kind="stable")[:_NEAREST]
    distance = np.hypot(*(places[:, :, None] - job.places[:, None, near]))
    order = near[np.argsort(distance, axis=1, kind="stable")[:, :_NEAREST]]
    sheet = Sheet(job.plane)
    for rank in range(order.shape[1]):
        rest = np.flatnonzero(~there)
        if not len(rest):
            break
        source = order[rest, rank]
        found, reached = sheet.follow(
            job.states[:, source], job.places[:, source], places[:, rest], shortest=_SHORTEST
        )
        good = reached == 1.0
        X[:, rest[good]], there[rest[good]] = found[:, good], True
    return X, there


def _spacing(places: Array) -> float:
    """Return about how far apart the known places are."""
    return 1.0 / max(math.sqrt(places.shape[1]) - 1.0, 1.0)
