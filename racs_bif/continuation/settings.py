"""Settings of the step control."""

from __future__ import annotations

import math
from dataclasses import dataclass

from racs_bif.errors import UsageError


@dataclass(frozen=True, kw_only=True)
class StepSettings:
    """How a branch is stepped along; every length is relative, so that it suits every problem.

    Lengths are measured in the scaled norm of `racs_bif.continuation.scaling`: the whole span of
    the parameter counts 1, and so does a change of an unknown by its own typical magnitude.

    Parameters
    ----------
    initial : float
        First step.
    minimum : float
        Smallest step; where it fails the branch ends.
    maximum : float
        Largest step, in the parameter and in each unknown.
    angle : float
        Largest angle between successive tangents, rad.
    tolerance : float
        Newton's method ends when its correction is this small.
    iterations : int
        Most Newton iterations of a step.
    points : int
        Most points of a branch, in each direction.
    location : float
        Events are located to this length along the branch.

    Raises
    ------
    UsageError
        If a setting is out of its range.
    """

    initial: float = 1e-2
    minimum: float = 1e-8
    maximum: float = 1 / 30
    angle: float = 0.3
    tolerance: float = 1e-9
    iterations: int = 8
    points: int = 2000
    location: float = 1e-11

    def __post_init__(self) -> None:
        for name in ("initial", "minimum", "maximum", "angle", "tolerance", "location"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0):
                msg = f"step setting '{name}' must be a positive number, not {value!r}"
                raise UsageError(msg)
        if not self.minimum <= self.initial <= self.maximum:
            msg = "step settings must obey minimum <= initial <= maximum"
            raise UsageError(msg)
        if self.angle >= math.pi / 2:
            msg = f"step setting 'angle' must be below pi/2, not {self.angle!r}"
            raise UsageError(msg)
        for name in ("iterations", "points"):
            if getattr(self, name) < 1:
                msg = f"step setting '{name}' must be at least 1, not {getattr(self, name)!r}"
                raise UsageError(msg)
