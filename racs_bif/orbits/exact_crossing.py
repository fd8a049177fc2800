"""Where a multiplier of the exact operator crosses the unit circle: NS and PD without realisation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.errors import ConvergenceError, UsageError
from racs_bif.orbits.hill import exact_multiplier

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
    multipliers = [exact_multiplier(problem.solution(ends[0]), guess).multiplier]
    multipliers.append(exact_multiplier(problem.solution(ends[1]), multipliers[0]).multiplier)
    sides = [float(np.log(abs(m))) for m in multipliers]
    if sides[0] * sides[1] > 0.0:
        raise UsageError(
            f"the multiplier is {multipliers[0]:.6g} at one orbit and {multipliers[1]:.6g} at the "
            "other, on the same side of the unit circle: give orbits on both sides"
        )
    for _ in range(_ITERATIONS):
        share = sides[0] / (sides[0] - sides[1])
        between = (1.0 - share) * ends[0] + share * ends[1]
        z = problem.solved(between)
        nearer = multipliers[0] if share < 0.5 else multipliers[1]
        multiplier = exact_multiplier(problem.solution(z), nearer).multiplier
        side = float(np.log(abs(multiplier)))
        if abs(side) < _TOLERANCE:
            return ExactCrossing(z, float(z[-1]), problem.period(z), multiplier)
        # the Illinois rule: an end that stays counts half
        k = 0 if side * sides[0] > 0.0 else 1
        ends[k], multipliers[k], sides[k] = z, multiplier, side
        sides[1 - k] *= 0.5
    raise ConvergenceError("the crossing of the unit circle was not located")
