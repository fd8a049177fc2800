"""What becomes of straight running over the stiffness C_s: exact roots, counted and located.

For the studies `which_stiffness` and `claims`. Under a condition (parameter values) the
equilibrium near straight running is followed over a grid of stiffnesses, its unstable roots are
counted by the argument principle at all of them, and where the count changes the place is halved
down; where a pair crosses, the exact Hopf condition is solved. Cells in which a pair could cross
twice, judged by how fast the characteristic function on the axis changes, are looked into as well.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:  # the folder is no package; the shelf finds its files in every installation
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from analyses._stability_search import Array, Crossing, Search
else:
    from racs_bif.shelf.analyses._stability_search import Crossing, Search

VARIANTS: Final = ("paper", "printed", "printed12", "paper12", "restoring", "lagrange")


@dataclass(frozen=True)
class Stretch:
    """Stiffnesses from `low` to `high` [N/rad] over which the vehicle behaves in one way.

    `state` is ``stable``, ``shimmy`` (the rightmost root is one of an unstable pair), ``slow``
    (so is it, below `SLOW`), ``divergence`` (it is real) or ``none`` (no equilibrium).
    """

    low: float
    high: float
    state: str


@dataclass(frozen=True)
class Course:
    """What was found under one condition.

    Parameters
    ----------
    condition : dict of str to float
        Parameter values that differ from the defaults.
    stretches : tuple of Stretch
        They cover `SPAN`.
    hopf : tuple of Crossing
        All Hopf points in `SPAN`.
    """

    condition: Mapping[str, float]
    stretches: tuple[Stretch, ...]
    hopf: tuple[Crossing, ...]

    def where(self, *states: str) -> tuple[tuple[float, float], ...]:
        """Return the stiffnesses over which the vehicle is in one of the states."""
        found: list[tuple[float, float]] = []
        for stretch in self.stretches:
            if stretch.state not in states:
                continue
            if found and found[-1][1] == stretch.low:
                found[-1] = (found[-1][0], stretch.high)
            else:
                found.append((stretch.low, stretch.high))
        return tuple(found)

    def at(self, stiffness: float) -> str:
        """Return the state at one stiffness."""
        inside = (s for s in self.stretches if s.low <= stiffness <= s.high)
        return next(inside).state


def courses(
    variant: str, conditions: Sequence[Mapping[str, float]], resolution: int
) -> list[Course]:
    """Find out what straight running is over `SPAN`, under several conditions.

    Parameters
    ----------
    variant : str
        Variant of the vehicle.
    conditions : sequence of mappings of str to float
        Parameter values, SI; what is left out has its default.
    resolution : int
        Stiffnesses on the grid, evenly spaced in log C_s.

    Returns
    -------
    list of Course
        One for each condition.
    """
    keys = tuple(tuple(sorted(condition.items())) for condition in conditions)
    known = dict(
        zip(
            dict.fromkeys(keys),
            _courses(variant, tuple(dict.fromkeys(keys)), resolution),
            strict=True,
        )
    )
    return [known[key] for key in keys]


def counts_over(
    variant: str, conditions: Sequence[Mapping[str, float]], resolution: int
) -> tuple[Array, NDArray[np.int64], Array]:
    """Count the unstable roots on the grid alone.

    Parameters
    ----------
    variant, conditions, resolution
        As for `courses`.

    Returns
    -------
    (array (n,), int array (m, n), array (m, n))
        Stiffnesses [N/rad]; unstable roots, `NONE` without an equilibrium; and the frequency of the
        rightmost root where it is unstable [rad/s], otherwise NaN.
    """
    search = Search(variant, conditions)
    nodes = search.grid(resolution)
    omega = np.full(len(nodes.owner), np.nan)
    bad = np.flatnonzero(nodes.count > 0)
    omega[bad] = search.rightmost(nodes, bad).imag
    shape = (len(conditions), resolution)
    return nodes.stiffness[:resolution], nodes.count.reshape(shape), omega.reshape(shape)


@lru_cache(maxsize=64)
def _courses(
    variant: str, keys: tuple[tuple[tuple[str, float], ...], ...], resolution: int
) -> tuple[Course, ...]:
    search = Search(variant, [dict(key) for key in keys])
    nodes = search.hidden(search.grid(resolution))
    a, b = search.changes(nodes)
    crossings: list[list[Crossing]] = [[] for _ in keys]
    edges: list[list[float]] = [[] for _ in keys]
    for k in range(len(a.owner)):
        owner = int(a.owner[k])
        edge = float(np.sqrt(a.stiffness[k] * b.stiffness[k]))
        pair = min(a.count[k], b.count[k]) >= 0 and abs(int(a.count[k] - b.count[k])) == 2
        if pair:
            crossing = search.polish(a, b, k)
            crossings[owner].append(crossing)
            edge = crossing.stiffness
        edges[owner].append(edge)
    words = search.words(nodes)
    return tuple(
        Course(
            dict(key),
            _stretches(nodes.stiffness[mine], words[mine], nodes.count[mine], edges[j]),
            tuple(crossings[j]),
        )
        for j, key in enumerate(keys)
        for mine in (nodes.owner == j,)
    )


def _stretches(
    stiffness: Array, words: NDArray[np.str_], count: NDArray[np.int64], edges: list[float]
) -> tuple[Stretch, ...]:
    """Divide the span; where a state changes and the count does not, only the cell is known."""
    found = [Stretch(float(stiffness[0]), float(stiffness[0]), str(words[0]))]
    exact = iter(edges)
    for k in range(1, len(stiffness)):
        edge = float(np.sqrt(stiffness[k - 1] * stiffness[k]))
        if count[k] != count[k - 1]:
            edge = next(exact)
        if words[k] != words[k - 1]:
            found[-1] = replace(found[-1], high=edge)
            found.append(Stretch(edge, edge, str(words[k])))
    found[-1] = replace(found[-1], high=float(stiffness[-1]))
    return tuple(found)
