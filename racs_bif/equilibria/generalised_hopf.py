"""GH: generalised Hopf (Bautin) points, where the first Lyapunov coefficient vanishes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from racs_bif.continuation.problem import Detector
from racs_bif.equilibria.critical import pair_vectors
from racs_bif.equilibria.manifold import Mode, NormalForm, normal_form

if TYPE_CHECKING:
    from racs_bif.continuation.points import Array, Point
    from racs_bif.equilibria.hopf_curve import HopfCurve

_NOISE = 1e-12
_ZERO = 1e-4


class GeneralisedHopf(Detector):
    """Re c1 changes sign; not where it does so through infinity, as at a zero-Hopf point."""

    label = "GH"

    def value(self, problem: HopfCurve, point: Point) -> float:
        """Return Re c1, zero where it is lost in rounding; NaN at a neutral saddle."""
        if not problem.frequency(point.z) > 0.0:
            return float("nan")
        cubic = problem.cubic(point.z)
        return 0.0 if abs(cubic.c1.real) <= _NOISE * cubic.size else cubic.c1.real

    def data(self, problem: HopfCurve, point: Point) -> dict[str, Any] | None:
        """Return frequency and second Lyapunov coefficient l2 = Re c2.

        w' = i omega w + c2 w |w|^4, c2 = G32 / 12 in Kuznetsov's terms (section 8.7), |q| = 1.
        """
        cubic = problem.cubic(point.z)
        # Beside what it was before, for all its terms may vanish together; at a pole it is large.
        if abs(cubic.c1.real) > _ZERO * problem.typical:
            return None
        omega = problem.frequency(point.z)
        form = quintic(problem, point.z, omega)
        l2 = float(form.g[(3, 2)][0].real)
        return {"omega": omega, "l1": cubic.c1.real / omega, "l2": l2, "starts": "hopf, lpc"}


def quintic(problem: HopfCurve, z: Array, omega: float) -> NormalForm:
    """Return the normal form of a Hopf point to degree five."""
    field, x, p = problem.realised(z)
    A = field.f_x(x, p)
    q, adjoint = pair_vectors(A, omega, problem.own)
    modes = (Mode((1,), q, adjoint), Mode((-1,), q.conj(), adjoint.conj()))
    return normal_form(field, (x, p, A), (omega,), modes, 5)
