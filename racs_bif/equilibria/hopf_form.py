"""Normal form of a Hopf point on the centre manifold.

Yu. A. Kuznetsov, *Elements of Applied Bifurcation Theory*, sections 3.5 and 5.4: with A q = i
omega q, A^T p = -i omega p, <p, q> = 1 the amplitude obeys ``w' = mu w + c1 w |w|^2``. Memory
states of a realisation are left out of the length |q| = 1, so that the coefficients tend to those
of the exact model.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from racs_bif.equilibria.linearised import linearise

if TYPE_CHECKING:
    from racs_bif.equilibria.linearised import Linearised
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
        Number of leading states that count in |q| = 1; see `VectorField.telling`.
    """
    A = linearise(field, x, p)
    q, adjoint = A.eigenvectors(omega)
    q = q / np.linalg.norm(field.telling(x, p, q, own))
    adjoint = adjoint / np.conj(np.vdot(adjoint, q))
    third = cubic(field, (x, p), A, omega, (q, adjoint))
    drift = A.resolve(0.0, field.f_p(x, p, dp))
    moved = field.f_xx(x, p, q, drift) + field.f_xp(x, p, q, dp)
    return HopfForm(
        omega=omega,
        q=q,
        p=adjoint,
        h20=third.h20,
        h11=third.h11,
        c1=third.c1,
        mu_slope=complex(np.vdot(adjoint, moved)),
        drift=np.asarray(drift, dtype=float),
    )


@dataclass(frozen=True)
class Cubic:
    """The cubic coefficient of a Hopf point.

    Parameters
    ----------
    c1 : complex
        The coefficient.
    size : float
        Sum of the magnitudes of the terms that it is the sum of: where c1 is much smaller, it is
        their difference.
    h20, h11 : complex and real array (n,)
        Second order of the centre manifold.
    """

    c1: complex
    size: float
    h20: Complex
    h11: Array


def cubic(
    field: VectorField,
    point: tuple[Array, Array],
    A: Linearised,
    omega: float,
    vectors: tuple[Complex, Complex],
) -> Cubic:
    """Compute the cubic coefficient of a Hopf point.

    Parameters
    ----------
    field : VectorField
        The vector field.
    point : tuple of array
        The equilibrium (n,) and the base parameters (np,).
    A : Linearised
        f_x there.
    omega : float
        Frequency [rad/s].
    vectors : tuple of complex array (n,)
        Right and left eigenvectors q, p with conj(p) . q = 1.
    """
    x, p = point
    q, adjoint = vectors
    static = -A.resolve(0.0, field.f_xx(x, p, q, q.conj()))
    double = A.resolve(2j * omega, field.f_xx(x, p, q, q))
    terms = np.array(
        [
            0.5 * np.vdot(adjoint, field.f_xxx(x, p, q, q, q.conj())),
            -np.vdot(adjoint, field.f_xx(x, p, q, static)),
            0.5 * np.vdot(adjoint, field.f_xx(x, p, q.conj(), double)),
        ]
    )
    return Cubic(
        c1=complex(terms.sum()),
        size=float(np.abs(terms).sum()),
        h20=np.asarray(double),
        h11=-np.asarray(static).real,
    )
