"""The search's places: equilibria and index counts on a lattice that is refined where needed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.charts.counting import Counts, count_right
from racs_bif.charts.sheet import Sheet
from racs_bif.charts.sums import LARGEST, expand
from racs_bif.errors import ConvergenceError, ModelError
from racs_bif.fractional.mikhailov import mikhailov_count

if TYPE_CHECKING:
    from collections.abc import Iterable

    from racs_bif.charts.plane import Plane
    from racs_bif.symbolic.field import Array

BEYOND, NOTHING, UNCOUNTED = -3, -2, -1
"""The mass matrix is singular on the way there; no equilibrium was found; there is one, but its
roots cannot be counted."""
Key = tuple[int, int]
_AROUND = ((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1))
_SHORT_OF = 0.97
_ASIDE = (0.0137, 0.0419, 0.1093)
_UNEQUAL = np.array([1.0, 0.6])
"""Shares of a move aside: along a diagonal it would not leave a boundary that runs along it."""
_REACH = 4.0
"""Moves aside, in their lengths, that may lead past a boundary to where an equilibrium was lost."""
_TRIALS = (0.5, 0.0, 1.0, 0.25, 0.75)


@dataclass(frozen=True)
class Node:
    """A place of the lattice.

    Parameters
    ----------
    count : int
        Unstable roots, or `BEYOND`, `NOTHING`, `UNCOUNTED`.
    X : array (size,)
        The equilibrium.
    margin, static : float
        Relative distance of a root to the imaginary axis, and of one to s = 0.
    omega : float
        Frequency at which the margin is least.
    place : array (2,)
        Where it is: a little aside where a root was on the axis.
    """

    count: int
    X: Array
    margin: float
    static: float
    omega: float
    place: Array

    @property
    def found(self) -> bool:
        """Whether there is an equilibrium."""
        return self.count > NOTHING


class Counter:
    """Counts unstable roots at equilibria, and how many determinants that took.

    Parameters
    ----------
    sheet : Sheet
        Its plane and its model.
    """

    def __init__(self, sheet: Sheet) -> None:
        self.sheet = sheet
        self.evaluations = 0

    def __call__(self, X: Array, P: Array) -> tuple[Counts, Array]:
        """Return counts and static margins (N,) at equilibria X (size, N), parameters P (np, N)."""
        core, laws = self.sheet.core(X, P), self.sheet.laws(P)
        static = _static_margin(self.sheet.static(core, laws))
        if self.sheet.size > LARGEST:
            counts = self._one_by_one(X, P)
        else:
            counts = count_right(expand(core, laws))
        self.evaluations += int(counts.evaluations.sum())
        return counts, static

    def _one_by_one(self, X: Array, P: Array) -> Counts:
        """Count for models too large for all their minors; no margin is known then."""
        exact, n = self.sheet.plane.system.exact, X.shape[1]
        unstable, evaluations = np.full(n, UNCOUNTED), np.zeros(n, dtype=np.int64)
        for k in range(n):
            try:
                found = mikhailov_count(exact, X[:, k], P[:, k])
            except ConvergenceError:
                continue
            unstable[k] = UNCOUNTED if found.unstable is None else found.unstable
            evaluations[k] = found.evaluations
        return Counts(unstable, np.ones(n), np.zeros(n), evaluations)


class Lattice:
    """Nodes at whole numbers from 0 to ``2**depth`` in both directions.

    Parameters
    ----------
    plane : Plane
        The plane.
    depth : int
        Of the finest lattice.
    """

    def __init__(self, plane: Plane, depth: int) -> None:
        self.plane, self.side = plane, 2**depth
        self.sheet = Sheet(plane)
        self.counter = Counter(self.sheet)
        self.nodes: dict[Key, Node] = {}
        self.beside: list[Node] = []
        self._scale: Array | None = None
        self._short: dict[Key, float] = {}

    def place(self, key: Key) -> Array:
        """Return the place (2,) of a node, present or not, in the unit square."""
        node = self.nodes.get(key)
        return np.array(key, dtype=float) / self.side if node is None else node.place

    def known(self, key: Key) -> bool:
        """Say whether there is an equilibrium at a node."""
        return key in self.nodes and self.nodes[key].found

    @property
    def found(self) -> list[Node]:
        """The nodes at which there is an equilibrium."""
        return [node for node in self.nodes.values() if node.found]

    @property
    def scale(self) -> Array:
        """Largest magnitudes (size,) of the states at the nodes."""
        if self._scale is None:
            X = np.array([node.X for node in self.found])
            scale = np.abs(X).max(axis=0)
            self._scale = np.maximum(scale, 1e-9 * max(float(scale.max()), 1e-3))
        return self._scale

    def begin(self, spacing: int) -> None:
        """Fill the lattice of a spacing, from wherever the model's guess leads to an equilibrium.

        Raises
        ------
        ConvergenceError
            If it leads to none, anywhere.
        """
        place, X = self._first()
        keys = [
            (i, j)
            for i in range(0, self.side + 1, spacing)
            for j in range(0, self.side + 1, spacing)
        ]
        keys.sort(key=lambda key: float(np.hypot(*(self.place(key) - place))))
        for key in keys[:4]:
            at = self.place(key)
            found, reached = self.sheet.follow(X[:, None], place[:, None], at[:, None])
            if reached[0] == 1.0:
                self._record([key], found, at[:, None])
                break
        else:
            raise ConvergenceError(self._lost())
        self.add(keys, spacing)

    def _first(self) -> tuple[Array, Array]:
        """Return a place at which there is an equilibrium, and the equilibrium."""
        places = [] if self.plane.nominal is None else [self.plane.nominal]
        places += [np.array([x, y]) for x in _TRIALS for y in _TRIALS]
        system = self.plane.system
        for place in places:
            p = self.plane.vectors(place[:, None])[:, 0]
            try:
                return place, system.exact_point(system.equilibrium(p), p)
            except (ConvergenceError, ModelError):
                continue
        raise ConvergenceError(self._lost())

    def _lost(self) -> str:
        spans = " and ".join(
            f"{name} {low:g} to {high:g}"
            for name, (low, high) in zip(self.plane.names, self.plane.spans, strict=True)
        )
        return (
            f"no equilibrium of model '{self.plane.system.name}' found anywhere in {spans}; give "
            "the model a better guess, or other spans"
        )

    def add(self, keys: Iterable[Key], spacing: int) -> None:
        """Add nodes, each continued from a neighbour at a spacing that has an equilibrium.

        Where that fails it is tried a little aside: a node may lie on a boundary.
        """
        pending = sorted(set(keys) - set(self.nodes))
        pending = self._spread(pending, spacing, 0.0)
        for aside in _ASIDE:
            before = len(pending)
            pending = self._spread(pending, spacing, aside)
            if len(pending) < before:
                pending = self._spread(pending, spacing, 0.0)
        nowhere = np.full(self.sheet.size, np.nan)
        counts = self._why_not(pending)
        for key, count in zip(pending, counts, strict=True):
            self.nodes[key] = Node(count, nowhere, np.nan, np.nan, np.nan, self.place(key))

    def _why_not(self, keys: list[Key]) -> list[int]:
        """Return why there is no equilibrium at nodes: `BEYOND` or `NOTHING`."""
        if not keys or not self.found:
            return [NOTHING] * len(keys)
        at = np.array([self.place(key) for key in keys])
        begun, known = self._nearest(at)
        P = self.plane.vectors(at.T)
        X, found, _ = self.sheet.newton(begun, P)
        X = np.where(found, X, begun)
        same = self.sheet.side(X, P) == self.sheet.side(begun, self.plane.vectors(known))
        return [NOTHING if here else BEYOND for here in same]

    def _nearest(self, at: Array) -> tuple[Array, Array]:
        """Return equilibria (size, N) and places (2, N) of the nodes nearest to places (N, 2)."""
        nodes = self.found
        places = np.array([node.place for node in nodes])
        nearest = np.hypot(*(at[:, None] - places).T).argmin(axis=0)
        return np.array([nodes[k].X for k in nearest]).T, places[nearest].T

    def along(self, line: Array) -> list[Node]:
        """Return nodes just before the places (N, 2) of a fold, on the side of the equilibrium.

        They are kept in `beside`; places that no node nearby leads to are left out.
        """
        X, start = self._nearest(line)
        end = start + _SHORT_OF * (line.T - start)
        X, reached = self.sheet.follow(X, start, end)
        good = np.flatnonzero(reached == 1.0)
        if not len(good):
            return []
        counts, static = self.counter(X[:, good], self.plane.vectors(end[:, good]))
        found = [
            Node(
                int(counts.unstable[j]),
                X[:, k].copy(),
                float(counts.margin[j]),
                float(static[j]),
                float(counts.omega[j]),
                end[:, k].copy(),
            )
            for j, k in enumerate(good)
        ]
        self.beside += found
        return found

    def _spread(self, pending: list[Key], spacing: int, aside: float) -> list[Key]:
        """Continue equilibria from node to node; return the nodes that are not reached.

        Aside only those are tried that were lost so near that a small move may help.
        """
        tried: set[tuple[Key, Key]] = set()
        far = _REACH * aside / self.side
        near = {key for key in pending if aside == 0.0 or self._short.get(key, 0.0) <= far}
        while pending:
            jobs = []
            for key in (key for key in pending if key in near):
                around = ((key[0] + spacing * i, key[1] + spacing * j) for i, j in _AROUND)
                source = next((k for k in around if self.known(k) and (key, k) not in tried), None)
                if source is not None:
                    jobs.append((key, source))
            if not jobs:
                break
            tried.update(jobs)
            start = np.array([self.place(source) for _, source in jobs]).T
            end = self._aside(np.array([self.place(key) for key, _ in jobs]).T, aside)
            X = np.array([self.nodes[source].X for _, source in jobs]).T
            X, reached = self.sheet.follow(X, start, end)
            short = (1.0 - reached) * np.hypot(*(end - start))
            for (key, _), left in zip(jobs, short.tolist(), strict=True):
                self._short[key] = min(self._short.get(key, np.inf), left)
            good = np.flatnonzero(reached == 1.0)
            if len(good):
                self._record([jobs[k][0] for k in good], X[:, good], end[:, good])
            pending = [key for key in pending if key not in self.nodes]
        return pending

    def _aside(self, places: Array, by: float) -> Array:
        """Return places moved inwards by a share of the finest spacing."""
        inwards = np.where(places > 0.5, -1.0, 1.0)
        return np.asarray(places + by / self.side * _UNEQUAL[:, None] * inwards)

    def _record(self, keys: list[Key], X: Array, at: Array) -> None:
        self._scale = None
        counts, static = self.counter(X, self.plane.vectors(at))
        unstable = counts.unstable.copy()
        for aside in _ASIDE:
            lost = np.flatnonzero(unstable < 0)
            if not len(lost):
                break
            # Beside a boundary that runs along the lattice its nodes can be counted again.
            moved = self._aside(at[:, lost], aside)
            found, reached = self.sheet.follow(X[:, lost], at[:, lost], moved)
            again = self.counter(found, self.plane.vectors(moved))[0].unstable
            good = (reached == 1.0) & (again >= 0)
            at[:, lost[good]], X[:, lost[good]] = moved[:, good], found[:, good]
            unstable[lost[good]] = again[good]
        for k, key in enumerate(keys):
            self.nodes[key] = Node(
                int(unstable[k]),
                X[:, k].copy(),
                float(counts.margin[k]),
                float(static[k]),
                float(counts.omega[k]),
                at[:, k].copy(),
            )


def _static_margin(jacobian: Array) -> Array:
    """Return |det| over the product of the rows' lengths (N,), with its sign."""
    lengths = np.linalg.norm(jacobian, axis=2, keepdims=True)
    lengths[lengths == 0.0] = 1.0
    return np.asarray(np.linalg.det(jacobian / lengths))
