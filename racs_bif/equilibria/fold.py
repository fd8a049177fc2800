"""LP: folds of a branch of equilibria."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from racs_bif.continuation.problem import Detector
from racs_bif.equilibria.linearised import linearise, margin

if TYPE_CHECKING:
    from racs_bif.continuation.points import Point
    from racs_bif.equilibria.problem import EquilibriumProblem


_FLAT = 1e-150
"""Below this an equation vanishes with its derivatives, as exp(-x) does on its way to infinity."""
_ASIDE = 1e-4
_CROSSED = 1e-2


def _crossed(problem: EquilibriumProblem, point: Point) -> bool:
    """Say whether another branch crosses: that of a pitchfork turns back without a fold."""
    here, beyond, before = (
        abs(margin(problem.jacobian(point.z + way * point.tangent), point.tangent))
        for way in (0.0, _ASIDE, -_ASIDE)
    )
    return here <= _CROSSED * max(beyond, before)


class Fold(Detector):
    """The tangent has no component along the parameter."""

    label = "LP"
    crossings = 1

    def value(self, problem: EquilibriumProblem, point: Point) -> float:
        """Return the tangent's component along the parameter."""
        del problem
        return float(point.tangent[-1])

    def data(self, problem: EquilibriumProblem, point: Point) -> dict[str, Any] | None:
        """Return the quadratic coefficient a of the fold's normal form; None at a branch point.

        With f_x q = 0, f_x^T p = 0, |q| = 1, <p, q> = 1: ``a = <p, B(q, q)> / 2`` (Yu. A.
        Kuznetsov, *Elements of Applied Bifurcation Theory*, section 5.4); its sign depends on that
        of q.
        """
        if _crossed(problem, point):
            return None
        x, p = point.z[:-1], problem.path.vector(point.z[-1])
        q, adjoint = linearise(problem.field, x, p).null()
        adjoint = adjoint / (adjoint @ q)
        a = float(0.5 * adjoint @ problem.field.f_xx(x, p, q, q))
        return {"a": a} if not abs(a) < _FLAT else None
