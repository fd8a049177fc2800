"""Solves with a square matrix, factorised once, that say when the matrix is singular."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from collections.abc import Callable

Array = NDArray[np.float64]

_SUSPICIOUS = 1e-8
_SINGULAR = 1e-17


@cache
def _lapack() -> tuple[Callable[..., Any], Callable[..., Any]]:
    from scipy.linalg.lapack import dgetrf, dgetrs

    return dgetrf, dgetrs


def factorise(matrix: Array) -> Callable[[Array], Array]:
    """Return a solver of a dense square matrix, by LU with partial pivoting.

    Parameters
    ----------
    matrix : array (m, m)
        Left unchanged.

    Returns
    -------
    callable
        Maps right-hand sides (m,) or (m, k) to solutions of the same shape.

    Raises
    ------
    numpy.linalg.LinAlgError
        If the matrix is singular, or not finite. A pivot counts as zero where it is lost in the
        rounding of both its row and its column, so that units of rows and columns do not matter.
    """
    dgetrf, dgetrs = _lapack()
    lu, pivots, info = dgetrf(matrix)
    diagonal = np.abs(lu.diagonal())
    smallest, largest = np.minimum.reduce(diagonal), np.maximum.reduce(diagonal)
    if info or not smallest > _SUSPICIOUS * largest:
        _check(matrix, diagonal, pivots)

    def solve(right: Array) -> Array:
        solution: Array = dgetrs(lu, pivots, right)[0]
        return solution

    return solve


def _check(matrix: Array, diagonal: Array, pivots: NDArray[np.int32]) -> None:
    """Raise if a pivot is zero but for rounding."""
    absolute = np.abs(matrix)
    rows, columns = absolute.max(axis=1), absolute.max(axis=0)
    order = np.arange(len(rows))
    for i, j in enumerate(pivots):
        order[i], order[j] = order[j], order[i]
    if not np.all(diagonal > _SINGULAR * len(rows) * np.minimum(rows[order], columns)):
        msg = "the matrix is singular"
        raise np.linalg.LinAlgError(msg)
