"""The orbit that phases are compared with in harmonic balance."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.orbits.fourier import subharmonics

if TYPE_CHECKING:
    from racs_bif.symbolic.field import Array


@dataclass(frozen=True, eq=False)
class PhaseReference:
    """An orbit that fixes the phase of its neighbours: integral <x - r, r'> ds = 0.

    Attributes
    ----------
    series : array (2H + 1, m)
        The orbit.
    velocities : array (2H + 1, m)
        Its derivative by the angle.
    scales : array (m,)
        Typical amplitudes of the unknowns, positive.
    degenerate : bool
        Whether the orbit is an equilibrium, from which a branch starts.
    """

    series: Array
    velocities: Array
    scales: Array
    degenerate: bool = False

    @cached_property
    def weights(self) -> Array:
        """Weights (2H + 1, m), normalised: a shift by an angle gives the angle."""
        weights = self.velocities / self.scales**2
        return np.asarray(weights / np.sum(weights * self.velocities))

    def phase(self, series: Array) -> float:
        """Return the angle by which a series is ahead, to first order."""
        return float(np.sum(self.weights * (series - self.series)))

    def correlation(self, series: Array) -> float:
        """Return the cosine between two orbits' departures from their means."""
        if self.degenerate:
            return 1.0
        here, there = series[1:] / self.scales, self.series[1:] / self.scales
        lengths = float(np.linalg.norm(here) * np.linalg.norm(there))
        return float(np.sum(here * there)) / lengths if lengths else 0.0

    def halved(self, series: Array, smallest: float) -> bool:
        """Return whether the halves of a doubled orbit are the same, or have changed places.

        No odd harmonics are left of it then, or they have changed sign.
        """
        here = subharmonics(series) / self.scales
        if float(np.linalg.norm(here, axis=0).max()) < smallest:
            return True
        if self.degenerate:
            return False
        return float(np.sum(here * subharmonics(self.series) / self.scales)) < 0.0
