"""Settings of periodic orbits."""

from __future__ import annotations

import math
from dataclasses import dataclass

from racs_bif.errors import UsageError


@dataclass(frozen=True, kw_only=True)
class OrbitSettings:
    """How an orbit is resolved, and when its branch ends.

    Parameters
    ----------
    steps : int
        Steps of the first mesh; adaptation takes more where the error asks for it.
    most_steps : int
        Most steps that adaptation may take.
    segments : int
        Fewest segments of multiple shooting; 1 is single shooting. The default of 8 integrates
        eight segments side by side, where evaluating f is vectorised well and the condensed system
        is still cheap (measured for n = 12 and 28: 4 to 16 differ by less than a quarter).
    growth : float
        Largest norm of a segment's transition matrix, in units of the states' ranges; above it the
        segments are halved.
    tolerance : float
        Error of the dense output that the mesh is adapted to, relative to the range of each state.
        The ends of the steps, and with them period and multipliers, are an order more accurate.
    longest : float
        Longest period, relative to the first one of the branch: beyond it the branch ends as
        approaching a homoclinic orbit.
    smallest : float
        Smallest range of the states, relative to the largest on the branch: below it, and
        shrinking, the orbit has collapsed onto an equilibrium.
    trivial : float
        Largest error of the trivial multiplier (`Floquet.health`, which allows for its splitting at
        folds): beyond it the mesh is refined, and the branch ends where that does not help.

    Raises
    ------
    UsageError
        If a setting is out of its range.
    """

    steps: int = 64
    most_steps: int = 1024
    segments: int = 8
    growth: float = 1e4
    tolerance: float = 2e-6
    longest: float = 300.0
    smallest: float = 1e-3
    trivial: float = 1e-3

    def __post_init__(self) -> None:
        for name in ("growth", "tolerance", "longest", "smallest", "trivial"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise UsageError(f"orbit setting '{name}' must be a positive number, not {value!r}")
        if self.segments < 1:
            raise UsageError(f"orbit setting 'segments' must be at least 1, not {self.segments!r}")
        if not self.segments <= self.steps <= self.most_steps:
            raise UsageError("orbit settings must obey segments <= steps <= most_steps")
        if self.growth <= 1.0:
            raise UsageError(f"orbit setting 'growth' must be above 1, not {self.growth!r}")
