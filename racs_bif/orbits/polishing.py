"""Solving for an orbit again after its mesh has changed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, Protocol

import numpy as np

from racs_bif.errors import ConvergenceError

if TYPE_CHECKING:
    from racs_bif.continuation.problem import Solver
    from racs_bif.symbolic.field import Array

_SAME: Final = 1e-9
"""Relative correction at which an orbit is found."""
_ITERATIONS: Final = 6


class Discretised(Protocol):
    """What is asked of a discretisation."""

    def residual(self, z: Array) -> Array:
        """Return the residual."""

    def bordered(self, z: Array, row: Array) -> Solver:
        """Return a solver of [jacobian; row]."""

    def magnitudes(self, z: Array) -> Array:
        """Return typical magnitudes of all unknowns."""


def polished(problem: Discretised, z: Array, tangent: Array) -> Array:
    """Return the solution in the hyperplane through `z` with the normal `tangent`.

    Raises
    ------
    ConvergenceError
        If Newton's method does not find it.
    """
    magnitudes = problem.magnitudes(z)
    row = tangent / magnitudes**2
    for _ in range(_ITERATIONS):
        step = problem.bordered(z, row)(np.append(problem.residual(z), 0.0))
        z = z - step
        size = float(np.abs(step / magnitudes).max())
        if size < _SAME:
            return z
        if not size < 1.0:
            break
    raise ConvergenceError("the orbit was not found again on another mesh")


def direction(problem: Discretised, z: Array, near: Array) -> Array:
    """Return the direction of the branch at `z`, as long as `near` in the problem's scales.

    Raises
    ------
    ConvergenceError
        If it is not defined.
    """
    magnitudes = problem.magnitudes(z)
    rhs = np.zeros(len(z))
    rhs[-1] = 1.0
    found = problem.bordered(z, near / magnitudes**2)(rhs)
    if not np.all(np.isfinite(found)):
        raise ConvergenceError("the direction of the branch of orbits is not defined here")
    length = np.linalg.norm(near / magnitudes) / np.linalg.norm(found / magnitudes)
    return np.asarray(found * length)
