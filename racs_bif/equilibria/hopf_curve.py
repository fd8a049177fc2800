"""Curves of Hopf points in two parameters, and of the neutral saddles that continue them."""

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
from racs_bif.equilibria.hopf_form import Complex, Cubic, cubic
from racs_bif.equilibria.linearised import Dense

if TYPE_CHECKING:
    from racs_bif.continuation.points import Array, Spectrum
    from racs_bif.symbolic.field import VectorField
    from racs_bif.symbolic.paths import ParameterPath


_ROUNDING = 1e-6
"""Frequencies below this, relative to the largest entry of f_x, are the root of rounding errors."""


@dataclass(frozen=True)
class _Solved:
    """What one point needs more than once; V, W (2n, 2) span null spaces where G is zero."""

    z: Array
    f: Array
    A: Array
    V: Array
    W: Array
    G: Array
    chosen: tuple[Array, Array]


class HopfCurve(CurveProblem):
    """Hopf points in two parameters; ``z = (x, kappa, lambda_1, lambda_2)``, kappa = omega**2.

    f_x^2 + kappa has two null vectors at a Hopf point, and so has [f_x -1; kappa f_x], which is
    not squared and therefore well scaled. Doubly bordered it gives a 2x2 matrix G, zero at a Hopf
    point, with dG = -W^T dK V. Near the curve G is a sum of W^T V and W^T f_x V: its components
    along these two are the two equations, the well chosen two of four. Where kappa is negative the
    curve is one of neutral saddles, with eigenvalues +-sqrt(-kappa); it passes through kappa = 0,
    a Bogdanov-Takens point, without noticing.

    Parameters
    ----------
    field, path, span, own, measures
        See `CurveProblem`.
    """

    kind = "hopf"
    critical = 2
    name = "Hopf curve"

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
        self._cubic: tuple[Array, Cubic] | None = None
        self._typical = 0.0

    def _matrix(self, A: Array, kappa: float) -> Array:
        n = self.n
        K = np.zeros((2 * n, 2 * n))
        K[:n, :n] = K[n:, n:] = A
        K[:n, n:] = -np.eye(n)
        K[n:, :n] = kappa * np.eye(n)
        return K

    def _solve(self, z: Array) -> _Solved:
        if self._solved is not None and np.array_equal(self._solved.z, z):
            return self._solved
        x, p = self.base(z)
        f, A = self.field.f(x, p), self.field.f_x(x, p)
        K = self._matrix(A, float(z[self.n]))
        left, right = self._borders.at(z, lambda: _null_spaces(K))
        V, W, G = _bordered(K, left, right)
        if oblique(V, W):
            left, right = _null_spaces(K)
            self._borders.restart(z, left, right)
            V, W, G = _bordered(K, left, right)
        self._solved = _Solved(z.copy(), f, A, V, W, G, self._choose(V, W))
        return self._solved

    def _choose(self, V: Array, W: Array) -> tuple[Array, Array]:
        """Return two 2x2 matrices, orthonormal, onto which G is projected.

        W^T (dK) V is a combination of W^T V and W^T f_x V, in which the lower half of V is f_x
        times the upper and kappa enters from the lower half of W.
        """
        n = self.n
        one, turn = W[n:].T @ V[:n], W[n:].T @ V[n:]
        one = one / np.linalg.norm(one)
        turn = turn - np.sum(one * turn) * one
        return one, turn / np.linalg.norm(turn)

    def residual(self, z: Array) -> Array:
        """Return f and the two components of G (n+2,)."""
        solved = self._solve(z)
        return np.concatenate([solved.f, [float(np.sum(N * solved.G)) for N in solved.chosen]])

    def jacobian(self, z: Array) -> Array:
        """Return the derivatives (n+2, n+3), with the choice of components held."""
        solved, n, field = self._solve(z), self.n, self.field
        x, p = self.base(z)
        v = np.hstack([solved.V[:n], solved.V[n:]])
        # Row r, column k: the weight of w^T (df_x) v_k in minus the component r.
        w = [np.hstack([solved.W[:n] @ N, solved.W[n:] @ N]) for N in solved.chosen]
        forms = field.f_xx_matrices(x, p, v)
        jacobian = np.zeros((n + 2, n + 3))
        jacobian[:n, :n] = solved.A
        for r, weights in enumerate(w):
            jacobian[n + r, :n] = -np.einsum("ik,kij->j", weights, forms)
            jacobian[n + r, n] = -np.sum(weights[:, 2:] * v[:, :2])
        for k, dp in enumerate(self.directions(z)):
            column = n + 1 + k
            jacobian[:n, column] = field.f_p(x, p, dp)
            moved = field.f_xp(x, p, v, dp)
            for r, weights in enumerate(w):
                jacobian[n + r, column] = -np.sum(weights * moved)
        return jacobian

    def adapt(self, z: Array, tangent: Array) -> None:
        """Let the borders follow the null spaces."""
        del tangent
        solved = self._solve(z)
        self._borders.follow(z, solved.W, solved.V)
        # The components are chosen anew with the borders.
        if self.frequency(z) > 0.0:
            self.typical = max(self.typical, abs(self.cubic(z).c1.real))
        self._solved = None

    def scales(self, z: Array) -> Array:
        """Return magnitudes of the unknowns; kappa counts by the eigenvalues too."""
        scales = super().scales(z)
        if not self._typical:
            A = self._solve(z).A
            middle = float(np.median(np.abs(np.linalg.eigvals(A))))
            self._typical = 0.1 * max(middle, 1e-3 * float(np.linalg.norm(A))) ** 2
        scales[self.n] = max(scales[self.n], self._typical)
        return scales

    def frequency(self, z: Array) -> float:
        """Return omega; NaN at a neutral saddle."""
        kappa = float(z[self.n])
        return kappa**0.5 if kappa > 0.0 else float("nan")

    def spectrum(self, z: Array) -> Spectrum:
        """Return the eigenvalues (n,) of f_x, the pair that the curve follows first."""
        from scipy.linalg import eigvals

        root = complex(-z[self.n]) ** 0.5
        return critical_first(eigvals(self._solve(z).A, check_finite=False), (root, -root))

    def eigenvectors(self, z: Array) -> tuple[Complex, Complex]:
        """Return right and left eigenvectors (n,) of the pair, conj(p) . q = 1, |q| = 1."""
        solved, n, omega = self._solve(z), self.n, self.frequency(z)
        q = solved.V[n:] + 1j * omega * solved.V[:n]
        p = solved.W[:n] - 1j * omega * solved.W[n:]
        q = q[:, int(np.argmax(np.linalg.norm(q, axis=0)))]
        p = p[:, int(np.argmax(np.linalg.norm(p, axis=0)))]
        q = q / np.linalg.norm(q[: self.own])
        return q, p / np.conj(np.vdot(p, q))

    def cubic(self, z: Array) -> Cubic:
        """Return the cubic coefficient of the Hopf point at z; omega must be positive."""
        if self._cubic is None or not np.array_equal(self._cubic[0], z):
            x, p = self.base(z)
            vectors = self.eigenvectors(z)
            found = cubic(self.field, (x, p), Dense(self._solve(z).A), self.frequency(z), vectors)
            self._cubic = z.copy(), found
        return self._cubic[1]

    def measures(self, z: Array) -> dict[str, float]:
        """Return frequency and first Lyapunov coefficient, NaN at a neutral saddle.

        It is infinite at a Bogdanov-Takens point, where rounding leaves a frequency of about the
        root of the precision: NaN there too.
        """
        omega = self.frequency(z)
        neutral = not omega > 0.0
        certain = omega > _ROUNDING * float(np.abs(self._solve(z).A).max())
        l1 = self.cubic(z).c1.real / omega if certain else float("nan")
        return super().measures(z) | {"omega": omega, "l1": l1, "neutral": float(neutral)}


def _null_spaces(K: Array) -> tuple[Matrix, Matrix]:
    left, _, right = np.linalg.svd(K)
    return left[:, -2:], right[-2:].T


def _bordered(K: Array, left: Matrix, right: Matrix) -> tuple[Matrix, Matrix, Matrix]:
    m = len(K)
    matrix = np.zeros((m + 2, m + 2))
    matrix[:m, :m], matrix[:m, m:], matrix[m:, :m] = K, left, right.T
    unit = np.eye(m + 2)[:, m:]
    V, W = np.linalg.solve(matrix, unit), np.linalg.solve(matrix.T, unit)
    return V[:m], W[:m], V[m:]
