"""All boundaries in a plane: seeds from a quadtree of counts, boundaries by continuation."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.charts.boundary import Boundary, Seed, trace_boundary
from racs_bif.charts.edges import Edge, cross, torn
from racs_bif.charts.ends import ENDS
from racs_bif.charts.lattice import Key, Lattice
from racs_bif.errors import ConvergenceError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from racs_bif.charts.plane import Plane
    from racs_bif.charts.settings import ChartSettings

_LINK = 0.1
"""Nodes along a fold farther apart than this are no neighbours."""
_FELT = {"margin": ("hopf",), "static": ("static", "fold")}
"""Distances to instability, and what they go to zero at."""
_HIDES = 0.75
"""A root's distance to the axis that falls by this share from node to node may vanish between."""

_BESIDE = 4
"""Cells that a boundary passes are divided into so many each way: another may pass beside it."""

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
    spacing : int
        Side of its first cells.
    boundaries : list of Boundary
        What was traced.
    edges : dict of (Key, Key) to Edge
        Sides of the cells, in their smallest pieces.
    hopeless : dict of (Key, Key) or int to int
        Edges that lead to no boundary, and how many boundaries were known then.
    unexplained : list of (Key, Key) or int
        Edges whose ends differ for no boundary that was found, by their nodes or place in `chain`.
    chain : list of Edge
        Edges along folds, on the side of the equilibrium.
    different : dict of (Key, Key) to bool
        Edges, and whether their ends have different equilibria.
    torn : int
        How many of the search's edges have: there are several equilibria over part of the plane.
    troubles : list of str
        Boundaries that could not be traced.
    """

    lattice: Lattice
    cells: list[Cell]
    spacing: int
    boundaries: list[Boundary] = field(default_factory=list)
    edges: dict[EdgeKey, Edge] = field(default_factory=dict)
    hopeless: dict[EdgeKey | int, int] = field(default_factory=dict)
    unexplained: list[EdgeKey | int] = field(default_factory=list)
    chain: list[Edge] = field(default_factory=list)
    different: dict[EdgeKey, bool] = field(default_factory=dict)
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
        name = f"tracing boundary {len(found.boundaries) + 1}"
        points = itertools.count(1)
        tell(name)
        return trace_boundary(
            plane,
            seed,
            settings,
            lyapunov=lyapunov,
            marks=marks,
            progress=lambda _: tell(f"{name}: {next(points)} points"),
        )

    lattice = Lattice(plane, settings.depth)
    spacing = 2 ** (settings.depth - settings.coarse)
    tell("searching")
    lattice.begin(spacing)
    steps = range(0, lattice.side, spacing)
    found = Search(lattice, [(i, j, spacing) for i in steps for j in steps], spacing)
    while True:
        found.edges = _sides(found)
        _cross(found)
        _trace_all(found, follow)
        _trace_folds(found, follow)
        unsure = [cell for cell in found.cells if cell[2] > 1 and _hides(found, cell)]
        if not unsure:
            break
        tell(f"refining: {len(lattice.nodes)} places counted")
        _divide(found, unsure)
    return found


def _trace_all(found: Search, follow: Callable[[Seed], Boundary]) -> None:
    """Trace boundaries until they explain every edge, or no more can be found.

    Counts of different equilibria may differ: edges between such are `_trace_folds`'s.
    """
    apart = set[EdgeKey | int](_tear(found))
    hopeless = apart | {key for key, n in found.hopeless.items() if n == len(found.boundaries)}
    while True:
        new = False
        for key, edge in _all_edges(found):
            if key in hopeless or edge.explained(found.boundaries):
                continue
            new |= _lead(found, edge, follow)
            if not edge.explained(found.boundaries):
                hopeless.add(key)
                found.hopeless[key] = len(found.boundaries)
        if not new:
            break
    found.unexplained = [
        key
        for key, edge in _all_edges(found)
        if key not in apart and not edge.explained(found.boundaries)
    ]


def _lead(found: Search, edge: Edge, follow: Callable[[Seed], Boundary]) -> bool:
    """Trace the boundary that an edge leads to, and say whether there is one."""
    seed = edge.seed(found.boundaries)
    if seed is None:
        return False
    try:
        _keep(found, follow(seed))
    except (ConvergenceError, np.linalg.LinAlgError) as error:
        found.troubles.append(f"a {seed.kind} boundary could not be traced: {error}")
        return False
    return True


def _trace_folds(found: Search, follow: Callable[[Seed], Boundary]) -> None:
    """Trace folds behind which the equilibria of neighbouring nodes are not the same."""
    for key in _tear(found):
        for line in found.edges[key].beyond():
            if not line.explained(found.boundaries):
                _lead(found, line, follow)


def _tear(found: Search) -> list[EdgeKey]:
    """Return the edges whose ends have different equilibria."""
    new = [key for key in found.edges if key not in found.different]
    found.different |= dict(zip(new, torn([found.edges[key] for key in new]), strict=True))
    apart = [key for key in found.edges if found.different[key]]
    found.torn = len(apart)
    return apart


def _keep(found: Search, boundary: Boundary) -> None:
    """Take in a boundary: what it crosses; along a fold look for others that end there."""
    found.boundaries.append(boundary)
    if boundary.kind in ENDS:
        nodes = found.lattice.along(found.lattice.plane.places(boundary.values.T).T)
        found.chain += [
            Edge(found.lattice, a, b)
            for a, b in pairwise(nodes)
            if float(np.hypot(*(a.place - b.place))) < _LINK
        ]
    _cross(found)


def _cross(found: Search) -> None:
    cross([edge for _, edge in _all_edges(found)], found.boundaries)


def _all_edges(found: Search) -> list[tuple[EdgeKey | int, Edge]]:
    """Return every edge with its name."""
    return [*found.edges.items(), *enumerate(found.chain)]


def _sides(found: Search) -> dict[EdgeKey, Edge]:
    """Return the sides of all cells, in their smallest pieces."""
    pieces: set[EdgeKey] = set()
    for i, j, h in found.cells:
        corners = ((i, j), (i + h, j), (i + h, j + h), (i, j + h))
        for a, b in zip(corners, (*corners[1:], corners[0]), strict=True):
            pieces.update(_pieces(found.lattice, min(a, b), max(a, b)))
    known, nodes = found.edges, found.lattice.nodes
    return {
        key: known.get(key) or Edge(found.lattice, nodes[key[0]], nodes[key[1]])
        for key in sorted(pieces)
    }


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
    counts = {nodes[key].count for key in corners if nodes[key].found}
    if len(counts) > 1 and h * _BESIDE > found.spacing:
        return True
    if len(counts) != 1 or min(counts) < 0:
        return False
    known = [key for key in corners if lattice.known(key)]
    for name, kinds in _FELT.items():
        lowest = min(abs(getattr(nodes[key], name)) for key in known)
        if lowest < _HIDES * _steepest(lattice, known, h, name) and not _near(found, cell, kinds):
            return True
    return False


def _steepest(lattice: Lattice, corners: list[Key], h: int, name: str) -> float:
    """Return how much a distance to instability changes, at most, from a corner to a neighbour."""
    changes = [0.0]
    for i, j in corners:
        here = abs(getattr(lattice.nodes[i, j], name))
        around = ((i + h, j), (i - h, j), (i, j + h), (i, j - h))
        changes += [
            abs(here - abs(getattr(lattice.nodes[key], name)))
            for key in around
            if lattice.known(key)
        ]
    return max(changes)


def _near(found: Search, cell: Cell, kinds: tuple[str, ...]) -> bool:
    """Say whether a boundary passes within a cell's side of it: that is what its corners feel."""
    i, j, h = cell
    side = h / found.lattice.side
    low = np.array([i, j]) / found.lattice.side - side
    high = low + 3.0 * side
    return any(
        bool(np.any(np.all((b.line >= low) & (b.line <= high), axis=1)))
        for b in found.boundaries
        if b.kind in kinds
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
