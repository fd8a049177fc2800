"""Sparse matrices: when they pay, and solves with them.

Importing this module does not import scipy.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from racs_bif.numerics.bordered import factorise

if TYPE_CHECKING:
    from collections.abc import Callable

Numbers = NDArray[Any]
"""Real or complex."""
Matrix = Any
"""A numpy array, or a scipy.sparse array in compressed columns."""

LARGE = 300
"""From this size on matrices are sparse if they can be.

Measured on a one-dimensional Brusselator, four Newton corrections, a spectrum and a test function:
24 ms at any size, against 31 ms with full matrices of 200 rows, 54 of 300 and 145 of 400. Below it
the whole spectrum is worth more than the time.
"""
_FULL = 0.05
_SINGULAR = 1e-17
LAST = 1e-3
"""Scale at which a full last row waits until it is wanted as a pivot."""


def worthwhile(matrix: Matrix) -> bool:
    """Say whether a sparse matrix is so large and so empty that it is not better full."""
    size = matrix.shape[0]
    return bool(size >= LARGE and matrix.nnz <= _FULL * size * size)


def solver(matrix: Matrix) -> Callable[[Numbers], Numbers]:
    """Return a solver of a full or sparse square matrix.

    Raises
    ------
    numpy.linalg.LinAlgError
        If the matrix is not finite; or if it is singular, maybe only when the solver is called.
    """
    if not isinstance(matrix, np.ndarray):
        return Factors(matrix).solve
    if not np.all(np.isfinite(matrix)):  # its solutions would be zero, as if all were solved
        msg = "the matrix is not finite"
        raise np.linalg.LinAlgError(msg)
    return lambda right: np.asarray(np.linalg.solve(matrix, right))


class Factors:
    """The LU factors of a sparse square matrix, its rows scaled to one (SuperLU).

    Parameters
    ----------
    matrix : sparse array (m, m)
        Left unchanged.
    last : float
        Scale of the last row: a full one below one leaves its place as pivot to others, which
        keeps the factors sparse.

    Raises
    ------
    numpy.linalg.LinAlgError
        If the matrix is singular, but for rounding, or not finite.
    """

    def __init__(self, matrix: Matrix, *, last: float = 1.0) -> None:
        from scipy.sparse.linalg import splu

        self._matrix = matrix = matrix.tocsc()
        size = abs(matrix).max(axis=1).toarray().ravel()
        if not (np.all(np.isfinite(size)) and np.all(size > 0.0)):
            msg = "the matrix is singular or not finite"
            raise np.linalg.LinAlgError(msg)
        self._scale = 1.0 / size
        self._scale[-1] *= last
        scaled = matrix.copy()
        scaled.data = matrix.data * self._scale[matrix.indices]
        try:
            self._lu = splu(scaled)
        except RuntimeError as error:  # an exact zero among the pivots
            raise np.linalg.LinAlgError(str(error)) from None
        self._pivots = self._lu.U.diagonal()
        columns = abs(scaled).max(axis=0).toarray().ravel()[self._lu.perm_c.argsort()]
        if not np.all(np.abs(self._pivots) > _SINGULAR * len(size) * columns):
            msg = "the matrix is singular"
            raise np.linalg.LinAlgError(msg)

    @property
    def sign(self) -> float:
        """Sign of the determinant of a real matrix."""
        swaps = _odd(self._lu.perm_r) + _odd(self._lu.perm_c)
        return float(np.prod(np.sign(self._pivots))) * (-1.0) ** swaps

    def solve(self, right: Numbers) -> Numbers:
        """Return the solution for right-hand sides (m,) or (m, k), refined once."""
        solution = self.once(right)
        return np.asarray(solution + self.once(right - self._matrix @ solution))

    def once(self, right: Numbers) -> Numbers:
        """Return the solution as it comes."""
        scale = self._scale if right.ndim == 1 else self._scale[:, None]
        return self._split(scale * right, "N")

    def adjoint(self, right: Numbers) -> Numbers:
        """Return the solution (m,) with the conjugate transpose of the matrix."""
        return np.asarray(self._scale * self._split(right, "H"))

    def _split(self, right: Numbers, trans: str) -> Numbers:
        """Solve with the factors; SuperLU takes complex numbers only where the matrix has them."""
        if np.iscomplexobj(right) and not np.iscomplexobj(self._pivots):
            real = self._lu.solve(np.ascontiguousarray(right.real), trans)
            return np.asarray(real + 1j * self._lu.solve(np.ascontiguousarray(right.imag), trans))
        return np.asarray(self._lu.solve(right.astype(self._pivots.dtype), trans))


def _odd(permutation: NDArray[np.intp]) -> int:
    """Return 1 for an odd permutation, 0 for an even one."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    size = len(permutation)
    graph = csr_array((np.ones(size), permutation, np.arange(size + 1)), shape=(size, size))
    return int(size - connected_components(graph, directed=False, return_labels=False)) % 2


def beside(matrix: Matrix, column: Numbers) -> Matrix:
    """Return the sparse array [matrix, column], (n, n + 1)."""
    from scipy.sparse import csc_array

    n = len(column)
    data = np.concatenate((matrix.data, column))
    indices = np.concatenate((matrix.indices, np.arange(n)))
    indptr = np.append(matrix.indptr, matrix.indptr[-1] + n)
    return csc_array((data, indices, indptr), shape=(matrix.shape[0], matrix.shape[1] + 1))


def bordered(matrix: Matrix, row: Numbers) -> Callable[[Numbers], Numbers]:
    """Return a solver of the square matrix [matrix; row], matrix (n, n + 1) full or sparse.

    Raises
    ------
    numpy.linalg.LinAlgError
        If it is singular.
    """
    if not isinstance(matrix, np.ndarray):
        return Factors(below(matrix, row), last=LAST).solve
    square = np.empty((len(row), len(row)), order="F")
    square[:-1] = matrix
    square[-1] = row
    return factorise(square)


def below(matrix: Matrix, row: Numbers) -> Matrix:
    """Return the sparse array [matrix; row]."""
    from scipy.sparse import csr_array, vstack

    return vstack([matrix, csr_array(row[None, :])], format="csc")


def smallest_singular(matrix: Matrix, factors: Factors) -> float:
    """Return the smallest singular value of a sparse matrix, by inverse iteration.

    It starts from the same vector whenever it is called.
    """
    x = start(matrix.shape[0])
    size = 0.0
    for _ in range(_MOST):
        x = factors.solve(factors.adjoint(x / np.sqrt(x @ x)))
        before, size = size, float(np.sqrt(x @ x))
        if abs(size - before) <= _SETTLED * size:
            break
    return float(1.0 / np.sqrt(size))


_MOST = 100
_SETTLED = 1e-12
_SEED = 20250


def start(size: int) -> NDArray[np.float64]:
    """Return a vector (size,) in which nothing is missing: random, and always the same."""
    return np.random.default_rng(_SEED).standard_normal(size)
