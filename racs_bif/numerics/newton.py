"""Newton's method on a curve: n equations for n + 1 unknowns, cut by a hyperplane.

The hyperplane is the last row of a bordered system, so that every iteration gives the tangent of
the curve along with the correction, for one more right-hand side (H. B. Keller, 1977). The damped
variant follows P. Deuflhard, *Newton Methods for Nonlinear Problems* (natural monotonicity test).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from racs_bif.errors import ConvergenceError

if TYPE_CHECKING:
    from collections.abc import Callable

Array = NDArray[np.float64]

_SLOW = 0.5
_CHORD = 0.1
_CLOSE = 0.1
_STAGNANT = 0.9
_NOISE = 1e3
_ROUNDING = 100 * np.finfo(float).eps
_SMALLEST_DAMPING = 1e-4


class NotFiniteError(ConvergenceError):
    """The equations gave NaN or infinity."""


class Equations(Protocol):
    """What Newton's method needs to know.

    Attributes
    ----------
    chord : bool
        Whether a matrix is kept while it contracts tenfold or more: where it costs far more than
        the residual.
    """

    chord: bool

    def residual(self, z: Array) -> Array:
        """Return the residual (n,) at z (n+1,)."""

    def terms(self, z: Array) -> Array:
        """Return the sizes (n,) of the terms that the residual is made of."""

    def bordered(self, z: Array, row: Array) -> Callable[[Array], Array]:
        """Return a solver of [jacobian; row]."""


@dataclass(slots=True)
class Corrected:
    """A solution with how it was reached.

    Attributes
    ----------
    z : array (n + 1,)
        The solution.
    tangent : array (n + 1,)
        Direction of the curve, with ``row @ tangent == 1``.
    iterations : int
        How many corrections were made by matrices of their own.
    contraction : float
        Ratio of the second correction to the first; 0 where that is within rounding.
    """

    z: Array
    tangent: Array
    iterations: int
    contraction: float


def newton(
    equations: Equations,
    z: Array,
    row: Array,
    weights: Array,
    *,
    tolerance: float,
    iterations: int,
    contraction: float = _SLOW,
    noise: float = 0.0,
) -> Corrected:
    """Correct ``z`` in the hyperplane through it whose normal is ``row``.

    It ends when the scaled correction is below the tolerance, or when it no longer shrinks because
    rounding is all that is left of the residual. It gives up at once where it does not contract.

    Parameters
    ----------
    equations : Equations
        Residual, its Jacobian and the bordered solver.
    z : array (n + 1,)
        Prediction.
    row : array (n + 1,)
        Normal of the hyperplane.
    weights : array (n + 1,)
        The scaled norm of v is ``sqrt(sum(weights * v**2))``.
    tolerance : float
        On the scaled correction.
    iterations : int
        At most.
    contraction : float
        Largest ratio of the second correction to the first.
    noise : float
        A correction below it that does not shrink is taken for rounding; at least a thousand times
        the tolerance.

    Raises
    ------
    ConvergenceError
        If it does not converge.
    numpy.linalg.LinAlgError
        If the bordered matrix is singular.
    """
    right = np.zeros((len(z), 2), order="F")
    right[-1, 1] = 1.0
    first, last = 0.0, math.inf
    noise = max(noise, _NOISE * tolerance)
    solve: Callable[[Array], Array] | None = None
    matrices, corrections = 0, 0
    while True:
        right[:-1, 0] = residual = _residual(equations, z)
        fresh = solve is None
        if solve is None:
            if matrices == iterations:
                break
            solve, matrices = equations.bordered(z, row), matrices + 1
        # only the last matrix, the solution's, is asked for the tangent
        solution = solve(right if fresh else right[:, :1])
        correction = solution[:, 0]
        size = _length(correction, weights)
        corrected, corrections = z - correction, corrections + 1
        ratio = size / last
        if corrections == 2 and size > noise:
            first = ratio
        if fresh and size <= tolerance:
            return Corrected(corrected, solution[:, 1], matrices, first)
        if ratio > (contraction if corrections == 2 else _SLOW) and (fresh or corrections == 2):
            stagnant = ratio > _STAGNANT and size <= noise
            if fresh and (stagnant or _rounded(equations, z, residual)):
                return Corrected(corrected, solution[:, 1], matrices, 0.0)
            if size > noise:
                msg = "Newton's method does not contract"
                raise ConvergenceError(msg)
        if not _kept(equations, size, ratio, tolerance, fresh=fresh):
            solve = None
        z, last = corrected, size
    msg = f"Newton's method did not converge in {iterations} iterations"
    raise ConvergenceError(msg)


def _kept(
    equations: Equations, size: float, ratio: float, tolerance: float, *, fresh: bool
) -> bool:
    """Return whether the matrix serves again; the last one is the solution's, for its tangent."""
    return equations.chord and size > _CLOSE * tolerance and (fresh or ratio <= _CHORD)


def _length(correction: Array, weights: Array) -> float:
    size = math.sqrt(weights.dot(correction * correction))
    if not math.isfinite(size):
        msg = "Newton's correction is not finite"
        raise NotFiniteError(msg)
    return size


def _residual(equations: Equations, z: Array) -> Array:
    residual = equations.residual(z)
    if not math.isfinite(residual.dot(residual)):
        msg = "the residual is not finite"
        raise NotFiniteError(msg)
    return residual


def damped_newton(
    equations: Equations,
    z: Array,
    row: Array,
    weights: Array,
    *,
    tolerance: float,
    iterations: int,
) -> Corrected:
    """Correct a rough guess ``z`` as `newton` does, with shorter corrections where need be.

    The weights are lowered where the first correction is larger than what they are made for: a
    guess of zero says nothing about magnitudes.

    Raises
    ------
    ConvergenceError
        If it does not converge.
    numpy.linalg.LinAlgError
        If the bordered matrix is singular.
    """
    right = np.zeros((len(z), 2), order="F")
    right[-1, 1] = 1.0
    damping = 1.0
    for iteration in range(1, iterations + 1):
        right[:-1, 0] = equations.residual(z)
        solve = equations.bordered(z, row)
        solution = solve(right)
        correction = solution[:, 0]
        if iteration == 1:
            weights = 1.0 / np.maximum(1.0 / weights, len(z) * correction**2)
        size = math.sqrt(weights.dot(correction * correction))
        if not math.isfinite(size):
            msg = "the residual is not finite"
            raise NotFiniteError(msg)
        if size <= tolerance:
            return Corrected(z - correction, solution[:, 1], iteration, 0.0)
        try:
            damping, z = _damp(equations, z, correction, solve, weights, min(1.0, 4.0 * damping))
        except ConvergenceError:
            if not _rounded(equations, z, right[:-1, 0]):
                raise
            return Corrected(z - correction, solution[:, 1], iteration, 0.0)
    msg = f"Newton's method did not converge in {iterations} iterations"
    raise ConvergenceError(msg)


def _damp(
    equations: Equations,
    z: Array,
    correction: Array,
    solve: Callable[[Array], Array],
    weights: Array,
    damping: float,
) -> tuple[float, Array]:
    """Return the largest damping at which the next simplified correction is shorter."""
    size = math.sqrt(weights.dot(correction * correction))
    right = np.zeros(len(z))
    while damping >= _SMALLEST_DAMPING:
        trial = z - damping * correction
        try:
            right[:-1] = equations.residual(trial)
            following = solve(right)
        except ArithmeticError:
            damping *= 0.5
            continue
        if weights.dot(following * following) <= ((1.0 - 0.25 * damping) * size) ** 2:
            return damping, trial
        damping *= 0.5
    msg = "Newton's method does not contract, however short its corrections"
    raise ConvergenceError(msg)


def _rounded(equations: Equations, z: Array, residual: Array) -> bool:
    """Whether the residual is what rounding leaves of the terms it is made of."""
    return bool(np.all(np.abs(residual) <= _ROUNDING * equations.terms(z)))
