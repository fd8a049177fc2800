"""Solving linear equations along an orbit, closed by a twist and bordered."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from racs_bif.errors import ConvergenceError

if TYPE_CHECKING:
    from racs_bif.orbits.variational import Function, Variational
    from racs_bif.symbolic.field import Array

_ITERATIONS: Final = 6
_SETTLED: Final = 1e-6
"""Relative change of the growth at which it is found; that over T is no growth at all."""


@dataclass(frozen=True, eq=False)
class Solved:
    """Solutions of linear equations along an orbit.

    Attributes
    ----------
    starts : array (c, N, n)
        Values at the mesh points.
    stages : array (c, N, m, n)
        Values at the Gauss points.
    unknowns : array (k, c)
        The border's unknowns.
    """

    starts: Function
    stages: Function
    unknowns: Function


class Twisted:
    """Solver of v' = A v + r + sum_j g_j w_j, v(T) = c v(0), integral <u_i, v> dt = s_i.

    In these products the states are divided by their scales.

    Parameters
    ----------
    along : Variational
        A.
    twist : complex
        c: 1, -1, or another number on the unit circle.
    columns, rows : sequence of k functions (N, m, n)
        w_j and u_i. With none the equations must not be singular.

    Raises
    ------
    ConvergenceError
        If the bordered system is singular.
    """

    def __init__(
        self,
        along: Variational,
        twist: complex,
        columns: tuple[Function, ...] = (),
        rows: tuple[Function, ...] = (),
    ) -> None:
        self._along = along
        count, _, size = along.shape
        self._twist = twist if np.imag(twist) else float(np.real(twist))
        borders = len(columns)
        empty = np.zeros((0, *along.shape))
        scaled = np.stack(columns) if borders else empty
        scaled = scaled * along.tau[:, None, None] / along.scales
        weighted = np.conj(np.stack(rows)) if borders else empty
        weighted = weighted * along.weights / along.scales
        # both of length 1, so that the elimination sees no units
        self._lengths = _lengths(scaled), _lengths(weighted)
        self._columns = scaled / self._lengths[0][:, None, None, None]
        self._adjoint = along.adjoint(weighted / self._lengths[1][:, None, None, None])
        ends = along.at_ends(self._columns)
        starts = np.tensordot(self._adjoint, along.gauss.row_sums, (2, 0))
        self._matrix = self._bordered(
            ends.reshape(borders, count * size).T,
            starts.reshape(borders, count * size),
            _products(self._adjoint, self._columns),
        )
        self._factors = self._factorised()

    def _bordered(self, ends: Function, starts: Function, corner: Function) -> Any:  # noqa: ANN401
        """Return x_(k+1) - P_k x_k - ends g, whose last x is the twist times the first, and rows.

        The matrix is a sparse one of scipy, which has no types.
        """
        from scipy.sparse import block_array, coo_array

        along = self._along
        count, _, size = along.shape
        total = count * size
        places = np.arange(total).reshape(count, size)
        blocks = np.broadcast_arrays(places[:, :, None], places[:, None, :])
        here = coo_array((-along.transitions.ravel(), [b.ravel() for b in blocks]), (total, total))
        ones = np.ones((count, size), dtype=np.result_type(self._twist, float))
        ones[-1] = self._twist
        following = np.roll(places, -1, axis=0)
        ring = here + coo_array((ones.ravel(), (places.ravel(), following.ravel())), here.shape)
        if not len(corner):
            return ring.tocsc()
        return block_array([[ring, coo_array(-ends)], [coo_array(starts), corner]]).tocsc()

    def _factorised(self) -> Any:  # noqa: ANN401 - scipy has no types
        from scipy.sparse.linalg import splu

        try:
            return splu(self._matrix)
        except RuntimeError as error:
            raise ConvergenceError("the linear equations along the orbit are singular") from error

    def solve(self, rhs: tuple[Function, ...] | Function, values: Function | None = None) -> Solved:
        """Solve.

        Parameters
        ----------
        rhs : c functions (N, m, n)
            r.
        values : array (k, c), optional
            s; zero if left out.

        Raises
        ------
        ConvergenceError
            If the solution is not finite.
        """
        along = self._along
        count, _, size = along.shape
        scaled = np.stack(tuple(rhs)) * along.tau[:, None, None] / along.scales
        width, borders = len(scaled), len(self._columns)
        border = np.zeros((borders, width)) if values is None else np.asarray(values)
        border = border / self._lengths[1][:, None] - _products(self._adjoint, scaled)
        ends = along.at_ends(scaled).reshape(width, count * size).T
        right = np.concatenate((ends, border)).astype(self._matrix.dtype)
        found = self._factors.solve(right)
        # one step of refinement takes back what the pivoting of a sparse matrix lost
        found = found + self._factors.solve(right - self._matrix @ found)
        if not np.isfinite(found).all():
            raise ConvergenceError("the linear equations along the orbit have no finite solution")
        starts = found[: count * size].T.reshape(width, count, size)
        unknowns = found[count * size :]
        full = scaled + np.tensordot(unknowns.T, self._columns, 1)
        stages = along.at_stages(starts, full) * along.scales
        return Solved(starts * along.scales, stages, unknowns / self._lengths[0][:, None])


def kernel(along: Variational, twist: complex, near: Function | None = None) -> Solved:
    """Return the solution of v' = A v that comes closest to v(T) = twist v(0), of length 1.

    Inverse iteration. The unknown is minus the rate at which v grows beside the twist.

    Parameters
    ----------
    along : Variational
        A.
    twist : complex
        Of modulus 1.
    near : function (N, m, n), optional
        The solution, nearly.

    Raises
    ------
    ConvergenceError
        If none comes close.
    """
    growth = np.inf
    for _ in range(_ITERATIONS):
        solved = nearer(along, twist, near)
        near, before, growth = solved.stages[0], growth, solved.unknowns[0, 0]
        if abs(growth - before) <= _SETTLED * max(abs(growth), _SETTLED / along.period):
            break
    return solved


def nearer(along: Variational, twist: complex, near: Function | None = None) -> Solved:
    """Return one step of the inverse iteration of `kernel`."""
    if near is None:
        near = along.noise(1) + (1j * along.noise(2) if np.imag(twist) else 0.0)
    solver = Twisted(along, twist, (near,), (near,))
    solved = solver.solve(np.zeros((1, *along.shape)), np.ones((1, 1)))
    length = along.size(solved.stages[0])
    return Solved(solved.starts / length, solved.stages / length, solved.unknowns / length)


def _lengths(functions: Function) -> Array:
    """Return the Euclidean lengths (k,) of functions (k, N, m, n)."""
    return np.asarray(np.sqrt(np.sum(np.abs(functions) ** 2, axis=(1, 2, 3))))


def _products(a: Function, b: Function) -> Function:
    """Return the sums of products (c, d) of a (c, N, m, n) and b (d, N, m, n)."""
    return np.asarray(np.tensordot(a, b, ((1, 2, 3), (1, 2, 3))))
