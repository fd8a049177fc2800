"""A ring of transition matrices multiplied together as far as they do not grow."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from racs_bif.orbits.condense import BorderedRing, Ring

if TYPE_CHECKING:
    from racs_bif.symbolic.field import Array


class Folds:
    """Neighbouring transition matrices multiplied, pair by pair and again.

    A product costs a hundredth of an orthogonal elimination (`Ring`) and is as accurate while its
    factors do not grow.

    Parameters
    ----------
    transitions : array (M, n, n)
        The matrices P_m, in units in which 1 is a typical change of every state.
    growth : float
        Largest norm of a product.
    fewest : int
        Fewest products to stop at.

    Attributes
    ----------
    pairs : list of (array, array)
        First and second factors (h, n, n) of every level.
    products : array (M', n, n)
        What is left.
    """

    def __init__(self, transitions: Array, growth: float, fewest: int = 1) -> None:
        self.pairs: list[tuple[Array, Array]] = []
        blocks = transitions
        while len(blocks) > 1 and (len(blocks) + 1) // 2 >= fewest:
            even = len(blocks) // 2 * 2
            first, second = blocks[:even:2], blocks[1:even:2]
            products = second @ first
            # not finite counts as grown
            if not float(np.linalg.norm(products, axis=(1, 2)).max()) <= growth:
                break
            self.pairs.append((first, second))
            blocks = np.concatenate((products, blocks[even:]))
        self.products = blocks

    def begins(self, points: Array) -> Array:
        """Return those of the points (M, n) at which the products begin (M', n)."""
        return points[:: 2 ** len(self.pairs)]

    def forward(self, rhs: Array) -> tuple[Array, list[Array]]:
        """Fold right-hand sides (M, n, c); return them and what was folded away."""
        kept = []
        for first, second in self.pairs:
            even = 2 * len(first)
            kept.append(rhs[:even:2])
            rhs = np.concatenate((second @ rhs[:even:2] + rhs[1:even:2], rhs[even:]))
        return rhs, kept

    def backward(self, rows: Array) -> tuple[Array, list[Array]]:
        """Fold rows of coefficients (M, r, n); return them and what was folded away."""
        kept = []
        for first, _ in self.pairs:
            even = 2 * len(first)
            kept.append(rows[1:even:2])
            rows = np.concatenate((rows[:even:2] + rows[1:even:2] @ first, rows[even:]))
        return rows, kept

    def unfold(self, points: Array, kept: list[Array]) -> Array:
        """Return all points (M, n, c), where x_(m+1) = P_m x_m + kept for those folded away."""
        for (first, _), added in zip(reversed(self.pairs), reversed(kept), strict=True):
            half = len(added)
            between = first @ points[:half] + added
            woven = np.stack((points[:half], between), axis=1).reshape(-1, *points.shape[1:])
            points = np.concatenate((woven, points[half:]))
        return points


class BorderedFolds:
    """Solver of the ring x_(m+1) = P_m x_m + C_m u + r_m bordered by k rows and k columns.

    Parameters
    ----------
    folds : Folds
        The transition matrices P.
    columns : array (M, n, k)
        C.
    rows : array (k, M, n)
        Border rows.
    corner : array (k, k)
        Where they meet.
    """

    def __init__(self, folds: Folds, columns: Array, rows: Array, corner: Array) -> None:
        self._folds = folds
        folded, self._columns = folds.forward(columns)
        left, self._rows = folds.backward(rows.swapaxes(0, 1))
        for row, column in zip(self._rows, self._columns, strict=True):
            corner = corner + np.sum(row @ column, axis=0)
        products = folds.products
        ring = Ring(products, np.broadcast_to(-np.eye(products.shape[-1]), products.shape))
        self._ring = BorderedRing(ring, folded, left.swapaxes(0, 1), corner)

    def sign(self) -> float:
        """Return the sign of the determinant, the same however long the ring: `Ring.sign`."""
        return self._ring.sign()

    def solve(self, rhs: Array, border: Array) -> tuple[Array, Array]:
        """Return the points (M, n, c) and the unknowns u (k, c).

        Parameters
        ----------
        rhs : array (M, n, c)
            r.
        border : array (k, c)
            Right-hand sides of the rows.
        """
        folded, kept = self._folds.forward(rhs)
        for row, added in zip(self._rows, kept, strict=True):
            border = border - np.sum(row @ added, axis=0)
        points, unknowns = self._ring.solve(-folded, border)
        pairs = zip(kept, self._columns, strict=True)
        moved = [added + column @ unknowns for added, column in pairs]
        return self._folds.unfold(points, moved), unknowns
