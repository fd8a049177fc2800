"""Small orbits of the exact model near a Hopf point, to second order in their amplitude.

X(t) = X_0 + a (q e^(i theta) + conj) + a^2 (mean + (second e^(2 i theta) + conj)) + ...; frequency
and parameter move by a^2 as well. What they move by follows from the solvability of the first
harmonic at third order, with Delta(i k omega) in the place of i k omega - A: no realisation.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import ConvergenceError
from racs_bif.orbits.diagonals import Diagonals

if TYPE_CHECKING:
    from racs_bif.fractional.exact import ExactModel
    from racs_bif.fractional.exact_hopf import ExactHopf
    from racs_bif.orbits.fourier import Complex
    from racs_bif.symbolic.field import Array
    from racs_bif.symbolic.paths import ParameterPath


@dataclass(frozen=True)
class ExactExpansion:
    """How orbits begin at a Hopf point of the exact model.

    Attributes
    ----------
    parameter, frequency : float
        Second order of the active parameter and of omega: what they move by is a^2 times it.
    mean : array (size,)
        Second order of the mean, the equilibrium's motion with the parameter included.
    second : complex array (size,)
        Second order of the second harmonic.
    """

    parameter: float
    frequency: float
    mean: Array
    second: Complex


def expand(model: ExactModel, path: ParameterPath, hopf: ExactHopf) -> ExactExpansion:
    """Expand the orbits born at an exact Hopf point.

    Parameters
    ----------
    model : ExactModel
        The model.
    path : ParameterPath
        Where the active parameter leads.
    hopf : ExactHopf
        The Hopf point; amplitudes are those along its null vector.

    Raises
    ------
    ConvergenceError
        If the point is degenerate: zero or a second harmonic is a root too, or the roots do not
        cross the imaginary axis.
    """
    X, q, s = hopf.X, hopf.q, 1j * hopf.omega
    p, dp = path.vector(hopf.value), path.direction(hopf.value)
    compiled = model.compiled
    P, dP = compiled.padded(p), compiled.padded(dp)
    jacobian = compiled.core_jacobian(X, P)
    diagonals = Diagonals.of(model, p, dp)
    frequencies = np.array([0.0, s, 2.0 * s])
    left, right = diagonals.at(frequencies)
    drifts = diagonals.drifts(frequencies)
    lefts, rights = (np.zeros_like(left),) * 2 if drifts is None else drifts
    delta = np.array([np.diag(a) for a in left]) - right[:, :, None] * jacobian

    def form(u: Complex, v: Complex) -> Complex:
        return np.asarray(compiled.core_xx(X, P, u, v), dtype=complex)

    try:
        steady = (
            lefts[0] * X - rights[0] * compiled.core(X, P) - right[0] * compiled.core_p(X, P, dP)
        )
        drift = -np.linalg.solve(delta[0], steady)
        mean = np.linalg.solve(delta[0], right[0] * form(q, q.conj()))
        second = np.linalg.solve(delta[2], right[2] * 0.5 * form(q, q))
        adjoint = np.linalg.svd(delta[1])[0][:, -1]
        left_s, right_s = (side[0] for side in diagonals.slopes(np.array([s])))
        by_omega = 1j * (left_s * q - right_s * (jacobian @ q))
        moved = compiled.core_xp(X, P, q, dP) + form(q, drift.astype(complex))
        by_value = lefts[1] * q - rights[1] * (jacobian @ q) - right[1] * moved
        cubic = form(q, mean) + form(q.conj(), second)
        cubic = right[1] * (cubic + 0.5 * compiled.core_xxx(X, P, q, q, q.conj()))
        a, b, c = (np.vdot(adjoint, vector) for vector in (by_omega, by_value, cubic))
        matrix = np.array([[a.real, b.real], [a.imag, b.imag]])
        frequency, parameter = np.linalg.solve(matrix, [c.real, c.imag])
    except np.linalg.LinAlgError as error:
        msg = f"the Hopf point at {path.names[0]} = {hopf.value:g} is degenerate: no single family"
        raise ConvergenceError(f"{msg} of orbits leaves it") from error
    moved_mean = (mean + parameter * drift).real
    return ExactExpansion(float(parameter), float(frequency), moved_mean, second)
