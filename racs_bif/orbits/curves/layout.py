"""Where the unknowns of a curve of cycles stand."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from racs_bif.symbolic.field import Array

TAIL = 4
"""Period, number of the reference and two parameters."""


@dataclass(frozen=True)
class Layout:
    """z = (X, V, u, T, g, lambda_1, lambda_2).

    Parameters
    ----------
    degree, states : int
        m and n.
    copies, further : int
        Number k of eigenfunctions and length of u.
    """

    degree: int
    states: int
    copies: int
    further: int

    def intervals(self, length: int) -> int:
        """Return the number N of intervals of a z of this length."""
        rest = length - TAIL - self.further
        return rest // ((1 + self.copies) * self.degree * self.states)

    def orbit(self, z: Array) -> Array:
        """Return X (N, m, n), a view."""
        return np.asarray(self._functions(z)[0])

    def functions(self, z: Array) -> Array:
        """Return V (k, N, m, n), a view."""
        return self._functions(z)[1:]

    def _functions(self, z: Array) -> Array:
        body = z[: len(z) - TAIL - self.further]
        return body.reshape(1 + self.copies, -1, self.degree, self.states)

    def further_of(self, z: Array) -> Array:
        """Return u."""
        return z[len(z) - TAIL - self.further : len(z) - TAIL]

    def main(self, z: Array) -> Array:
        """Return orbit, period and parameters (N m n + 3,)."""
        return np.concatenate((self.orbit(z).ravel(), z[-TAIL:-3], z[-2:]))

    def join(self, orbit: Array, functions: Array, further: Array, tail: Array) -> Array:
        """Return z from its parts; the tail is (T, g, lambda_1, lambda_2)."""
        return np.concatenate((orbit.ravel(), functions.ravel(), further, tail))
