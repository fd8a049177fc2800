"""Elimination of the values at the Gauss points of all intervals, densely."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from racs_bif.orbits.gauss import Gauss
    from racs_bif.symbolic.field import Array


class Stages(ABC):
    """Factors of the linearised equations B Y = A^-1 1 x + rhs of N intervals.

    B is A^-1 (x) I - tau diag(J_1, ..., J_m), with A the Runge-Kutta matrix of the Gauss points.
    Right-hand sides are shaped (c, N, m, n), c of them at once.
    """

    _gauss: Gauss

    @abstractmethod
    def transitions(self) -> Array:
        """Return the derivatives (N, n, n) of the ends of the intervals by their starts."""

    @abstractmethod
    def at_ends(self, rhs: Array) -> Array:
        """Return what B^-1 rhs adds at the ends of the intervals (c, N, n)."""

    @abstractmethod
    def solve(self, rhs: Array) -> Array:
        """Return B^-1 rhs."""

    @abstractmethod
    def adjoint(self, rhs: Array) -> Array:
        """Return B^-T rhs."""

    def from_starts(self, starts: Array) -> Array:
        """Return B^-1 A^-1 1 x (c, N, m, n) for x = starts (c, N, n)."""
        return self.solve(starts[:, :, None] * self._gauss.row_sums[:, None])


def interval_matrices(coefficients: Gauss, jacobians: Array, tau: Array) -> Array:
    """Return B (N, m n, m n).

    Parameters
    ----------
    coefficients : Gauss
        Of the degree.
    jacobians : array (N, m, n, n)
        Derivatives of f at the Gauss points.
    tau : array (N,)
        Lengths of the intervals in time.
    """
    count, degree, size = jacobians.shape[:3]
    matrix = np.zeros((count, degree, size, degree, size))
    for j in range(degree):
        matrix[:, j, :, j] = -tau[:, None, None] * jacobians[:, j]
    diagonals = np.einsum("kiaja->kija", matrix)
    diagonals += coefficients.inverse[:, :, None]
    return matrix.reshape(count, degree * size, degree * size)


class DenseStages(Stages):
    """One dense matrix of m n unknowns an interval.

    Parameters
    ----------
    coefficients : Gauss
        Of the degree.
    matrices : array (N, m n, m n)
        From `interval_matrices`.

    Raises
    ------
    numpy.linalg.LinAlgError
        If an interval's matrix is singular: it is too long.
    """

    def __init__(self, coefficients: Gauss, matrices: Array) -> None:
        self._gauss = coefficients
        self._size = matrices.shape[-1] // coefficients.degree
        self._factorise(matrices)

    def transitions(self) -> Array:
        """Return the derivatives (N, n, n) of the ends of the intervals by their starts."""
        g, size = self._gauss, self._size
        blocks = self._ends.reshape(len(self._ends), g.degree, -1)
        sums = (g.row_sums @ blocks).reshape(-1, size, size)
        return np.asarray(np.swapaxes(sums, 1, 2) + g.end_start * np.eye(size))

    @cached_property
    def _ends(self) -> Array:
        """B^-T times what makes the end of an interval of its Gauss points (N, m n, n)."""
        weights = np.multiply.outer(self._gauss.end, np.eye(self._size))
        return self._transposed(weights.reshape(-1, self._size))

    def at_ends(self, rhs: Array) -> Array:
        """Return what B^-1 rhs adds at the ends of the intervals (c, N, n)."""
        rows = rhs.reshape(*rhs.shape[:2], 1, -1)
        return np.asarray((rows @ self._ends)[:, :, 0])

    @abstractmethod
    def _factorise(self, matrices: Array) -> None:
        """Take the matrices B (N, m n, m n)."""

    @abstractmethod
    def _transposed(self, columns: Array) -> Array:
        """Return B^-T (N, m n, c) times the same columns (m n, c) for all intervals."""


class InvertedStages(DenseStages):
    """By explicit inverses, all at once: faster than factors while the matrices are small."""

    def _factorise(self, matrices: Array) -> None:
        self._inverse = np.linalg.inv(matrices)

    def _transposed(self, columns: Array) -> Array:
        return np.asarray(np.swapaxes(self._inverse, 1, 2) @ columns)

    def solve(self, rhs: Array) -> Array:
        """Return B^-1 rhs."""
        columns = rhs.reshape(*rhs.shape[:2], -1, 1)
        return np.asarray((self._inverse @ columns).reshape(rhs.shape))

    def adjoint(self, rhs: Array) -> Array:
        """Return B^-T rhs."""
        rows = rhs.reshape(*rhs.shape[:2], 1, -1)
        return np.asarray((rows @ self._inverse).reshape(rhs.shape))


class FactoredStages(DenseStages):
    """By LU factorisations, one interval after the other."""

    def _factorise(self, matrices: Array) -> None:
        from scipy.linalg.lapack import dgetrf, dgetrs

        self._solver = dgetrs
        self._factors = []
        for one in matrices:
            # LAPACK reads rows as columns: what is factorised is the transpose
            lu, pivots, info = dgetrf(one.T, overwrite_a=True)
            if info > 0:
                raise np.linalg.LinAlgError("the equations of an interval are singular")
            self._factors.append((lu, pivots))

    def _transposed(self, columns: Array) -> Array:
        return np.stack([self._solver(lu, pivots, columns)[0] for lu, pivots in self._factors])

    def solve(self, rhs: Array) -> Array:
        """Return B^-1 rhs."""
        return self._apply(rhs, transposed=1)

    def adjoint(self, rhs: Array) -> Array:
        """Return B^-T rhs."""
        return self._apply(rhs, transposed=0)

    def _apply(self, rhs: Array, *, transposed: int) -> Array:
        columns = rhs.reshape(*rhs.shape[:2], -1)
        solution = np.empty_like(columns)
        for k, (lu, pivots) in enumerate(self._factors):
            solution[:, k] = self._solver(lu, pivots, columns[:, k].T, trans=transposed)[0].T
        return solution.reshape(rhs.shape)
