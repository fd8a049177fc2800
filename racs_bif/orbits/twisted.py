"""The linearised equations of collocation for functions that do not close on themselves.

k functions solve the same linear equations and meet their own starts by a matrix: V(1) = V(0) C. An
eigenfunction of the multiplier -1 has C = -1, the real pair that belongs to exp(+-i theta) has the
companion matrix of mu^2 - 2 kappa mu + 1. Where such functions exist the equations are singular;
bordered they are regular, and the unknown of the border is a test function (W. Govaerts, *Numerical
Methods for Bifurcations of Dynamical Equilibria*, SIAM 2000, chapter 3; E. J. Doedel, W. Govaerts
and Yu. A. Kuznetsov, *Computation of periodic solution bifurcations in ODEs using bordered
systems*, SIAM J. Numer. Anal. 41, 2003).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import ConvergenceError
from racs_bif.orbits.condense import Ring

if TYPE_CHECKING:
    from racs_bif.orbits.intervals import Linearised
    from racs_bif.symbolic.field import Array


@dataclass(frozen=True, eq=False)
class Border:
    """c more unknowns and c + 1 more equations.

    Attributes
    ----------
    columns : array (c, k, N, m, n)
        What the unknowns add to the right-hand sides at the Gauss points.
    closing : array (c, k, n)
        What they add to V(1) beside V(0) C.
    rows : array (c + 1, k, N, m, n)
        The equations' coefficients of V at the Gauss points, the normalisation last.
    """

    columns: Array
    closing: Array
    rows: Array


class TwistedIntervals:
    """Solver of B Y = A^-1 1 v + columns u + rhs with V(1) = V(0) C + closing u + ends, and rows.

    One more column completes the border: the left null vector of the system without its last row,
    condensed to the start of the period. Its unknown g is zero where V is an exact solution of the
    homogeneous equations.

    Parameters
    ----------
    equations : Linearised
        The equations, states in units of their scales.
    twist : array (k, k)
        C.
    border : Border
        Further unknowns and rows.

    Attributes
    ----------
    null : array (k, n)
        Start of the right null vector.
    dual : array (k, n)
        Left null vector of C - M, with the monodromy matrix M.
    pairing : float
        Product of both, divided by their lengths: zero where the multiplier has a longer Jordan
        chain. Its sign is arbitrary, like those of the vectors.
    """

    def __init__(self, equations: Linearised, twist: Array, border: Border) -> None:
        self._equations, self._twist, self._border = equations, twist, border
        folds, stages, g = equations.folds, equations.stages, equations.gauss
        products = folds.products
        self._n = products.shape[-1]
        self._ring = Ring(products, np.broadcast_to(-np.eye(self._n), products.shape))
        self._bases()
        count = len(border.rows)
        flat = border.rows.reshape(count * len(twist), *border.rows.shape[2:])
        self._adjoint = stages.adjoint(flat).reshape(border.rows.shape)
        starts = (g.row_sums @ self._adjoint).reshape(flat.shape[0], -1, self._n)
        self._rows, self._kept_rows = folds.backward(np.moveaxis(starts, 0, 1))
        first, last = (
            np.tensordot(self._rows, basis, ((0, 2), (0, 1))).reshape(count, -1, self._n)
            for basis in (self._from_first, self._from_last)
        )
        self._last = last
        width = len(twist) * self._n
        matrix = np.zeros((width + count, width + count))
        blocks = np.einsum("ij,ab->iajb", np.eye(len(twist)), self._ring.before)
        blocks += np.einsum("ij,ab->iajb", twist, self._ring.after)
        matrix[:width, :width] = blocks.reshape(width, width)
        of_starts = first + np.einsum("rja,ji->ria", last, twist)
        matrix[width:, :width] = of_starts.reshape(count, width)
        moved, self._of_unknowns = self._forced(border.columns, border.closing)
        matrix[:, width:-1] = -moved
        self._matrix = matrix
        self._complete(width)

    def _bases(self) -> None:
        """Find the points at which the products begin from the first point and the last one."""
        kept = [np.zeros((h, self._n, self._n)) for h in self._ring.halves()]
        eye, zero = np.eye(self._n), np.zeros((self._n, self._n))
        self._from_first = self._ring.expand(eye, kept, zero)
        self._from_last = self._ring.expand(zero, kept, eye)

    def _complete(self, width: int) -> None:
        """Put the last column in."""
        try:
            left, sizes, right = np.linalg.svd(self._matrix[:-1, :-1])
        except np.linalg.LinAlgError as error:
            raise ConvergenceError("the eigenfunction's equations are not finite") from error
        found, null = left[:, -1], right[-1]
        self._matrix[:-1, -1] = found * sizes[0]
        self.null = null[:width].reshape(-1, self._n)
        self.dual = found[:width].reshape(-1, self._n) @ self._ring.after
        lengths = float(np.linalg.norm(self.dual) * np.linalg.norm(self.null))
        self.pairing = float(np.sum(self.dual * self.null)) / lengths if lengths else 0.0

    def _forced(self, rhs: Array, ends: Array) -> tuple[Array, tuple[Array, list[Array]]]:
        """Return what forcing (q, k, N, m, n) leaves for the small system, and the points it moves.

        Returns
        -------
        moved : array (k n + r, q)
            Right-hand side of the small system.
        points : tuple
            Points with first and last one zero (M', n, q k), and what was folded away.
        """
        equations, n = self._equations, self._n
        count, k = rhs.shape[:2]
        rows = len(self._adjoint)
        flat = rhs.reshape(count * k, *rhs.shape[2:])
        moved = np.zeros((len(flat), flat.shape[1], n))
        active = flat.any(axis=(1, 2, 3))
        if active.any():
            moved[active] = equations.stages.at_ends(flat[active])
        folded, kept = equations.folds.forward(np.moveaxis(moved, 0, -1))
        condensed, turned = self._ring.reduce(-folded)
        zero = np.zeros((n, count * k))
        points = self._ring.expand(zero, turned, zero)
        top = condensed.reshape(n, count, k) - np.einsum("ab,qjb->aqj", self._ring.after, ends)
        known = np.tensordot(self._rows, points, ((0, 2), (0, 1)))
        for row, added in zip(self._kept_rows, kept, strict=True):
            known += np.tensordot(row, added, ((0, 2), (0, 1)))
        known = np.einsum("rjqj->rq", known.reshape(rows, k, count, k))
        known += np.tensordot(self._adjoint, rhs, ((1, 2, 3, 4), (1, 2, 3, 4)))
        known += np.einsum("rja,qja->rq", self._last, ends)
        small = np.concatenate((np.moveaxis(top, 2, 0).reshape(k * n, count), -known))
        return small, (points, kept)

    def solve(self, rhs: Array, border: Array, ends: Array | None = None) -> Solved:
        """Solve.

        Parameters
        ----------
        rhs : array (q, k, N, m, n)
            Right-hand sides at the Gauss points.
        border : array (c + 1, q)
            Right-hand sides of the rows.
        ends : array (q, k, n), optional
            What is added to V(1).

        Returns
        -------
        Solved
            The solution.

        Raises
        ------
        numpy.linalg.LinAlgError
            If the bordered system is exactly singular.
        """
        (count, k), n = rhs.shape[:2], self._n
        ends = np.zeros((count, k, n)) if ends is None else ends
        small, (points, kept) = self._forced(rhs, ends)
        small[k * n :] += border
        solution = np.asarray(np.linalg.solve(self._matrix, small), dtype=float)
        first = solution[: k * n].reshape(k, n, count)
        unknowns = solution[k * n : -1]
        last = np.einsum("ji,inq->jnq", self._twist, first)
        last += np.einsum("cjn,cq->jnq", self._border.closing, unknowns)
        last += np.moveaxis(ends, 0, -1)
        own, own_kept = self._of_unknowns
        starts = np.moveaxis(first, 0, -1).reshape(n, count * k)
        moved = self._from_first @ starts
        moved += self._from_last @ np.moveaxis(last, 0, -1).reshape(n, count * k)
        moved += points + _spread(own, unknowns, k)
        folded = [a + _spread(b, unknowns, k) for a, b in zip(kept, own_kept, strict=True)]
        whole = self._equations.folds.unfold(moved, folded)
        begins = np.ascontiguousarray(np.moveaxis(whole, -1, 0))
        forcing = self._equations.from_starts(begins) + rhs.reshape(count * k, *rhs.shape[2:])
        forcing += np.tensordot(unknowns.T, self._border.columns, 1).reshape(forcing.shape)
        values = self._equations.stages.solve(forcing)
        g = self._equations.gauss
        nodes = np.empty_like(values)
        nodes[:, :, 0] = begins
        nodes[:, :, 1:] = begins[:, :, None] * g.inner_start[:, None] + g.inner @ values
        return Solved(nodes.reshape(rhs.shape), unknowns, solution[-1])


@dataclass(frozen=True, eq=False)
class Solved:
    """A solution of the bordered equations.

    Attributes
    ----------
    nodes : array (q, k, N, m, n)
        V at the nodes, in units of the scales.
    unknowns : array (c, q)
        The border's unknowns.
    test : array (q,)
        g.
    """

    nodes: Array
    unknowns: Array
    test: Array


def _spread(columns: Array, unknowns: Array, k: int) -> Array:
    """Return columns (M, n, c k) times unknowns (c, q) as (M, n, q k)."""
    split = columns.reshape(*columns.shape[:2], len(unknowns), k)
    product = np.einsum("mnck,cq->mnqk", split, unknowns)
    return np.asarray(product).reshape(*columns.shape[:2], unknowns.shape[1] * k)
