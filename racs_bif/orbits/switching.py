"""The other branch where two branches of periodic orbits cross, by any discretisation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.errors import ConvergenceError, UsageError
from racs_bif.orbits.polishing import polished

if TYPE_CHECKING:
    from racs_bif.orbits.problem import OrbitProblem
    from racs_bif.symbolic.field import Array

_AMPLITUDE: Final = 0.1
"""Length of the direction in which a branch is left, in ranges of the states."""
SINGULAR: Final = 1e-3
"""How nearly a branch point's matrix must be singular."""
_FIRST: Final = 1e-2
"""First step away from a branch point, in ranges of the states."""
_STILL: Final = 2e-4
"""Scales below this share of the largest are guesses: the state stands still."""
_UNMOVED: Final = 1e-6
_ASTRAY: Final = 0.05
_SHARES: Final = (1.0, 0.1, 1e-2, 1e-3, 0.0)
"""Scales that are tried for states that were still, over that of the states that moved."""
_SYMMETRIC: Final = 0.05
"""Largest first-order motion of the parameter, over that of the states, of a pitchfork."""
_SEED: Final = 7


Rescaled = Callable[["Array"], "tuple[OrbitProblem, Array]"]
"""Maps scales of the unknown states (m,) to the same equations with these, and the same orbit."""


@dataclass(frozen=True, eq=False)
class Crossing:
    """How the other branch goes through a branch point.

    Attributes
    ----------
    problem : OrbitProblem
        The equations, with scales that suit the other branch.
    z, direction : array
        The branch point there and the direction of the other branch.
    symmetric : bool
        Whether period and parameter are stationary along it: a broken symmetry, so that its two
        halves are mirror images of each other.
    """

    problem: OrbitProblem
    z: Array
    direction: Array
    symmetric: bool


def null_direction(
    problem: OrbitProblem, z: Array, tangent: Array, singular: float = SINGULAR
) -> Array:
    """Return the direction, orthogonal to the branch known, in which the equations are singular.

    Parameters
    ----------
    problem : OrbitProblem
        The problem whose branch the point lies on.
    z, tangent : array
        The point and the direction of the branch known.
    singular : float
        How nearly the matrix must be singular there.

    Raises
    ------
    UsageError
        If it is not.
    """
    magnitudes = problem.magnitudes(z)
    solve = problem.bordered(z, tangent / magnitudes**2)
    found = np.random.default_rng(_SEED).standard_normal(len(z))
    found[-2] = 0.0
    before = float(np.linalg.norm(found))
    size = 0.0
    for _ in range(2):
        step = solve(found)
        before = float(np.linalg.norm(found))
        size = float(np.linalg.norm(step / magnitudes))
        found = step / magnitudes / size
    if size < 1.0 / singular * before:
        raise UsageError(
            "no other branch of periodic orbits crosses this one here: start from a BPC point"
        )
    return np.asarray(found * magnitudes * _AMPLITUDE * np.sqrt(len(z)))


def crossing(problem: OrbitProblem, z: Array, tangent: Array, rescaled: Rescaled) -> Crossing:
    """Return the other branch through a branch point, from two points of it beside that.

    Of the plane of directions in which the equations allow to leave, a branch whose symmetry is
    broken takes the one orthogonal to the branch known. Any other is met by solving in the
    hyperplane a little way along that direction. States that were still on the branch known say
    nothing about how far they will move: they are given the largest scale, up to that of the states
    that did move, at which two such points are found.

    Parameters
    ----------
    problem : OrbitProblem
        The problem whose branch the point lies on.
    z, tangent : array
        The branch point and the direction of the branch known.
    rescaled : callable
        Gives the same equations with other scales.

    Raises
    ------
    UsageError
        If branches do not cross there.
    """
    return leave(problem, z, null_direction(problem, z, tangent), rescaled)


def leave(problem: OrbitProblem, z: Array, across: Array, rescaled: Rescaled) -> Crossing:
    """Return the branch through `z` in the direction `across`, with scales that suit it.

    Parameters
    ----------
    problem : OrbitProblem
        The equations that are singular at `z`.
    z, across : array
        The point and the direction in which they are singular.
    rescaled : callable
        Gives the same equations with other scales.
    """
    scales = problem.reference(z).scales
    moving = _moving(problem, across, scales)
    for share in _SHARES:
        other, there = rescaled(np.maximum(scales, share * moving))
        found = _beside(other, there, across)
        if found is not None:
            return found
    return Crossing(problem, z, across, symmetric=False)


def _moving(problem: OrbitProblem, across: Array, scales: Array) -> Array:
    """Return how far the states move in a direction in which one that moved before fills its scale.

    Where none of those moves, the largest scale of all is the best guess.
    """
    moving = np.abs(problem.unknown_states(across)).max(axis=0)
    known = scales > _STILL * scales.max()
    share = float((moving[known] / scales[known]).max())
    if share > _UNMOVED * float((moving / scales).max()):
        return np.asarray(moving / share)
    return np.asarray(moving * (scales.max() / moving.max()))


def _beside(problem: OrbitProblem, z: Array, across: Array) -> Crossing | None:
    """Return the direction between two orbits on both sides of a branch point; or None."""
    magnitudes = problem.magnitudes(z)
    across = np.array(across)
    across[-2] = 0.0
    size = np.sqrt(len(z)) / float(np.linalg.norm(across / magnitudes))
    sides = []
    for sign in (1.0, -1.0):
        try:
            side = polished(problem, z + sign * _FIRST * size * across, across)
        except (ConvergenceError, np.linalg.LinAlgError):
            return None
        # beyond this Newton's method went to another orbit
        if abs(side[-1] - z[-1]) > _ASTRAY * magnitudes[-1]:
            return None
        sides.append(side)
    chord = (sides[0] - sides[1]) / magnitudes
    chord[-2] = 0.0
    length = float(np.linalg.norm(chord)) / np.sqrt(len(z))
    # one number of many is compared with the root mean square of the states
    first_order = float(np.hypot(chord[-1], chord[-3]))
    direction = chord * magnitudes * (_AMPLITUDE / length)
    problem.crossing = np.array(z)
    return Crossing(problem, z, direction, symmetric=first_order < _SYMMETRIC * length)
