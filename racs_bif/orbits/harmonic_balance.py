"""Periodic orbits by harmonic balance on the exact fractional operator."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.continuation.stopped import Stopped
from racs_bif.errors import ConvergenceError, UsageError
from racs_bif.orbits.balance_harmonics import wanted_harmonics
from racs_bif.orbits.balance_settings import BalanceSettings
from racs_bif.orbits.fourier import (
    amplitudes,
    evaluated,
    extrema,
    harmonics_of,
    resized,
    tails,
    turned,
)
from racs_bif.orbits.phase_reference import PhaseReference
from racs_bif.orbits.problem import FEWEST_TOLD, TOLD_PER_UNKNOWN, OrbitProblem
from racs_bif.orbits.realised_orbit import multipliers_along, realised_states

if TYPE_CHECKING:
    from racs_bif.continuation.points import Point
    from racs_bif.fractional.exact import ExactModel
    from racs_bif.fractional.realised import RealisedField
    from racs_bif.orbits.balance import Balance, Balanced
    from racs_bif.orbits.floquet import Floquet
    from racs_bif.symbolic.field import Array
    from racs_bif.symbolic.paths import ParameterPath

STABILITY: Final = "monodromy of the realisation along the exact orbit"
"""Where the multipliers come from."""

TAIL: Final = 3
"""Unknowns after the coefficients: period, number of the reference, parameter."""
_SAME: Final = 1e-9
_POLISHING: Final = 6


class HarmonicBalanceProblem(OrbitProblem):
    """Periodic orbits of the exact model, by harmonic balance.

    The unknowns are z = (c, T, g, lambda): the Fourier coefficients (2H + 1, m) of the unknowns
    that no affine equation gives, the period, the number of the phase condition in use, and the
    active parameter. An accepted orbit makes the phase condition of the next; a solution thus
    knows, by its number, the equations that it solves.

    Multipliers belong to the realisation: its variational equation is integrated along the exact
    orbit. The distance of the trivial one from 1 is then what the realisation costs.

    Parameters
    ----------
    model : ExactModel
        The exact model; the realisation of its field serves for the multipliers.
    path : ParameterPath
        Where the active parameter leads.
    balance : Balance
        Its equations.
    reference : PhaseReference
        The first phase condition.
    settings : BalanceSettings, optional
        Harmonics, multipliers, ends.
    turns : int
        2 where the branch begins at a period doubling; see `OrbitProblem`.
    """

    field: RealisedField

    def __init__(
        self,
        model: ExactModel,
        path: ParameterPath,
        balance: Balance,
        reference: PhaseReference,
        settings: BalanceSettings | None = None,
        *,
        turns: int = 1,
    ) -> None:
        self.name = "periodic orbits by harmonic balance"
        self.turns = turns
        self.parameter = path.names[0]
        self.field = model.field
        self.model = model
        self.path = path
        self.balance = balance
        self.settings = settings or BalanceSettings()
        self.trivial, self.operator = self.settings.trivial, self.settings.operator
        self._references: list[PhaseReference] = [reference]
        self._width = len(balance.kept)
        self._solution: tuple[bytes, Balanced] | None = None
        self._floquet: tuple[bytes, Floquet] | None = None
        self._first_period: float | None = None

    # ------------------------------------------------------------------ the unknowns

    def join(self, series: Array, period: float, active: float, number: int = 0) -> Array:
        """Return z from a series (2H + 1, m), period, parameter and number of the reference."""
        return np.concatenate((series.ravel(), (period, float(number), active)))

    def series(self, z: Array) -> Array:
        """Return the unknown series (2H + 1, m)."""
        return z[:-TAIL].reshape(-1, self._width)

    def unknown_states(self, z: Array) -> Array:
        """Return the unknown series (2H + 1, m)."""
        return self.series(z)

    def period(self, z: Array) -> float:
        """Return the period, in units of time."""
        return float(z[-3])

    def harmonics(self, z: Array) -> int:
        """Return the number of harmonics."""
        return harmonics_of(self.series(z))

    def telling(self, z: Array) -> Array:
        """Return equal steps, several for each coefficient of a state."""
        steps = max(FEWEST_TOLD, TOLD_PER_UNKNOWN * (2 * self.harmonics(z) + 1))
        return np.linspace(0.0, 1.0, steps + 1)

    def tail(self, z: Array) -> float:
        """Return the largest of the last harmonics, relative to the orbit: its error."""
        return float(tails(self.series(z)).max())

    def reference(self, z: Array) -> PhaseReference:
        """Return the phase condition that `z` belongs to.

        Raises
        ------
        UsageError
            If it belongs to none of this problem's.
        """
        number = round(float(z[-2]))
        if 0 <= number < len(self._references):
            reference = self._references[number]
            if reference.series.size == len(z) - TAIL:
                return reference
        raise UsageError(
            f"{len(z)} unknowns with phase condition {number} are no orbit of this branch: "
            "continue from its profile instead"
        )

    # ------------------------------------------------------------------ the equations

    def solution(self, z: Array) -> Balanced:
        """Return the balance at `z`.

        Raises
        ------
        ConvergenceError
            If the period is not positive or the equations are not finite on the orbit.
        """
        key = z.tobytes()
        if self._solution is None or self._solution[0] != key:
            self._solution = (key, self._exactly(z))
        return self._solution[1]

    def _exactly(self, z: Array) -> Balanced:
        """Return the balance at `z` without keeping it, for what needs no Jacobian."""
        return self.balance.at(self.series(z).copy(), self.period(z), float(z[-1]))

    def _near(self, z: Array) -> Balanced:
        """Return the balance at `z`, or where it is known within rounding of it."""
        if self._solution is not None:
            known = np.frombuffer(self._solution[0])
            if len(known) == len(z):
                distance = np.abs(z - known) / self._magnitudes(z)
                distance[-2] = 0.0
                if float(distance.max()) < _SAME:
                    return self._solution[1]
        return self.solution(z)

    def residual(self, z: Array) -> Array:
        """Return what does not balance, the phase and the number's distance."""
        reference = self.reference(z)
        residual = self.solution(z).residual.ravel()
        number = z[-2] - np.round(z[-2])
        return np.concatenate((residual, (reference.phase(self.series(z)), number)))

    def jacobian(self, z: Array) -> Array:
        """Return the exact derivative ((2H + 1) m + 2, (2H + 1) m + 3) of the residual."""
        solution, count = self._near(z), len(z) - TAIL
        jacobian = np.zeros((count + 2, count + TAIL))
        jacobian[:count, :count] = solution.jacobian.reshape(count, count)
        by_period, by_parameter = solution.slopes
        jacobian[:count, -3], jacobian[:count, -1] = by_period.ravel(), by_parameter.ravel()
        jacobian[-2, :count] = self.reference(z).weights.ravel()
        jacobian[-1, -2] = 1.0
        return jacobian

    # ------------------------------------------------------------------ what the engine asks

    def degenerate(self, z: Array) -> bool:
        """Return whether there is no amplitude, or it has changed sign at an equilibrium."""
        series, reference = self.series(z), self.reference(z)
        if self.at_crossing(z):
            return True
        if self.turns == 2:
            return reference.halved(series, self.settings.smallest)
        relative = amplitudes(series) / reference.scales
        if float(relative.max()) < self.settings.smallest:
            return True
        return reference.correlation(series) < 0.0

    def floquet(self, z: Array) -> Floquet:
        """Return the multipliers of the realisation along the exact orbit."""
        key = z.tobytes()
        if self._floquet is None or self._floquet[0] != key:
            found = multipliers_along(self._near(z), self.field, self.settings)
            self._floquet = (key, found)
        return self._floquet[1]

    def scales(self, z: Array) -> Array:
        """Return the scales of the unknowns, the same for all harmonics, the period, and 1."""
        series = np.tile(self.reference(z).scales, 2 * self.harmonics(z) + 1)
        return np.concatenate((series, (abs(self.period(z)), 1.0)))

    def ends(self, point: Point) -> Stopped | None:
        """Return why the branch ends here: long period, no amplitude left, too few harmonics."""
        z = point.z
        if self._first_period is None:
            self._first_period = self.period(z)
        if self.period(z) > self.settings.longest * self._first_period:
            return Stopped.PERIOD
        if self.degenerate(z):
            return None if self.reference(z).degenerate else self.vanished
        full = self.harmonics(z) >= self.settings.most_harmonics
        if full and self.tail(z) > self.settings.poorest:
            return Stopped.ACCURACY
        return None

    def adapt(self, z: Array, tangent: Array) -> tuple[Array, Array] | None:
        """Take this orbit as the reference of the next, with as many harmonics as its tail asks."""
        if self.degenerate(z):
            return None
        wanted = wanted_harmonics(self.series(z), self.settings)
        if wanted != self.harmonics(z):
            # if that fails the present ones serve, until they no longer do and the branch ends
            with suppress(ConvergenceError, np.linalg.LinAlgError):
                return self.with_harmonics(z, wanted, tangent)
        return self._follow(z), tangent

    # ------------------------------------------------------------------ harmonics

    def _follow(self, z: Array) -> Array:
        """Return `z` with this orbit itself as the reference of its phase."""
        series = self.series(z).copy()
        scales = np.maximum(self.reference(z).scales, amplitudes(series))
        self._references.append(PhaseReference(series, turned(series), scales))
        followed = np.array(z)
        followed[-2] = len(self._references) - 1
        return followed

    def with_harmonics(
        self, z: Array, harmonics: int, tangent: Array | None = None
    ) -> tuple[Array, Array]:
        """Solve for the same orbit with another number of harmonics.

        Parameters
        ----------
        z : array ((2H + 1) m + 3,)
            A solution.
        harmonics : int
            The number wanted.
        tangent : array ((2H + 1) m + 3,), optional
            The direction in which not to move; without it the parameter is held.

        Returns
        -------
        tuple of array ((2H' + 1) m + 3,)
            The solution, its own phase reference, and the direction of the branch; the direction
            is that of the parameter where no tangent is given.

        Raises
        ------
        ConvergenceError, numpy.linalg.LinAlgError
            If the orbit is not found.
        """
        there = self._resized(z, harmonics)
        reference = self.reference(z)
        series = self.series(there)
        self._references.append(PhaseReference(series, turned(series), reference.scales))
        there[-2] = len(self._references) - 1
        held = np.zeros(len(z)) if tangent is None else tangent.copy()
        held[-1] = 1.0 if tangent is None else held[-1]
        direction = self._resized(held, harmonics)
        magnitudes = self._magnitudes(there)
        there, tangential = self._polished(there, direction / magnitudes**2)
        there = self._follow(there)
        if tangent is None:
            return there, direction
        length = np.linalg.norm(direction / magnitudes) / np.linalg.norm(tangential / magnitudes)
        return there, tangential * length

    def solved(self, z: Array) -> Array:
        """Solve for the orbit near `z` at its parameter.

        Raises
        ------
        ConvergenceError, numpy.linalg.LinAlgError
            If Newton's method does not converge.
        """
        held = np.zeros(len(z))
        held[-1] = 1.0
        return self._polished(z, held)[0]

    def _resized(self, z: Array, harmonics: int) -> Array:
        return np.concatenate((resized(self.series(z), harmonics).ravel(), z[-TAIL:]))

    def _magnitudes(self, z: Array) -> Array:
        return np.append(self.scales(z), max(1.0, abs(z[-1])))

    def _polished(self, z: Array, row: Array) -> tuple[Array, Array]:
        """Return the solution on the hyperplane through `z`, and the direction of the branch."""
        magnitudes = self._magnitudes(z)
        rhs = np.zeros((len(z), 2))
        rhs[-1, 1] = 1.0
        for _ in range(_POLISHING):
            rhs[:-1, 0] = self.residual(z)
            step, direction = self.bordered(z, row)(rhs).T
            z = z - step
            size = float(np.abs(step / magnitudes).max())
            if size < _SAME:
                return z, direction
            if not size < 1.0:
                break
        raise ConvergenceError("the orbit was not found: Newton's method does not converge")

    # ------------------------------------------------------------------ results

    def extrema(self, z: Array) -> tuple[Array, Array]:
        """Return the highest and the lowest values (n,) of the states."""
        return extrema(realised_states(self._exactly(z), self.field))

    def sample(self, z: Array, fractions: Array) -> Array:
        """Return the states (n, m) at fractions (m,) of the period.

        Those of the realisation's memory are its steady response to the exact orbit.
        """
        return evaluated(realised_states(self._exactly(z), self.field), fractions)

    def remarks(self, z: Array) -> dict[str, float | str]:
        """Return how the orbit was resolved and where its multipliers come from."""
        return {
            "harmonics": float(self.harmonics(z)),
            "tail": self.tail(z),
            "stability by": STABILITY,
        }

    def measures(self, z: Array) -> dict[str, float]:
        """Return period, extremes of the model's states, tail, harmonics, and trivial error.

        Where a model is made of elements only, their outputs are what states are elsewhere.
        """
        compiled = self.balance.compiled
        highest, lowest = extrema(self._exactly(z).spectrum[:, : self.model.ny or None])
        measures = {"period": self.period(z)}
        for j, state in enumerate(compiled.states or compiled.elements):
            measures[f"max {state}"] = float(highest[j])
            measures[f"min {state}"] = float(lowest[j])
        measures["tail"] = self.tail(z)
        measures["harmonics"] = float(self.harmonics(z))
        measures["trivial error"] = self.floquet(z).trivial_error
        return measures
