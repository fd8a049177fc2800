"""Curves of branch points in two parameters, where a symmetry lets them persist."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.continuation.stopped import Stopped
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
    from racs_bif.continuation.points import Array, Point, Spectrum
    from racs_bif.fractional.realised import RealisedField
    from racs_bif.fractional.static import StaticField
    from racs_bif.symbolic.paths import ParameterPath

_PERSISTS = 1e-7


@dataclass(frozen=True)
class _Solved:
    """What one point needs more than once; V (n+1, 2) and w are null vectors where g is zero."""

    z: Array
    f: Array
    D: Array
    V: Array
    w: Array
    g: Array
    size: float


class BranchPointCurve(CurveProblem):
    """Branch points in two parameters; ``z = (y, w, beta, lambda_1, lambda_2)``.

    At a branch point D = [f_x f_lambda1] has rank n - 1: with two parameters that takes one more
    condition than there are unknowns, so that f = 0 is unfolded to f + beta b = 0, b the left null
    vector at the start. Branch points persist where beta stays zero; elsewhere the curve ends. D
    is bordered by a column and two rows; g has two components, dg_i = -w^T (dD) v_i. Works on
    the exact equilibrium equations, which every realisation shares.

    Parameters
    ----------
    static : StaticField
        The equilibrium equations.
    realised : RealisedField
        The realisation, for the other eigenvalues.
    path, span, measures
        See `CurveProblem`.
    """

    kind = "bp"
    critical = 1
    name = "branch-point curve"

    def __init__(
        self,
        static: StaticField,
        realised: RealisedField,
        path: ParameterPath,
        span: Span,
        measures: Measures | None = None,
    ) -> None:
        super().__init__(static, path, span, len(realised.compiled.states), measures)
        self._static, self._realised = static, realised
        self._borders = Borders()
        self._solved: _Solved | None = None
        self._unfold: Array | None = None

    def realised(self, z: Array) -> tuple[RealisedField, Array, Array]:
        """Return the realised field, its states (n,) at rest, and the base parameters."""
        X, p = self.base(z)
        return self._realised, self.resting(self._realised, X, p), p

    def _solve(self, z: Array) -> _Solved:
        if self._solved is not None and np.array_equal(self._solved.z, z):
            return self._solved
        X, p = self.base(z)
        by = self._static.f_p(X, p, self.directions(z)[0])
        D = np.column_stack([self._static.f_x(X, p), by])
        left, right = self._borders.at(z, lambda: _null_spaces(D))
        if self._unfold is None:
            self._unfold = left[:, 0]
        V, w, g = _bordered(D, left, right)
        if oblique(V, w):
            left, right = _null_spaces(D)
            self._borders.restart(z, left, right)
            V, w, g = _bordered(D, left, right)
        f = self._static.f(X, p) + z[self.n] * self._unfold
        size = float(np.linalg.norm(np.abs(D) @ np.abs(np.append(X, z[-2]))))
        self._solved = _Solved(z.copy(), f, D, V, w, g, size)
        return self._solved

    def residual(self, z: Array) -> Array:
        """Return f + beta b and the two components of g (n+2,)."""
        solved = self._solve(z)
        return np.concatenate([solved.f, solved.g])

    def jacobian(self, z: Array) -> Array:
        """Return the derivatives (n+2, n+3)."""
        solved, n, field = self._solve(z), self.n, self._static
        X, p = self.base(z)
        first = self.directions(z)[0]
        w, V = solved.w, solved.V
        jacobian = np.zeros((n + 2, n + 3))
        jacobian[:n, :n], jacobian[:n, n] = solved.D[:, :n], self._unfold
        crossed = np.column_stack([field.f_xp(X, p, unit, first) for unit in np.eye(n)])
        forms = field.f_xx_matrices(X, p, V[:n])
        for i in range(2):
            jacobian[n + i, :n] = -w @ (forms[i] + V[n, i] * crossed)
        for k, dp in enumerate(self.directions(z)):
            jacobian[:n, n + 1 + k] = field.f_p(X, p, dp)
            second = field.f_pp(X, p, first, dp) + field.f_p(X, p, self.path.bend(z[-2:], 0, k))
            for i in range(2):
                moved = field.f_xp(X, p, V[:n, i], dp) + V[n, i] * second
                jacobian[n + i, n + 1 + k] = -w @ moved
        return jacobian

    def adapt(self, z: Array, tangent: Array) -> None:
        """Let the borders follow the null vectors."""
        del tangent
        solved = self._solve(z)
        self._borders.follow(z, solved.w[:, None], solved.V)
        self._solved = None

    def ends(self, point: Point) -> Stopped | None:
        """End where beta is no longer zero: there is no branch point any more."""
        beta = abs(float(point.z[self.n]))
        return Stopped.UNFOLDED if beta > _PERSISTS * self._solve(point.z).size else None

    def frequency(self, z: Array) -> float:
        """Return NaN: no pair is critical all along."""
        del z
        return float("nan")

    def spectrum(self, z: Array) -> Spectrum:
        """Return the eigenvalues of the realisation, the one that is zero all along first."""
        from scipy.linalg import eigvals

        field, x, p = self.realised(z)
        return critical_first(eigvals(field.f_x(x, p), check_finite=False), (0.0,))

    def scales(self, z: Array) -> Array:
        """Return magnitudes of the unknowns; beta counts by the terms of the equations."""
        scales = super().scales(z)
        scales[self.n] = max(scales[self.n], self._solve(z).size)
        return scales

    def measures(self, z: Array) -> dict[str, float]:
        """Return further quantities of the point and the unfolding beta."""
        further = {} if self._measures is None else self._measures(*self.realised(z)[1:])
        return further | {"beta": float(z[self.n])}


def _null_spaces(D: Array) -> tuple[Matrix, Matrix]:
    left, _, right = np.linalg.svd(D)
    return left[:, -1:], right[-2:].T


def _bordered(D: Array, left: Matrix, right: Matrix) -> tuple[Matrix, Matrix, Matrix]:
    n = len(D)
    matrix = np.zeros((n + 2, n + 2))
    matrix[:n, : n + 1], matrix[:n, n + 1 :], matrix[n:, : n + 1] = D, left, right.T
    V = np.linalg.solve(matrix, np.eye(n + 2)[:, n:])
    w = np.linalg.solve(matrix.T, np.eye(n + 2)[:, n + 1])
    return V[: n + 1], w[:n], V[n + 1]
