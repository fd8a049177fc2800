"""Elimination of the values at the Gauss points where few entries of the Jacobian vary.

With J = A0 + L V(x) R the constant part is diagonal in the modes of A0 and in those of the
Runge-Kutta matrix, for intervals of any widths; what varies is a correction of rank m k an interval
(M. A. Woodbury, *Inverting modified matrices*, 1950). Nothing of the size m n is factorised.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from racs_bif.orbits.stages import Stages

if TYPE_CHECKING:
    from racs_bif.orbits.gauss import Gauss
    from racs_bif.symbolic.field import Array, Vectors

Complex = NDArray[np.complex128]

CONDITION: Final = 1e6
"""Largest condition number of the modes of A0; beyond it the dense elimination is more accurate."""


@dataclass(frozen=True, eq=False)
class Modes:
    """The modes of a real matrix, one of every conjugate pair.

    Attributes
    ----------
    values : complex array (K,)
        Eigenvalues.
    vectors : complex array (n, K)
        Eigenvectors times 1, or 2 where they stand for a pair: the real part of their sum counts.
    inverse : complex array (K, n)
        Rows of the inverse of the matrix of eigenvectors.
    condition : float
        Its condition number (Frobenius norm).
    """

    values: Complex
    vectors: Complex
    inverse: Complex
    condition: float


def modes(matrix: Array) -> Modes:
    """Return the modes of a real matrix (n, n).

    Raises
    ------
    numpy.linalg.LinAlgError
        If it has none, or its eigenvectors are exactly dependent.
    """
    values, vectors = np.linalg.eig(matrix)
    inverse = np.linalg.inv(vectors)
    condition = float(np.linalg.norm(vectors) * np.linalg.norm(inverse))
    upper = values.imag >= 0.0
    twice = np.where(values.imag[upper] > 0.0, 2.0, 1.0)
    return Modes(
        values=np.asarray(values[upper], dtype=complex),
        vectors=np.asarray(vectors[:, upper] * twice, dtype=complex),
        inverse=np.asarray(inverse[upper], dtype=complex),
        condition=condition,
    )


@dataclass(frozen=True, eq=False)
class _Side:
    """What one application takes: into the modes, through the correction, and out of them."""

    into: Array  # (n, 2K): coordinates to modes
    out: Array  # (2K, n): modes to coordinates
    first: Complex  # (m, m): Gauss points to their modes
    last: Complex  # (m, m): and back
    probe: Complex  # (K, r): modes to what the correction sees
    inject: Complex  # (k, K): what the correction adds to the modes
    correction: Array  # (N, m k, m r)


class LowRankStages(Stages):
    """Elimination by modes and a correction of low rank.

    Parameters
    ----------
    coefficients : Gauss
        Of the degree.
    basis : Modes
        Modes of the constant part A0.
    left : array (n, k)
    right : array (r, n)
        L and R.
    varying : array (N, m, k, r)
        V at the Gauss points.
    tau : array (N,)
        Lengths of the intervals in time.

    Raises
    ------
    numpy.linalg.LinAlgError
        If an interval's matrix is singular: it is too long.
    """

    def __init__(
        self,
        coefficients: Gauss,
        basis: Modes,
        left: Array,
        right: Array,
        varying: Array,
        tau: Array,
    ) -> None:
        self._gauss, self._basis, self._tau = coefficients, basis, tau
        g = coefficients
        poles = tau[:, None, None] * basis.values
        by_interval: Complex = 1.0 / (g.eigenvalues[:, None] - poles)  # (N, m, K)
        self._by_interval = by_interval
        self._resolvent = np.ascontiguousarray(np.moveaxis(by_interval, 1, 0))[:, None]
        self._seen: Complex = right @ basis.vectors  # (r, K)
        self._added: Complex = basis.inverse @ left  # (K, k)
        correction = self._correct(varying)
        self._forward = _Side(
            into=_into(basis.inverse.T),
            out=_out(basis.vectors.T),
            first=g.left,
            last=g.right,
            probe=self._seen.T,
            inject=self._added.T,
            correction=correction,
        )
        # the transpose: modes and their inverse change places, pairs counted on the way out
        pairs = np.where(basis.values.imag > 0.0, 2.0, 1.0)
        self._backward = _Side(
            into=_into(basis.vectors / pairs),
            out=_out(basis.inverse * pairs[:, None]),
            first=g.right.T,
            last=g.left.T,
            probe=self._added * pairs[:, None],
            inject=self._seen / pairs,
            correction=np.swapaxes(correction, 1, 2),
        )

    def _correct(self, varying: Array) -> Array:
        """Return (I - V H)^-1 V, (N, m k, m r), with H = tau R (B at V = 0)^-1 L."""
        count, degree, k, r = varying.shape
        g = self._gauss
        table = (g.right[:, None, :] * g.left.T[None, :, :]).reshape(-1, degree)
        kernels = np.ascontiguousarray(table @ self._by_interval)  # (N, m m, K)
        products = self._seen[:, None, :] * self._added.T[None]  # (r, k, K)
        small = _real(kernels) @ _out(products.reshape(r * k, -1).T)
        small = self._tau[:, None, None] * small
        small = small.reshape(count, degree, degree, r, k).swapaxes(2, 3)
        loop = varying @ small.reshape(count, degree, r, degree * k)
        blocks = np.zeros((count, degree, k, degree, r))
        for j in range(degree):
            blocks[:, j, :, j] = varying[:, j]
        matrix = np.eye(degree * k) - loop.reshape(count, degree * k, -1)
        return np.asarray(np.linalg.solve(matrix, blocks.reshape(count, degree * k, -1)))

    def transitions(self) -> Array:
        """Return the derivatives (N, n, n) of the ends of the intervals by their starts."""
        g, basis, tau = self._gauss, self._basis, self._tau
        count = len(tau)
        starts = g.left @ g.row_sums.astype(complex)
        ends = g.end.astype(complex) @ g.right
        growth = g.end_start + (starts * ends) @ self._by_interval  # (N, K)
        constant = _real(growth[:, None, :] * basis.vectors) @ _out(basis.inverse)
        sees = (g.right * starts) @ self._by_interval  # (N, m, K)
        seen = _real(sees[:, :, None] * self._seen) @ _out(basis.inverse)
        adds = (g.left.T * ends) @ self._by_interval
        added = _real(adds[:, :, None] * self._added.T) @ _out(basis.vectors.T)
        size = constant.shape[-1]
        seen = seen.reshape(count, -1, size)
        added = np.swapaxes(added.reshape(count, -1, size), 1, 2)
        varying = (tau[:, None, None] * added) @ (self._forward.correction @ seen)
        return np.asarray(constant + varying)

    def at_ends(self, rhs: Array) -> Array:
        """Return what B^-1 rhs adds at the ends of the intervals (c, N, n)."""
        return np.asarray(self._gauss.end @ self.solve(rhs))

    def solve(self, rhs: Array) -> Array:
        """Return B^-1 rhs."""
        return self._apply(rhs, self._forward)

    def adjoint(self, rhs: Array) -> Array:
        """Return B^-T rhs."""
        return self._apply(rhs, self._backward)

    def _apply(self, rhs: Array, side: _Side) -> Array:
        # Gauss points first: mixing them is then one product of a small and a long matrix
        modal = _complex(np.moveaxis(rhs, 2, 0) @ side.into)
        modal = _mixed(side.first, modal) * self._resolvent
        seen = _mixed(side.last, modal @ side.probe).real
        moved = np.moveaxis(seen, 0, 2)
        flat = moved.reshape(*moved.shape[:2], -1, 1)
        added = (self._tau[:, None, None] * side.correction) @ flat
        added = np.moveaxis(added.reshape(*moved.shape[:3], -1), 2, 0)
        modal += (_mixed(side.first, added) @ side.inject) * self._resolvent
        values = _real(_mixed(side.last, modal)) @ side.out
        return np.ascontiguousarray(np.moveaxis(values, 0, 2))


def _mixed(matrix: Complex, values: Vectors) -> Complex:
    """Return a matrix (m, m) times values (m, ...)."""
    return np.asarray((matrix @ values.reshape(len(values), -1)).reshape(values.shape))


def _into(matrix: Complex) -> Array:
    """Return a complex matrix (a, K) as real (a, 2K): real vectors times it are complex ones."""
    return np.ascontiguousarray(matrix).view(float)


def _out(matrix: Complex) -> Array:
    """Return a complex matrix (K, a) as real (2K, a): complex vectors, as reals, times it.

    The result is the real part of the complex product.
    """
    return np.stack((matrix.real, -matrix.imag), axis=1).reshape(-1, matrix.shape[1])


def _real(values: Complex) -> Array:
    """Return complex values (..., K) as reals (..., 2K)."""
    return np.ascontiguousarray(values).view(float)


def _complex(values: Array) -> Complex:
    """Return reals (..., 2K) as complex values (..., K)."""
    return np.ascontiguousarray(values).view(complex)
