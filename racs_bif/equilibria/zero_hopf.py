"""ZH: zero-Hopf (fold-Hopf, Gavrilov-Guckenheimer) points, a zero eigenvalue beside a pair."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, Any

import numpy as np

from racs_bif.continuation.problem import Detector
from racs_bif.equilibria.critical import null_vectors, pair_vectors
from racs_bif.equilibria.hopf import REAL, real_sums
from racs_bif.equilibria.manifold import Mode, NormalForm, normal_form

if TYPE_CHECKING:
    from racs_bif.continuation.points import Array, Point
    from racs_bif.equilibria.curve_problem import CurveProblem
    from racs_bif.fractional.realised import RealisedField

_NEAR = 1e-5


class _ZeroHopf(Detector):
    """What a zero-Hopf point is, whatever curve it is found on."""

    label = "ZH"

    @abstractmethod
    def value(self, problem: Any, point: Point) -> float:  # noqa: ANN401 - as of `Detector`
        """Return the test function."""

    @abstractmethod
    def frequency(self, problem: Any, point: Point) -> float:  # noqa: ANN401 - as above
        """Return the frequency of the pair, zero if this is another kind of point."""

    def data(self, problem: CurveProblem, point: Point) -> dict[str, Any] | None:
        """Return frequency, coefficients and unfolding; None at a neutral saddle."""
        omega = self.frequency(problem, point)
        if not omega > 0.0:
            return None
        field, x, p = problem.realised(point.z)
        form = zero_hopf_form(field, x, p, omega, problem.own)
        found = _unfolding(form)
        torus = ", ns" if found["s"] * found["theta"] < 0.0 else ""
        return {"omega": omega} | found | {"starts": f"fold, hopf{torus}"}


class ZeroOnHopf(_ZeroHopf):
    """On a Hopf curve a real eigenvalue passes zero."""

    crossings = 1

    def value(self, problem: CurveProblem, point: Point) -> float:
        """Return the real eigenvalue nearest to zero, signed by the product of all of them."""
        rest = problem.noncritical(point.spectrum)
        real = rest[rest.imag == 0.0].real
        if not len(real):
            return float("nan")
        sign = -1.0 if np.count_nonzero(real > 0.0) % 2 else 1.0
        return float(sign * np.abs(real).min())

    def frequency(self, problem: CurveProblem, point: Point) -> float:
        """Return the frequency of the curve where an eigenvalue is indeed zero."""
        rest = problem.noncritical(point.spectrum)
        omega = problem.frequency(point.z)
        return omega if float(np.abs(rest).min()) <= _NEAR * max(1.0, omega) else 0.0


class PairOnFold(_ZeroHopf):
    """On a fold curve a pair passes the imaginary axis."""

    crossings = 2

    def value(self, problem: CurveProblem, point: Point) -> float:
        """Return the smallest real sum of two eigenvalues with the sign of the product of all."""
        sums = real_sums(problem.noncritical(point.spectrum))[0]
        if not len(sums):
            return float("nan")
        sign = -1.0 if np.count_nonzero(sums < 0.0) % 2 else 1.0
        return float(sign * np.abs(sums).min())

    def frequency(self, problem: CurveProblem, point: Point) -> float:
        """Return the frequency of the pair, zero if it is a real one."""
        sums, frequencies = real_sums(problem.noncritical(point.spectrum))
        k = int(np.argmin(np.abs(sums)))
        omega = float(frequencies[k])
        return omega if abs(sums[k]) <= _NEAR * max(1.0, omega) and omega > REAL else 0.0


def zero_hopf_form(field: RealisedField, x: Array, p: Array, omega: float, own: int) -> NormalForm:
    """Return the cubic normal form of a zero-Hopf point; modes are the zero one, the pair."""
    A = field.f_x(x, p)
    q0, p0 = null_vectors(A, own)
    q1, p1 = pair_vectors(A, omega, own)
    modes = (Mode((0,), q0, p0), Mode((1,), q1, p1), Mode((-1,), q1.conj(), p1.conj()))
    return normal_form(field, (x, p, A), (omega,), modes, 3)


def _unfolding(form: NormalForm) -> dict[str, Any]:
    """Return coefficients and what they imply (Kuznetsov, section 8.5).

    In Kuznetsov's terms g200 = G200/2, g011 = G011, g110 = G110, g300 = G300/6, g111 = G111,
    g210 = G210/2, g021 = G021/2. The amplitudes obey, after scaling, xi' = b1 + xi^2 + s rho^2,
    rho' = rho (b2 + theta xi + xi^2), and E > 0 or < 0 tells the direction of the torus.
    """
    g = form.g
    G200, G011 = 2.0 * g[2, 0, 0][0].real, g[0, 1, 1][0].real
    G300, G111 = 6.0 * g[3, 0, 0][0].real, g[1, 1, 1][0].real
    G110, G210, G021 = g[1, 1, 0][1], 2.0 * g[2, 1, 0][1], 2.0 * g[0, 2, 1][1]
    theta = G110.real / G200
    s = float(np.sign(G200 * G011))
    E = 0.5 * float(
        (G210 + G110 * (G021.real / G011 - G300 / G200 + G111 / G011) - G021 * G200 / G011).real
    )
    torus = s * theta < 0.0
    case = f"s = {s:+.0f}, theta {'>' if theta > 0.0 else '<'} 0"
    return {
        "G200": G200,
        "G011": G011,
        "G110": complex(G110),
        "s": s,
        "theta": theta,
        "E": E,
        "unfolding": f"{case}: {'a torus' if torus else 'no torus'} nearby",
    }
