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
_CHORD: Final = 0.1
"""Contraction up to which a matrix is kept."""
_NEAR: Final = 1e-4
"""Relative distance up to which a matrix serves for the direction, too."""


class Discretised(Protocol):
    """What is asked of a discretisation; `chord` as in `continuation.problem.Problem`."""

    chord: bool

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
    row = tangent / problem.magnitudes(z) ** 2
    return _solved(problem, z, row)[0]


def followed(problem: Discretised, z: Array, tangent: Array) -> tuple[Array, Array]:
    """Return what `polished` and `direction` do, by one matrix where that is near enough.

    Raises
    ------
    ConvergenceError
        If the orbit is not found, or its direction not defined.
    """
    row = tangent / problem.magnitudes(z) ** 2
    found, solve, distance = _solved(problem, z, row)
    if distance > _NEAR:
        return found, direction(problem, found, tangent)
    return found, _along(problem, solve, found, tangent)


def _solved(problem: Discretised, z: Array, row: Array) -> tuple[Array, Solver, float]:
    """Return the solution, the last matrix's solver and how far from it that matrix belongs."""
    magnitudes = problem.magnitudes(z)
    last, matrices, distance = np.inf, 0, 0.0
    solve: Solver | None = None
    while True:
        residual = problem.residual(z)
        fresh = solve is None
        if solve is None:
            if matrices == _ITERATIONS:
                break
            solve, matrices, distance = problem.bordered(z, row), matrices + 1, 0.0
        step = solve(np.append(residual, 0.0))
        z = z - step
        size = float(np.abs(step / magnitudes).max())
        distance += size
        if size < _SAME:
            return z, solve, distance
        if not size < 1.0:
            break
        if not problem.chord or not (fresh or size <= _CHORD * last):
            solve = None
        last = size
    raise ConvergenceError("the orbit was not found again on another mesh")


def direction(problem: Discretised, z: Array, near: Array) -> Array:
    """Return the direction of the branch at `z`, as long as `near` in the problem's scales.

    Raises
    ------
    ConvergenceError
        If it is not defined.
    """
    solve = problem.bordered(z, near / problem.magnitudes(z) ** 2)
    return _along(problem, solve, z, near)


def _along(problem: Discretised, solve: Solver, z: Array, near: Array) -> Array:
    magnitudes = problem.magnitudes(z)
    rhs = np.zeros(len(z))
    rhs[-1] = 1.0
    found = solve(rhs)
    if not np.all(np.isfinite(found)):
        raise ConvergenceError("the branch of orbits has no direction here")
    length = np.linalg.norm(near / magnitudes) / np.linalg.norm(found / magnitudes)
    return np.asarray(found * length)
