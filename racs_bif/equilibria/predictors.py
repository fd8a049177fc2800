"""Where curves of cycles and of homoclinic orbits leave points of codimension two.

Leading order of the unfoldings in Yu. A. Kuznetsov, *Elements of Applied Bifurcation Theory*,
chapter 8. The curve on which the point was found is used as it is, so that its curvature in the
plane of parameters needs no second derivatives by them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.equilibria.critical import nilpotent_vectors, null_vectors, pair_vectors
from racs_bif.equilibria.double_hopf import double_hopf_form
from racs_bif.equilibria.generalised_hopf import quintic
from racs_bif.equilibria.hopf_form import hopf_form
from racs_bif.equilibria.orbit_guess import HomoclinicGuess, OrbitGuess
from racs_bif.equilibria.zero_hopf import zero_hopf_form
from racs_bif.errors import ConvergenceError
from racs_bif.numerics.newton import newton

if TYPE_CHECKING:
    from collections.abc import Callable

    from racs_bif.continuation.points import SpecialPoint
    from racs_bif.equilibria.curve_problem import CurveProblem
    from racs_bif.equilibria.fold_curve import FoldCurve
    from racs_bif.equilibria.hopf_curve import HopfCurve
    from racs_bif.equilibria.hopf_form import Complex
    from racs_bif.fractional.realised import RealisedField
    from racs_bif.symbolic.field import Array

_PROBE = 1e-4
_TOLERANCE = 1e-10
_CLOSE = 1e-3
_ITERATIONS = 10
_SMALLEST = 1e-3


def fold_of_cycles(problem: HopfCurve, special: SpecialPoint, amplitude: float) -> OrbitGuess:
    """Return the fold of cycles of an amplitude predicted at a generalised Hopf point.

    Re mu + Re c1 r^2 + l2 r^4 has a double root r^2 = -Re c1 / (2 l2): a Hopf point with that Re
    c1 is looked for along the curve, then a parameter is moved across it to Re mu = (Re c1)^2 / (4
    l2).

    Parameters
    ----------
    problem : HopfCurve
        The curve on which the point lies.
    special : SpecialPoint
        The point GH.
    amplitude : float
        Length r of the critical amplitude; 2 r is about half of the peak-to-peak value.
    """
    c2 = quintic(problem, special.z, problem.frequency(special.z)).g[3, 2][0]
    wanted = -2.0 * c2.real * amplitude**2
    z = _reach(problem, special.z, wanted, lambda z: problem.cubic(z).c1.real)
    field, x, p = problem.realised(z)
    omega = problem.frequency(z)
    forms = [hopf_form(field, x, p, dp, omega, problem.own) for dp in problem.directions(z)]
    k = int(np.argmax([abs(form.mu_slope.real) for form in forms]))
    form = forms[k]
    shift = form.c1.real**2 / (4.0 * c2.real) / form.mu_slope.real
    parameters = z[-2:].copy()
    parameters[k] += shift
    square = amplitude**2
    frequency = omega + form.mu_slope.imag * shift + form.c1.imag * square + c2.imag * square**2
    return OrbitGuess(
        label="LPC",
        parameters=parameters,
        period=2.0 * np.pi / frequency,
        mean=x + form.drift * shift + form.h11 * square,
        first=form.q * amplitude,
        second=0.5 * form.h20 * square,
        angle=0.0,
    )


def torus_at_zero_hopf(
    problem: CurveProblem, special: SpecialPoint, amplitude: float
) -> OrbitGuess:
    """Return the Neimark-Sacker point of an amplitude predicted at a zero-Hopf point.

    With w0' = gamma + nu w0 + G200 w0^2 / 2 + G011 r^2 + G111 w0 r^2 and r' = r (Re mu + Re G110
    w0 + Re G021 r^2 / 2) the cycle of amplitude r has eigenvalues of zero sum there; to leading
    order this is linear in w0 and in the parameters, which enter by gamma, nu and mu.

    Raises
    ------
    ConvergenceError
        If there is no torus nearby: s theta > 0.
    """
    field, x, p = problem.realised(special.z)
    A, omega = field.f_x(x, p), float(special.data["omega"])
    g = zero_hopf_form(field, x, p, omega, problem.own).g
    modes = [*null_vectors(A, problem.own), *pair_vectors(A, omega, problem.own)]
    slopes = [_slopes(field, (x, p, A), modes, dp) for dp in problem.directions(special.z)]
    G200, G011 = 2.0 * g[2, 0, 0][0].real, g[0, 1, 1][0].real
    G111 = g[1, 1, 1][0].real
    G110, G021 = g[1, 1, 0][1].real, 2.0 * g[0, 2, 1][1].real
    determinant = -2.0 * G011 * G110 * amplitude**2
    if not determinant > 0.0:
        msg = "no Neimark-Sacker curve starts at this zero-Hopf point: s theta > 0"
        raise ConvergenceError(msg)
    matrix = np.array(
        [
            [*(s.gamma for s in slopes), 0.0],
            [*(s.mu.real for s in slopes), G110],
            [*(s.nu for s in slopes), G200],
        ]
    )
    right = -(amplitude**2) * np.array([G011, 0.5 * G021, G111 + G021])
    first, second, w0 = np.linalg.solve(matrix, right)
    change = np.array([first, second])
    frequency = omega + float(change @ [s.mu.imag for s in slopes])
    frequency += g[1, 1, 0][1].imag * w0 + g[0, 2, 1][1].imag * amplitude**2
    period = 2.0 * np.pi / frequency
    H = zero_hopf_form(field, x, p, omega, problem.own).H
    drift = np.column_stack([s.drift for s in slopes]) @ change
    return OrbitGuess(
        label="NS",
        parameters=special.z[-2:] + change,
        period=period,
        mean=x + drift + modes[0].real * w0 + H[0, 1, 1].real * amplitude**2,
        first=modes[2] * amplitude,
        second=H[0, 2, 0] * amplitude**2,
        angle=period * float(np.sqrt(determinant)),
    )


def tori_at_double_hopf(
    problem: CurveProblem, special: SpecialPoint, amplitude: float
) -> tuple[OrbitGuess, OrbitGuess]:
    """Return the Neimark-Sacker points of both cycles predicted at a double Hopf point.

    The cycle of the first pair has Re mu1 = -p11 r^2, and the second pair is critical on it where
    Re mu2 = -p21 r^2; the same with the pairs exchanged.
    """
    field, x, p = problem.realised(special.z)
    A = field.f_x(x, p)
    frequencies = float(special.data["omega"]), float(special.data["omega2"])
    form = double_hopf_form(field, x, p, frequencies, problem.own)
    g, H = form.g, form.H
    pairs = [pair_vectors(A, omega, problem.own) for omega in frequencies]
    mu = np.empty((2, 2), dtype=complex)
    drifts = []
    for k, dp in enumerate(problem.directions(special.z)):
        drift = -np.linalg.solve(A, field.f_p(x, p, dp))
        drifts.append(drift)
        for i, (q, adjoint) in enumerate(pairs):
            moved = field.f_xx(x, p, q, drift) + field.f_xp(x, p, q, dp)
            mu[i, k] = np.vdot(adjoint, moved)
    cubic = (
        (np.array([g[2, 1, 0, 0][0], g[1, 1, 1, 0][2]]), (1, 1, 0, 0), (2, 0, 0, 0)),
        (np.array([g[1, 0, 1, 1][0], g[0, 0, 2, 1][2]]), (0, 0, 1, 1), (0, 0, 2, 0)),
    )
    guesses = []
    for i, (coefficients, even, double) in enumerate(cubic):
        change = np.linalg.solve(mu.real, -coefficients.real * amplitude**2)
        shift = mu.imag @ change + coefficients.imag * amplitude**2
        turning = np.array(frequencies) + shift
        period = 2.0 * np.pi / turning[i]
        guesses.append(
            OrbitGuess(
                label="NS",
                parameters=special.z[-2:] + change,
                period=period,
                mean=x + np.column_stack(drifts) @ change + H[even].real * amplitude**2,
                first=pairs[i][0] * amplitude,
                second=H[double] * amplitude**2,
                angle=period * turning[1 - i],
            )
        )
    return guesses[0], guesses[1]


def homoclinic(problem: FoldCurve, z: Array, a: float, b: float, epsilon: float) -> HomoclinicGuess:
    """Return the homoclinic orbit of size epsilon predicted at a Bogdanov-Takens point.

    In w0'' = beta1 + beta2 w0' + a w0^2 + b w0 w0' it lies at beta1 = -4 epsilon^4 / a, beta2 = 10
    b epsilon^2 / (7 a). The point of the fold curve with that beta2, its second small eigenvalue,
    has beta1 = 0; from there the parameters move across the curve.

    Parameters
    ----------
    problem : FoldCurve
        The fold curve through the point.
    z : array
        The point on it.
    a, b : float
        Coefficients of the point.
    epsilon : float
        Root of the size of the orbit times a.
    """
    field, x, there = problem.realised(z)
    wanted = 10.0 * b * epsilon**2 / (7.0 * a)
    z = _reach(problem, z, wanted, lambda z: _second(problem, z))
    _, middle, p = problem.realised(z)
    q0, q1, _, p1 = nilpotent_vectors(field.f_x(x, there), problem.own)
    across = np.array([p1 @ field.f_p(middle, p, dp) for dp in problem.directions(z)])
    beta1 = -4.0 * epsilon**4 / a
    return HomoclinicGuess(
        parameters=z[-2:] + across / (across @ across) * beta1,
        saddle=middle + 2.0 * epsilon**2 / a * q0,
        middle=middle,
        q0=q0,
        q1=q1,
        a=a,
        epsilon=epsilon,
    )


def _second(problem: FoldCurve, z: Array) -> float:
    """Return the real eigenvalue nearest to zero beside the one that is zero all along."""
    rest = problem.noncritical(problem.spectrum(z))
    return float(rest[int(np.argmin(np.abs(rest)))].real)


def _reach(
    problem: CurveProblem, z: Array, wanted: float, function: Callable[[Array], float]
) -> Array:
    """Return the solution near z at which a function that is zero at z has a small value.

    Raises
    ------
    ConvergenceError
        If there is none.
    """
    scales = np.append(problem.scales(z), max(abs(float(z[-1])), _SMALLEST))
    weights = 1.0 / scales**2
    problem.residual(z)
    tangent = scales * np.linalg.svd(problem.jacobian(z) * scales)[2][-1]

    def along(step: float) -> Array:
        guess, row = z + step * tangent, weights * tangent
        return newton(problem, guess, row, weights, tolerance=_TOLERANCE, iterations=12).z

    step, there = _PROBE, along(_PROBE)
    for _ in range(_ITERATIONS):
        value = function(there)
        if abs(value - wanted) <= _CLOSE * abs(wanted):
            return there
        step *= wanted / value
        there = along(step)
    msg = "the normal form does not hold as far as this size; give a smaller one"
    raise ConvergenceError(msg)


@dataclass(frozen=True)
class _Slopes:
    """Derivatives by one parameter of the linear terms of a zero-Hopf point's unfolding."""

    gamma: float
    nu: float
    mu: complex
    drift: Array


def _slopes(
    field: RealisedField, point: tuple[Array, Array, Array], modes: list[Complex], dp: Array
) -> _Slopes:
    x, p, A = point
    q0, p0, q1, p1 = modes
    n = len(x)
    matrix = np.zeros((n + 1, n + 1))
    matrix[:n, :n], matrix[:n, n], matrix[n, :n] = -A, q0.real, p0.real
    solution = np.linalg.solve(matrix, np.append(field.f_p(x, p, dp), 0.0))
    drift = solution[:n]

    def moved(q: Complex) -> Complex:
        return np.asarray(field.f_xx(x, p, q, drift) + field.f_xp(x, p, q, dp))

    nu = float(p0.real @ moved(q0).real)
    return _Slopes(float(solution[n]), nu, complex(np.vdot(p1, moved(q1))), drift)
