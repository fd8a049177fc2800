"""The points of a branch one by one, where no events are wanted."""

from __future__ import annotations

from typing import TYPE_CHECKING

from racs_bif.continuation.building import Builder
from racs_bif.continuation.settings import StepSettings
from racs_bif.continuation.start import begin
from racs_bif.continuation.stepping import Stepper
from racs_bif.errors import UsageError

if TYPE_CHECKING:
    from collections.abc import Generator

    from racs_bif.continuation.points import Array, Point
    from racs_bif.continuation.problem import Problem
    from racs_bif.continuation.stopped import Stopped


def steps(
    problem: Problem,
    z: Array,
    span: tuple[float, float],
    settings: StepSettings | None = None,
    *,
    direction: int = 1,
    tangent: Array | None = None,
) -> Generator[Point, None, Stopped]:
    """Yield the points of a branch one by one, without looking for events.

    Parameters
    ----------
    problem : Problem
        What is solved.
    z : array (n + 1,)
        A guess of the first point; solved at its parameter.
    span : tuple of float
        Lowest and highest value of the parameter.
    settings : StepSettings, optional
        Of the step control.
    direction : int
        +1 to set off with the parameter increasing, or along `tangent` if given; -1 the other way.
    tangent : array (n + 1,), optional
        Direction in which to set off. The start is then corrected across it.

    Yields
    ------
    Point
        The start, then every accepted point.

    Returns
    -------
    Stopped
        Why it ended, as the generator's value.

    Raises
    ------
    UsageError
        If the span, the start or the direction cannot be used.
    ConvergenceError
        If there is no solution at the start.
    """
    if direction not in {1, -1}:
        msg = f"the direction must be 1 or -1, not {direction!r}"
        raise UsageError(msg)
    settings = settings or StepSettings()
    corrected, unit, iterations, scaling = begin(problem, z, span, settings, tangent)
    builder = Builder(problem, (), 0)
    start = builder.point(corrected, unit * direction, 0.0, iterations)
    stepper = Stepper(builder, scaling, start, span, settings)
    yield start
    while (point := stepper.advance()) is not None:
        yield point
    assert stepper.stopped is not None
    return stepper.stopped
