"""The boundaries' problems: those of special equilibria, without what only their curves need."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from racs_bif.equilibria.branch_point_curve import BranchPointCurve
from racs_bif.equilibria.curve_problem import CurveProblem, Matrix
from racs_bif.equilibria.exact_fold_curve import ExactFoldCurve
from racs_bif.equilibria.exact_hopf_curve import ExactHopfCurve
from racs_bif.equilibria.singular_mass_curve import SingularMassCurve

if TYPE_CHECKING:
    from racs_bif.continuation.points import Array, Spectrum

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


class SingularBoundary(_Boundary, SingularMassCurve):
    """Where the mass matrix is singular."""

    name = "singular mass matrix"


def _unit(vector: Matrix) -> Matrix:
    return np.asarray(vector / np.linalg.norm(vector)).reshape(-1, 1)
