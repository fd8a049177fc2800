"""Elimination of the values at the Gauss points of all intervals, densely."""

from __future__ import annotations

from abc import ABC, abstractmethod
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

    @abstractmethod
    def transitions(self) -> Array:
        """Return the derivatives (N, n, n) of the ends of the intervals by their starts."""

    @abstractmethod
    def solve(self, rhs: Array) -> Array:
        """Return B^-1 rhs."""

    @abstractmethod
    def adjoint(self, rhs: Array) -> Array:
        """Return B^-T rhs."""


class DenseStages(Stages):
    """One LU factorisation of m n unknowns an interval.

    Parameters
    ----------
    coefficients : Gauss
        Of the degree.
    jacobians : array (N, m, n, n)
        Derivatives of f at the Gauss points.
    tau : array (N,)
        Lengths of the intervals in time.

    Raises
    ------
    numpy.linalg.LinAlgError
        If an interval's matrix is singular: it is too long.
    """

    def __init__(self, coefficients: Gauss, jacobians: Array, tau: Array) -> None:
        from scipy.linalg.lapack import dgetrf, dgetrs

        self._gauss = coefficients
        count, degree, size = jacobians.shape[:3]
        matrix = np.zeros((count, degree, size, degree, size))
        for j in range(degree):
            matrix[:, j, :, j] = -tau[:, None, None] * jacobians[:, j]
        diagonals = np.einsum("kiaja->kija", matrix)
        diagonals += coefficients.inverse[:, :, None]
        self._shape = (degree, size)
        self._solver = dgetrs
        self._factors = []
        for one in matrix.reshape(count, degree * size, degree * size):
            # LAPACK reads rows as columns: what is factorised is the transpose
            lu, pivots, info = dgetrf(one.T, overwrite_a=True)
            if info > 0:
                raise np.linalg.LinAlgError("the equations of an interval are singular")
            self._factors.append((lu, pivots))

    def transitions(self) -> Array:
        """Return the derivatives (N, n, n) of the ends of the intervals by their starts."""
        degree, size = self._shape
        eye = np.eye(size)
        ends = np.multiply.outer(self._gauss.end, eye).reshape(degree * size, size)
        adjoints = np.stack([self._solver(lu, pivots, ends)[0] for lu, pivots in self._factors])
        blocks = adjoints.reshape(-1, degree, size, size)
        sums = np.einsum("j,kjab->kba", self._gauss.row_sums, blocks)
        return np.asarray(sums + self._gauss.end_start * eye)

    def solve(self, rhs: Array) -> Array:
        """Return B^-1 rhs."""
        return self._apply(rhs, transposed=1)

    def adjoint(self, rhs: Array) -> Array:
        """Return B^-T rhs."""
        return self._apply(rhs, transposed=0)

    def _apply(self, rhs: Array, *, transposed: int) -> Array:
        columns = rhs.reshape(len(rhs), len(self._factors), -1)
        solution = np.empty_like(columns)
        for k, (lu, pivots) in enumerate(self._factors):
            solution[:, k] = self._solver(lu, pivots, columns[:, k].T, trans=transposed)[0].T
        return solution.reshape(rhs.shape)
