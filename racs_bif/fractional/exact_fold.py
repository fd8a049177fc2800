"""Folds of the equilibria of the exact fractional model, by Newton's method on their definition.

Unknowns are the equilibrium X, one parameter and the real null vector v of the equilibrium
equations' Jacobian (which is Delta(0) but for its sign); equations are equilibrium, ``J v = 0`` and
``c v = 1``. All derivatives are exact.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from racs_bif.errors import ConvergenceError
from racs_bif.fractional.static import StaticField

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from racs_bif.fractional.exact import ExactModel
    from racs_bif.symbolic.field import Array
    from racs_bif.symbolic.paths import ParameterPath

_ITERATIONS = 25
_TOLERANCE = 1e-12
_ENOUGH = 1e-8


@dataclass(frozen=True)
class ExactFold:
    """A fold of the exact model's equilibria.

    Parameters
    ----------
    X : array (size,)
        States and outputs of the elements.
    value : float
        The active parameter.
    v : array (size,)
        Null vector of the Jacobian.
    residual : float
        Largest last Newton correction, relative: what is left of the error.
    """

    X: Array
    value: float
    v: Array
    residual: float


def solve_fold(model: ExactModel, path: ParameterPath, X: Array, value: float) -> ExactFold:
    """Solve for the fold near an estimate.

    Parameters
    ----------
    model : ExactModel
        The exact model.
    path : ParameterPath
        The active parameter.
    X : array (size,)
        Estimate of states and element outputs.
    value : float
        Estimate of the parameter.

    Raises
    ------
    ConvergenceError
        If Newton's method does not converge.
    """
    field, m = StaticField(model), model.size
    v = null_vectors(field.f_x(X, path.vector(value)))[1]
    z = np.concatenate([X, [value], v])
    error = np.inf
    for _ in range(_ITERATIONS):
        residual, jacobian = _system(field, path, v, z)
        try:
            step = np.linalg.solve(jacobian, residual)
        except np.linalg.LinAlgError:
            break
        if not np.all(np.isfinite(step)):
            break
        z = z - step
        error = float(np.max(np.abs(step) / _magnitudes(z, m)))
        if error < _TOLERANCE:
            break
    if not error < _ENOUGH:
        msg = (
            f"no exact fold found near {path.names[0]} = {value:g}; "
            "widen the realisation's band or raise its order"
        )
        raise ConvergenceError(msg)
    return ExactFold(z[:m], float(z[m]), z[m + 1 :], error)


def null_vectors(matrix: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return left and right null vectors (size,) of a nearly singular matrix.

    They are singular vectors of the matrix with its rows scaled: ``left`` borders it from the
    right, ``conj(right)`` from below, so that the bordered matrix is regular.
    """
    rows = np.abs(matrix).max(axis=1, keepdims=True)
    rows[rows == 0.0] = 1.0
    left, _, right = np.linalg.svd(matrix / rows)
    return rows[:, 0] * left[:, -1], right[-1].conj()


def _magnitudes(z: Array, m: int) -> Array:
    """Return what corrections are compared with; see `racs_bif.fractional.exact_hopf`."""
    size = np.abs(z)
    size[:m] = np.maximum(size[:m], max(1e-3 * float(size[:m].max()), 1e-12))
    size[m] = max(float(size[m]), 1e-3)
    size[m + 1 :] = size[m + 1 :].max()
    return size


def _system(
    field: StaticField, path: ParameterPath, border: Array, z: Array
) -> tuple[Array, Array]:
    """Return residual (2m+1,) and Jacobian of the defining system."""
    m = len(border)
    x, value, v = z[:m], z[m], z[m + 1 :]
    p, dp = path.vector(value), path.direction(value)
    f_x = field.f_x(x, p)
    J = np.zeros((2 * m + 1, 2 * m + 1))
    J[:m, :m], J[:m, m] = f_x, field.f_p(x, p, dp)
    J[m : 2 * m, :m] = field.f_xx(x, p, np.broadcast_to(v[:, None], (m, m)), np.eye(m)).real
    J[m : 2 * m, m] = field.f_xp(x, p, v, dp).real
    J[m : 2 * m, m + 1 :] = f_x
    J[2 * m, m + 1 :] = border
    return np.concatenate([field.f(x, p), f_x @ v, [border @ v - 1.0]]), J
