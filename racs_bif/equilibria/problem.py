"""Equilibria of a vector field as a continuation problem."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.continuation.points import Array, Spectrum
from racs_bif.continuation.problem import Problem

if TYPE_CHECKING:
    from racs_bif.symbolic.field import VectorField
    from racs_bif.symbolic.paths import ParameterPath

Measures = Callable[[Array, Array], dict[str, float]]
"""Maps states (n,) and base parameters (np,) to named quantities."""


class EquilibriumProblem(Problem):
    """Solutions of f(x, p) = 0 along one active parameter; ``z = (x, lambda)``.

    Parameters
    ----------
    field : VectorField
        The vector field.
    path : ParameterPath
        The active parameter.
    measures : callable, optional
        Further quantities of a point.
    """

    def __init__(
        self, field: VectorField, path: ParameterPath, measures: Measures | None = None
    ) -> None:
        self.field = field
        self.path = path
        self.name = "equilibria"
        self.parameter = path.names[0]
        self._measures = measures

    def residual(self, z: Array) -> Array:
        """Return f (n,)."""
        return self.field.f(z[:-1], self.path.vector(z[-1]))

    def jacobian(self, z: Array) -> Array:
        """Return (f_x, f_lambda) as (n, n+1)."""
        n = len(z) - 1
        p = self.path.vector(z[-1])
        jacobian = np.empty((n, n + 1))
        jacobian[:, :n] = self.field.f_x(z[:-1], p)
        jacobian[:, n] = self.field.f_p(z[:-1], p, self.path.direction(z[-1]))
        return jacobian

    def spectrum(self, z: Array) -> Spectrum:
        """Return the eigenvalues (n,) of f_x, the rightmost first."""
        from scipy.linalg import eigvals

        found = eigvals(self.field.f_x(z[:-1], self.path.vector(z[-1])), check_finite=False)
        return np.asarray(found[np.lexsort((found.imag, -found.real))])

    def sides(self, spectrum: Spectrum) -> np.ndarray:
        """Return which eigenvalues are right of the imaginary axis."""
        return np.asarray(spectrum.real > 0.0)

    def measures(self, z: Array) -> dict[str, float]:
        """Return further quantities of the point."""
        if self._measures is None:
            return {}
        return self._measures(z[:-1], self.path.vector(z[-1]))
