"""A first orbit solved and resolved, before its branch is followed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.errors import ConvergenceError
from racs_bif.numerics.newton import damped_newton

if TYPE_CHECKING:
    from racs_bif.orbits.problem import OrbitProblem
    from racs_bif.symbolic.field import Array

_TOLERANCE: Final = 1e-9
_ITERATIONS: Final = 60
_MESHES: Final = 4
"""How often the mesh is moved at most."""


def settled(problem: OrbitProblem, z: Array) -> tuple[Array, Array]:
    """Solve for the orbit near a guess at its parameter, on a mesh that suits it.

    Parameters
    ----------
    problem : OrbitProblem
        The problem.
    z : array
        The guess.

    Returns
    -------
    tuple of array
        The orbit and the direction of its branch, both on the last mesh.

    Raises
    ------
    ConvergenceError
        If Newton's method finds no orbit, or an equilibrium.
    """
    value = float(z[-1])
    z, tangent = _solved(problem, z)
    for _ in range(_MESHES):
        if problem.degenerate(z):
            raise ConvergenceError(
                f"no orbit near the guess at {problem.parameter} = {z[-1]:.10g}: Newton's method "
                "found an equilibrium; give a better guess"
            )
        adapted = problem.adapt(z, tangent)
        if adapted is None:
            break
        before, z = z, np.array(adapted[0])
        z[-1] = value  # adapting may have moved it along the branch
        if len(z) == len(before) and _same(problem, z, before):
            break
        z, tangent = _solved(problem, z)
    return z, tangent


def _same(problem: OrbitProblem, z: Array, before: Array) -> bool:
    """Say whether the mesh did not move: its points, and so all unknowns, are where they were."""
    change = (z - before) / problem.magnitudes(z)
    change[-2] = 0.0
    return float(np.abs(change).max()) < 10.0 * _TOLERANCE


def _solved(problem: OrbitProblem, z: Array) -> tuple[Array, Array]:
    row = np.zeros(len(z))
    row[-1] = 1.0
    weights = 1.0 / problem.magnitudes(z) ** 2
    weights[:-1] /= len(z) - 1
    try:
        found = damped_newton(
            problem, z, row, weights, tolerance=_TOLERANCE, iterations=_ITERATIONS
        )
    except (ArithmeticError, np.linalg.LinAlgError) as error:
        raise ConvergenceError(
            f"no orbit near the guess at {problem.parameter} = {z[-1]:.10g} ({error}); give a "
            "better guess"
        ) from error
    return found.z, found.tangent
