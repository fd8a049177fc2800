"""BP: points where two branches of equilibria cross."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from racs_bif.continuation.problem import Detector
from racs_bif.equilibria.linearised import linearise, margin

if TYPE_CHECKING:
    from racs_bif.continuation.points import Point
    from racs_bif.equilibria.problem import EquilibriumProblem


_PITCHFORK = 1e-6
_ALONG = 1e-4
_STEADY = 1e-6
_MUCH_LARGER = 100.0
_ASIDE = 1e-4


def _pole(problem: EquilibriumProblem, point: Point) -> bool:
    """Say whether the determinant changed its sign through infinity: the matrix shrinks away."""
    aside = point.z + _ASIDE * (1.0 + np.abs(point.z).max()) * point.tangent
    here, there = (abs(problem.jacobian(z)).max() for z in (point.z, aside))
    return bool(here > _MUCH_LARGER * there)


class BranchPoint(Detector):
    """The matrix [f_x f_lambda; tangent] is singular."""

    label = "BP"
    crossings = 1

    def value(self, problem: EquilibriumProblem, point: Point) -> float:
        """Return its smallest singular value with the sign of its determinant.

        One singular value changes its sign where the matrix is singular, so this test function is
        smooth there. Rows are scaled to length one, which leaves the zero where it is.
        """
        return margin(problem.jacobian(point.z), point.tangent)

    def data(self, problem: EquilibriumProblem, point: Point) -> dict[str, Any] | None:
        """Return the kind of crossing and the direction (n+1,) of the other branch.

        None where the matrix is regular, as at a pole of the equations, and where its singular
        value stays zero to first order, as along equilibria that are not isolated.

        The kernel of (f_x, f_lambda) is spanned by (v, 0) and (w, 1), v being the null vector of
        f_x; psi is that of its transpose. Branches leave along ``alpha (w, 1) + beta (v, 0)``,
        ``c22 alpha^2 + 2 c12 alpha beta + c11 beta^2 = 0``, c11 = <psi, B(v, v)> and so on. One
        of the two is known: it gives the other without c22, save on the branch of a pitchfork
        itself, along (v, 0). There w is taken orthogonal to v, which is the other branch where a
        reflection is the reason for the pitchfork, and a start from which it is found elsewhere.
        """
        z, field = point.z, problem.field
        x, p, dp = z[:-1], problem.path.vector(z[-1]), problem.path.direction(z[-1])
        A = linearise(field, x, p)
        if _pole(problem, point):
            return None
        v, psi = null = A.null()
        w = A.across(-field.f_p(x, p, dp), null)
        square = field.f_xx(x, p, v, v)
        c11 = float(psi @ square)
        mixed = field.f_xx(x, p, w, v), field.f_xp(x, p, v, dp)
        c12 = float(psi @ (mixed[0] + mixed[1]))
        pitchfork = abs(c11) <= _PITCHFORK * (float(np.abs(psi * square).sum()) + abs(c12))
        alpha = float(point.tangent[-1])
        beta = float(point.tangent[:-1] @ v)
        rate = abs(alpha * c12 + beta * c11) + abs(beta * c12)
        if rate <= _STEADY * sum(float(np.abs(psi * term).sum()) for term in (square, *mixed)):
            return None
        if abs(alpha) * np.sqrt(w @ w + 1.0) <= _ALONG * abs(beta):
            other = np.append(w, 1.0)
        elif pitchfork:
            other = np.append(v, 0.0)
        else:
            other = c11 * np.append(w, 1.0) - (2.0 * c12 + beta / alpha * c11) * np.append(v, 0.0)
        return {
            "kind": "pitchfork" if pitchfork else "transcritical",
            "other_tangent": other / np.sqrt(other @ other),
        }

    def explains(self, data: dict[str, Any]) -> int:
        """Return 1; 0 on the branch of a pitchfork, whose eigenvalue only touches the axis."""
        touches = data.get("kind") == "pitchfork" and data["other_tangent"][-1] != 0.0
        return 0 if touches else self.crossings
