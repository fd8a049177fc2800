"""HH: double Hopf points, two pairs on the imaginary axis."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from racs_bif.continuation.problem import Detector
from racs_bif.equilibria.critical import pair_vectors
from racs_bif.equilibria.hopf import REAL, real_sums
from racs_bif.equilibria.manifold import Mode, NormalForm, normal_form

if TYPE_CHECKING:
    from racs_bif.continuation.points import Array, Point
    from racs_bif.equilibria.curve_problem import CurveProblem
    from racs_bif.fractional.realised import RealisedField

_NEAR = 1e-5
_RESONANT = 1e-4


class DoubleHopf(Detector):
    """On a Hopf curve a second pair passes the imaginary axis."""

    label = "HH"
    crossings = 2

    def value(self, problem: CurveProblem, point: Point) -> float:
        """Return the smallest real sum of two further eigenvalues, signed by the product of all."""
        sums = real_sums(problem.noncritical(point.spectrum))[0]
        if not len(sums) or not problem.frequency(point.z) > 0.0:
            return float("nan")
        sign = -1.0 if np.count_nonzero(sums < 0.0) % 2 else 1.0
        return float(sign * np.abs(sums).min())

    def data(self, problem: CurveProblem, point: Point) -> dict[str, Any] | None:
        """Return frequencies, coefficients and unfolding; None at a neutral saddle."""
        sums, frequencies = real_sums(problem.noncritical(point.spectrum))
        k = int(np.argmin(np.abs(sums)))
        second, omega = float(frequencies[k]), problem.frequency(point.z)
        if not second > REAL or abs(sums[k]) > _NEAR * max(1.0, second):
            return None
        found: dict[str, Any] = {"omega": omega, "omega2": second}
        resonance = _resonance(omega, second)
        if resonance:
            return found | {"resonance": resonance, "starts": "hopf"}
        field, x, p = problem.realised(point.z)
        form = double_hopf_form(field, x, p, (omega, second), problem.own)
        return found | _unfolding(form) | {"starts": "hopf, ns"}


def _resonance(omega: float, second: float) -> str:
    """Name a strong resonance, at which the normal form has further terms."""
    low, high = sorted((omega, second))
    for ratio in (1, 2, 3):
        if abs(high / low - ratio) < _RESONANT:
            return f"1:{ratio}"
    return ""


def double_hopf_form(
    field: RealisedField, x: Array, p: Array, frequencies: tuple[float, float], own: int
) -> NormalForm:
    """Return the cubic normal form; modes are each pair with its conjugate."""
    A = field.f_x(x, p)
    modes: list[Mode] = []
    for turns, omega in zip(((1, 0), (0, 1)), frequencies, strict=True):
        q, adjoint = pair_vectors(A, omega, own)
        back = (-turns[0], -turns[1])
        modes += [Mode(turns, q, adjoint), Mode(back, q.conj(), adjoint.conj())]
    return normal_form(field, (x, p, A), frequencies, tuple(modes), 3)


def _unfolding(form: NormalForm) -> dict[str, Any]:
    """Return coefficients and the unfolding they imply (Kuznetsov, section 8.6).

    r1' = r1 (m1 + p11 r1^2 + p12 r2^2), r2' = r2 (m2 + p21 r1^2 + p22 r2^2), theta = p12 / p22,
    delta = p21 / p11.
    """
    g = form.g
    p11, p12 = g[2, 1, 0, 0][0].real, g[1, 0, 1, 1][0].real
    p21, p22 = g[1, 1, 1, 0][2].real, g[0, 0, 2, 1][2].real
    theta, delta = p12 / p22, p21 / p11
    simple = p11 * p22 > 0.0
    larger, smaller = max(theta, delta), min(theta, delta)
    case = _simple(larger, smaller) if simple else _difficult(larger, smaller)
    return {
        "p11": float(p11),
        "p12": float(p12),
        "p21": float(p21),
        "p22": float(p22),
        "theta": float(theta),
        "delta": float(delta),
        "unfolding": f"{'simple' if simple else 'difficult'} case {case}",
    }


def _simple(larger: float, smaller: float) -> str:
    """Return Kuznetsov's number of the case, theta and delta ordered by size."""
    inside = larger * smaller < 1.0
    if smaller > 0.0:
        return "II" if inside else "I"
    if larger > 0.0:
        return "III"
    return "IV" if inside else "V"


def _difficult(larger: float, smaller: float) -> str:
    """Return Kuznetsov's number of the case, theta and delta ordered by size."""
    inside = larger * smaller < 1.0
    if smaller > 0.0:
        if inside:
            return "III"
        return "I" if smaller > 1.0 else "II"
    if larger > 0.0:
        return "IV"
    return "V" if inside else "VI"
