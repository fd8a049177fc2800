"""Edges of the search's cells: which boundaries cross them, and seeds of those still missing."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.charts.boundary import Seed
from racs_bif.charts.crossing import alike, between, intersections
from racs_bif.charts.edge_path import EdgePath
from racs_bif.charts.ends import ENDS, end_seed
from racs_bif.charts.lattice import NOTHING, UNCOUNTED, Lattice, Node
from racs_bif.errors import ConvergenceError
from racs_bif.fractional.exact_hopf import solve_hopf
from racs_bif.numerics.bracketing import root

if TYPE_CHECKING:
    from collections.abc import Sequence

    from racs_bif.charts.boundary import Boundary
    from racs_bif.symbolic.field import Array

_HALVINGS = 12
_BESIDE = 1e-4
_BEYOND = 1e-6
_ALMOST = 0.05
"""Share of an edge by which boundaries where the equilibrium ends may pass beside it."""


@dataclass(frozen=True)
class Crossing:
    """Where a boundary crosses an edge.

    Parameters
    ----------
    share : float
        How far along the edge.
    boundary : int
        Which boundary.
    jump : int
        Change of the count along the edge; 0 where the equilibrium ends.
    """

    share: float
    boundary: int
    jump: int


@dataclass
class _Bracket:
    """A stretch of an edge: ends, how the counts there differ from what is explained, and X."""

    low: float
    high: float
    wrong: tuple[int, int]
    X: tuple[Array, Array]
    omega: tuple[float, float]

    @property
    def odd(self) -> bool:
        """Whether a real root crosses zero there."""
        return (self.wrong[1] - self.wrong[0]) % 2 == 1


class Edge:
    """A straight line between two nodes.

    Parameters
    ----------
    lattice : Lattice
        The nodes.
    start, end : Node
        Which; one of them has an equilibrium.
    """

    def __init__(self, lattice: Lattice, start: Node, end: Node) -> None:
        if not start.found:
            start, end = end, start
        self.lattice = lattice
        self.a, self.b = start, end
        self.start, self.end = start.place, end.place
        self.path = EdgePath(lattice.plane, self.start, self.end)
        self.crossed: list[list[Crossing]] = []

    def beyond(self) -> tuple[Edge, Edge]:
        """Return straight lines from both ends through the other one to the box."""
        lines = []
        for a, b in ((self.a, self.b), (self.b, self.a)):
            way = b.place - a.place
            moving = way != 0.0
            ahead = np.where(way > 0.0, 1.0 - a.place, a.place)
            room = np.where(moving, ahead / np.where(moving, np.abs(way), 1.0), np.inf)
            far = np.clip(a.place + way * float(room.min()), 0.0, 1.0)
            lines.append(Edge(self.lattice, a, replace(b, count=NOTHING, place=far)))
        return lines[0], lines[1]

    @property
    def counted(self) -> bool:
        """Whether both ends have counts."""
        return self.a.count >= 0 and self.b.count >= 0

    @property
    def ends(self) -> bool:
        """Whether the equilibrium ends between its ends."""
        return self.a.found and not self.b.found

    def follow(self, shares: Array) -> tuple[Array, Array]:
        """Return equilibria (size, k) at shares of it, continued from its start, and how far."""
        k = len(shares)
        X, begin = (
            np.repeat(self.a.X[:, None], k, axis=1),
            np.repeat(self.start[:, None], k, axis=1),
        )
        end = begin + shares * (self.end - self.start)[:, None]
        return self.lattice.sheet.follow(X, begin, end)

    def count(self, shares: Array) -> tuple[np.ndarray, Array, Array]:
        """Return counts (k,), equilibria (size, k) and frequencies (k,) at shares of the edge."""
        X, reached = self.follow(shares)
        at = self.start[:, None] + shares * (self.end - self.start)[:, None]
        counts, _ = self.lattice.counter(X, self.lattice.plane.vectors(at))
        unstable = np.where(reached == 1.0, counts.unstable, NOTHING)
        return unstable, X, counts.omega

    def crossings(self, boundaries: list[Boundary]) -> list[Crossing]:
        """Return where boundaries cross, in order; those of other equilibria are left out."""
        cross([self], boundaries)
        everything = [crossing for found in self.crossed for crossing in found]
        return sorted(everything, key=lambda crossing: crossing.share)

    @property
    def beside(self) -> float:
        """How far beside a boundary, in shares of the edge, its equilibria are told apart."""
        return _BESIDE / float(np.hypot(*(self.end - self.start)))

    def jump(self, share: float, boundary: Boundary, place: float) -> int:
        """Return how the count changes where a boundary crosses: at a share, a place on it."""
        gradient = between(boundary.gradient, place)
        if np.all(np.isfinite(gradient)):
            return 2 if float(gradient @ (self.end - self.start)) > 0.0 else -2
        both = np.clip(np.array([share - self.beside, share + self.beside]), 0.0, 1.0)
        unstable = self.count(both)[0]
        return int(unstable[1] - unstable[0]) if unstable.min() >= 0 else 0

    def explained(self, boundaries: list[Boundary]) -> bool:
        """Say whether the boundaries account for how the ends differ."""
        if self.ends:
            return any(boundaries[c.boundary].kind in ENDS for c in self.crossings(boundaries))
        if not self.counted:
            return True
        crossed = self.crossings(boundaries)
        return self.b.count - self.a.count == sum(crossing.jump for crossing in crossed)

    def seed(self, boundaries: list[Boundary]) -> Seed | None:
        """Return a point of a boundary that is not there yet, None where none is found."""
        if self.ends:
            return end_seed(self)
        crossed = self.crossings(boundaries)

        def explained(share: float) -> int:
            return self.a.count + sum(c.jump for c in crossed if c.share < share)

        bracket = _Bracket(
            0.0,
            1.0,
            (0, self.b.count - explained(1.0 + _BEYOND)),
            (self.a.X, self.b.X),
            (self.a.omega, self.b.omega),
        )
        for _ in range(_HALVINGS):
            found = self._solve(bracket)
            if found is not None and not self._there(found, boundaries):
                return found
            if found is None and bracket.odd:
                return None  # the equilibrium is lost where a real root would cross zero
            middle = 0.5 * (bracket.low + bracket.high)
            if any(abs(c.share - middle) < 1e-3 * (bracket.high - bracket.low) for c in crossed):
                middle += 0.11 * (bracket.high - bracket.low)
            unstable, X, omega = self.count(np.array([middle]))
            if unstable[0] in {NOTHING, UNCOUNTED}:
                return None
            wrong = int(unstable[0]) - explained(middle)
            at = X[:, 0], float(omega[0])
            if wrong != bracket.wrong[0]:
                bracket = _Bracket(
                    bracket.low,
                    middle,
                    (bracket.wrong[0], wrong),
                    (bracket.X[0], at[0]),
                    (bracket.omega[0], at[1]),
                )
            else:
                bracket = _Bracket(
                    middle,
                    bracket.high,
                    (wrong, bracket.wrong[1]),
                    (at[0], bracket.X[1]),
                    (at[1], bracket.omega[1]),
                )
        return None

    def _solve(self, bracket: _Bracket) -> Seed | None:
        return self._static(bracket) if bracket.odd else self._hopf(bracket)

    def _hopf(self, bracket: _Bracket) -> Seed | None:
        exact = self.lattice.plane.system.exact
        width = bracket.high - bracket.low
        guesses = [
            (bracket.low + share * width, X, omega)
            for omega in bracket.omega
            for share, X in ((0.5, 0.5 * (bracket.X[0] + bracket.X[1])),)
            if omega > 0.0
        ]
        for share, X, omega in guesses:
            try:
                hopf = solve_hopf(exact, self.path, X, share, omega)
            except (ConvergenceError, ArithmeticError, np.linalg.LinAlgError):
                continue
            slack = 1e-9
            inside = bracket.low - slack <= hopf.value <= bracket.high + slack
            if inside and self._same_sheet(hopf.value, hopf.X):
                return Seed("hopf", hopf.X, self.place(hopf.value), hopf.omega)
        return None

    def _static(self, bracket: _Bracket) -> Seed | None:
        sheet = self.lattice.sheet

        def sign(share: float, low: float, high: float) -> tuple[float, float]:
            del low, high
            X, reached = self.follow(np.array([share]))
            if reached[0] < 1.0:
                return share, float("nan")
            at = self.place(share)[:, None]
            jacobian = sheet.equations(self.lattice.plane.vectors(at))(X)[1][0]
            scale = np.linalg.norm(jacobian, axis=1, keepdims=True)
            return share, float(np.linalg.det(jacobian / np.where(scale > 0.0, scale, 1.0)))

        low, high = bracket.low, bracket.high
        ends = sign(low, low, high)[1], sign(high, low, high)[1]
        if not ends[0] * ends[1] < 0.0:
            return None
        found = root(sign, (low, high, *ends), 1e-12)
        if found is None:
            return None
        share = 0.5 * (found[0] + found[1])
        X, _ = self.follow(np.array([share]))
        return Seed("static", X[:, 0], self.place(share))

    def place(self, share: float) -> Array:
        """Return the place (2,) at a share of it."""
        return np.clip(self.start + share * (self.end - self.start), 0.0, 1.0)

    def _same_sheet(self, share: float, X: Array) -> bool:
        own, reached = self.follow(np.array([min(max(share, 0.0), 1.0)]))
        return reached[0] == 1.0 and alike(own[:, 0], X, self.lattice.scale)

    def _there(self, seed: Seed, boundaries: list[Boundary]) -> bool:
        """Say whether a seed is on a boundary that was traced already."""
        for boundary in boundaries:
            if boundary.kind != seed.kind:
                continue
            ends = self.start[:, None], self.end[:, None]
            _, shares, places = intersections(*ends, boundary)
            for share, place in zip(shares.tolist(), places.tolist(), strict=True):
                near = np.hypot(*(self.place(share) - seed.place)) < 10.0 * _BESIDE
                omega = between(boundary.omega, place)
                if near and (seed.kind != "hopf" or abs(omega - seed.omega) < 0.02 * omega):
                    return True
        return False


def cross(edges: Sequence[Edge], boundaries: list[Boundary]) -> None:
    """Find where boundaries cross edges that do not know it yet, all edges at once."""
    for k, boundary in enumerate(boundaries):
        new = [edge for edge in edges if len(edge.crossed) == k]
        if new:
            for edge in new:
                edge.crossed.append([])
            last = boundary.kind in ENDS
            asked = [edge for edge in new if edge.counted or (last and edge.ends)]
            if asked:
                _crossed(asked, boundary, k)


def _crossed(edges: Sequence[Edge], boundary: Boundary, number: int) -> None:
    start, end = (np.array([getattr(edge, at) for edge in edges]).T for at in ("start", "end"))
    # a node may be on where the equilibrium ends, or as near as the line between its points is
    beside, way = _ALMOST if boundary.kind in ENDS else 0.0, end - start
    which, shares, places = intersections(start - beside * way, end + beside * way, boundary)
    shares = (1.0 + 2.0 * beside) * shares - beside
    found = list(zip(which.tolist(), shares.tolist(), places.tolist(), strict=True))
    if boundary.kind in ENDS or not found:
        for e, share, _ in found:
            edges[e].crossed[-1].append(Crossing(share, number, 0))
        return
    before = np.array([edges[e].beside if boundary.kind == "static" else 0.0 for e, _, _ in found])
    at = np.maximum(shares - before, 0.0)
    X = np.array([edges[e].a.X for e in which]).T
    begin = start[:, which]
    lattice = edges[0].lattice
    own, reached = lattice.sheet.follow(X, begin, begin + at * (end[:, which] - begin))
    for j, (e, share, place) in enumerate(found):
        # others belong to another equilibrium than the edge's ends have
        if reached[j] == 1.0 and alike(own[:, j], between(boundary.states, place), lattice.scale):
            jump = edges[e].jump(share, boundary, place)
            edges[e].crossed[-1].append(Crossing(share, number, jump))


def torn(edges: Sequence[Edge]) -> list[bool]:
    """Say of edges whether the equilibria at their ends are not continued into each other."""
    both = [k for k, edge in enumerate(edges) if edge.a.found and edge.b.found]
    told = [False] * len(edges)
    if not both:
        return told
    lattice = edges[0].lattice
    start, end = (
        [
            np.array([getattr(getattr(edges[k], side), what) for k in both]).T
            for what in ("X", "place")
        ]
        for side in ("a", "b")
    )
    own, reached = lattice.sheet.follow(start[0], start[1], end[1])
    for column, k in enumerate(both):
        same = alike(own[:, column], end[0][:, column], lattice.scale)
        told[k] = not (reached[column] == 1.0 and same)
    return told
