"""Both sides of the exact model at the harmonics of an orbit: left X = right core(X)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from racs_bif.fractional.exact import ExactModel
    from racs_bif.fractional.laws import Law
    from racs_bif.orbits.fourier import Complex
    from racs_bif.symbolic.field import Array

Pair = tuple["Complex", "Complex"]


@dataclass(frozen=True)
class Diagonals:
    """The diagonals (s, D(s)) and (1, N(s)) of an exact model at given parameters.

    Attributes
    ----------
    states : int
        Number of states, whose rows are s X = g(X).
    laws : tuple of Law
        Of the elements, whose rows are D(s) w = N(s) e(X).
    directions : tuple of Law or None
        Their derivatives along the active parameter, None if no law moves.
    """

    states: int
    laws: tuple[Law, ...]
    directions: tuple[Law, ...] | None = None

    @classmethod
    def of(cls, model: ExactModel, p: Array, dp: Array | None = None) -> Diagonals:
        """Return those of a model at base parameters p (np,), moving along dp (np,)."""
        directions = None if dp is None else model.field.law_directions(p, dp)
        return cls(model.ny, model.laws(p), directions)

    def at(self, s: Complex) -> Pair:
        """Return both diagonals (m, n) at frequencies s (m,); zero is a frequency as well."""
        left, right = self._empty(s)
        left[:, : self.states], right[:, : self.states] = s[:, None], 1.0
        for k, law in enumerate(self.laws, self.states):
            left[:, k], right[:, k] = law.denominator(s), law.numerator(s)
        return left, right

    def slopes(self, s: Complex) -> Pair:
        """Return the derivatives (m, n) of both by s; zero for s = 0, which never moves."""
        left, right = self._empty(s)
        moving = s != 0.0
        left[moving, : self.states] = 1.0
        for k, law in enumerate(self.laws, self.states):
            left[moving, k] = law.denominator.slope(s[moving])
            right[moving, k] = law.numerator.slope(s[moving])
        return left, right

    def drifts(self, s: Complex) -> Pair | None:
        """Return the derivatives (m, n) of both by the parameter; None if no law moves."""
        if self.directions is None:
            return None
        left, right = self._empty(s)
        moving, still = s != 0.0, s == 0.0
        for k, (law, moved) in enumerate(zip(self.laws, self.directions, strict=True), self.states):
            pairs = (
                (left, law.denominator, moved.denominator),
                (right, law.numerator, moved.numerator),
            )
            for side, terms, direction in pairs:
                side[moving, k] = terms.along(direction, s[moving])
                side[still, k] = direction.coefficients[terms.exponents == 0.0].sum()
        return left, right

    def _empty(self, s: Complex) -> Pair:
        shape = (len(s), self.states + len(self.laws))
        return np.zeros(shape, dtype=complex), np.zeros(shape, dtype=complex)
