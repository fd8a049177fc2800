"""Whether two orbits are the same but for where they begin."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from racs_bif.orbits.problem import OrbitProblem
    from racs_bif.symbolic.field import Array

SAME: Final = 1e-4
"""Distance below which two orbits are the same: above what two meshes make of one orbit."""
_SAMPLES: Final = 256
_ROUNDS: Final = 4
_STILL: Final = 1e-4
"""States that move less than this share of the others are compared on the others' scale of it."""


@dataclass(frozen=True, eq=False)
class Loop:
    """An orbit as a function of the fraction of its period.

    Attributes
    ----------
    period : float
        The period.
    sample : callable
        Maps fractions (m,) between 0 and 1 to states (n, m).
    """

    period: float
    sample: Callable[[Array], Array]


def loop_of(problem: OrbitProblem, z: Array, own: int) -> Loop:
    """Return an orbit of a problem; only its first `own` states count."""
    held = np.array(z)
    return Loop(problem.period(held), lambda fractions: problem.sample(held, fractions)[:own])


def loop_through(times: Array, profile: Array) -> Loop:
    """Return an orbit through samples: times (m,) over one period, states (n, m)."""
    from scipy.interpolate import CubicSpline

    period = float(times[-1] - times[0])
    closed = np.array(profile)
    closed[:, -1] = closed[:, 0]
    spline = CubicSpline((times - times[0]) / period, closed, axis=1, bc_type="periodic")
    return Loop(period, lambda fractions: np.asarray(spline(fractions)))


def distance(one: Loop, other: Loop) -> float:
    """Return how far apart two orbits are.

    The greatest of the root mean square differences of the states, each over its range, once the
    other orbit is shifted in time so that they are closest, and of the periods, relative.

    Parameters
    ----------
    one, other : Loop
        The orbits.
    """
    fractions = np.arange(_SAMPLES) / _SAMPLES
    here = one.sample(fractions)
    ranges = np.ptp(here, axis=1)
    scales = np.maximum(ranges, _STILL * max(float(ranges.max()), float(np.abs(here).max())))
    scales = (scales + np.finfo(float).tiny)[:, None]
    first = np.fft.rfft(here / scales, axis=1)
    second = np.fft.rfft(other.sample(fractions) / scales, axis=1)
    together = np.fft.irfft((first * second.conj()).sum(axis=0), _SAMPLES)
    # the other at fraction t - best / N is the one at t
    shift = -float(np.argmax(together)) / _SAMPLES
    turning = 2j * np.pi * np.arange(first.shape[1])
    difference = here / scales
    for _ in range(_ROUNDS):
        there = other.sample((fractions + shift) % 1.0) / scales
        speeds = np.fft.irfft(turning * np.fft.rfft(there, axis=1), _SAMPLES, axis=1)
        difference = here / scales - there
        steepness = float(np.sum(speeds**2))
        if steepness == 0.0:
            break
        shift += float(np.sum(difference * speeds)) / steepness
    apart = float(np.sqrt(np.mean(difference**2, axis=1)).max())
    return max(apart, abs(one.period - other.period) / max(one.period, other.period))
