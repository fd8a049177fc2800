"""Hopf points of the exact fractional model, by Newton's method on their defining system.

Unknowns are the exact equilibrium X, one parameter, omega and the complex null vector q of
Delta(i omega); equations are equilibrium, ``Delta(i omega) q = 0`` and ``c* q = 1``. All
derivatives are exact.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import ConvergenceError

if TYPE_CHECKING:
    from racs_bif.fractional.exact import ExactModel
    from racs_bif.fractional.laws import Complex
    from racs_bif.symbolic.field import Array
    from racs_bif.symbolic.paths import ParameterPath

_ITERATIONS = 25
_TOLERANCE = 1e-12


@dataclass(frozen=True)
class ExactHopf:
    """A Hopf point of the exact model.

    Parameters
    ----------
    X : array (size,)
        States and outputs of the elements at the equilibrium.
    value : float
        The active parameter.
    omega : float
        Frequency [rad/s].
    q : array (size,)
        Null vector of Delta(i omega).
    residual : float
        Largest last Newton correction, relative: what is left of the error.
    """

    X: Array
    value: float
    omega: float
    q: Complex
    residual: float


def solve_hopf(
    model: ExactModel, path: ParameterPath, X: Array, value: float, omega: float
) -> ExactHopf:
    """Solve for the exact Hopf point near an estimate.

    Parameters
    ----------
    model : ExactModel
        The exact model.
    path : ParameterPath
        The active parameter.
    X : array (size,)
        Estimate of states and element outputs.
    value, omega : float
        Estimates of the parameter and of the frequency.

    Raises
    ------
    ConvergenceError
        If Newton's method does not converge to a point with omega > 0.
    """
    m = model.size
    q = _null_vector(model.delta(1j * omega, X, path.vector(value)))
    border = q.conj()
    z = np.concatenate([X, [value, omega], q.real, q.imag])
    error = np.inf
    for _ in range(_ITERATIONS):
        with np.errstate(all="ignore"):  # an iterate may be far out; then the step is not finite
            residual, jacobian = _system(model, path, border, z)
        try:
            step = np.linalg.solve(jacobian, residual)
        except np.linalg.LinAlgError:
            break
        if not np.all(np.isfinite(step)):
            break
        z -= step
        error = float(np.max(np.abs(step) / _magnitudes(z, m)))
        if error < _TOLERANCE:
            break
    if not error < 1e-8 or z[m + 1] <= 0.0:
        msg = (
            f"no exact Hopf point found near {path.names[0]} = {value:g}, omega = {omega:g} rad/s; "
            "widen the realisation's band or raise its order"
        )
        raise ConvergenceError(msg)
    q = z[m + 2 : 2 * m + 2] + 1j * z[2 * m + 2 :]
    return ExactHopf(z[:m], float(z[m]), float(z[m + 1]), q, error)


def _magnitudes(z: Array, m: int) -> Array:
    """Return what corrections are compared with.

    States and parameter may vanish at the Hopf point and then are compared with the others and with
    omega. The parameter may have any unit, so it is no measure for the rest.
    """
    size = np.abs(z)
    floor = 1e-3 * max(size[:m].max(), size[m + 1])
    size[: m + 1] = np.maximum(size[: m + 1], floor)
    size[m + 2 :] = size[m + 2 :].max()
    return size


def _null_vector(matrix: Complex) -> Complex:
    """Return the right singular vector of the smallest singular value of the row-scaled matrix."""
    scaled = matrix / np.abs(matrix).max(axis=1, keepdims=True)
    return np.asarray(np.linalg.svd(scaled)[2][-1].conj())


def _system(
    model: ExactModel, path: ParameterPath, border: Complex, z: Array
) -> tuple[Array, Array]:
    """Return residual (3m+2,) and Jacobian of the defining system."""
    m = model.size
    X, value, s = z[:m], z[m], 1j * z[m + 1]
    q = z[m + 2 : 2 * m + 2] + 1j * z[2 * m + 2 :]
    p, dp = path.vector(value), path.direction(value)
    padded = model.compiled.padded
    P, dP = padded(p), padded(dp)
    core_x = model.compiled.core_jacobian(X, P)
    w, w_s, w_p = model.weights(s, p), model.weights_s(s, p), model.weights_p(s, p, dp)
    delta = np.diag(w.left) - w.right[:, None] * core_x
    turned = core_x @ q
    by_X = -w.right[:, None] * model.compiled.core_xx(
        X, P, np.broadcast_to(q[:, None], (m, m)), np.eye(m)
    )
    by_value = w_p.left * q - w_p.right * turned
    by_value = by_value - w.right * model.compiled.core_xp(X, P, q, dP)
    by_omega = 1j * (w_s.left * q - w_s.right * turned)
    residual = delta @ q
    norm = border @ q - 1.0
    value_of = np.concatenate(
        [model.residual(X, p), residual.real, residual.imag, [norm.real, norm.imag]]
    )
    J = np.zeros((3 * m + 2, 3 * m + 2))
    J[:m, :m] = model.jacobian(X, p)
    J[:m, m] = model.residual_p(X, p, dp)
    for part, rows in ((np.real, slice(m, 2 * m)), (np.imag, slice(2 * m, 3 * m))):
        J[rows, :m] = part(by_X)
        J[rows, m], J[rows, m + 1] = part(by_value), part(by_omega)
        J[rows, m + 2 : 2 * m + 2], J[rows, 2 * m + 2 :] = part(delta), part(1j * delta)
    J[3 * m, m + 2 :] = np.concatenate([border.real, -border.imag])
    J[3 * m + 1, m + 2 :] = np.concatenate([border.imag, border.real])
    return value_of, J
