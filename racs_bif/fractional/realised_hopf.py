"""Hopf points of a realised system, by Newton's method on the real part of an eigenvalue."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import ConvergenceError

if TYPE_CHECKING:
    from racs_bif.fractional.laws import Complex
    from racs_bif.fractional.system import System
    from racs_bif.symbolic.field import Array
    from racs_bif.symbolic.paths import ParameterPath

_ITERATIONS = 30
_TOLERANCE = 1e-13


@dataclass(frozen=True)
class RealisedHopf:
    """A Hopf point of a realised system.

    Parameters
    ----------
    x : array (n,)
        States, memory among them.
    value : float
        The active parameter.
    omega : float
        Frequency [rad/s].
    slope : complex
        Derivative of the eigenvalue by the parameter, along the equilibria.
    """

    x: Array
    value: float
    omega: float
    slope: complex


def solve_realised_hopf(
    system: System, path: ParameterPath, X: Array, value: float, omega: float
) -> RealisedHopf:
    """Solve for the Hopf point of the realised system near an estimate.

    Its equilibria are those of the exact model, static gains being exact.

    Parameters
    ----------
    system : System
        The system; its realisation is what is solved.
    path : ParameterPath
        The active parameter.
    X : array (size,)
        Estimate of states and element outputs.
    value, omega : float
        Estimates of the parameter and of the frequency [rad/s].

    Raises
    ------
    ConvergenceError
        If there is none near the estimate.
    """
    target, best = 1j * omega, np.inf
    for _ in range(_ITERATIONS):
        p, dp = path.vector(value), path.direction(value)
        X = system.exact.equilibrium(X, p)
        x = system.field.rest(X[: len(system.states)], X[len(system.states) :], p)
        A = system.field.f_x(x, p)
        mu, left, right = _eigenpair(A, target)
        drift = -np.linalg.solve(A, system.field.f_p(x, p, dp))
        moved = system.field.f_xx(x, p, right, drift) + system.field.f_xp(x, p, right, dp)
        slope = complex(np.vdot(left, moved))
        step = -mu.real / slope.real if slope.real else np.inf
        # a parameter may be zero at the point: it counts by what moves the eigenvalue too
        size = abs(value) + (abs(mu / slope) if slope else np.inf)
        if abs(step) < _TOLERANCE * size or (abs(step) >= best and best < 1e-9 * size):
            return RealisedHopf(x, value, mu.imag, slope)
        if not np.isfinite(step) or mu.imag <= 0.0:
            break
        value, target, best = value + step, 1j * (mu + slope * step).imag, abs(step)
    msg = (
        f"no Hopf point of the realised system near {path.names[0]} = {value:g}, "
        f"omega = {omega:g} rad/s; widen the realisation's band or raise its order"
    )
    raise ConvergenceError(msg)


def _eigenpair(A: Array, target: complex) -> tuple[complex, Complex, Complex]:
    """Return the eigenvalue nearest to `target` with vectors, conj(left) . right = 1.

    The pair is refined by the two-sided Rayleigh quotient: eigenvalues of a stiff matrix are exact
    to its largest entries only.
    """
    values, vectors = np.linalg.eig(A)
    k = int(np.argmin(np.abs(values - target)))
    mu, right = complex(values[k]), vectors[:, k]
    lefts, adjoint = np.linalg.eig(A.T)
    left = adjoint[:, int(np.argmin(np.abs(lefts - mu)))].conj()
    for _ in range(2):
        left = left / np.conj(np.vdot(left, right))
        mu = complex(np.vdot(left, A @ right))
        right = right - _correction(A, mu, left, right)
        left = left - _correction(A.conj().T, np.conj(mu), right, left)
        right = right / np.linalg.norm(right)
    left = left / np.conj(np.vdot(left, right))
    return complex(np.vdot(left, A @ right)), left, right


def _correction(A: Array, mu: complex, border: Complex, vector: Complex) -> Complex:
    """Return what an approximate eigenvector has too much, by a bordered solve."""
    n = len(vector)
    matrix = np.zeros((n + 1, n + 1), dtype=complex)
    matrix[:n, :n] = A - mu * np.eye(n)
    matrix[:n, n], matrix[n, :n] = vector, border.conj()
    right = np.append(A @ vector - mu * vector, 0.0)
    return np.asarray(np.linalg.solve(matrix, right)[:n])
