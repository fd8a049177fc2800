"""What all discretisations of periodic orbits have in common."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from racs_bif.continuation.problem import Problem
from racs_bif.continuation.stopped import Stopped
from racs_bif.orbits.orbit import Orbit

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from racs_bif.continuation.points import Point
    from racs_bif.orbits.floquet import Floquet
    from racs_bif.symbolic.field import Array, VectorField
    from racs_bif.symbolic.paths import ParameterPath

FEWEST_TOLD: Final = 200
"""Fewest steps in time that an orbit is kept by."""
TOLD_PER_UNKNOWN: Final = 3
"""Times at which an orbit is kept, for each at which a method knows it."""
_SEED: Final = 20240
_SAMPLES: Final = 800
_ROUNDED: Final = 1e-10
"""A multiplier this little outside the unit circle is on it, as those around a centre are."""
_BESIDE: Final = 1e-6
"""Relative distance within which an orbit is the branch point that its branch begins at."""


class OrbitProblem(Problem):
    """A boundary-value problem of periodic orbits, by whichever discretisation.

    Detectors, curves and results ask for nothing more than this. The spectrum is the Floquet
    multipliers with the trivial one first; stability never asks that one.

    Attributes
    ----------
    field : VectorField
        The right-hand side.
    path : ParameterPath
        Where the active parameter leads.
    turns : int
        2 where the branch begins at a period doubling: an orbit is a proper one of this branch if
        its halves differ. Otherwise 1.
    trivial : float
        Largest error of the trivial multiplier, times its distance from the nearest other, at which
        the multipliers still tell whether an orbit is stable.
    crossing : array or None
        The branch point that the branch begins at, where it does: no test function is defined
        there, as two branches pass.
    """

    field: VectorField
    path: ParameterPath
    turns: int = 1
    trivial: float = 1e-3
    crossing: Array | None = None

    @property
    def vanished(self) -> Stopped:
        """Why a branch ends whose orbits are no proper ones any more."""
        return Stopped.HALVED if self.turns == 2 else Stopped.VANISHED

    @abstractmethod
    def reference(self, z: Array) -> Any:  # noqa: ANN401 - as the discretisation has it
        """Return the orbit that the phase of `z` is compared with; it has the states' scales."""

    @abstractmethod
    def unknown_states(self, z: Array) -> Array:
        """Return the unknowns that are states, (k, m): the columns belong to the same state."""

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

    def base(self, z: Array) -> Array:
        """Return the base parameters (np,)."""
        return self.path.vector(z[-len(self.path.names) :])

    def at_crossing(self, z: Array) -> bool:
        """Return whether `z` is the branch point that the branch begins at."""
        if self.crossing is None or len(z) != len(self.crossing):
            return False
        distance = (z - self.crossing) / self.magnitudes(z)
        distance[-2] = 0.0
        return float(np.abs(distance).max()) < _BESIDE

    def place(self, measure: str) -> int | None:
        """Return where in z the period is; no other measure is an unknown."""
        return -3 if measure == "period" else None

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

    @abstractmethod
    def telling(self, z: Array) -> Array:
        """Return fractions of the period, from 0 to 1, dense enough to keep the orbit by them."""

    def orbit(self, z: Array) -> Orbit:
        """Return the orbit as a result, sampled where it is told by."""
        found = self.floquet(z)
        highest, lowest = self.extrema(z)
        fractions = self.telling(z)
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
        measures |= self._swings_of_outputs(z)
        measures["trivial error"] = self.floquet(z).trivial_error
        return measures

    def _swings_of_outputs(self, z: Array) -> dict[str, float]:
        """Return the extremes of elements' outputs where a model has no states of its own."""
        found: dict[str, float] = {}
        if not self.field.stateless:
            return found
        states = self.sample(z, np.arange(_SAMPLES) / _SAMPLES)
        outputs = self.field.own_outputs(states, self.path.vector(z[-1]))
        for name, values in outputs.items():
            found[f"max {name}"] = _peak(values)
            found[f"min {name}"] = -_peak(-values)
        return found

    def remarks(self, z: Array) -> dict[str, float | str]:
        """Return what else there is to know about an orbit, by default nothing."""
        del z
        return {}

    def spectrum(self, z: Array) -> NDArray[np.complex128]:
        """Return the multipliers (n,), the trivial one first; none of what is no proper orbit."""
        if self.degenerate(z):
            return np.empty(0, dtype=complex)
        return self.floquet(z).multipliers

    def stable(self, spectrum: NDArray[np.complex128]) -> bool | None:
        """Return whether an orbit is stable; None where its multipliers are too poor to tell.

        As in `Floquet.health`, the error of the trivial multiplier counts by its distance from the
        nearest other.
        """
        if not len(spectrum):
            return None
        apart = np.abs(spectrum[1:] - spectrum[0])
        nearest = float(apart[np.isfinite(apart)].min(initial=1.0))
        if not abs(spectrum[0] - 1.0) * min(1.0, nearest) <= self.trivial:
            return None
        return self.unstable(spectrum) == 0

    def unstable(self, spectrum: NDArray[np.complex128]) -> int:
        """Return how many multipliers other than the trivial one are outside the unit circle."""
        return int(np.count_nonzero(self.sides(spectrum)))

    def sides(self, spectrum: NDArray[np.complex128]) -> NDArray[np.bool_]:
        """Return which multipliers (n,) are outside the unit circle, the trivial one exempt."""
        outside = np.asarray(np.abs(spectrum) > 1.0 + _ROUNDED)
        outside[:1] = False
        return outside


def describe(problem: OrbitProblem, point: Point) -> dict[str, Any]:
    """Return what every special point of cycles reports: period, multipliers, trivial error."""
    return {
        "period": problem.period(point.z),
        "multipliers": point.spectrum,
        "trivial_error": float(abs(point.spectrum[0] - 1.0)),
    }


def _peak(values: Array) -> float:
    """Return the highest value of a periodic function from its samples (m,), by a parabola."""
    k = int(np.argmax(values))
    before, at, after = values[k - 1], values[k], values[(k + 1) % len(values)]
    bend = 2.0 * at - before - after
    return float(at + (after - before) ** 2 / (8.0 * bend)) if bend > 0.0 else float(at)
