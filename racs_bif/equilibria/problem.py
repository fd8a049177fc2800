"""Equilibria of a vector field as a continuation problem."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.continuation.points import Array, Spectrum
from racs_bif.continuation.problem import Problem, Solver
from racs_bif.equilibria.linearised import jacobian
from racs_bif.numerics import sparse

if TYPE_CHECKING:
    from racs_bif.symbolic.field import VectorField
    from racs_bif.symbolic.paths import ParameterPath

Measures = Callable[[Array, Array], dict[str, float]]
"""Maps states (n,) and base parameters (np,) to named quantities."""


class EquilibriumProblem(Problem):
    """Solutions of f(x, p) = 0 along one active parameter; ``z = (x, lambda)``.

    A large system whose Jacobian is sparse is treated as one; see `spectrum`.

    Parameters
    ----------
    field : VectorField
        The vector field.
    path : ParameterPath
        The active parameter.
    measures : callable, optional
        Further quantities of a point.

    Attributes
    ----------
    height : float
        No unstable eigenvalue of any point so far with an imaginary part below this is missing from
        its spectrum; infinity where none is missing at all.
    """

    def __init__(
        self, field: VectorField, path: ParameterPath, measures: Measures | None = None
    ) -> None:
        self.field = field
        self.path = path
        self.name = "equilibria"
        self.parameter = path.names[0]
        self.height = math.inf
        self._measures = measures

    def residual(self, z: Array) -> Array:
        """Return f (n,)."""
        return self.field.f(z[:-1], self.path.vector(z[-1]))

    def jacobian(self, z: Array) -> Array:
        """Return (f_x, f_lambda) as (n, n+1), as a sparse array where that is faster."""
        x, p = z[:-1], self.path.vector(z[-1])
        A = jacobian(self.field, x, p)
        column = self.field.f_p(x, p, self.path.direction(z[-1]))
        if not isinstance(A, np.ndarray):
            beside: Array = sparse.beside(A, column)
            return beside
        both = np.empty((len(x), len(x) + 1))
        both[:, :-1] = A
        both[:, -1] = column
        return both

    def bordered(self, z: Array, row: Array) -> Solver:
        """Return a solver of the matrix [jacobian; row], shape (n+1, n+1)."""
        return sparse.bordered(self.jacobian(z), row)

    def spectrum(self, z: Array) -> Spectrum:
        """Return the eigenvalues of f_x, the rightmost first.

        All n where the Jacobian is full. Where it is sparse, all that are unstable, as far up the
        imaginary axis as `height` says, and others near them; `racs_bif.numerics.rightmost` says
        what that rests on.
        """
        A = jacobian(self.field, z[:-1], self.path.vector(z[-1]))
        if not isinstance(A, np.ndarray):
            from racs_bif.numerics.rightmost import rightmost

            seen = rightmost(A)
            self.height = min(self.height, seen.height)
            return seen.values
        from scipy.linalg import eigvals

        found = eigvals(A, check_finite=False)
        return np.asarray(found[np.lexsort((found.imag, -found.real))])

    def sides(self, spectrum: Spectrum) -> np.ndarray:
        """Return which eigenvalues are right of the imaginary axis."""
        return np.asarray(spectrum.real > 0.0)

    def on_axis(self, spectrum: Spectrum, count: int) -> np.ndarray | None:
        """Return which eigenvalues are the `count` nearest to the imaginary axis."""
        if len(spectrum) < count:
            return None
        mask = np.zeros(len(spectrum), dtype=bool)
        mask[np.argsort(np.abs(spectrum.real))[:count]] = True
        return mask

    def measures(self, z: Array) -> dict[str, float]:
        """Return further quantities of the point."""
        if self._measures is None:
            return {}
        return self._measures(z[:-1], self.path.vector(z[-1]))
