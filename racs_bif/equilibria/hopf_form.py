"""Normal form of a Hopf point on the centre manifold.

Yu. A. Kuznetsov, *Elements of Applied Bifurcation Theory*, sections 3.5 and 5.4: with A q = i omega q,
A^T p = -i omega p, <p, q> = 1 the amplitude obeys ``w' = mu w + c1 w |w|^2``. Memory states of a realisation
are left out of the length |q| = 1, so that the coefficients tend to those of the exact model.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from racs_bif.symbolic.field import Array, VectorField

Complex = NDArray[np.complex128]


@dataclass(frozen=True)
class HopfForm:
    """Coefficients at a Hopf point.

    Parameters
    ----------
    omega : float
        Frequency [rad/s].
    q, p : complex array (n,)
        Right and left (adjoint) eigenvectors, conj(p) . q = 1.
    h20, h11 : complex and real array (n,)
        Second order of the centre manifold, ``x = w q + conj + (h20 w^2 + 2 h11 |w|^2 + conj)/2``.
    c1 : complex
        Cubic coefficient.
    mu_slope : complex
        Derivative of the critical eigenvalue by the parameter, along the equilibria.
    drift : array (n,)
        Derivative of the equilibrium by the parameter.
    """

    omega: float
    q: Complex
    p: Complex
    h20: Complex
    h11: Array
    c1: complex
    mu_slope: complex
    drift: Array

    @property
    def l1(self) -> float:
        """First Lyapunov coefficient, Re c1 / omega; its sign says whether orbits are stable."""
        return self.c1.real / self.omega

    @property
    def parameter_curvature(self) -> float:
        """Change of the parameter over |w|^2 along the orbits born here."""
        return -self.c1.real / self.mu_slope.real

    @property
    def frequency_curvature(self) -> float:
        """Change of the frequency over |w|^2 along the orbits born here."""
        return self.c1.imag + self.parameter_curvature * self.mu_slope.imag


def hopf_form(
    field: VectorField, x: Array, p: Array, dp: Array, omega: float, own: int
) -> HopfForm:
    """Compute the normal form at a Hopf point.

    Parameters
    ----------
    field : VectorField
        The vector field.
    x : array (n,)
        The equilibrium.
    p, dp : array (np,)
        Base parameters, and their direction along the active parameter.
    omega : float
        Frequency [rad/s].
    own : int
        Number of leading states that count in |q| = 1.
    """
    A = field.f_x(x, p)
    n = len(x)
    values, left, right = _eigen(A)
    k = int(np.argmin(np.abs(values - 1j * omega)))
    q = right[:, k]
    q = q / np.sqrt(np.vdot(q[:own], q[:own]).real)
    adjoint = left[:, k]
    adjoint = adjoint / np.conj(np.vdot(adjoint, q))
    static = np.linalg.solve(A, field.f_xx(x, p, q, q.conj()))
    double = np.linalg.solve(2j * omega * np.eye(n) - A, field.f_xx(x, p, q, q))
    cubic = (
        field.f_xxx(x, p, q, q, q.conj())
        - 2.0 * field.f_xx(x, p, q, static)
        + field.f_xx(x, p, q.conj(), double)
    )
    drift = -np.linalg.solve(A, field.f_p(x, p, dp))
    moved = field.f_xx(x, p, q, drift) + field.f_xp(x, p, q, dp)
    return HopfForm(
        omega=omega,
        q=q,
        p=adjoint,
        h20=np.asarray(double),
        h11=-np.asarray(static).real,
        c1=complex(0.5 * np.vdot(adjoint, cubic)),
        mu_slope=complex(np.vdot(adjoint, moved)),
        drift=drift,
    )


def _eigen(A: Array) -> tuple[Complex, Complex, Complex]:
    from scipy.linalg import eig

    values, left, right = eig(A, left=True, right=True)
    return values, left, right
