"""Normal form of a Hopf point of the exact fractional model, from its characteristic matrix alone.

The orbit is ``X = X0 + w q e^(i theta) + h11 |w|^2 + h20 w^2 e^(2 i theta) / 2 + conj``; harmonic k
obeys ``Delta(i k omega) X_k = W(i k omega) N_k``, N the nonlinear part of the core and W the
numerators of the laws. With Delta(i omega) q = 0, p* Delta(i omega) = 0 the first harmonic is
solvable if ``p* Delta'(i omega) q w' = p* W(i omega) (C(q, q, q') / 2 + B(q, h11) + B(q', h20) / 2)
w |w|^2``, which for an ordinary system is the formula of Kuznetsov, section 5.4.
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


@dataclass(frozen=True)
class ExactCubic:
    """The cubic coefficient and what it is made of.

    Parameters
    ----------
    terms : complex array (3,)
        Contributions of C(q, q, q'), of the shifted mean and of the second harmonic.
    h20 : complex array (size,)
        Second harmonic.
    h11 : array (size,)
        Shift of the mean.
    speed : complex
        ``p* Delta'(i omega) q``.
    """

    terms: Complex
    h20: Complex
    h11: Array
    speed: complex

    @property
    def c1(self) -> complex:
        """Cubic coefficient of ``w' = mu w + c1 w |w|^2``."""
        return complex(self.terms.sum())


def exact_cubic(
    model: ExactModel, X: Array, p: Array, omega: float, vectors: tuple[Complex, Complex]
) -> ExactCubic:
    """Compute the cubic coefficient of an exact Hopf point.

    Parameters
    ----------
    model : ExactModel
        The exact model.
    X, p : array (size,), array (np,)
        The equilibrium and its base parameters.
    omega : float
        Frequency [rad/s].
    vectors : (array, array)
        q with Delta(i omega) q = 0, of length one over the model's own states, and the left null
        vector, of any length.
    """
    q, left = vectors
    s = 1j * omega
    core, P = model.compiled, model.compiled.padded(p)
    core_x = core.core_jacobian(X, P)

    def response(rate: complex, form: Complex) -> Complex:
        w = model.weights(rate, p)
        delta = np.diag(w.left) - w.right[:, None] * core_x
        return np.asarray(np.linalg.solve(delta, w.right * form))

    slope = model.weights_s(s, p)
    speed = complex(np.vdot(left, slope.left * q - slope.right * (core_x @ q)))
    adjoint = left.conj() / speed * model.weights(s, p).right
    bar = q.conj()
    h20 = response(2.0 * s, np.asarray(core.core_xx(X, P, q, q)))
    h11 = response(0.0, np.asarray(core.core_xx(X, P, q, bar))).real
    terms = (
        0.5 * adjoint @ core.core_xxx(X, P, q, q, bar),
        adjoint @ core.core_xx(X, P, q, h11.astype(complex)),
        0.5 * adjoint @ core.core_xx(X, P, bar, h20),
    )
    return ExactCubic(np.array(terms, dtype=np.complex128), h20, h11, speed)


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
    own = float(np.linalg.norm(hopf.q[: model.ny]))
    q = hopf.q / (own or float(np.linalg.norm(hopf.q)))
    delta = model.delta(s, X, p)
    size = np.abs(delta).max(axis=1)
    left = np.linalg.svd(delta / size[:, None])[0][:, -1] / size
    cubic = exact_cubic(model, X, p, hopf.omega, (q, left))
    w, w_p = model.weights(s, p), model.weights_p(s, p, dp)
    drift = -np.linalg.solve(model.jacobian(X, p), model.residual_p(X, p, dp))
    moved = core.core_xp(X, padded(p), q, padded(dp))
    moved = moved + core.core_xx(X, padded(p), q, drift.astype(complex))
    turned = core.core_jacobian(X, padded(p)) @ q
    by_value = w_p.left * q - w_p.right * turned - w.right * moved
    return ExactForm(
        omega=hopf.omega,
        q=q,
        h20=cubic.h20,
        h11=cubic.h11,
        c1=cubic.c1,
        mu_slope=complex(-np.vdot(left, by_value) / cubic.speed),
    )
