"""BT: Bogdanov-Takens points, a double zero eigenvalue with one eigenvector."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, Any

import numpy as np

from racs_bif.continuation.problem import Detector
from racs_bif.equilibria.critical import nilpotent_vectors

if TYPE_CHECKING:
    from racs_bif.continuation.points import Point
    from racs_bif.equilibria.curve_problem import CurveProblem
    from racs_bif.equilibria.fold_curve import FoldCurve
    from racs_bif.equilibria.hopf_curve import HopfCurve

_SEMISIMPLE = 1e-6


class _BogdanovTakens(Detector):
    """What a Bogdanov-Takens point is, whatever curve it is found on."""

    label = "BT"

    @abstractmethod
    def value(self, problem: Any, point: Point) -> float:  # noqa: ANN401 - as of `Detector`
        """Return the test function."""

    def data(self, problem: CurveProblem, point: Point) -> dict[str, Any] | None:
        """Return the coefficients a and b; None where each zero eigenvalue has its eigenvector.

        On the centre manifold w0' = w1, w1' = a w0^2 + b w0 w1 with |q0| = 1, q0 . q1 = 0
        (Kuznetsov, section 8.4); both change sign with q0.
        """
        field, x, p = problem.realised(point.z)
        A = field.f_x(x, p)
        singular = np.linalg.svd(A, compute_uv=False)
        if len(A) > 1 and singular[-2] <= _SEMISIMPLE * singular[0] * _SEMISIMPLE:
            return None
        q0, q1, p0, p1 = nilpotent_vectors(A, problem.own)
        square = field.f_xx(x, p, q0, q0)
        a = 0.5 * float(p1 @ square)
        b = float(p0 @ square + p1 @ field.f_xx(x, p, q0, q1))
        return {"a": a, "b": b, "starts": "fold, hopf, homoclinic"}


class BogdanovTakensOnFold(_BogdanovTakens):
    """The null vectors of f_x are orthogonal to each other."""

    crossings = 1

    def value(self, problem: FoldCurve, point: Point) -> float:
        """Return w . v of the unit null vectors."""
        return problem.alignment(point.z)


class BogdanovTakensOnHopf(_BogdanovTakens):
    """kappa = omega^2 vanishes."""

    def value(self, problem: HopfCurve, point: Point) -> float:
        """Return kappa."""
        return float(point.z[problem.n])
