"""Settings of orthogonal collocation."""

from __future__ import annotations

import math
from dataclasses import dataclass

from racs_bif.errors import UsageError


@dataclass(frozen=True, kw_only=True)
class CollocationSettings:
    """How finely an orbit is collocated, and when its branch ends.

    Parameters
    ----------
    intervals : int
        Mesh intervals of the first mesh (NTST), and the fewest; adaptation takes more where the
        error asks for it.
    degree : int
        Degree of the polynomials and number of collocation points of an interval (NCOL), 2 to 7.
    most_intervals : int
        Most intervals that adaptation may take.
    tolerance : float
        Error of the polynomials that the mesh is adapted to, relative to the range of each state.
        The mesh points, and with them period and multipliers, are far more accurate: there the
        error falls with the power 2 NCOL of the width, not NCOL + 1.
    longest : float
        Longest period, relative to the first one of the branch: beyond it the branch ends as
        approaching a homoclinic orbit.
    smallest : float
        Smallest range of the states, relative to the largest on the branch: below it, and
        shrinking, the orbit has collapsed onto an equilibrium.
    trivial : float
        Largest error of the trivial multiplier (`Floquet.health`): beyond it the mesh is refined,
        and the branch ends where that does not help.

    Raises
    ------
    UsageError
        If a setting is out of its range.
    """

    intervals: int = 40
    degree: int = 4
    most_intervals: int = 400
    tolerance: float = 1e-6
    longest: float = 300.0
    smallest: float = 1e-3
    trivial: float = 1e-3

    def __post_init__(self) -> None:
        for name in ("tolerance", "longest", "smallest", "trivial"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise UsageError(
                    f"collocation setting '{name}' must be a positive number, not {value!r}"
                )
        if not 2 <= self.degree <= 7:
            raise UsageError(
                f"collocation setting 'degree' must be from 2 to 7, not {self.degree!r}"
            )
        if not 4 <= self.intervals <= self.most_intervals:
            raise UsageError("collocation settings must obey 4 <= intervals <= most_intervals")
