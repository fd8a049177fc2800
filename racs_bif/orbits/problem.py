"""What all discretisations of periodic orbits have in common."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from racs_bif.continuation.problem import Problem
from racs_bif.orbits.orbit import Orbit

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from racs_bif.continuation.points import Point
    from racs_bif.orbits.floquet import Floquet
    from racs_bif.symbolic.field import Array, VectorField

_SEED: Final = 20240


class OrbitProblem(Problem):
    """A boundary-value problem of periodic orbits, by whichever discretisation.

    Detectors, curves and results ask for nothing more than this. The spectrum is the Floquet
    multipliers with the trivial one first; stability never asks that one.

    Attributes
    ----------
    field : VectorField
        The right-hand side.
    """

    field: VectorField

    @abstractmethod
    def period(self, z: Array) -> float:
        """Return the period, in units of time."""

    @abstractmethod
    def degenerate(self, z: Array) -> bool:
        """Return whether `z` is no proper orbit, such as the Hopf point that a branch starts from.

        Test functions are not defined there: with no amplitude the period is free, and the branch
        of equilibria passes through.
        """

    @abstractmethod
    def floquet(self, z: Array) -> Floquet:
        """Return the multipliers and the error of the trivial one."""

    @abstractmethod
    def extrema(self, z: Array) -> tuple[Array, Array]:
        """Return the highest and the lowest values (n,) of the states."""

    @abstractmethod
    def sample(self, z: Array, fractions: Array) -> Array:
        """Return the states (n, m) at fractions (m,) of the period."""

    def magnitudes(self, z: Array) -> Array:
        """Return the scales of the unknowns with that of the parameter."""
        return np.append(self.scales(z), max(1.0, abs(z[-1])))

    def singularity(self, z: Array, tangent: Array) -> float:
        """Return how far [jacobian; tangent] is from singular, with the sign of its determinant.

        The matrix is scaled by the magnitudes of the unknowns. The estimate of its smallest
        singular value is |r| / |A^-1 r| for a vector r that is always the same; it passes through
        zero linearly. The determinant keeps its sign from mesh to mesh.
        """
        magnitudes = self.magnitudes(z)
        row = tangent / magnitudes
        row /= np.linalg.norm(row)
        matrix = np.concatenate((self.jacobian(z) * magnitudes, row[None]))
        sign = np.linalg.slogdet(matrix)[0]
        if sign == 0.0:
            return 0.0
        right = np.random.default_rng(_SEED).standard_normal(len(z))
        solution = np.linalg.solve(matrix, right)
        return float(sign * np.linalg.norm(right) / np.linalg.norm(solution))

    def orbit(self, z: Array, samples: int = 201) -> Orbit:
        """Return the orbit as a result, sampled at equal times over one period."""
        found = self.floquet(z)
        highest, lowest = self.extrema(z)
        fractions = np.linspace(0.0, 1.0, samples)
        return Orbit(
            states=self.field.states,
            parameter=self.parameter,
            value=float(z[-1]),
            period=self.period(z),
            times=fractions * self.period(z),
            profile=self.sample(z, fractions),
            maxima=highest,
            minima=lowest,
            multipliers=found.multipliers,
            stable=None if self.degenerate(z) else self.stable(found.multipliers),
            trivial_error=found.trivial_error,
        )

    def measures(self, z: Array) -> dict[str, float]:
        """Return the period, the highest and lowest value of each state and the trivial error."""
        highest, lowest = self.extrema(z)
        measures = {"period": self.period(z)}
        for j, state in enumerate(self.field.states):
            measures[f"max {state}"] = float(highest[j])
            measures[f"min {state}"] = float(lowest[j])
        measures["trivial error"] = self.floquet(z).trivial_error
        return measures

    def remarks(self, z: Array) -> dict[str, float | str]:
        """Return what else there is to know about an orbit, by default nothing."""
        del z
        return {}

    def spectrum(self, z: Array) -> NDArray[np.complex128]:
        """Return the multipliers (n,), the trivial one first; none of what is no proper orbit."""
        if self.degenerate(z):
            return np.empty(0, dtype=complex)
        return self.floquet(z).multipliers

    def unstable(self, spectrum: NDArray[np.complex128]) -> int:
        """Return how many multipliers other than the trivial one are outside the unit circle."""
        return int(np.count_nonzero(self.sides(spectrum)))

    def sides(self, spectrum: NDArray[np.complex128]) -> NDArray[np.bool_]:
        """Return which multipliers (n,) are outside the unit circle, the trivial one exempt."""
        outside = np.asarray(np.abs(spectrum) > 1.0)
        outside[:1] = False
        return outside


def describe(problem: OrbitProblem, point: Point) -> dict[str, Any]:
    """Return what every special point of cycles reports: period, multipliers, trivial error."""
    return {
        "period": problem.period(point.z),
        "multipliers": point.spectrum,
        "trivial_error": float(abs(point.spectrum[0] - 1.0)),
    }
