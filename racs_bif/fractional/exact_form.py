"""Normal form of a Hopf point of the exact fractional model, from its characteristic matrix alone.

The orbit is ``X = X0 + w q e^(i theta) + h11 |w|^2 + h20 w^2 e^(2 i theta) / 2 + conj``; harmonic k obeys
``Delta(i k omega) X_k = W(i k omega) N_k``, N the nonlinear part of the core and W the numerators of the laws.
With Delta(i omega) q = 0, p* Delta(i omega) = 0 the first harmonic is solvable if
``p* Delta'(i omega) q w' = p* W(i omega) (C(q, q, q') / 2 + B(q, h11) + B(q', h20) / 2) w |w|^2``,
which for an ordinary system is the formula of Kuznetsov, section 5.4.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from racs_bif.fractional.exact import ExactModel
    from racs_bif.fractional.exact_hopf import ExactHopf
    from racs_bif.fractional.laws import Complex
    from racs_bif.symbolic.field import Array
    from racs_bif.symbolic.paths import ParameterPath


@dataclass(frozen=True)
class ExactForm:
    """Coefficients at an exact Hopf point.

    Parameters
    ----------
    omega : float
        Frequency [rad/s].
    q, h20 : complex array (size,)
        Null vector, |q| = 1 over the model's own states, and second harmonic.
    h11 : array (size,)
        Shift of the mean.
    c1 : complex
        Cubic coefficient of ``w' = mu w + c1 w |w|^2``.
    mu_slope : complex
        Derivative of the critical root by the parameter, along the equilibria.
    """

    omega: float
    q: Complex
    h20: Complex
    h11: Array
    c1: complex
    mu_slope: complex

    @property
    def l1(self) -> float:
        """First Lyapunov coefficient, Re c1 / omega."""
        return self.c1.real / self.omega

    @property
    def parameter_curvature(self) -> float:
        """Change of the parameter over |w|^2 along the orbits born here."""
        return -self.c1.real / self.mu_slope.real

    @property
    def frequency_curvature(self) -> float:
        """Change of the frequency over |w|^2 along the orbits born here."""
        return self.c1.imag + self.parameter_curvature * self.mu_slope.imag

    def curvature(self, k: int) -> float:
        """Change of the parameter over A^2, A the first harmonic of unknown k."""
        return float(self.parameter_curvature / (4.0 * abs(self.q[k]) ** 2))


def exact_form(model: ExactModel, path: ParameterPath, hopf: ExactHopf) -> ExactForm:
    """Compute the normal form of an exact Hopf point.

    Parameters
    ----------
    model : ExactModel
        The exact model.
    path : ParameterPath
        The active parameter.
    hopf : ExactHopf
        Its Hopf point, from `racs_bif.fractional.exact_hopf.solve_hopf`.

    Returns
    -------
    ExactForm
    """
    X, s = hopf.X, 1j * hopf.omega
    p, dp = path.vector(hopf.value), path.direction(hopf.value)
    core, padded = model.compiled, model.compiled.padded
    P, dP = padded(p), padded(dp)
    core_x = core.core_jacobian(X, P)
    delta, turned = model.delta(s, X, p), None
    q = hopf.q / np.sqrt(np.vdot(hopf.q[: model.ny], hopf.q[: model.ny]).real or 1.0)
    left = np.linalg.svd(delta / np.abs(delta).max(axis=1, keepdims=True))[0][:, -1]
    left = left / np.abs(delta).max(axis=1)
    turned = core_x @ q
    w, w_s, w_p = model.weights(s, p), model.weights_s(s, p), model.weights_p(s, p, dp)

    def forced(multiple: int, value: Complex) -> Complex:
        """Return the answer of harmonic `multiple` to a nonlinear part."""
        at = s * multiple
        right = model.weights(at, p).right if multiple else _static(model, p)
        matrix = model.delta(at, X, p) if multiple else -model.jacobian(X, p).astype(complex)
        return np.asarray(np.linalg.solve(matrix, right * value))

    h20 = forced(2, np.asarray(core.core_xx(X, P, q, q)))
    h11 = forced(0, np.asarray(core.core_xx(X, P, q, q.conj()))).real
    cubic = 0.5 * core.core_xxx(X, P, q, q, q.conj()) + core.core_xx(X, P, q, h11)
    cubic = cubic + 0.5 * core.core_xx(X, P, q.conj(), h20)
    speed = np.vdot(left, w_s.left * q - w_s.right * turned)
    drift = -np.linalg.solve(model.jacobian(X, p), model.residual_p(X, p, dp))
    moved = core.core_xp(X, P, q, dP) + core.core_xx(X, P, q, drift)
    by_value = w_p.left * q - w_p.right * turned - w.right * moved
    return ExactForm(
        omega=hopf.omega,
        q=q,
        h20=h20,
        h11=h11,
        c1=complex(np.vdot(left, w.right * cubic) / speed),
        mu_slope=complex(-np.vdot(left, by_value) / speed),
    )


def _static(model: ExactModel, p: Array) -> Array:
    """Return the weights of the equilibrium equations: one, and N(0) of each law."""
    gains = [law.numerator.at_zero for law in model.laws(p)]
    return np.array([*[1.0] * model.ny, *gains])
