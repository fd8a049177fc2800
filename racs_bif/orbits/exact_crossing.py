"""Where a multiplier of the exact operator crosses the unit circle: NS and PD themselves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.errors import ConvergenceError, UsageError
from racs_bif.orbits.hill import ExactMultiplier, exact_multiplier

if TYPE_CHECKING:
    from racs_bif.orbits.harmonic_balance import HarmonicBalanceProblem
    from racs_bif.symbolic.field import Array

_ITERATIONS: Final = 40
_TOLERANCE: Final = 1e-10


@dataclass(frozen=True, eq=False)
class ExactCrossing:
    """An orbit with a multiplier of the exact operator on the unit circle.

    Attributes
    ----------
    z : array
        The orbit.
    value : float
        The active parameter.
    period : float
        The period.
    multiplier : complex
        The multiplier.
    """

    z: Array
    value: float
    period: float
    multiplier: complex


def exact_crossing(
    problem: HarmonicBalanceProblem, first: Array, last: Array, guess: complex
) -> ExactCrossing:
    """Locate a crossing between two orbits of a branch that has no fold between them.

    Parameters
    ----------
    problem : HarmonicBalanceProblem
        The problem.
    first, last : array
        Solutions on both sides.
    guess : complex
        The multiplier at the first of them.

    Raises
    ------
    UsageError
        If the multiplier is on the same side at both.
    ConvergenceError
        If the orbit or the multiplier is lost on the way.
    """
    harmonics = max(problem.harmonics(first), problem.harmonics(last))
    ends = [problem.with_harmonics(z, harmonics)[0] for z in (first, last)]
    ends[1][-2] = ends[0][-2]  # one phase condition for both
    ends[1] = problem.solved(ends[1])
    known = [exact_multiplier(problem.solution(ends[0]), guess)]
    known.append(_followed(problem, ends[1], known[0]))
    sides = [_side(found) for found in known]
    if sides[0] * sides[1] > 0.0:
        raise UsageError(
            f"the multiplier is {known[0].multiplier:.6g} at one orbit and "
            f"{known[1].multiplier:.6g} at the other, on the same side of the unit circle: "
            "give orbits on both sides"
        )
    for _ in range(_ITERATIONS):
        share = sides[0] / (sides[0] - sides[1])
        z = problem.solved((1.0 - share) * ends[0] + share * ends[1])
        found = _followed(problem, z, known[0] if share < 0.5 else known[1])
        side = _side(found)
        if abs(side) < _TOLERANCE:
            return ExactCrossing(z, float(z[-1]), problem.period(z), found.multiplier)
        # the Illinois rule: an end that stays counts half
        k = 0 if side * sides[0] > 0.0 else 1
        ends[k], known[k], sides[k] = z, found, side
        sides[1 - k] *= 0.5
    raise ConvergenceError(
        "the orbit whose multiplier is on the unit circle was not located: give nearer orbits"
    )


def _followed(
    problem: HarmonicBalanceProblem, z: Array, before: ExactMultiplier
) -> ExactMultiplier:
    """Return the multiplier that continues the one of a neighbouring orbit."""
    return exact_multiplier(problem.solution(z), before.multiplier, before.vector)


def _side(found: ExactMultiplier) -> float:
    """Return the logarithm of the modulus: negative inside the unit circle."""
    return float(np.log(abs(found.multiplier)))
