"""Curves in two parameters along which the mass matrix of an equilibrium is singular."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from racs_bif.equilibria.curve_problem import CurveProblem, Span

if TYPE_CHECKING:
    from racs_bif.continuation.points import Array
    from racs_bif.fractional.realised import RealisedField
    from racs_bif.fractional.static import StaticField
    from racs_bif.symbolic.paths import ParameterPath


class SingularMassCurve(CurveProblem):
    """Where the mass matrix is singular: z = (y, w, lambda_1, lambda_2), f = 0 and det M = 0.

    The forces are taken before they are divided by M, and so are finite.

    Parameters
    ----------
    static : StaticField
        The equilibrium equations, of a model that `has_inertia`.
    realised : RealisedField
        The realisation, which is not asked.
    path, span
        See `CurveProblem`.
    """

    kind = "singular"
    critical = 0
    name = "singular-mass curve"

    def __init__(
        self, static: StaticField, realised: RealisedField, path: ParameterPath, span: Span
    ) -> None:
        super().__init__(static, path, span, len(realised.compiled.states))
        self._compiled = static.compiled

    def residual(self, z: Array) -> Array:
        """Return (f, det M) (n+1,)."""
        X, p = self.base(z)
        forces = self._compiled.forces(X, self._compiled.padded(p))
        with np.errstate(all="ignore"):
            elements = self.field.f(X, p)[self.own :]
        return np.concatenate([forces[:-1], elements, forces[-1:]])

    def jacobian(self, z: Array) -> Array:
        """Return the derivatives (n+1, n+2)."""
        X, p = self.base(z)
        n, own, padded = self.n, self.own, self._compiled.padded
        directions = self.directions(z)
        along, moved = np.zeros((n, n + 2)), np.zeros((len(p), n + 2))
        along[:, :n] = np.eye(n)
        moved[:, n:] = np.column_stack(directions)
        slopes = self._compiled.forces_d(X, padded(p), along, padded(moved))
        jacobian = np.empty((n + 1, n + 2))
        jacobian[:own], jacobian[n] = slopes[:-1], slopes[-1]
        with np.errstate(all="ignore"):
            jacobian[own:n, :n] = self.field.f_x(X, p)[own:]
            for k, dp in enumerate(directions):
                jacobian[own:n, n + k] = self.field.f_p(X, p, dp)[own:]
        return jacobian

    def frequency(self, z: Array) -> float:
        """Return infinity: where a root passes."""
        del z
        return float("inf")
