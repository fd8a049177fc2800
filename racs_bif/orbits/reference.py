"""The orbit that phases are compared with, on the mesh that the next ones are computed on."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.orbits.radau import WEIGHTS

if TYPE_CHECKING:
    from racs_bif.orbits.mesh import Mesh
    from racs_bif.symbolic.field import Array


@dataclass(frozen=True, eq=False)
class Reference:
    """A mesh, and an orbit on it that fixes the phase of its neighbours.

    The phase condition is AUTO's and MatCont's: the shift in time that brings x closest to the
    reference r in the mean square is zero, integral <x - r, r'> ds = 0. States are divided by their
    scales, so that it does not depend on units.

    Parameters
    ----------
    mesh : Mesh
        The steps.
    stages : array (N, s, n)
        The reference orbit at the points of a quadrature.
    velocities : array (N, s, n)
        Its derivative with respect to time in units of the period.
    scales : array (n,)
        Typical magnitudes of the variation of the states, positive.
    degenerate : bool
        Whether `stages` is an equilibrium, from which a branch of orbits starts.
    quadrature : array (s,)
        Weights of the quadrature on a step, by default those of the Radau points.
    """

    mesh: Mesh
    stages: Array
    velocities: Array
    scales: Array
    degenerate: bool = False
    quadrature: Array = field(default_factory=lambda: WEIGHTS)

    @cached_property
    def weights(self) -> Array:
        """Weights (N, s, n) of the phase condition, normalised: a shift by t gives t."""
        quadrature = self.mesh.widths[:, None, None] * self.quadrature[:, None]
        weights = quadrature * self.velocities / self.scales**2
        return np.asarray(weights / np.sum(weights * self.velocities))

    def phase(self, stages: Array) -> float:
        """Return the shift in time, in units of the period, to first order."""
        return float(np.sum(self.weights * (stages - self.stages)))

    def correlation(self, stages: Array) -> float:
        """Return the cosine between two orbits' departures from their means.

        It is close to 1 along a branch, and close to -1 across an equilibrium of no amplitude, on
        whose other side the same orbits are met again, half a period later.
        """
        quadrature = self.mesh.widths[:, None, None] * self.quadrature[:, None]
        here = (stages - np.sum(quadrature * stages, axis=(0, 1))) / self.scales
        if self.degenerate:
            return 1.0
        mean = np.sum(quadrature * self.stages, axis=(0, 1))
        there = (self.stages - mean) / self.scales
        lengths = np.sum(quadrature * here**2) * np.sum(quadrature * there**2)
        if lengths == 0.0:
            return 0.0
        return float(np.sum(quadrature * here * there) / np.sqrt(lengths))
