"""Curves of folds in two parameters: f = 0 with f_x singular."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.equilibria.curve_problem import (
    Borders,
    CurveProblem,
    Matrix,
    Measures,
    Span,
    critical_first,
    oblique,
)

if TYPE_CHECKING:
    from racs_bif.continuation.points import Array, Spectrum
    from racs_bif.symbolic.field import VectorField
    from racs_bif.symbolic.paths import ParameterPath


@dataclass(frozen=True)
class _Solved:
    """What one point needs more than once; v and w are null vectors where g is zero."""

    z: Array
    f: Array
    A: Array
    v: Array
    w: Array
    g: float


class FoldCurve(CurveProblem):
    """Folds in two parameters; ``z = (x, lambda_1, lambda_2)``.

    With [f_x b; c^T 0] (v, g) = (0, 1) and its transpose for w, g vanishes with the determinant of
    f_x, and dg = -w^T (df_x) v. Regular at cusps and at Bogdanov-Takens points too.

    Parameters
    ----------
    field, path, span, own, measures
        See `CurveProblem`.
    """

    kind = "fold"
    critical = 1
    name = "fold curve"

    def __init__(
        self,
        field: VectorField,
        path: ParameterPath,
        span: Span,
        own: int,
        measures: Measures | None = None,
    ) -> None:
        super().__init__(field, path, span, own, measures)
        self._borders = Borders()
        self._solved: _Solved | None = None

    def _solve(self, z: Array) -> _Solved:
        if self._solved is not None and np.array_equal(self._solved.z, z):
            return self._solved
        x, p = self.base(z)
        f, A = self.field.f(x, p), self.field.f_x(x, p)
        left, right = self._borders.at(z, lambda: _null_vectors(A))
        v, w, g = _bordered(A, left, right)
        if oblique(v, w):
            left, right = _null_vectors(A)
            self._borders.restart(z, left, right)
            v, w, g = _bordered(A, left, right)
        self._solved = _Solved(z.copy(), f, A, v, w, g)
        return self._solved

    def residual(self, z: Array) -> Array:
        """Return (f, g) (n+1,)."""
        solved = self._solve(z)
        return np.append(solved.f, solved.g)

    def jacobian(self, z: Array) -> Array:
        """Return the derivatives (n+1, n+2)."""
        solved, n = self._solve(z), self.n
        x, p = self.base(z)
        jacobian = np.empty((n + 1, n + 2))
        jacobian[:n, :n] = solved.A
        jacobian[n, :n] = -solved.w @ self.field.f_xx_matrices(x, p, solved.v[:, None])[0]
        for k, dp in enumerate(self.directions(z)):
            jacobian[:n, n + k] = self.field.f_p(x, p, dp)
            jacobian[n, n + k] = -solved.w @ self.field.f_xp(x, p, solved.v, dp)
        return jacobian

    def terms(self, z: Array) -> Array:
        """Return the sizes (n+1,) of the terms of the residual: of g, those of w^T f_x v too."""
        sizes, solved = super().terms(z), self._solve(z)
        sizes[-1] += np.abs(solved.w) @ np.abs(solved.A) @ np.abs(solved.v)
        return sizes

    def adapt(self, z: Array, tangent: Array) -> None:
        """Let the borders follow the null vectors."""
        del tangent
        solved = self._solve(z)
        self._borders.follow(z, solved.w[:, None], solved.v[:, None])
        self.typical = max(self.typical, abs(self.quadratic(z)[0]))

    def null_vectors(self, z: Array) -> tuple[Array, Array]:
        """Return the unit null vectors (n,) of f_x, right and left, that turn continuously."""
        solved = self._solve(z)
        return solved.v / np.linalg.norm(solved.v), solved.w / np.linalg.norm(solved.w)

    def quadratic(self, z: Array) -> tuple[float, float]:
        """Return w . B(v, v) of the unit null vectors, and the sum of the terms' magnitudes."""
        x, p = self.base(z)
        v, w = self.null_vectors(z)
        terms = w * self.field.f_xx(x, p, v, v)
        return float(terms.sum()), float(np.abs(terms).sum())

    def alignment(self, z: Array) -> float:
        """Return w . v of the unit null vectors, zero where zero is a double eigenvalue."""
        v, w = self.null_vectors(z)
        return float(w @ v)

    def frequency(self, z: Array) -> float:
        """Return NaN: no pair is critical all along."""
        del z
        return float("nan")

    def spectrum(self, z: Array) -> Spectrum:
        """Return the eigenvalues (n,) of f_x, the one that is zero all along first."""
        from scipy.linalg import eigvals

        return critical_first(eigvals(self._solve(z).A, check_finite=False), (0.0,))


def _null_vectors(A: Array) -> tuple[Matrix, Matrix]:
    left, _, right = np.linalg.svd(A)
    return left[:, -1:], right[-1:].T


def _bordered(A: Array, left: Matrix, right: Matrix) -> tuple[Matrix, Matrix, float]:
    n = len(A)
    matrix = np.zeros((n + 1, n + 1))
    matrix[:n, :n], matrix[:n, n:], matrix[n:, :n] = A, left, right.T
    unit = np.zeros(n + 1)
    unit[n] = 1.0
    v, w = np.linalg.solve(matrix, unit), np.linalg.solve(matrix.T, unit)
    return v[:n], w[:n], float(v[n])
