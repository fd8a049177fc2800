"""The course of many members over one step."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.simulation.rosenbrock import BETWEEN, Step, weighted

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from racs_bif.symbolic.field import Array


@dataclass(frozen=True)
class Piece:
    """A step of M members; over it k states are polynomials of s = (t - t0) / h, of degree 4.

    Parameters
    ----------
    t, h : array (M,)
        When it begins and how long it is [s].
    coefficients : array (5, k, M)
        Of 1, s, ..., s**4.
    """

    t: Array
    h: Array
    coefficients: Array

    @classmethod
    def of(cls, t: Array, h: Array, x: Array, step: Step, rows: int) -> Piece:
        """Return the course of the first states over a step from x (n, M)."""
        begin, end = x[:rows], step.x[:rows]
        parts = step.increments[:, :rows]
        k1, k2, k3 = (weighted(row, parts) for row in BETWEEN)
        c = np.stack([begin, end - begin + k1, k2 - k1, k3 - k2, -k3])
        return cls(t, h, c)

    def take(self, which: NDArray[np.intp] | NDArray[np.bool_]) -> Piece:
        """Return the courses of some members."""
        return Piece(self.t[which], self.h[which], self.coefficients[:, :, which])

    def row(self, k: int) -> Piece:
        """Return the course of one state."""
        return Piece(self.t, self.h, self.coefficients[:, k : k + 1])

    def at(self, s: Array) -> Array:
        """Return the states (k, M) at s (M,), or each at its own s (k, M)."""
        value = self.coefficients[4]
        for c in self.coefficients[3::-1]:
            value = value * s + c
        return np.asarray(value)

    def slope(self, s: Array) -> Array:
        """Return their derivatives by s (k, M) at s (M,)."""
        c = self.coefficients
        return np.asarray(c[1] + s * (2.0 * c[2] + s * (3.0 * c[3] + s * (4.0 * c[4]))))
