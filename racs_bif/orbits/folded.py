"""A ring of transition matrices multiplied together as far as they do not grow."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from racs_bif.orbits.condense import Ring

if TYPE_CHECKING:
    from racs_bif.symbolic.field import Array


class FoldedRing(Ring):
    """The ring P_m x_m - x_(m+1), neighbours multiplied first, condensed orthogonally then.

    A product costs a hundredth of an orthogonal elimination and is as accurate while its factors
    do not grow.

    Parameters
    ----------
    transitions : array (M, n, n)
        The matrices P_m, in units in which 1 is a typical change of every state.
    growth : float
        Largest norm of a product.
    most : int, optional
        Most neighbours to multiply, a power of 2; by default any number.

    Attributes
    ----------
    folded : array (M', n, n)
        The products.
    """

    def __init__(self, transitions: Array, growth: float, most: int | None = None) -> None:
        self._folds: list[tuple[Array, Array]] = []
        blocks = transitions
        while len(blocks) > 1 and (most is None or 2 ** len(self._folds) < most):
            even = len(blocks) // 2 * 2
            first, second = blocks[:even:2], blocks[1:even:2]
            products = second @ first
            # not finite counts as grown
            if not float(np.linalg.norm(products, axis=(1, 2)).max()) <= growth:
                break
            self._folds.append((first, second))
            blocks = np.concatenate((products, blocks[even:]))
        self.folded = blocks
        super().__init__(blocks, np.broadcast_to(-np.eye(blocks.shape[-1]), blocks.shape))

    def picked(self, points: Array) -> Array:
        """Return those of the points (M, n) at which the products begin (M', n)."""
        for _ in self._folds:
            points = points[::2]
        return points

    def reduce(self, rhs: Array) -> tuple[Array, list[Array]]:
        """Condense right-hand sides (M, n, k); see `Ring.reduce`."""
        kept = []
        for first, second in self._folds:
            even = 2 * len(first)
            kept.append(rhs[:even:2])
            rhs = np.concatenate((second @ rhs[:even:2] + rhs[1:even:2], rhs[even:]))
        condensed, rest = super().reduce(rhs)
        return condensed, [*kept, *rest]

    def expand(self, first: Array, kept: list[Array]) -> Array:
        """Return all points (M, n, k) from the first one (n, k) and what `reduce` kept."""
        folds = len(self._folds)
        points = super().expand(first, kept[folds:])
        for (matrix, _), rhs in zip(reversed(self._folds), reversed(kept[:folds]), strict=True):
            half = len(rhs)
            between = matrix @ points[:half] - rhs
            woven = np.stack((points[:half], between), axis=1).reshape(-1, *first.shape)
            points = np.concatenate((woven, points[half:]))
        return points
