"""The linearised equations of collocation, solved by condensation of every interval and the ring.

The values at the Gauss points are eliminated interval by interval, which leaves a ring of
transition matrices from mesh point to mesh point, bordered by the columns of period and parameter
and the rows of the phase condition and of the engine.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.orbits.folded import BorderedFolds, Folds

if TYPE_CHECKING:
    from racs_bif.orbits.gauss import Gauss
    from racs_bif.orbits.stages import Stages
    from racs_bif.symbolic.field import Array

GROWTH: Final = 1e4
"""Norm up to which transition matrices are multiplied, relative to the scales of the states."""


class Linearised:
    """The equations B Y = A^-1 1 x + C u + rhs of all intervals, which meet at their ends.

    x are the mesh points (N, n), Y the values at the Gauss points (N, m, n), u the two unknowns
    beside the orbit: period and parameter. States are in units of their scales.

    Parameters
    ----------
    coefficients : Gauss
        Of the degree.
    stages : Stages
        Elimination of Y.
    columns : array (2, N, m, n)
        C.
    """

    def __init__(self, coefficients: Gauss, stages: Stages, columns: Array) -> None:
        self.gauss, self.stages, self.columns = coefficients, stages, columns
        self.transitions = stages.transitions()

    @cached_property
    def folds(self) -> Folds:
        """The transition matrices, multiplied as far as they do not grow."""
        return Folds(self.transitions, GROWTH)

    @cached_property
    def by_unknowns(self) -> Array:
        """Derivatives (2, N, m, n) of the values at the Gauss points by u."""
        return self.stages.solve(self.columns)

    @cached_property
    def ends(self) -> Array:
        """Derivatives (2, N, n) of the ends of the intervals by u."""
        return np.asarray(self.gauss.end @ self.by_unknowns)

    def from_starts(self, starts: Array) -> Array:
        """Return right-hand sides (c, N, m, n) of starts (c, N, n)."""
        return np.asarray(starts[:, :, None] * self.gauss.row_sums[:, None])


class BorderedIntervals:
    """Solver of the linearised equations with two more rows.

    Parameters
    ----------
    equations : Linearised
        The equations.
    nodes : array (2, N, m, n)
        The rows' coefficients of the values at the nodes.
    stages : array (2, N, m, n)
        The rows' coefficients of the values at the Gauss points.
    corner : array (2, 2)
        The rows' coefficients of period and parameter.
    """

    def __init__(self, equations: Linearised, nodes: Array, stages: Array, corner: Array) -> None:
        g = equations.gauss
        self._equations = equations
        inner = nodes[:, :, 1:]
        self._adjoint = equations.stages.adjoint(stages + g.inner.T @ inner)
        rows = nodes[:, :, 0] + g.inner_start @ inner + g.row_sums @ self._adjoint
        meeting = corner + _products(self._adjoint, equations.columns)
        columns = np.ascontiguousarray(equations.ends.transpose(1, 2, 0))
        self._ring = BorderedFolds(equations.folds, columns, rows, meeting)

    def sign(self) -> float:
        """Return the sign of the determinant, the same on all meshes."""
        return self._ring.sign()

    def solve(self, stages: Array, border: Array) -> tuple[Array, Array]:
        """Solve.

        Parameters
        ----------
        stages : array (c, N, m, n)
            Right-hand sides of the equations at the Gauss points.
        border : array (2, c)
            Right-hand sides of the two rows.

        Returns
        -------
        nodes : array (c, N, m, n)
            Values at the nodes.
        unknowns : array (2, c)
            Period and parameter.
        """
        equations, g = self._equations, self._equations.gauss
        values = np.zeros_like(stages)
        active = stages.any(axis=(1, 2, 3))
        if active.any():
            values[active] = equations.stages.solve(stages[active])
        border = border - _products(self._adjoint, stages)
        moved = g.end @ values
        points, unknowns = self._ring.solve(moved.transpose(1, 2, 0), border)
        starts = np.ascontiguousarray(points.transpose(2, 0, 1))
        values += equations.stages.from_starts(starts)
        values += np.tensordot(unknowns.T, equations.by_unknowns, 1)
        nodes = np.empty_like(values)
        nodes[:, :, 0] = starts
        nodes[:, :, 1:] = starts[:, :, None] * g.inner_start[:, None] + g.inner @ values
        return nodes, unknowns


def _products(a: Array, b: Array) -> Array:
    """Return the inner products (c, d) of a (c, ...) and b (d, ...)."""
    return np.asarray(a.reshape(len(a), -1) @ b.reshape(len(b), -1).T)
