"""The first point of a branch and the direction in which it goes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.continuation.building import FAILURES
from racs_bif.continuation.scaling import ZERO, Scaling
from racs_bif.errors import ConvergenceError, UsageError
from racs_bif.numerics.newton import Corrected, damped_newton, newton

if TYPE_CHECKING:
    from racs_bif.continuation.points import Array
    from racs_bif.continuation.problem import Problem
    from racs_bif.continuation.settings import StepSettings

_EDGE = 1e-12
_ASTRAY = 1e-6
_ITERATIONS = 60
_SEED = 12345
_LEAP = 4.0
_LEAPS = 40


def begin(
    problem: Problem,
    z: Array,
    span: tuple[float, float],
    settings: StepSettings,
    tangent: Array | None,
) -> tuple[Array, Array, int, Scaling]:
    """Return the corrected start, its unit tangent, the iterations it took and the norm.

    Raises
    ------
    UsageError
        If the span or the start cannot be used.
    ConvergenceError
        If there is no solution at the start.
    """
    z = checked(problem, z, span)
    width = span[1] - span[0]
    with np.errstate(all="ignore"):
        if tangent is None:
            return first(problem, z, width, settings)
        return along(problem, z, np.array(tangent, dtype=float), width, settings)


def checked(problem: Problem, z: Array, span: tuple[float, float]) -> Array:
    """Return the start as a fresh array with a parameter within the span.

    Raises
    ------
    UsageError
        If the span is empty or the start is not on it, not finite or without unknowns.
    """
    low, high = span
    if not (math.isfinite(low) and math.isfinite(high) and low < high):
        msg = f"the span of {problem.parameter} must go from low to high, not {low!r} to {high!r}"
        raise UsageError(msg)
    z = np.array(z, dtype=float)
    if z.ndim != 1 or len(z) < 2:
        msg = f"{problem.name}: a start must be a vector of at least one unknown and the parameter"
        raise UsageError(msg)
    if not np.isfinite(z).all():
        msg = f"{problem.name}: all values of the start must be finite"
        raise UsageError(msg)
    for end in span:
        if abs(z[-1] - end) <= _EDGE * (high - low):
            z[-1] = end
    if not low <= z[-1] <= high:
        msg = (
            f"{problem.name} starts at {problem.parameter} = {z[-1]:.10g}, outside the span "
            f"{low:.10g} to {high:.10g}; move the start or widen the span"
        )
        raise UsageError(msg)
    return z


def first(
    problem: Problem, z: Array, width: float, settings: StepSettings
) -> tuple[Array, Array, int, Scaling]:
    """Solve for the first point at the start's parameter.

    Returns
    -------
    tuple
        The solution, its unit tangent with the parameter increasing, iterations, the norm.

    Raises
    ------
    ConvergenceError
        If Newton's method does not converge.
    """
    scaling = Scaling(width, problem.scales(z))
    at, at_fold = float(z[-1]), None
    row = np.zeros(len(z))
    row[-1] = 1.0 / width
    try:
        rough = damped_newton(
            problem,
            z,
            row,
            scaling.weights,
            tolerance=settings.tolerance,
            iterations=_ITERATIONS,
        )
        scaling.restart(problem.scales(rough.z))
        corrected = newton(
            problem,
            rough.z,
            row,
            scaling.weights,
            tolerance=settings.tolerance,
            iterations=settings.iterations,
        )
        corrected.iterations += rough.iterations
    except FAILURES as error:
        scaling.restart(problem.scales(z))
        at_fold = _on_fold(problem, z, scaling, settings)
        if at_fold is None:
            msg = (
                f"{problem.name}: no solution found at the start, {problem.parameter} = {at:.10g} "
                f"({error}); give a better guess or another {problem.parameter}"
            )
            raise ConvergenceError(msg) from error
        corrected = at_fold
    corrected.z[-1] = at
    tangent = corrected.tangent
    if at_fold is not None:
        tangent = tangent / scaling.norm(tangent)
        _leave_zero(problem, corrected.z, tangent, scaling, settings)
    elif scaling.foresee(tangent):
        scaling.grow(problem.scales(corrected.z))
    tangent = tangent / scaling.norm(tangent)
    largest = int(np.argmax(scaling.weights * tangent * tangent))
    sense = tangent[-1] if tangent[-1] else tangent[largest]
    return corrected.z, tangent * math.copysign(1.0, sense), corrected.iterations, scaling


def _on_fold(
    problem: Problem, z: Array, scaling: Scaling, settings: StepSettings
) -> Corrected | None:
    """Correct a start at which the parameter cannot be held; None unless it hardly moves."""
    row = np.sqrt(scaling.weights) * np.random.default_rng(_SEED).standard_normal(len(z))
    try:
        corrected = newton(
            problem,
            z,
            row,
            scaling.weights,
            tolerance=settings.tolerance,
            iterations=settings.iterations,
        )
    except FAILURES:
        return None
    return corrected if scaling.norm(corrected.z - z) <= _ASTRAY else None


def along(
    problem: Problem, z: Array, tangent: Array, width: float, settings: StepSettings
) -> tuple[Array, Array, int, Scaling]:
    """Correct the first point across a given direction and set off in it.

    Where branches meet the correction has no unique answer: then the start is taken as it is.

    Returns
    -------
    tuple
        As of `first`, the tangent being the one given.
    """
    scaling = Scaling(width, problem.scales(z))
    if tangent.shape != z.shape or not scaling.norm(tangent) > 0.0:
        msg = (
            f"{problem.name}: the tangent must have the shape {z.shape} of the start and not vanish"
        )
        raise UsageError(msg)
    tangent = tangent / scaling.norm(tangent)
    _leave_zero(problem, z, tangent, scaling, settings)
    tangent = tangent / scaling.norm(tangent)
    iterations = 0
    try:
        corrected = newton(
            problem,
            z,
            scaling.weights * tangent,
            scaling.weights,
            tolerance=settings.tolerance,
            iterations=settings.iterations,
        )
    except FAILURES:
        return z, tangent, iterations, scaling
    if 1.0 / scaling.norm(corrected.tangent) > 0.5:
        z, iterations = corrected.z, corrected.iterations
        scaling.grow(problem.scales(z))
        tangent = tangent / scaling.norm(tangent)
    return z, tangent, iterations, scaling


def _leave_zero(
    problem: Problem, z: Array, tangent: Array, scaling: Scaling, settings: StepSettings
) -> None:
    """Give unknowns that are zero the magnitude they soon have on the branch along a tangent.

    A branch that breaks a symmetry leaves with the parameter standing still and the unknowns at
    zero, so that neither says how long a step is: steps as short as those unknowns would trace
    rounding. Trial points ever farther out tell where the parameter begins to move.
    """
    leading = int(np.argmax(scaling.weights[:-1] * tangent[:-1] ** 2))
    if problem.scales(z)[leading] > ZERO:
        return
    trial, reach = scaling.copy(), 1.0
    for _ in range(_LEAPS):
        motion = reach * tangent
        trial.suppose(motion)
        weights = trial.weights
        try:
            with np.errstate(all="ignore"):
                corrected = newton(
                    problem,
                    z + motion,
                    weights * tangent,
                    weights,
                    tolerance=settings.tolerance,
                    iterations=settings.iterations,
                )
        except FAILURES:
            return
        scaling.suppose(motion)
        scaling.suppose(corrected.z - z)
        if scaling.bend(z, corrected.z) >= 1.0:
            return
        reach *= _LEAP
