"""The search behind `_stability`: equilibria, counts and Hopf points over C_s, many at once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif import load_model
from racs_bif.charts.counting import UNKNOWN, count_right
from racs_bif.charts.damping import rightmost
from racs_bif.charts.plane import Plane
from racs_bif.charts.sheet import Sheet
from racs_bif.charts.sums import expand
from racs_bif.errors import ConvergenceError
from racs_bif.fractional.exact_hopf import solve_hopf

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from racs_bif.fractional.system import System

    Array = NDArray[np.float64]

SPAN: Final = (5e2, 1e7)
"""Stiffnesses searched [N/rad], named by the paper's E_0 and d: another E_0 scales them."""
NEAR: Final = 0.5
"""Beyond this |delta_c| [rad] an equilibrium is not near straight running."""
SLOW: Final = 1.0
"""An unstable pair below this frequency [rad/s] is no shimmy but a slow motion of the law."""
NONE: Final = UNKNOWN - 1
"""The count where there is no equilibrium near straight running."""
_PIECES: Final = (4, 16, 64)
_STEP: Final = 0.02  # of the sideslip and compliance steering angles, rad
_HALVINGS: Final = 24
_INSIDE: Final = 8
_ROUNDS: Final = 3


@dataclass(frozen=True)
class Crossing:
    """A stiffness [N/rad] at which a pair of roots +-i omega is on the axis."""

    stiffness: float
    omega: float
    below: int
    above: int


@dataclass(frozen=True, eq=False)
class Nodes:
    """Points over the stiffness: which condition, stiffness, equilibrium, count, least |det|."""

    owner: NDArray[np.intp]
    stiffness: Array
    X: Array
    count: NDArray[np.int64]
    margin: Array
    omega: Array

    def take(self, which: NDArray[np.intp] | NDArray[np.bool_]) -> Nodes:
        """Return some of them."""
        return Nodes(
            self.owner[which],
            self.stiffness[which],
            self.X[:, which],
            self.count[which],
            self.margin[which],
            self.omega[which],
        )

    def join(self, other: Nodes) -> Nodes:
        """Return both, in the order of conditions and stiffnesses."""
        pairs = zip(vars(self).values(), vars(other).values(), strict=True)
        both = Nodes(*(np.concatenate(pair, axis=-1) for pair in pairs))
        return both.take(np.lexsort((both.stiffness, both.owner)))


class Search:
    """All conditions of one variant together: what can be done at once is done at once."""

    def __init__(self, variant: str, conditions: Sequence[Mapping[str, float]]) -> None:
        base = load_model("racs", variant=variant)
        self.unit = base.parameters["C_s"] / base.parameters["A_h"]
        self.systems = [base.with_parameters(condition) for condition in conditions]
        self.base = base
        self.sheet = Sheet(Plane(base, ("u", "C_s"), ((1.0, 100.0), SPAN)))
        self.row = [p.name for p in base.parameter_table].index("A_h")
        self.angle, self.lateral = base.states.index("delta_c"), base.states.index("v")
        self.speed = [p.name for p in base.parameter_table].index("u")
        self.P = np.array([system.values for system in self.systems]).T

    def parameters(self, owner: NDArray[np.intp], stiffness: Array) -> Array:
        """Return base parameters (np, N)."""
        P = self.P[:, owner]
        P[self.row] = stiffness / self.unit
        return P

    def solve(self, owner: NDArray[np.intp], stiffness: Array, X: Array) -> Nodes:
        """Return nodes, their equilibria solved near X and their unstable roots counted."""
        P = self.parameters(owner, stiffness)
        X, found, _ = self.sheet.newton(X, P)
        found &= np.abs(X[self.angle]) < NEAR
        X[:, ~found] = np.nan
        count = np.full(len(owner), NONE, dtype=np.int64)
        margin, omega = np.full(len(owner), np.nan), np.full(len(owner), np.nan)
        if found.any():
            P, at = P[:, found], X[:, found]
            counts = count_right(expand(self.sheet.core(at, P), self.sheet.laws(P)))
            count[found], margin[found], omega[found] = counts.unstable, counts.margin, counts.omega
        return Nodes(owner, stiffness, X, count, margin, omega)

    def grid(self, resolution: int) -> Nodes:
        """Follow the equilibria over the grid, from where they are found to both its ends."""
        stiffness = np.geomspace(*SPAN, resolution)
        found = np.full((self.sheet.size, len(self.systems), resolution), np.nan)
        for j, system in enumerate(self.systems):
            start = self._start(system, stiffness)
            if start is not None:
                found[:, j, start[0]] = start[1]
        everyone = np.arange(len(self.systems))
        for along in (range(resolution - 2, -1, -1), range(1, resolution)):
            back = 1 if along.step < 0 else -1
            for k in along:
                open_ = everyone[np.isnan(found[0, :, k]) & ~np.isnan(found[0, :, k + back])]
                if len(open_):
                    ends = (float(stiffness[k + back]), float(stiffness[k]))
                    tried, good = self.follow(open_, found[:, open_, k + back], ends)
                    found[:, open_[good], k] = tried[:, good]
        owner = np.repeat(everyone, resolution)
        return self.solve(owner, np.tile(stiffness, len(everyone)), found.reshape(len(found), -1))

    def follow(
        self, owner: NDArray[np.intp], X: Array, ends: tuple[float, float]
    ) -> tuple[Array, NDArray[np.bool_]]:
        """Continue equilibria from one stiffness to another, where it is hard in many pieces."""
        tried, good = self._move(owner, X, ends[1])
        for pieces in _PIECES:
            left = np.flatnonzero(~good)
            if not len(left):
                break
            there, fine = X[:, left], np.ones(len(left), dtype=bool)
            for stiffness in np.geomspace(*ends, pieces + 1)[1:]:
                there, found = self._move(owner[left], there, float(stiffness))
                fine &= found
            tried[:, left[fine]], good[left] = there[:, fine], fine
        return tried, good & (np.abs(tried[self.angle]) < NEAR)

    def _move(
        self, owner: NDArray[np.intp], X: Array, stiffness: float
    ) -> tuple[Array, NDArray[np.bool_]]:
        """Take one step; one so long that it may have gone over a fold is none."""
        P = self.parameters(owner, np.full(len(owner), stiffness))
        tried, good, _ = self.sheet.newton(X, P)
        sideslip = np.abs(tried[self.lateral] - X[self.lateral]) / P[self.speed]
        turned = np.abs(tried[self.angle] - X[self.angle])
        return tried, good & (sideslip < _STEP) & (turned < _STEP)

    def _start(self, system: System, stiffness: Array) -> tuple[int, Array] | None:
        """Return the highest place on the grid where an equilibrium is found from the guess."""
        for k in range(len(stiffness) - 1, -1, -max(len(stiffness) // 40, 1)):
            there = system.with_parameters({"A_h": stiffness[k] / self.unit})
            try:
                x = there.equilibrium()
            except ConvergenceError:
                continue
            if abs(x[self.angle]) < NEAR:
                return k, there.exact_point(x, there.values)
        return None

    def hidden(self, nodes: Nodes) -> Nodes:
        """Look into cells in which a pair might cross the axis and come back."""
        for _ in range(_ROUNDS):
            slope = np.abs(np.diff(nodes.margin))
            before, after = np.roll(slope, 1), np.roll(slope, -1)
            with np.errstate(invalid="ignore"):
                least = np.minimum(nodes.margin[:-1], nodes.margin[1:])
                close = least < np.fmax(np.fmax(before, after), slope)
            cells = np.flatnonzero(close & self._cells(nodes) & (np.diff(nodes.count) == 0))
            if not len(cells):
                break
            shares = np.arange(1, _INSIDE) / _INSIDE
            a, b = nodes.take(cells), nodes.take(cells + 1)
            stiffness = np.exp(
                np.outer(1.0 - shares, np.log(a.stiffness)) + np.outer(shares, np.log(b.stiffness))
            ).ravel()
            X = np.repeat(0.5 * (a.X + b.X)[:, None, :], len(shares), axis=1)
            X = X.reshape(len(a.X), -1)
            nodes = nodes.join(self.solve(np.tile(a.owner, len(shares)), stiffness, X))
        return nodes

    @staticmethod
    def _cells(nodes: Nodes) -> NDArray[np.bool_]:
        """Tell which neighbours belong to one condition."""
        return np.asarray(np.diff(nodes.owner) == 0)

    def changes(self, nodes: Nodes) -> tuple[Nodes, Nodes]:
        """Return the two sides of every place where the count changes, halved down."""
        cells = np.flatnonzero((np.diff(nodes.count) != 0) & self._cells(nodes))
        a, b = nodes.take(cells), nodes.take(cells + 1)
        for _ in range(_HALVINGS if len(cells) else 0):
            X = np.where(np.isnan(a.X), b.X, a.X)
            middle = self.solve(a.owner, np.sqrt(a.stiffness * b.stiffness), X)
            # Of three counts the lower two are kept; with a root on the axis none is left to do.
            left, lost = middle.count == a.count, middle.count == UNKNOWN
            a, b = _either(left, middle, a), _either(~left & ~lost, middle, b)
        return a, b

    def polish(self, a: Nodes, b: Nodes, k: int) -> Crossing:
        """Solve the exact Hopf condition between two counts that differ by two."""
        owner = int(a.owner[k])
        system, path = self.systems[owner], self.systems[owner].path("A_h")
        guess = float(np.sqrt(a.stiffness[k] * b.stiffness[k])) / self.unit
        found = solve_hopf(system.exact, path, a.X[:, k], guess, float(a.omega[k]))
        return Crossing(found.value * self.unit, found.omega, int(a.count[k]), int(b.count[k]))

    def words(self, nodes: Nodes) -> NDArray[np.str_]:
        """Return the state at each node."""
        words = np.full(len(nodes.owner), "none", dtype="<U10")
        words[nodes.count == 0] = "stable"
        bad = np.flatnonzero(nodes.count > 0)
        root = self.rightmost(nodes, bad)
        pair = (nodes.count[bad] % 2 == 0) & (root.imag > 0.0)
        words[bad] = np.where(pair, np.where(root.imag > SLOW, "shimmy", "slow"), "divergence")
        return words

    def rightmost(self, nodes: Nodes, which: NDArray[np.intp]) -> NDArray[np.complex128]:
        """Return the rightmost roots of some nodes."""
        if not len(which):
            return np.empty(0, dtype=complex)
        P, X = self.parameters(nodes.owner[which], nodes.stiffness[which]), nodes.X[:, which]
        sums = expand(self.sheet.core(X, P), self.sheet.laws(P))
        return rightmost(self.base.exact, sums, X, P).root


def _either(choose: NDArray[np.bool_], one: Nodes, other: Nodes) -> Nodes:
    """Return column by column one or the other."""
    pairs = zip(vars(one).values(), vars(other).values(), strict=True)
    return Nodes(*(np.where(choose, x, y) for x, y in pairs))
