"""CP: cusps, where the quadratic coefficient of a fold vanishes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from racs_bif.continuation.problem import Detector
from racs_bif.equilibria.critical import null_vectors
from racs_bif.equilibria.manifold import Mode, normal_form

if TYPE_CHECKING:
    from racs_bif.continuation.points import Point
    from racs_bif.equilibria.fold_curve import FoldCurve

_NOISE = 1e-13
_ZERO = 1e-5


class Cusp(Detector):
    """w . B(v, v) vanishes, v and w being the unit null vectors of f_x."""

    label = "CP"

    def value(self, problem: FoldCurve, point: Point) -> float:
        """Return w . B(v, v), zero where it is lost in rounding."""
        value, size = problem.quadratic(point.z)
        return 0.0 if abs(value) <= _NOISE * size else value

    def data(self, problem: FoldCurve, point: Point) -> dict[str, Any] | None:
        """Return the cubic coefficient c; None where B(v, v) does not vanish but jump.

        On the centre manifold ``w' = c w**3``: c = <p, C(q,q,q) + 3 B(q, h2)> / 6 with |q| = 1
        (Kuznetsov, section 8.2).
        """
        value, size = problem.quadratic(point.z)
        if abs(value) > _ZERO * max(size, problem.typical):
            return None
        field, x, p = problem.realised(point.z)
        A = field.f_x(x, p)
        q, adjoint = null_vectors(A, problem.own)
        form = normal_form(field, (x, p, A), (), (Mode((), q, adjoint),), 3)
        return {"c": float(form.g[(3,)][0].real), "starts": "fold"}
