"""Points wanted exactly: values of the parameter or of a measure (AUTO's UZ)."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from racs_bif.continuation.building import FAILURES
from racs_bif.continuation.problem import Detector, Problem
from racs_bif.continuation.scaling import Scaling
from racs_bif.errors import UsageError
from racs_bif.numerics.newton import newton

if TYPE_CHECKING:
    from racs_bif.continuation.points import Array, Point, SpecialPoint
    from racs_bif.continuation.settings import StepSettings

Targets = Sequence[float] | Mapping[str, Sequence[float]]
"""Values of the parameter, or values by the name of the parameter or of a measure."""


class Target(Detector):
    """A wanted value of something.

    Parameters
    ----------
    name : str
        The parameter or the measure.
    target : float
        Its wanted value.
    """

    label = "UZ"

    def __init__(self, name: str, target: float) -> None:
        self.name, self.target = name, target

    def value(self, problem: Problem, point: Point) -> float:
        """Return how far the measure is above its target."""
        del problem
        return point.measures[self.name] - self.target

    def data(self, problem: Problem, point: Point) -> dict[str, Any]:
        """Return what was wanted."""
        del problem, point
        return {"name": self.name, "target": self.target}


class HeldTarget(Target):
    """A wanted value of something that is an unknown itself, met exactly.

    Parameters
    ----------
    name, target
        As for `Target`.
    place : int
        Where it is in z, counted from the end.
    settings : StepSettings
        How closely to solve.
    width : float
        Width of the parameter's span.
    """

    def __init__(
        self, name: str, target: float, place: int, settings: StepSettings, width: float
    ) -> None:
        super().__init__(name, target)
        self._place, self._settings, self._width = place, settings, width

    def value(self, problem: Problem, point: Point) -> float:
        """Return how far the unknown is above its target."""
        del problem
        return float(point.z[self._place]) - self.target

    def refine(self, problem: Problem, special: SpecialPoint) -> Array | None:
        """Solve with the unknown held at its target."""
        z = special.z.copy()
        z[self._place] = self.target
        scale = self._width if self._place == -1 else abs(self.target) or 1.0
        row = np.zeros(len(z))
        row[self._place] = 1.0 / scale
        try:
            corrected = newton(
                problem,
                z,
                row,
                Scaling(self._width, problem.scales(z)).weights,
                tolerance=self._settings.tolerance,
                iterations=self._settings.iterations,
            )
        except FAILURES:
            return None
        corrected.z[self._place] = self.target
        return corrected.z


class ParameterTarget(HeldTarget):
    """A wanted value of the continuation parameter."""

    def __init__(self, name: str, target: float, settings: StepSettings, width: float) -> None:
        super().__init__(name, target, -1, settings, width)


def detectors_of(
    targets: Targets,
    problem: Problem,
    span: tuple[float, float],
    settings: StepSettings,
    measures: Mapping[str, float],
) -> list[Target]:
    """Return a detector of each target.

    Raises
    ------
    UsageError
        If a value is not finite or outside the span, or nothing has the name.
    """
    if not isinstance(targets, Mapping):
        targets = {problem.parameter: targets}
    found: list[Target] = []
    low, high = span
    for name, values in targets.items():
        for value in map(float, dict.fromkeys(values)):
            if not math.isfinite(value):
                msg = f"the value {value!r} wanted of '{name}' must be finite"
                raise UsageError(msg)
            if name == problem.parameter:
                if not low <= value <= high:
                    msg = (
                        f"the point wanted at {name} = {value:.10g} is outside the span "
                        f"{low:.10g} to {high:.10g}; widen the span"
                    )
                    raise UsageError(msg)
                found.append(ParameterTarget(name, value, settings, high - low))
            elif name in measures:
                place = problem.place(name)
                found.append(
                    Target(name, value)
                    if place is None
                    else HeldTarget(name, value, place, settings, high - low)
                )
            else:
                known = ", ".join([problem.parameter, *measures])
                msg = f"no '{name}' to want values of; there are: {known}"
                raise UsageError(msg)
    return found
