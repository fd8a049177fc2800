"""Curves of Hopf points of the exact fractional model, on Delta(i omega) itself."""

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
from racs_bif.equilibria.hopf_form import Complex, Cubic
from racs_bif.fractional.exact_form import exact_cubic

if TYPE_CHECKING:
    from racs_bif.continuation.points import Array, Point, Spectrum
    from racs_bif.fractional.exact import Weights
    from racs_bif.fractional.realised import RealisedField
    from racs_bif.fractional.static import StaticField
    from racs_bif.symbolic.paths import ParameterPath

_SLOWEST = 1e-4


@dataclass(frozen=True)
class _Solved:
    """What one point needs more than once; v and w are null vectors where g is zero."""

    z: Array
    f: Array
    core_x: Array
    weights: Weights
    v: Complex
    w: Complex
    g: complex


class ExactHopfCurve(CurveProblem):
    """Hopf points of the exact model; ``z = (y, w, omega, lambda_1, lambda_2)``.

    With [Delta(i omega) b; c^H 0] (v, g) = (0, 1) and its adjoint for w, the complex g vanishes
    with the determinant, and dg = -w^H (d Delta) v. Where omega tends to zero s**alpha is not
    smooth: there the curve ends. Other eigenvalues are those of the realisation at rest there.

    Parameters
    ----------
    static : StaticField
        The equilibrium equations.
    realised : RealisedField
        The realisation.
    path, span, measures
        See `CurveProblem`.
    """

    kind = "hopf"
    critical = 2
    name = "exact Hopf curve"

    def __init__(
        self,
        static: StaticField,
        realised: RealisedField,
        path: ParameterPath,
        span: Span,
        measures: Measures | None = None,
    ) -> None:
        own = len(realised.compiled.states)
        super().__init__(static, path, span, own, measures)
        self.exact, self._realised = static.exact, realised
        self._borders = Borders()
        self._solved: _Solved | None = None
        self._cubic: tuple[Array, Cubic] | None = None
        self._first = 0.0

    def realised(self, z: Array) -> tuple[RealisedField, Array, Array]:
        """Return the realised field, its states (n,) at rest, and the base parameters."""
        X, p = self.base(z)
        return self._realised, self.resting(self._realised, X, p), p

    def _solve(self, z: Array) -> _Solved:
        if self._solved is not None and np.array_equal(self._solved.z, z):
            return self._solved
        X, p = self.base(z)
        f = self.field.f(X, p)
        core_x = self.exact.compiled.core_jacobian(X, self.exact.compiled.padded(p))
        weights = self.exact.weights(1j * float(z[self.n]), p)
        delta = np.diag(weights.left) - weights.right[:, None] * core_x
        left, right = self._borders.at(z, lambda: _null_vectors(delta))
        v, w, g = _bordered(delta, left, right)
        if oblique(v, w):
            left, right = _null_vectors(delta)
            self._borders.restart(z, left, right)
            v, w, g = _bordered(delta, left, right)
        self._solved = _Solved(z.copy(), f, core_x, weights, v, w, g)
        return self._solved

    def residual(self, z: Array) -> Array:
        """Return (f, Re g, Im g) (n+2,)."""
        solved = self._solve(z)
        return np.concatenate([solved.f, [solved.g.real, solved.g.imag]])

    def jacobian(self, z: Array) -> Array:
        """Return the derivatives (n+2, n+3)."""
        solved, n, exact = self._solve(z), self.n, self.exact
        X, p = self.base(z)
        padded = exact.compiled.padded
        s, v, right = 1j * float(z[n]), solved.v, solved.weights.right
        adjoint = solved.w.conj()
        turned = solved.core_x @ v
        slope = exact.weights_s(s, p)
        by = np.empty(n + 3, dtype=complex)
        # One kernel call for all n directions.
        directions = np.broadcast_to(v[:, None], (n, n))
        forms = exact.compiled.core_xx(X, padded(p), directions, np.eye(n))
        by[:n] = (adjoint * right) @ forms
        by[n] = -1j * (adjoint @ (slope.left * v - slope.right * turned))
        jacobian = np.zeros((n + 2, n + 3))
        jacobian[:n, :n] = self.field.f_x(X, p)
        for k, dp in enumerate(self.directions(z)):
            jacobian[:n, n + 1 + k] = self.field.f_p(X, p, dp)
            moved = exact.weights_p(s, p, dp)
            mixed = exact.compiled.core_xp(X, padded(p), v, padded(dp))
            by[n + 1 + k] = -adjoint @ (moved.left * v - moved.right * turned - right * mixed)
        jacobian[n], jacobian[n + 1] = by.real, by.imag
        return jacobian

    def adapt(self, z: Array, tangent: Array) -> None:
        """Let the borders follow the null vectors."""
        del tangent
        solved = self._solve(z)
        self._borders.follow(z, _unit(solved.w), _unit(solved.v))
        if self.frequency(z) > 0.0:
            self.typical = max(self.typical, abs(self.cubic(z).c1.real))
        self._solved = None

    def frequency(self, z: Array) -> float:
        """Return omega."""
        return float(z[self.n])

    def spectrum(self, z: Array) -> Spectrum:
        """Return the eigenvalues of the realisation, the pair that the curve follows first."""
        from scipy.linalg import eigvals

        field, x, p = self.realised(z)
        pair = 1j * float(z[self.n])
        return critical_first(eigvals(field.f_x(x, p), check_finite=False), (pair, -pair))

    def ends(self, point: Point) -> Stopped | None:
        """End where the frequency has become very small beside what it was, or negative."""
        omega = self.frequency(point.z)
        self._first = self._first or omega
        return Stopped.STATIC if omega < _SLOWEST * self._first else None

    def cubic(self, z: Array) -> Cubic:
        """Return the cubic coefficient of the exact Hopf point at z.

        As for an ordinary one, each harmonic k seen through Delta(k i omega): steady oscillations
        are the same for the exact operator and for a filter that agrees with it at these
        frequencies.
        """
        if self._cubic is None or not np.array_equal(self._cubic[0], z):
            self._cubic = z.copy(), self._cubic_at(z)
        return self._cubic[1]

    def _cubic_at(self, z: Array) -> Cubic:
        solved = self._solve(z)
        X, p = self.base(z)
        q = solved.v / np.linalg.norm(solved.v[: self.own])
        found = exact_cubic(self.exact, X, p, self.frequency(z), (q, solved.w))
        size = float(np.abs(found.terms).sum())
        return Cubic(found.c1, size, h20=found.h20, h11=found.h11)

    def measures(self, z: Array) -> dict[str, float]:
        """Return frequency and first Lyapunov coefficient of the exact model."""
        omega = self.frequency(z)
        l1 = self.cubic(z).c1.real / omega
        further = {} if self._measures is None else self._measures(*self.realised(z)[1:])
        return further | {"omega": omega, "l1": l1, "neutral": 0.0}


def _null_vectors(delta: Complex) -> tuple[Matrix, Matrix]:
    # Rows may differ by orders of magnitude; scaling them moves the left vector only.
    size = np.abs(delta).max(axis=1)
    left, _, right = np.linalg.svd(delta / size[:, None])
    return _unit(left[:, -1] / size), right[-1:].conj().T


def _unit(vector: Matrix) -> Matrix:
    return np.asarray(vector / np.linalg.norm(vector)).reshape(-1, 1)


def _bordered(delta: Complex, left: Matrix, right: Matrix) -> tuple[Matrix, Matrix, complex]:
    n = len(delta)
    matrix = np.zeros((n + 1, n + 1), dtype=complex)
    matrix[:n, :n], matrix[:n, n:], matrix[n:, :n] = delta, left, right.conj().T
    unit = np.zeros(n + 1, dtype=complex)
    unit[n] = 1.0
    v, w = np.linalg.solve(matrix, unit), np.linalg.solve(matrix.conj().T, unit)
    return v[:n], w[:n], complex(v[n])
