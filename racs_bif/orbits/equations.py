"""The collocation equations of periodic orbits at one set of unknowns, and their linearisation."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from racs_bif.errors import ConvergenceError
from racs_bif.orbits.banded import Band, BandedStages, band
from racs_bif.orbits.checked import CheckedField
from racs_bif.orbits.intervals import Linearised
from racs_bif.orbits.lowrank import CONDITION, LowRankStages, Modes, modes
from racs_bif.orbits.stages import FactoredStages, InvertedStages, Stages, interval_matrices

if TYPE_CHECKING:
    from racs_bif.orbits.piecewise import Piecewise
    from racs_bif.symbolic.field import Array, VectorField
    from racs_bif.symbolic.paths import ParameterPath
    from racs_bif.symbolic.structure import Structure

_RANK: Final = 0.4
"""Rank of what varies over the number of states up to which the low-rank elimination is taken."""
_INVERTED: Final = 28
"""Unknowns of an interval up to which an explicit inverse is faster than factors (measured)."""
_SMALL: Final = 8
"""States from which on it, or a banded one, is faster than the dense one (measured)."""


Active = float | NDArray[np.float64]
"""One active parameter, or an array (a,) of them."""


class Collocated:
    """A curve with its period and parameter, and f along it.

    Attributes
    ----------
    curve : Piecewise
        The curve.
    period : float
        Period.
    active : float or array (a,)
        Active parameters.
    tau : array (N,)
        Lengths of the intervals in time.
    stages, rates : array (N, m, n)
        Values at the Gauss points and f there.
    """

    def __init__(self, curve: Piecewise, period: float, active: Active, rates: Array) -> None:
        self.curve, self.period, self.active = curve, period, active
        self.tau = period * curve.mesh.widths
        self.rates = rates

    @property
    def times(self) -> Array:
        """Starts of the intervals in time (N,)."""
        return self.period * self.curve.mesh.nodes[:-1]

    def defects(self) -> Array:
        """Return p' - tau f at the Gauss points (N, m, n)."""
        g = self.curve.gauss
        return np.asarray(g.slopes @ self.curve.closed - self.tau[:, None, None] * self.rates)


class Equations:
    """Evaluates and linearises the collocation equations of a vector field.

    Parameters
    ----------
    field : VectorField
        The right-hand side.
    path : ParameterPath
        Where the active parameter leads.
    """

    def __init__(self, field: VectorField, path: ParameterPath) -> None:
        self.checked = CheckedField(field)
        self._field, self._path = field, path
        self._band: Band | None = None

    def collocated(self, curve: Piecewise, period: float, active: Active) -> Collocated:
        """Return the equations at a curve.

        Raises
        ------
        ConvergenceError
            If unknowns or right-hand side are not finite, or the period is not positive.
        ModelError
            If the right-hand side raises or returns a wrong shape.
        """
        known = np.isfinite(period) and np.all(np.isfinite(active))
        if not (known and np.isfinite(curve.nodes.sum())):
            raise ConvergenceError("the orbit became infinite")
        if period <= 0.0:
            raise ConvergenceError(f"the period became {period:.6g}, which is not positive")
        times = period * curve.mesh.nodes[:-1]
        rates = self.checked.rates(curve.stages(), self._path.vector(active), times)
        return Collocated(curve, period, active, rates)

    def rates(self, points: Array, active: Active) -> Array:
        """Return f at points (N, n)."""
        p = self._path.vector(active)
        return self.checked.rates(points[:, None, :], p, np.zeros(len(points)))[:, 0]

    def columns(self, at: Collocated) -> Array:
        """Return the derivatives (1 + a, N, m, n) of tau f by period and parameters."""
        p, stages = self._path.vector(at.active), at.curve.stages()
        columns = [at.curve.mesh.widths[:, None, None] * at.rates]
        for k in range(len(self._path.names)):
            dp = self._path.direction(at.active, k)
            by_active = self.checked.by_parameter(stages, p, dp, at.times)
            columns.append(at.tau[:, None, None] * by_active)
        return np.stack(columns)

    def jacobians(self, at: Collocated) -> Array:
        """Return f_x at the Gauss points (N, m, n, n)."""
        p = self._path.vector(at.active)
        return self.checked.jacobians(at.curve.stages(), p, at.times)

    def linearised(self, at: Collocated, scales: Array) -> Linearised:
        """Return the linearised equations with the states in units of `scales` (n,).

        Raises
        ------
        ConvergenceError
            If the equations of an interval are singular.
        """
        columns = self.columns(at) / scales
        try:
            stages = self._low_rank(at, scales) or self._full(at, scales)
        except np.linalg.LinAlgError as error:
            raise ConvergenceError(
                "the equations of a mesh interval are singular: take more intervals"
            ) from error
        return Linearised(at.curve.gauss, stages, columns)

    def _full(self, at: Collocated, scales: Array) -> Stages:
        balanced = self.jacobians(at) * (scales / scales[:, None])
        g = at.curve.gauss
        if len(scales) >= _SMALL:
            pattern = np.any(balanced != 0.0, axis=(0, 1))
            if self._band is None or not self._band.holds(pattern):
                self._band = band(pattern)
            if self._band.narrow:
                return BandedStages(g, balanced, at.tau, self._band)
        matrices = interval_matrices(g, balanced, at.tau)
        if g.degree * len(scales) <= _INVERTED:
            return InvertedStages(g, matrices)
        return FactoredStages(g, matrices)

    def _low_rank(self, at: Collocated, scales: Array) -> Stages | None:
        """Return the elimination by modes, None where it does not pay or is not accurate."""
        size = len(scales)
        structure = self._field.structure(self._path.vector(at.active))
        if structure is None or size < _SMALL or structure.rank > _RANK * size:
            return None
        varying = self._varying(structure, at)
        left, right = structure.left / scales[:, None], structure.right * scales
        # around their mean the varying entries disturb the modes least
        middle = varying.mean(axis=(0, 1))
        constant = structure.constant * (scales / scales[:, None]) + left @ middle @ right
        basis = _modes(constant)
        if basis is None:
            return None
        varying -= middle
        return LowRankStages(at.curve.gauss, basis, left, right, varying, at.tau)

    @staticmethod
    def _varying(structure: Structure, at: Collocated) -> Array:
        stages = at.curve.stages()
        points = np.ascontiguousarray(stages.reshape(-1, stages.shape[-1]).T)
        varying = structure.varying(points)
        if not np.isfinite(varying.sum()):
            raise ConvergenceError("the Jacobian is not finite along the orbit")
        return varying.reshape(*stages.shape[:2], *varying.shape[1:])


def _modes(matrix: Array) -> Modes | None:
    try:
        basis = modes(matrix)
    except np.linalg.LinAlgError:
        return None
    return basis if basis.condition < CONDITION else None
