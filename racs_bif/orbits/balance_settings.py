"""Settings of harmonic balance."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

from racs_bif.errors import UsageError

OPERATORS: Final = ("exact", "realised")


@dataclass(frozen=True, kw_only=True)
class BalanceSettings:
    """How many harmonics an orbit has, how its multipliers are found, and when its branch ends.

    Parameters
    ----------
    operator : str
        "exact", or "realised": the rational operators of the realisation, for comparison with what
        shooting and collocation find on it.
    harmonics : int
        Harmonics at the start, and the fewest; adaptation takes more where the tail asks for it.
    most_harmonics : int
        Most harmonics that adaptation may take. The cost of a point grows with their third power.
    tail : float
        Largest of the last harmonics, relative to the whole orbit, that is let pass. The error of
        an orbit is of this order, that of its period of the order of its square.
    poorest : float
        The tail at which the branch ends, if more harmonics are not allowed.
    multipliers : float
        Error of the orbit per step that the mesh of the variational equation would make, relative
        to the range of each state; the multipliers are an order more accurate.
    trivial : float
        Largest error of the trivial multiplier, times its distance from the nearest other, at which
        the realisation still tells whether an orbit is stable.
    steps, most_steps : int
        Fewest and most steps of that mesh.
    longest : float
        Longest period, relative to the first one of the branch: beyond it the branch ends as
        approaching a homoclinic orbit.
    smallest : float
        Smallest amplitude, relative to the largest on the branch: below it, and shrinking, the
        orbit has collapsed onto an equilibrium.

    Raises
    ------
    UsageError
        If a setting is out of its range.
    """

    operator: str = "exact"
    harmonics: int = 20
    most_harmonics: int = 200
    tail: float = 1e-8
    poorest: float = 1e-5
    multipliers: float = 2e-6
    trivial: float = 1e-2
    steps: int = 64
    most_steps: int = 1024
    longest: float = 300.0
    smallest: float = 1e-3

    def __post_init__(self) -> None:
        if self.operator not in OPERATORS:
            raise UsageError(
                "setting 'operator' of harmonic balance must be "
                f"{' or '.join(map(repr, OPERATORS))}, not {self.operator!r}"
            )
        for name in ("tail", "poorest", "multipliers", "trivial", "longest", "smallest"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise UsageError(
                    f"setting '{name}' of harmonic balance must be a positive number, not {value!r}"
                )
        if not 4 <= self.harmonics <= self.most_harmonics:
            raise UsageError(
                "settings of harmonic balance must obey 4 <= harmonics <= most_harmonics"
            )
        if not 1 <= self.steps <= self.most_steps:
            raise UsageError("settings of harmonic balance must obey 1 <= steps <= most_steps")
