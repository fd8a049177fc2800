"""What detectors ask of the Jacobian at an equilibrium, full where small and sparse where large."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from racs_bif.numerics import sparse

if TYPE_CHECKING:
    from racs_bif.symbolic.field import Array, VectorField

Complex = NDArray[np.complex128]
Vectors = NDArray[np.inexact[Any]]

_ROUNDS = 3


def jacobian(field: VectorField, x: Array, p: Array) -> Any:  # noqa: ANN401 - either kind
    """Return f_x (n, n), as a sparse array where that is faster."""
    if len(x) >= sparse.LARGE:
        matrix = field.f_x_sparse(x, p)
        if matrix is not None and sparse.worthwhile(matrix):
            return matrix
    return field.f_x(x, p)


def linearise(field: VectorField, x: Array, p: Array) -> Linearised:
    """Return the linear algebra of f_x at one point."""
    A = jacobian(field, x, p)
    return Dense(A) if isinstance(A, np.ndarray) else Sparse(A)


def margin(matrix: Any, row: Array) -> float:  # noqa: ANN401 - either kind
    """Return the smallest singular value of [matrix; row] with the sign of the determinant.

    Rows are scaled to length one before; zero where that cannot be.

    Parameters
    ----------
    matrix : array or sparse array (n, n + 1)
    row : array (n + 1,)
    """
    full = isinstance(matrix, np.ndarray)
    square = np.vstack([matrix, row]) if full else sparse.below(matrix, row)
    length = _lengths(square)
    if not np.all(length > 0.0):
        return 0.0
    if not full:
        return _sparse_margin(square, length)
    square = square / length[:, None]
    sign = np.linalg.slogdet(square)[0]
    return float(sign * np.linalg.svd(square, compute_uv=False)[-1])


def _lengths(matrix: Any) -> Array:  # noqa: ANN401 - either kind
    """Return the lengths of the rows, whose squares may be too large for a number."""
    largest = abs(matrix).max()
    if not 1e-150 < largest < 1e150:
        if largest == 0.0 or not np.isfinite(largest):
            return np.zeros(matrix.shape[0])
        return np.asarray(_lengths(matrix / largest) * largest)
    return np.asarray(np.sqrt((matrix * matrix).sum(axis=1)))


def _sparse_margin(square: Any, length: Array) -> float:  # noqa: ANN401 - as above
    square.data /= length[square.indices]
    try:
        factors = sparse.Factors(square, last=sparse.LAST)
    except np.linalg.LinAlgError:
        return 0.0
    return factors.sign * sparse.smallest_singular(square, factors)


class Linearised(ABC):
    """A real square matrix A (n, n)."""

    @abstractmethod
    def null(self) -> tuple[Array, Array]:
        """Return unit null vectors (n,) of A and of its transpose; A is singular but for rounding.

        Where A is not, they belong to its smallest singular value.
        """

    @abstractmethod
    def across(self, right: Array, null: tuple[Array, Array]) -> Array:
        """Solve A w = right, as far as it can be solved, for w (n,) orthogonal to the null vector.

        Parameters
        ----------
        right : array (n,)
        null : tuple of array (n,)
            What `null` returned.
        """

    @abstractmethod
    def eigenvectors(self, omega: float) -> tuple[Complex, Complex]:
        """Return right and left (adjoint) eigenvectors (n,) of the eigenvalue next to i omega."""

    @abstractmethod
    def resolve(self, s: complex, right: Vectors) -> Vectors:
        """Return (s - A)^-1 right, right (n,)."""


class Dense(Linearised):
    """A full matrix.

    Parameters
    ----------
    A : array (n, n)
    """

    def __init__(self, A: Array) -> None:
        self.A = A

    def null(self) -> tuple[Array, Array]:
        """Return the singular vectors of the smallest singular value."""
        left, _, right = np.linalg.svd(self.A)
        return right[-1], left[:, -1]

    def across(self, right: Array, null: tuple[Array, Array]) -> Array:
        """Solve A w = right in the least-squares sense, but for the smallest singular value."""
        del null
        left, singular, transposed = np.linalg.svd(self.A)
        solution: Array = transposed[:-1].T @ ((left[:, :-1].T @ right) / singular[:-1])
        return solution

    def eigenvectors(self, omega: float) -> tuple[Complex, Complex]:
        """Return right and left (adjoint) eigenvectors (n,) of the eigenvalue next to i omega."""
        from scipy.linalg import eig

        values, left, right = eig(self.A, left=True, right=True)
        k = int(np.argmin(np.abs(values - 1j * omega)))
        return right[:, k], left[:, k]

    def resolve(self, s: complex, right: Vectors) -> Vectors:
        """Return (s - A)^-1 right, right (n,)."""
        shifted = -self.A if s == 0.0 else s * np.eye(len(self.A)) - self.A
        return np.asarray(np.linalg.solve(shifted, right))


class Sparse(Linearised):
    """A sparse matrix.

    Parameters
    ----------
    A : sparse array (n, n)
    """

    def __init__(self, A: Any) -> None:  # noqa: ANN401 - scipy has no types
        self.A = A

    def null(self) -> tuple[Array, Array]:
        """Return null vectors by a bordered matrix, the border improved by what it gives."""
        n = self.A.shape[0]
        v = psi = sparse.start(n) / np.sqrt(n)
        last = np.append(np.zeros(n), 1.0)
        for _ in range(_ROUNDS):
            factors = self._bordered(v, psi)
            v, psi = factors.solve(last)[:n], factors.adjoint(last)[:n]
            v, psi = v / np.sqrt(v @ v), psi / np.sqrt(psi @ psi)
        return v, psi

    def across(self, right: Array, null: tuple[Array, Array]) -> Array:
        """Solve A w = right, but for what is along the left null vector."""
        solution = self._bordered(*null).solve(np.append(right, 0.0))[:-1]
        return np.asarray(solution, dtype=float)

    def eigenvectors(self, omega: float) -> tuple[Complex, Complex]:
        """Return right and left (adjoint) eigenvectors (n,) by inverse iteration."""
        factors = self._shifted(1j * omega)
        q = adjoint = sparse.start(self.A.shape[0]).astype(complex)
        for _ in range(_ROUNDS):
            q, adjoint = factors.once(q), factors.adjoint(adjoint)
            q /= np.sqrt(np.vdot(q, q).real)
            adjoint /= np.sqrt(np.vdot(adjoint, adjoint).real)
        return q, adjoint

    def resolve(self, s: complex, right: Vectors) -> Vectors:
        """Return (s - A)^-1 right, right (n,)."""
        return self._shifted(s).solve(right)

    def _bordered(self, v: Array, psi: Array) -> sparse.Factors:
        square = sparse.below(sparse.beside(self.A, psi), np.append(v, 0.0))
        return sparse.Factors(square, last=sparse.LAST)

    def _shifted(self, s: complex) -> sparse.Factors:
        from scipy.sparse import eye_array

        eye = eye_array(self.A.shape[0], format="csc")
        return sparse.Factors((s.real if s.imag == 0.0 else s) * eye - self.A)
