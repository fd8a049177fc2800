"""One ride of the vehicle: exact time history, exact roots, and the orbit at that speed."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from racs_bif import all_equilibria, continue_orbits, load_model, simulate, spectrum
from racs_bif.continuation.settings import StepSettings
from racs_bif.orbits.balance_settings import BalanceSettings

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from racs_bif.fractional.system import System
    from racs_bif.results.branch import Branch, Profile
    from racs_bif.results.history import TimeHistory

    Complexes = NDArray[np.complex128]

STEP: Final = 0.005
START: Final = {"delta_c": 0.01}
"""Small disturbance that every simulation begins with [rad]."""
_STEPS: Final = StepSettings(maximum=0.05, tolerance=1e-8, location=1e-7)


@dataclass(frozen=True, eq=False)
class Ride:
    """What is known of the vehicle under one condition.

    Parameters
    ----------
    system : System
        The vehicle.
    history : TimeHistory
        Of the exact operator, from a small disturbance at rest.
    rest : dict of str to float
        The equilibrium near straight running.
    roots : complex array
        Its exact characteristic roots right of Re s = -3, the rightmost first.
    orbit : Profile, optional
        The exact orbit, where its branch reaches the condition.
    period : float
        Its period [s]; NaN where there is none.
    multipliers : complex array
        Its multipliers; empty where there is none.
    orbit_stable : bool
        Whether it is stable; False where there is none.
    others : tuple of (mapping of str to float, bool)
        Further equilibria and whether they are stable; empty where none were looked for.
    """

    system: System
    history: TimeHistory
    rest: Mapping[str, float]
    roots: Complexes
    orbit: Profile | None
    period: float
    multipliers: Complexes
    orbit_stable: bool
    others: tuple[tuple[Mapping[str, float], bool], ...] = ()

    @property
    def stable(self) -> bool:
        """Whether straight running is."""
        return not len(self.roots) or bool(self.roots[0].real < 0.0)

    def orbit_range(self, name: str) -> tuple[float, float]:
        """Return least and greatest value of a state on the orbit, NaN where there is none."""
        if self.orbit is None:
            return float("nan"), float("nan")
        column = self.orbit.states[:, self.orbit.names.index(name)]
        return float(column.min()), float(column.max())


class _Orbit(NamedTuple):
    profile: Profile | None
    period: float
    multipliers: Complexes
    stable: bool


_NONE: Final = _Orbit(None, float("nan"), np.empty(0, dtype=complex), stable=False)


def ride(
    values: Mapping[str, float],
    *,
    duration: float = 20.0,
    parameter: str = "u",
    span: tuple[float, float] | None = (5.0, 25.0),
    step: float = STEP,
    points: int = 120,
) -> Ride:
    """Simulate the vehicle, and find its roots and its orbit.

    Parameters
    ----------
    values : mapping of str to float
        The condition.
    duration : float
        Of the simulation [s].
    parameter, span
        Along what the orbit is looked for, from Hopf points within; it must hold the condition.
        None looks for no orbit.
    step : float
        Of the simulation [s].
    points : int
        Most orbits of a branch.
    """
    system = load_model("racs", parameters=values)
    found = spectrum(system, above=-3.0)
    found_orbit = _NONE
    others: tuple[tuple[Mapping[str, float], bool], ...] = ()
    if span is not None:
        value = system.parameters[parameter]
        diagram = all_equilibria(system, parameter, span, at=(value,))
        others = tuple(
            (point.state, bool(branch.stable[point.index]))
            for branch in diagram.branches[1:]
            for point in branch.special
            if point.label == "UZ"
        )
        found_orbit = _orbit(diagram.branches[0], value, points)
    return Ride(
        system=system,
        history=simulate(system, duration, method="fast", initial=START, step=step),
        rest=found.state,
        roots=found.roots.roots,
        orbit=found_orbit.profile,
        period=found_orbit.period,
        multipliers=found_orbit.multipliers,
        orbit_stable=found_orbit.stable,
        others=others,
    )


def _orbit(branch: Branch, value: float, points: int) -> _Orbit:
    """Return the exact orbit, its period and its multipliers, if a branch leads there."""
    for hopf in (p for p in branch.special if p.label == "H"):
        born = hopf.parameters[branch.parameters[0]]
        margin = 0.05 * abs(value - born)
        orbits = continue_orbits(
            hopf,
            (min(value, born) - margin, max(value, born) + margin),
            method="harmonic-balance",
            at=(value,),
            settings=replace(_STEPS, points=points),
            orbit_settings=BalanceSettings(tail=1e-6, multipliers=1e-5, longest=6.0),
        )
        for point in orbits.special:
            if point.label == "UZ":
                found = orbits.spectrum[point.index]
                return _Orbit(
                    orbits.profiles[point.name],
                    point.period,
                    found[np.isfinite(found)],
                    bool(orbits.stable[point.index]),
                )
    return _NONE
