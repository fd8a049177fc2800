"""Elimination of the values at the Gauss points where only neighbouring states are coupled.

With the states in the order of Cuthill and McKee (1969), and the Gauss points of each beside one
another, the equations of every interval have a narrow band. Those of all intervals are one banded
matrix: LAPACK factorises it in one call, and no pivot is ever taken from the next interval, whose
entries in the columns of this one are zero.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from racs_bif.orbits.stages import Stages

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from racs_bif.orbits.gauss import Gauss
    from racs_bif.symbolic.field import Array

_NARROW: Final = 0.4
"""Width of the band over the states up to which it is faster than full matrices (measured)."""


@dataclass(frozen=True, eq=False)
class Band:
    """Where a Jacobian has entries, and the order of the states in which they make a band.

    Attributes
    ----------
    pattern : array of bool (n, n)
        Where there may be entries.
    order : array of int (n,)
        The states in their order.
    rows, columns : array of int (q,)
        Places of the entries in that order.
    below, above : int
        Diagonals below and above the main one.
    """

    pattern: NDArray[np.bool_]
    order: NDArray[np.intp]
    rows: NDArray[np.intp]
    columns: NDArray[np.intp]
    below: int
    above: int

    @property
    def narrow(self) -> bool:
        """Whether the band pays."""
        return self.below + self.above + 1 <= _NARROW * len(self.order)

    def holds(self, pattern: NDArray[np.bool_]) -> bool:
        """Return whether all entries of another pattern have their place."""
        return pattern.shape == self.pattern.shape and not np.any(pattern & ~self.pattern)


def band(pattern: NDArray[np.bool_]) -> Band:
    """Return the order of the states (n,) that makes the band of a pattern (n, n) narrow."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import reverse_cuthill_mckee

    order = reverse_cuthill_mckee(csr_array(pattern | pattern.T), symmetric_mode=True).astype(int)
    rows, columns = np.nonzero(pattern[np.ix_(order, order)])
    offsets = rows - columns
    below, above = int(offsets.max(initial=0)), int(-offsets.min(initial=0))
    return Band(pattern, order, rows, columns, below, above)


class BandedStages(Stages):
    """One banded matrix of all intervals.

    Parameters
    ----------
    coefficients : Gauss
        Of the degree.
    jacobians : array (N, m, n, n)
        Derivatives of f at the Gauss points.
    tau : array (N,)
        Lengths of the intervals in time.
    shape : Band
        Where they have entries.

    Raises
    ------
    numpy.linalg.LinAlgError
        If an interval's equations are singular: it is too long.
    """

    def __init__(self, coefficients: Gauss, jacobians: Array, tau: Array, shape: Band) -> None:
        self._gauss, self._size, self._count = coefficients, jacobians.shape[-1], len(tau)
        self._order = shape.order
        self._back = np.argsort(shape.order)
        degree = coefficients.degree
        self._below = max(degree * shape.below, degree - 1)
        self._above = max(degree * shape.above, degree - 1)
        self._factorise(self._band(jacobians, tau, shape))

    def _band(self, jacobians: Array, tau: Array, shape: Band) -> Array:
        """Return LAPACK's band storage: places (N, n, m) of columns, and the diagonals of each."""
        g, middle = self._gauss, self._below + self._above
        storage = np.zeros((self._count, self._size, g.degree, middle + self._below + 1))
        rows, columns = shape.rows, shape.columns
        entries = jacobians[:, :, self._order[rows], self._order[columns]]
        places = middle + g.degree * (rows - columns)
        storage[:, columns, :, places] = -(tau[:, None, None] * entries).transpose(2, 0, 1)
        for i in range(g.degree):
            for j in range(g.degree):
                storage[:, :, j, middle + i - j] += g.inverse[i, j]
        return storage.reshape(-1, storage.shape[-1])

    def _factorise(self, storage: Array) -> None:
        from scipy.linalg.lapack import dgbtrf, dgbtrs

        self._solver: Any = dgbtrs
        lu, pivots, info = dgbtrf(storage.T, self._below, self._above, overwrite_ab=True)
        if info > 0:
            raise np.linalg.LinAlgError("the equations of an interval are singular")
        self._factors = lu, pivots

    @cached_property
    def _by_starts(self) -> Array:
        """Derivatives (n, N, n, m) of the Gauss points by the starts, each in the band's order."""
        size = self._size
        starts = np.zeros((size, self._count, size, self._gauss.degree))
        starts[range(size), :, range(size)] = self._gauss.row_sums
        return self._banded(starts, transposed=0)

    def transitions(self) -> Array:
        """Return the derivatives (N, n, n) of the ends of the intervals by their starts."""
        g, back = self._gauss, self._back
        moved = (self._by_starts @ g.end).transpose(1, 2, 0)
        return np.asarray(moved[:, back[:, None], back] + g.end_start * np.eye(self._size))

    def from_starts(self, starts: Array) -> Array:
        """Return B^-1 A^-1 1 x (c, N, m, n) for x = starts (c, N, n)."""
        there = starts[:, :, self._order].transpose(1, 0, 2)
        moved = there @ self._spread
        moved = moved.reshape(*there.shape, self._gauss.degree).transpose(1, 0, 3, 2)
        return np.ascontiguousarray(moved[..., self._back])

    @cached_property
    def _spread(self) -> Array:
        """As `_by_starts`, (N, n, n m)."""
        return self._by_starts.swapaxes(0, 1).reshape(self._count, self._size, -1)

    def at_ends(self, rhs: Array) -> Array:
        """Return what B^-1 rhs adds at the ends of the intervals (c, N, n)."""
        return np.asarray(self._gauss.end @ self.solve(rhs))

    def solve(self, rhs: Array) -> Array:
        """Return B^-1 rhs."""
        return self._apply(rhs, transposed=0)

    def adjoint(self, rhs: Array) -> Array:
        """Return B^-T rhs."""
        return self._apply(rhs, transposed=1)

    def _apply(self, rhs: Array, *, transposed: int) -> Array:
        there = np.ascontiguousarray(rhs[..., self._order].swapaxes(2, 3))
        values = self._banded(there, transposed=transposed)[:, :, self._back]
        return np.ascontiguousarray(values.swapaxes(2, 3))

    def _banded(self, there: Array, *, transposed: int) -> Array:
        """Return B^-1 times right-hand sides (c, N, n, m) in the band's order, written over."""
        lu, pivots = self._factors
        columns = there.reshape(len(there), -1).T
        found = self._solver(
            lu, self._below, self._above, columns, pivots, trans=transposed, overwrite_b=True
        )[0]
        return np.asarray(found.T.reshape(there.shape))
