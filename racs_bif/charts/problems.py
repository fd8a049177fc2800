"""The boundaries' problems: those of special equilibria, without what only their curves need."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from racs_bif.equilibria.branch_point_curve import BranchPointCurve
from racs_bif.equilibria.curve_problem import CurveProblem, Matrix, Span
from racs_bif.equilibria.exact_fold_curve import ExactFoldCurve
from racs_bif.equilibria.exact_hopf_curve import ExactHopfCurve

if TYPE_CHECKING:
    from racs_bif.continuation.points import Array, Spectrum
    from racs_bif.fractional.realised import RealisedField
    from racs_bif.fractional.static import StaticField
    from racs_bif.symbolic.paths import ParameterPath

_NO_SPECTRUM = np.empty(0, dtype=complex)
DERIVATIVES = 4
"""A Jacobian differentiates the characteristic matrix by s, by the state and by two parameters."""


class _Boundary(CurveProblem):
    """What boundaries have in common.

    Attributes
    ----------
    evaluations : int
        Characteristic matrices and their derivatives so far.
    """

    evaluations = 0

    def residual(self, z: Array) -> Array:
        """Return the residual, and count it."""
        self.evaluations += 1
        return super().residual(z)  # type: ignore[safe-super] # that of the curve

    def jacobian(self, z: Array) -> Array:
        """Return the Jacobian, and count it."""
        self.evaluations += DERIVATIVES
        return super().jacobian(z)  # type: ignore[safe-super] # that of the curve

    def spectrum(self, z: Array) -> Spectrum:
        """Return nothing: what else is unstable is counted in the regions."""
        del z
        return _NO_SPECTRUM

    def measures(self, z: Array) -> dict[str, float]:
        """Return the first parameter, so that its values can be asked for like the second's."""
        return {self.path.names[0]: float(z[-2])}


class HopfBoundary(_Boundary, ExactHopfCurve):
    """A pair of exact characteristic roots on the imaginary axis.

    Attributes
    ----------
    wanted : bool
        Whether the first Lyapunov coefficient is computed.
    """

    name = "Hopf boundary"
    wanted = False

    def adapt(self, z: Array, tangent: Array) -> None:
        """Let the borders follow the null vectors."""
        if self.wanted:
            super().adapt(z, tangent)
        else:
            solved = self._solve(z)
            self._borders.follow(z, _unit(solved.w), _unit(solved.v))

    def measures(self, z: Array) -> dict[str, float]:
        """Return the first parameter, and l1 where it is wanted."""
        told = _Boundary.measures(self, z)
        if not self.wanted:
            return told
        self.evaluations += 2
        return told | {"l1": self.cubic(z).c1.real / self.frequency(z)}

    def gradient(self, z: Array) -> Array:
        """Return the derivative (2,) of Re s by the two parameters, along the equilibria."""
        n, jacobian = self.n, self.jacobian(z)
        g = jacobian[n] + 1j * jacobian[n + 1]
        drift = np.linalg.solve(jacobian[:n, :n], jacobian[:n, n + 1 :])
        moved = g[n + 1 :] - g[:n] @ drift
        # g depends on s = i omega analytically: dg/ds = -i dg/domega.
        return np.asarray((-moved / (-1j * g[n])).real)


class FoldBoundary(_Boundary, ExactFoldCurve):
    """Where the equilibrium itself ends, in a fold."""

    name = "fold boundary"


class StaticBoundary(_Boundary, BranchPointCurve):
    """A real root through zero at an equilibrium that persists."""

    name = "static boundary"


class SingularBoundary(_Boundary):
    """Where the mass matrix is singular: z = (y, w, lambda_1, lambda_2), f = 0 and det M = 0.

    Parameters
    ----------
    static : StaticField
        The equilibrium equations.
    realised : RealisedField
        The realisation, which is not asked.
    path, span
        See `CurveProblem`.
    """

    kind = "singular"
    critical = 0
    name = "singular mass matrix"

    def __init__(
        self, static: StaticField, realised: RealisedField, path: ParameterPath, span: Span
    ) -> None:
        super().__init__(static, path, span, len(realised.compiled.states))
        self._compiled = static.compiled
        self._ny = len(self._compiled.states)

    def residual(self, z: Array) -> Array:
        """Return (f, det M) (n+1,), the forces before they are divided by M."""
        self.evaluations += 1
        X, p = self.base(z)
        forces = self._compiled.forces(X, self._compiled.padded(p))
        with np.errstate(all="ignore"):
            rest = self.field.f(X, p)[self._ny :]
        return np.concatenate([forces[:-1], rest, forces[-1:]])

    def jacobian(self, z: Array) -> Array:
        """Return the derivatives (n+1, n+2)."""
        self.evaluations += DERIVATIVES
        X, p = self.base(z)
        n, ny, padded = self.n, self._ny, self._compiled.padded
        along, moved = np.zeros((n, n + 2)), np.zeros((len(p), n + 2))
        along[:, :n] = np.eye(n)
        moved[:, n:] = np.column_stack(self.directions(z))
        slopes = self._compiled.forces_d(X, padded(p), along, padded(moved))
        jacobian = np.empty((n + 1, n + 2))
        jacobian[:ny], jacobian[n] = slopes[:-1], slopes[-1]
        with np.errstate(all="ignore"):
            jacobian[ny:n, :n] = self.field.f_x(X, p)[ny:]
            for k, dp in enumerate(self.directions(z)):
                jacobian[ny:n, n + k] = self.field.f_p(X, p, dp)[ny:]
        return jacobian

    def frequency(self, z: Array) -> float:
        """Return infinity: where a root passes."""
        del z
        return float("inf")


def _unit(vector: Matrix) -> Matrix:
    return np.asarray(vector / np.linalg.norm(vector)).reshape(-1, 1)
