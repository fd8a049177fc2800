"""Orthogonal condensation of the cyclic systems of multiple shooting and collocation.

M block rows A_m x_m + B_m x_(m+1) + C_m y = r_m on a ring are reduced pair by pair: the QR
factorisation of the stack [B_m; A_(m+1)] eliminates the point between them, without ever
multiplying transition matrices, so that neither fast growth nor fast decay is lost (S. J. Wright,
*Stable parallel algorithms for two-point boundary value problems*, SIAM J. Sci. Stat. Comput. 13,
1992; for the multipliers T. F. Fairgrieve and A. D. Jepson, *O.K. Floquet multipliers*, SIAM J.
Numer. Anal. 28, 1991).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from racs_bif.symbolic.field import Array


@dataclass(frozen=True, eq=False)
class _Level:
    """One halving of the ring: the points between the pairs in terms of their neighbours."""

    turn: Array  # (h, 2n, 2n): transposed orthogonal factors
    inverse: Array  # (h, n, n): inverses of the triangular factors
    left: Array  # (h, n, n): coefficients of the point before
    right: Array  # (h, n, n): coefficients of the point after
    odd: bool  # a last row had no partner and is carried over


class Ring:
    """The condensed ring of block rows A_m x_m + B_m x_(m+1), with x_(M+1) = x_1.

    Parameters
    ----------
    before, after : array (M, n, n)
        The blocks A_m and B_m.

    Attributes
    ----------
    before, after : array (n, n)
        Blocks of the one row that is left, A x_1 + B x_(M+1).
    """

    def __init__(self, before: Array, after: Array) -> None:
        self._levels: list[_Level] = []
        while len(before) > 1:
            before, after = self._halve(before, after)
        self.before: Array = before[0]
        self.after: Array = after[0]

    def _halve(self, before: Array, after: Array) -> tuple[Array, Array]:
        count, size = len(before), before.shape[-1]
        half = count // 2
        first, second = slice(0, 2 * half, 2), slice(1, 2 * half, 2)
        stack = np.concatenate((after[first], before[second]), axis=1)
        q, r = np.linalg.qr(stack, mode="complete")
        turn = np.ascontiguousarray(np.swapaxes(q, 1, 2))
        left = turn[:, :, :size] @ before[first]
        right = turn[:, :, size:] @ after[second]
        odd = bool(count % 2)
        inverse = np.linalg.inv(r[:, :size])
        self._levels.append(_Level(turn, inverse, left[:, :size], right[:, :size], odd))
        new_before, new_after = left[:, size:], right[:, size:]
        if odd:
            new_before = np.concatenate((new_before, before[-1:]))
            new_after = np.concatenate((new_after, after[-1:]))
        return new_before, new_after

    def halves(self) -> list[int]:
        """Return how many points every halving eliminates."""
        return [len(level.left) for level in self._levels]

    def sign(self) -> float:
        """Return the sign that the condensation gives the determinant of the ring.

        The determinant of P_m x_m - x_(m+1) on a ring is that of P_M ... P_1 - I, whatever M.
        """
        sign = 1.0
        for level in self._levels:
            half, size = level.left.shape[:2]
            turned = float(np.prod(np.linalg.slogdet(level.turn)[0]))
            triangular = float(np.prod(np.sign(np.diagonal(level.inverse, axis1=1, axis2=2))))
            sign *= turned * triangular * (-1.0) ** (half * size)
        return sign

    def reduce(self, rhs: Array) -> tuple[Array, list[Array]]:
        """Condense right-hand sides.

        Parameters
        ----------
        rhs : array (M, n, k)
            Right-hand sides of the block rows.

        Returns
        -------
        condensed : array (n, k)
            Right-hand side of the row that is left.
        kept : list of array
            What `expand` needs.
        """
        kept = []
        for level in self._levels:
            half, size = level.left.shape[:2]
            pairs = rhs[: 2 * half].reshape(half, 2 * size, rhs.shape[-1])
            turned = level.turn @ pairs
            kept.append(turned[:, :size])
            rhs = np.concatenate((turned[:, size:], rhs[-1:])) if level.odd else turned[:, size:]
        return rhs[0], kept

    def expand(self, first: Array, kept: list[Array], last: Array | None = None) -> Array:
        """Return all points (M, n, k) from the first one (n, k) and what `reduce` kept.

        The point after the last block is the first one, or `last` (n, k) where the ring is open.
        """
        points, end = first[None], (first if last is None else last)[None]
        for level, tops in zip(reversed(self._levels), reversed(kept), strict=True):
            half = len(tops)
            following = np.concatenate((points[1:], end))
            between = level.inverse @ (
                tops - level.left @ points[:half] - level.right @ following[:half]
            )
            woven = np.stack((points[:half], between), axis=1).reshape(-1, *first.shape)
            points = np.concatenate((woven, points[half:])) if level.odd else woven
        return points


class BorderedRing:
    """Solver of a ring bordered by k columns and k rows.

    The rows and columns are eliminated with the ring condensed to one block and the small system
    solved densely, so that the ring's own part may be singular, as it is at every periodic orbit.

    Parameters
    ----------
    ring : Ring
        The condensed ring.
    columns : array (M, n, k)
        Border columns C.
    rows : array (k, M, n)
        Border rows.
    corner : array (k, k)
        Where they meet.
    """

    def __init__(self, ring: Ring, columns: Array, rows: Array, corner: Array) -> None:
        count, size, borders = columns.shape
        self._ring, self._rows = ring, rows.reshape(borders, count * size)
        self._size = size
        condensed, kept = ring.reduce(columns)
        # every point as an affine function of the first point and of the border unknowns
        basis = np.zeros((size, size + borders))
        basis[:, :size] = np.eye(size)
        padded = [np.concatenate((np.zeros((len(k), size, size)), -k), axis=2) for k in kept]
        self._basis = ring.expand(basis, padded).reshape(count * size, size + borders)
        self._small = np.zeros((size + borders, size + borders))
        self._small[:size, :size] = ring.before + ring.after
        self._small[:size, size:] = condensed
        self._small[size:] = self._rows @ self._basis
        self._small[size:, size:] += corner

    def sign(self) -> float:
        """Return the sign of the determinant, the border last; see `Ring.sign`."""
        return self._ring.sign() * float(np.linalg.slogdet(self._small)[0])

    def solve(self, rhs: Array, border: Array) -> tuple[Array, Array]:
        """Solve.

        Parameters
        ----------
        rhs : array (M, n, c)
            Right-hand sides of the block rows.
        border : array (k, c)
            Right-hand sides of the border rows.

        Returns
        -------
        points : array (M, n, c)
            The points.
        unknowns : array (k, c)
            The border unknowns.

        Raises
        ------
        numpy.linalg.LinAlgError
            If the system is exactly singular.
        """
        count, size, width = rhs.shape
        condensed, kept = self._ring.reduce(rhs)
        particular = self._ring.expand(np.zeros((size, width)), kept).reshape(count * size, width)
        small = np.concatenate((condensed, border - self._rows @ particular))
        solution = np.asarray(np.linalg.solve(self._small, small), dtype=float)
        points = particular + self._basis @ solution
        return points.reshape(count, size, width), solution[size:]
