"""BP: points where two branches of equilibria cross."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from racs_bif.continuation.problem import Detector

if TYPE_CHECKING:
    from racs_bif.continuation.points import Point
    from racs_bif.equilibria.problem import EquilibriumProblem


class BranchPoint(Detector):
    """The matrix [f_x f_lambda; tangent] is singular."""

    label = "BP"
    crossings = 1

    def value(self, problem: EquilibriumProblem, point: Point) -> float:
        """Return its smallest singular value with the sign of its determinant.

        One singular value changes its sign where the matrix is singular, so this test function is
        smooth there. Rows are scaled to length one, which leaves the zero where it is.
        """
        matrix = np.vstack([problem.jacobian(point.z), point.tangent])
        length = np.sqrt((matrix * matrix).sum(axis=1, keepdims=True))
        if not np.all(length > 0.0):
            return 0.0
        matrix = matrix / length
        sign = np.linalg.slogdet(matrix)[0]
        return float(sign * np.linalg.svd(matrix, compute_uv=False)[-1])

    def data(self, problem: EquilibriumProblem, point: Point) -> dict[str, Any]:
        """Return the kind of crossing and the direction (n+1,) of the other branch.

        With v spanning the kernel of f_x and psi that of its transpose, the other branch leaves along
        ``alpha t + beta (v, 0)`` with ``2 alpha <psi, f_zz(t, v)> + beta <psi, B(v, v)> = 0``: a pitchfork
        where ``<psi, B(v, v)> = 0``, otherwise a transcritical point.
        """
        z, field = point.z, problem.field
        x, p, dp = z[:-1], problem.path.vector(z[-1]), problem.path.direction(z[-1])
        left, _, right = np.linalg.svd(field.f_x(x, p))
        v, psi = right[-1], left[:, -1]
        along = point.tangent / np.abs(point.tangent).max()
        curvature = float(psi @ field.f_xx(x, p, v, v))
        mixed = float(psi @ (field.f_xx(x, p, along[:-1], v) + along[-1] * field.f_xp(x, p, v, dp)))
        size = float(np.abs(field.f_xx(x, p, v, v)).max()) + abs(mixed)
        pitchfork = abs(curvature) <= 1e-6 * size
        alpha = 0.0 if pitchfork or mixed == 0.0 else -0.5 * curvature / mixed
        other = alpha * along + np.append(v, 0.0)
        return {
            "kind": "pitchfork" if pitchfork else "transcritical",
            "other_tangent": other / np.sqrt(other @ other),
        }
