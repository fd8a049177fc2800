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
from racs_bif.charts.sweeps import SWEEPS, Sweep, nothing, swept
from racs_bif.errors import UsageError
from racs_bif.numerics.threads import single_threaded

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from racs_bif.charts.plane import Plane
    from racs_bif.symbolic.field import Array

QUANTITIES: Final = ("count", "damping", *SWEEPS)
Tile = dict[str, "NDArray[np.generic]"]
_SIDE: Final = 64
_SIDE_OF_SWEEPS: Final = 16
"""Simulations take longer: smaller tiles are lost and shown less."""
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
    quantity : str
        One of `QUANTITIES`: the number of unstable roots only, the rightmost root besides, or what
        simulations settle on.
    places, states : arrays (2, m) and (size, m)
        Where equilibria are known already, and what they are.
    sweep : Sweep, optional
        What is simulated, where that is what the map is of.
    """

    plane: Plane
    shape: tuple[int, int]
    quantity: str
    places: Array
    states: Array
    sweep: Sweep | None = None

    @classmethod
    def over(
        cls, lattice: Lattice, shape: tuple[int, int], quantity: str, sweep: Sweep | None = None
    ) -> MapJob:
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
        if (quantity in SWEEPS) != (sweep is not None):
            mend = "needs simulations; give sweep" if sweep is None else "has none; leave out sweep"
            msg = f"a map of '{quantity}' {mend}"
            raise UsageError(msg)
        if size > LARGEST and sweep is None:
            msg = (
                f"maps are for models with up to {LARGEST} states and elements, here {size}; "
                "draw the chart without one"
            )
            raise UsageError(msg)
        nodes = lattice.found
        places = np.array([node.place for node in nodes]).T
        return cls(lattice.plane, shape, quantity, places, np.array([n.X for n in nodes]).T, sweep)

    @property
    def tiles(self) -> int:
        """Number of tiles."""
        return len(self._corners)

    @cached_property
    def _corners(self) -> list[tuple[int, int]]:
        rows, columns = (range(0, n, self._side) for n in self.shape)
        return [(i, j) for i in rows for j in columns]

    @property
    def _side(self) -> int:
        return _SIDE if self.sweep is None else _SIDE_OF_SWEEPS

    def window(self, index: int) -> tuple[slice, slice]:
        """Return the cells of a tile, along both parameters."""
        i, j = self._corners[index]
        return (
            slice(i, min(i + self._side, self.shape[0])),
            slice(j, min(j + self._side, self.shape[1])),
        )

    @cached_property
    def fingerprint(self) -> str:
        """Digest of everything that the map depends on."""
        from racs_bif import __version__

        system, plane = self.plane.system, self.plane
        told = (__version__, system.compiled.digest, plane.names, plane.spans, self.shape)
        digest = hashlib.sha256(repr((*told, self.quantity, self._side, self.sweep)).encode())
        digest.update(repr((type(system).__name__, system.settings)).encode())
        for array in (system.values, self.places, self.states):
            digest.update(np.ascontiguousarray(array).tobytes())
        return digest.hexdigest()

    def compute(self, index: int) -> Tile:
        """Compute one tile; see `compute_tile`."""
        return compute_tile(self, index)

    def empty(self, shape: tuple[int, ...] | None = None) -> Tile:
        """Return the arrays of the whole map, or of another shape, with nothing known."""
        shape = self.shape if shape is None else shape
        whole: Tile = {
            "unstable": np.full(shape, NOTHING, dtype=np.int8),
            "evaluations": np.zeros(shape, dtype=np.int32),
        }
        if self.sweep is not None:
            whole |= nothing(shape)
        if self.quantity == "damping":
            whole["sigma"] = np.full(shape, np.nan)
            whole["omega"] = np.full(shape, np.nan)
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
        ``evaluations``, steps of simulations among them; ``sigma`` [1/s] and ``omega`` [rad/s] of
        the rightmost root, NaN where it is not certain; or ``value``, ``error`` and ``status`` of
        `racs_bif.charts.sweeps.swept`.
    """
    window = job.window(index)
    first, second = (
        (np.arange(part.start, part.stop) + 0.5) / n
        for part, n in zip(window, job.shape, strict=True)
    )
    places = np.array([a.ravel() for a in np.meshgrid(first, second, indexing="ij")])
    X, there = _equilibria(job, places)
    shape = (len(first), len(second))
    known = np.flatnonzero(there)
    tile = job.empty((places.shape[1],))
    if len(known):
        P = job.plane.vectors(places[:, known])
        _roots(job, tile, known, X[:, known], P)
        if job.sweep is not None:
            values, status, steps = swept(job.plane, job.quantity, job.sweep, X[:, known], P)
            for name, column in values.items():
                tile[name][known] = column
            tile["status"][known] = status
            counted = tile["evaluations"][known].astype(np.int64)
            tile["evaluations"][known] = (counted + steps).astype(np.int32)
    return {name: column.reshape(shape) for name, column in tile.items()}


def _roots(job: MapJob, tile: Tile, cells: NDArray[np.intp], X: Array, P: Array) -> None:
    """Fill in what the characteristic roots tell of cells, at equilibria X (size, N)."""
    if job.plane.system.compiled.size > LARGEST:
        tile["unstable"][cells] = UNKNOWN
        return
    sheet = Sheet(job.plane)
    sums = expand(sheet.core(X, P), sheet.laws(P))
    counts = count_right(sums)
    tile["unstable"][cells] = counts.unstable
    tile["evaluations"][cells] = counts.evaluations
    if job.quantity != "damping":
        return
    found = rightmost(job.plane.system.exact, sums, X, P)
    tile["evaluations"][cells] = (counts.evaluations + found.evaluations).astype(np.int32)
    # Two ways to the same: a root right of the axis, and a count above zero.
    with np.errstate(invalid="ignore"):
        doubtful = (found.root.real > 0.0) != (counts.unstable > 0)
        near = np.abs(found.root.real) <= _AXIS * np.abs(found.root)
    wrong = doubtful & ~near & np.isfinite(found.root.real) & (counts.unstable >= 0)
    tile["unstable"][cells[wrong]] = UNKNOWN
    root = np.where(wrong, np.nan, found.root)
    tile["sigma"][cells], tile["omega"][cells] = root.real, root.imag


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
