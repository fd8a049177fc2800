"""What simulations settle on along a parameter, by Lyapunov exponents and Poincare sections."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif import load_model
from racs_bif.simulation.attractors import FAILED, SETTLED, periods
from racs_bif.simulation.batch import BatchSettings, initial, members
from racs_bif.simulation.batch_field import BatchField
from racs_bif.simulation.batch_lyapunov import largest_exponents
from racs_bif.simulation.poincare import poincare_section
from racs_bif.verbs.simulate_batch import simulate_batch

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from racs_bif.symbolic.field import Array

BAND: Final = (0.01, 50.0)
TOLERANCE: Final = 1e-5
START: Final = (0.0, 0.0, 0.01, 0.0)
"""v, w, delta_c, ddelta_c at t = 0."""
_RATE: Final = 50.0
_STILL: Final = 3.0
"""Longer than the periods of all that moves [s]."""
_SURE: Final = 3.0
"""Standard errors that a positive exponent must be away from zero."""


@dataclass(frozen=True, eq=False)
class Family:
    """Members along a parameter.

    Parameters
    ----------
    parameter : str
        Its name.
    values : array (N,)
        Its values.
    exponent, error : array (N,)
        Largest Lyapunov exponent and its standard error [1/s].
    repeats : array (N,)
        After how many crossings of the section the motion repeats: 0 at rest, infinite if it does
        not, NaN where that is not certain.
    side : array (N,)
        Sign of delta_c at the end of those at rest, otherwise 0.
    kinds : tuple of str
        The verdicts: ``rest``, ``periodic``, ``chaos``, ``undecided``.
    """

    parameter: str
    values: Array
    exponent: Array
    error: Array
    repeats: Array
    side: Array
    kinds: tuple[str, ...]

    @property
    def doubtful(self) -> int:
        """How many are undecided although their exponent is positive."""
        positive = self.exponent > _SURE * self.error
        pairs = zip(self.kinds, positive, strict=True)
        return sum(kind == "undecided" and bool(above) for kind, above in pairs)

    def count(self, kind: str) -> int:
        """Return how many are of a kind."""
        return sum(each == kind for each in self.kinds)


def family(
    values: Mapping[str, float],
    parameter: str,
    along: Array,
    duration: float,
    progress: Callable[[float], None] | None = None,
) -> Family:
    """Decide what the vehicle settles on at many values of a parameter.

    Parameters
    ----------
    values : mapping of str to float
        Its other parameters.
    parameter, along
        What is varied, (N,).
    duration : float
        Of every simulation; exponents and sections are taken from its second half [s].
    progress : callable, optional
        Told the share that is done.
    """
    system = load_model("racs", parameters=values, band=BAND)
    field = BatchField(system, members(system, {parameter: along}))
    x = initial(field, np.tile(START, (len(along), 1)))
    tell = progress or (lambda _share: None)
    grown = largest_exponents(
        field, x, duration, TOLERANCE, progress=lambda t: tell(0.7 * t / duration)
    )
    row = system.states.index("delta_c")
    seen = periods(
        field, x, duration, row, TOLERANCE, progress=lambda t: tell(0.7 + 0.2 * t / duration)
    )
    ends = simulate_batch(
        system,
        duration,
        values={parameter: along},
        initial={"delta_c": START[row]},
        settings=BatchSettings(
            tolerance=TOLERANCE, estimate=False, after=0.75 * duration, samples=501
        ),
        progress=lambda t: tell(0.9 + 0.1 * t / duration),
    )
    late = ends.column("delta_c")
    # An equilibrium creeps on for as long as the memory reaches, always to one side.
    creeps = (np.abs(np.diff(np.sign(np.diff(late, axis=1)), axis=1)) > 0).sum(axis=1) <= 1
    repeats = np.where(creeps, 0.0, np.where(seen.status == SETTLED, seen.value, np.nan))
    kinds = tuple(
        _kind(float(a), float(b), float(c), failed=bool(d))
        for a, b, c, d in zip(grown.value, grown.error, repeats, seen.status == FAILED, strict=True)
    )
    side = np.where(np.array([k == "rest" for k in kinds]), np.sign(late[:, -1]), 0.0)
    return Family(parameter, along, grown.value, grown.error, repeats, side, kinds)


def _kind(exponent: float, error: float, repeats: float, *, failed: bool) -> str:
    """Return the verdict: both the exponent and the section must say the same."""
    if failed or not np.isfinite(exponent):
        return "undecided"
    positive = exponent > _SURE * error
    if repeats == 0.0:
        return "undecided" if positive else "rest"
    if np.isinf(repeats):
        return "chaos" if positive else "undecided"
    if np.isnan(repeats):
        return "undecided"
    return "undecided" if positive else "periodic"


@dataclass(frozen=True, eq=False)
class Motion:
    """One motion looked at closely.

    Parameters
    ----------
    frequency, power : array (k,)
        Power spectrum of delta_c by Welch's method, relative to its peak [Hz, 1].
    times, angle : array (m,)
        The steering angle [s, rad].
    section : array (j, 2)
        Yaw rate and lateral velocity where delta_c rises through the middle of its range.
    """

    frequency: Array
    power: Array
    times: Array
    angle: Array
    section: Array

    @property
    def rests(self) -> bool:
        """Whether it has come to rest in the last seconds, as motions do that leave chaos."""
        late = self.angle[self.times > self.times[-1] - _STILL]
        return bool(np.ptp(late) < 0.05 * np.ptp(self.angle))


def motion(values: Mapping[str, float], duration: float) -> Motion:
    """Simulate one vehicle and return spectrum and section of its second half.

    Parameters
    ----------
    values : mapping of str to float
        Its parameters.
    duration : float
        [s].
    """
    from scipy.signal import welch

    system = load_model("racs", parameters=values, band=BAND)
    settings = BatchSettings(
        tolerance=TOLERANCE,
        estimate=False,
        after=0.5 * duration,
        samples=int(0.5 * duration * _RATE) + 1,
    )
    done = simulate_batch(system, duration, initial={"delta_c": START[2]}, settings=settings)
    states = done.states[0]
    angle = states[:, done.names.index("delta_c")]
    rate = (len(done.times) - 1) / (done.times[-1] - done.times[0])
    size = max(16, len(angle) // 3)
    frequency, power = welch(angle, fs=rate, nperseg=size, detrend="linear")
    plane = states[:, [done.names.index("w"), done.names.index("v")]]
    middle = 0.5 * (float(angle.max()) + float(angle.min()))
    section = poincare_section(done.times, plane, angle, level=middle)
    relative = power / max(float(power.max()), 1e-300)
    return Motion(frequency, relative, done.times, angle, section.points)
