"""What all problems share whose orbits are piecewise polynomials, collocated at Gauss points."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.orbits.floquet import Floquet, floquet
from racs_bif.orbits.folded import Folds
from racs_bif.orbits.intervals import GROWTH, Linearised
from racs_bif.orbits.piecewise import Piecewise, equidistant
from racs_bif.orbits.problem import FEWEST_TOLD, TOLD_PER_UNKNOWN, OrbitProblem

if TYPE_CHECKING:
    from racs_bif.orbits.equations import Active, Collocated, Equations
    from racs_bif.orbits.reference import Reference
    from racs_bif.symbolic.field import Array

_SAME: Final = 1e-9
"""Relative distance below which the linearised equations are taken over: the root mean square of
the states, the period and the parameter."""
_FEWEST: Final = 4
"""Fewest products of transition matrices for the multipliers, so that small ones are not lost."""


class CollocatedProblem(OrbitProblem):
    """Orbits by collocation, whatever else is unknown beside them.

    Attributes
    ----------
    equations : Equations
        What is collocated.
    """

    equations: Equations
    chord = True

    def __init__(self) -> None:
        self._found: tuple[Array, Collocated] | None = None
        self._bases: list[tuple[Array, Linearised]] = []
        self._floquet: tuple[Array, Floquet] | None = None

    @abstractmethod
    def nodes(self, z: Array) -> Array:
        """Return the values of the orbit at the nodes (N, m, n)."""

    @abstractmethod
    def active(self, z: Array) -> Active:
        """Return the active parameter, or an array of them."""

    @abstractmethod
    def reference(self, z: Array) -> Reference:
        """Return the mesh and phase condition that `z` belongs to."""

    def curve(self, z: Array) -> Piecewise:
        """Return the orbit as a function of time."""
        return self.at(z).curve

    def telling(self, z: Array) -> Array:
        """Return times in the mesh's own intervals, several for each node."""
        return self.reference(z).mesh.dense(TOLD_PER_UNKNOWN * self.nodes(z).shape[1], FEWEST_TOLD)

    def at(self, z: Array) -> Collocated:
        """Return the equations at `z`, kept until they are asked for elsewhere."""
        if self._found is None or not np.array_equal(self._found[0], z):
            curve = Piecewise(self.reference(z).mesh, self.nodes(z).copy())
            at = self.equations.collocated(curve, self.period(z), self.active(z))
            self._found = (np.array(z), at)
        return self._found[1]

    def linearised(self, z: Array) -> Linearised:
        """Return the linearised equations at `z`, or where they are known within rounding of it."""
        for known, linearised in self._bases:
            if len(known) == len(z) and self._alike(known, z) and self._distance(known, z) < _SAME:
                return linearised
        linearised = self.equations.linearised(self.at(z), self.reference(z).scales)
        # two: where the mesh was adapted, detectors still ask for the orbit on the one before
        self._bases = [(np.array(z), linearised), *self._bases[:1]]
        return linearised

    def _alike(self, known: Array, z: Array) -> bool:
        """Return whether two orbits are on one mesh and in the same units."""
        there, here = self.reference(known), self.reference(z)
        return there.mesh is here.mesh and np.array_equal(there.scales, here.scales)

    def _distance(self, known: Array, z: Array) -> float:
        """Return how far two orbits are from each other, relative to their magnitudes."""
        states = (self.nodes(z) - self.nodes(known)) / self.reference(z).scales
        period = (self.period(z) - self.period(known)) / self.period(z)
        there, here = np.atleast_1d(self.active(known)), np.atleast_1d(self.active(z))
        moved = np.abs(here - there) / np.maximum(1.0, np.abs(here))
        mean = float(np.sqrt(np.mean(states**2)))
        return max(mean, abs(period), float(moved.max()))

    def floquet(self, z: Array) -> Floquet:
        """Return the multipliers, from the transition matrices of the intervals."""
        if self._floquet is None or not np.array_equal(self._floquet[0], z):
            scales = self.reference(z).scales
            folds = Folds(self.linearised(z).transitions, GROWTH, _FEWEST)
            starts = folds.begins(self.nodes(z)[:, 0])
            velocities = self.equations.rates(starts, self.active(z)) / scales
            self._floquet = (np.array(z), floquet(folds.products, velocities))
        return self._floquet[1]

    def vanishing(self, z: Array, before: Piecewise, smallest: float, turns: int = 1) -> bool:
        """Return whether the amplitude is small or has changed sign since the orbit before.

        Parameters
        ----------
        z : array
            The orbit.
        before : Piecewise
            An earlier orbit on the same mesh.
        smallest : float
            Smallest range, relative to the scales.
        turns : int
            What makes it a proper orbit: that it differs from its mean (1), or in its halves (2).
        """
        reference, curve = self.reference(z), self.curve(z)
        departures = _departures(curve, turns)
        relative = np.abs(departures).max(axis=(0, 1)) / reference.scales
        if 2.0 * float(relative.max()) < smallest:
            return True
        if reference.degenerate:
            return False
        weights = reference.mesh.widths[:, None, None] / reference.scales**2
        return float(np.sum(weights * departures * _departures(before, turns))) < 0.0

    def extrema(self, z: Array) -> tuple[Array, Array]:
        """Return the highest and the lowest values (n,) of the states."""
        return self.curve(z).extrema()

    def sample(self, z: Array, fractions: Array) -> Array:
        """Return the states (n, m) at fractions (m,) of the period."""
        return np.ascontiguousarray(self.curve(z)(fractions).T)


def _departures(curve: Piecewise, turns: int) -> Array:
    """Return an orbit at its nodes (N, m, n) less its mean, or half of its halves' difference.

    Half, so that both kinds are amplitudes.
    """
    if turns == 1:
        return np.asarray(curve.nodes - curve.mean())
    times = equidistant(curve.mesh, curve.gauss.degree)
    return np.asarray(0.5 * (curve.nodes - curve((times + 1.0 / turns) % 1.0)))
