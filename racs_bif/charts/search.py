"""All boundaries in a plane: seeds from a quadtree of counts, boundaries by continuation."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.charts.boundary import Boundary, Seed, trace_boundary
from racs_bif.charts.edges import Edge
from racs_bif.charts.lattice import Key, Lattice
from racs_bif.errors import ConvergenceError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from racs_bif.charts.plane import Plane
    from racs_bif.charts.settings import ChartSettings

_HIDES = 0.75
"""A root's distance to the axis that falls by this share from node to node may vanish between."""

Cell = tuple[int, int, int]
"""Lower corner and side."""
EdgeKey = tuple[Key, Key]


@dataclass
class Search:
    """What a search found.

    Attributes
    ----------
    lattice : Lattice
        Nodes with their equilibria and counts.
    cells : list of (int, int, int)
        Leaves of the quadtree.
    boundaries : list of Boundary
        What was traced.
    unexplained : list of (Key, Key)
        Edges whose ends differ for no boundary that was found.
    torn : int
        Edges whose ends have different equilibria: there are several over part of the plane.
    troubles : list of str
        Boundaries that could not be traced.
    """

    lattice: Lattice
    cells: list[Cell]
    boundaries: list[Boundary] = field(default_factory=list)
    unexplained: list[EdgeKey] = field(default_factory=list)
    torn: int = 0
    troubles: list[str] = field(default_factory=list)

    @property
    def evaluations(self) -> int:
        """Characteristic matrices and their derivatives that the search took."""
        return self.lattice.counter.evaluations + sum(b.evaluations for b in self.boundaries)


def search(
    plane: Plane,
    settings: ChartSettings,
    *,
    lyapunov: bool = False,
    marks: Mapping[str, Sequence[float]] | None = None,
    progress: Callable[[str], None] | None = None,
) -> Search:
    """Find and trace the boundaries in a plane.

    Parameters
    ----------
    plane : Plane
        The plane.
    settings : ChartSettings
        How finely it is searched.
    lyapunov : bool
        Compute l1 along Hopf boundaries.
    marks : mapping of str to sequence of float, optional
        Values of the parameters at which points of boundaries are wanted exactly.
    progress : callable, optional
        Told what is being done.

    Raises
    ------
    ConvergenceError
        If there is no equilibrium anywhere in the plane.
    """
    tell = progress or (lambda _: None)

    def follow(seed: Seed) -> Boundary:
        tell(f"tracing boundary {len(found.boundaries) + 1}")
        return trace_boundary(plane, seed, settings, lyapunov=lyapunov, marks=marks)

    lattice = Lattice(plane, settings.depth)
    spacing = 2 ** (settings.depth - settings.coarse)
    tell("searching")
    lattice.begin(spacing)
    steps = range(0, lattice.side, spacing)
    found = Search(lattice, [(i, j, spacing) for i in steps for j in steps])
    edges: dict[EdgeKey, Edge] = {}
    while True:
        _trace_all(found, edges, follow)
        _trace_folds(found, edges, follow)
        unsure = [cell for cell in found.cells if cell[2] > 1 and _hides(found, cell)]
        if not unsure:
            break
        tell("refining")
        _divide(found, unsure)
    return found


def _trace_all(
    found: Search,
    edges: dict[EdgeKey, Edge],
    follow: Callable[[Seed], Boundary],
) -> None:
    """Trace boundaries until they explain every edge, or no more can be found."""
    hopeless: set[EdgeKey] = set()
    while True:
        new = False
        for key in _edges(found):
            edge = edges.get(key)
            if edge is None:
                edge = edges[key] = Edge(found.lattice, *(found.lattice.nodes[k] for k in key))
            if key in hopeless or edge.explained(found.boundaries):
                continue
            seed = edge.seed(found.boundaries)
            if seed is None:
                hopeless.add(key)
                continue
            try:
                boundary = follow(seed)
            except (ConvergenceError, np.linalg.LinAlgError) as error:
                found.troubles.append(f"a {seed.kind} boundary could not be traced: {error}")
                hopeless.add(key)
                continue
            found.boundaries.append(boundary)
            if not edge.explained(found.boundaries):
                hopeless.add(key)
            new = True
        if not new:
            break
    found.unexplained = [key for key in _edges(found) if not edges[key].explained(found.boundaries)]


def _trace_folds(
    found: Search,
    edges: dict[EdgeKey, Edge],
    follow: Callable[[Seed], Boundary],
) -> None:
    """Trace folds behind which the equilibria of neighbouring nodes are not the same."""
    keys = _edges(found)
    torn = [key for key in keys if edges[key].torn]
    found.torn = len(torn)
    for key in torn:
        for line in edges[key].beyond():
            if line.explained(found.boundaries):
                continue
            seed = line.seed(found.boundaries)
            if seed is None:
                continue
            try:
                found.boundaries.append(follow(seed))
            except (ConvergenceError, np.linalg.LinAlgError) as error:
                found.troubles.append(f"a fold boundary could not be traced: {error}")


def _edges(found: Search) -> list[EdgeKey]:
    """Return the sides of all cells, in their smallest pieces."""
    pieces: set[EdgeKey] = set()
    for i, j, h in found.cells:
        corners = ((i, j), (i + h, j), (i + h, j + h), (i, j + h))
        for a, b in zip(corners, (*corners[1:], corners[0]), strict=True):
            pieces.update(_pieces(found.lattice, min(a, b), max(a, b)))
    return sorted(pieces)


def _pieces(lattice: Lattice, a: Key, b: Key) -> Iterator[EdgeKey]:
    middle = ((a[0] + b[0]) // 2, (a[1] + b[1]) // 2)
    whole = abs(b[0] - a[0]) + abs(b[1] - a[1]) == 1
    if whole or middle not in lattice.nodes:
        yield a, b
    else:
        yield from _pieces(lattice, a, middle)
        yield from _pieces(lattice, middle, b)


def _hides(found: Search, cell: Cell) -> bool:
    """Say whether a cell may hide what its corners do not show."""
    i, j, h = cell
    lattice, nodes = found.lattice, found.lattice.nodes
    corners = ((i, j), (i + h, j), (i + h, j + h), (i, j + h))
    sides = {
        (min(a, b), max(a, b)) for a, b in zip(corners, (*corners[1:], corners[0]), strict=True)
    }
    if any(piece in sides for piece in found.unexplained):
        return True
    counts = {nodes[key].count for key in corners}
    if len(counts) > 1 or min(counts) < 0:
        return False
    for name in ("margin", "static"):
        lowest = min(abs(getattr(nodes[key], name)) for key in corners)
        steepest = 0.0
        for key in corners:
            for other in (
                (key[0] + h, key[1]),
                (key[0] - h, key[1]),
                (key[0], key[1] + h),
                (key[0], key[1] - h),
            ):
                if lattice.known(other):
                    change = abs(getattr(nodes[key], name)) - abs(getattr(nodes[other], name))
                    steepest = max(steepest, abs(change))
        if lowest < _HIDES * steepest and not _near(found, cell):
            return True
    return False


def _near(found: Search, cell: Cell) -> bool:
    """Say whether a boundary passes within a cell's side of it: that is what its corners feel."""
    i, j, h = cell
    side = h / found.lattice.side
    low = np.array([i, j]) / found.lattice.side - side
    high = low + 3.0 * side
    return any(
        bool(np.any(np.all((b.line >= low) & (b.line <= high), axis=1))) for b in found.boundaries
    )


def _divide(found: Search, cells: list[Cell]) -> None:
    """Quarter cells."""
    whole, keys = set(cells), []
    kept = [cell for cell in found.cells if cell not in whole]
    half = {cell[2] // 2 for cell in cells}
    for i, j, h in cells:
        k = h // 2
        keys += [(i + k, j), (i, j + k), (i + k, j + k), (i + h, j + k), (i + k, j + h)]
        kept += [(i, j, k), (i + k, j, k), (i, j + k, k), (i + k, j + k, k)]
    for k in sorted(half, reverse=True):
        found.lattice.add(
            [
                key
                for key in keys
                if key[0] % k == 0 and key[1] % k == 0 and (key[0] % (2 * k) or key[1] % (2 * k))
            ],
            k,
        )
    found.cells = sorted(kept)
