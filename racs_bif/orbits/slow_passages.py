"""The saddles that an orbit passes slowly."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from racs_bif.orbits.problem import OrbitProblem
    from racs_bif.symbolic.field import Array

_SAMPLES: Final = 2001
_SLOW: Final = 0.1
"""Largest speed, over the mean of the orbit's, of a slow passage."""
_ITERATIONS: Final = 30
_SOLVED: Final = 1e-11
_SAME: Final = 1e-6
_BESIDE: Final = 0.25
"""How far, relative to the orbit, its saddle may be from a slow passage."""


@dataclass(frozen=True, eq=False)
class Saddle:
    """A saddle and how an orbit passes it.

    Attributes
    ----------
    state : array (n,)
        The equilibrium.
    eigenvalues : complex array (n,)
        Its eigenvalues by falling real part.
    distance : float
        Least distance of the orbit from it, each state over its range on the orbit.
    """

    state: Array
    eigenvalues: NDArray[np.complex128]
    distance: float

    @property
    def leading(self) -> tuple[complex, complex]:
        """The leading eigenvalues: the unstable and the stable one nearest to the imaginary axis.

        Of a pair the one with positive imaginary part.
        """
        right = self.eigenvalues[self.eigenvalues.real > 0.0]
        left = self.eigenvalues[self.eigenvalues.real < 0.0]
        slow = (min(right, key=_order), max(left, key=lambda value: (value.real, value.imag)))
        return complex(slow[0]), complex(slow[1])

    @property
    def quantity(self) -> float:
        """Saddle quantity: the sum of the real parts of the leading eigenvalues."""
        return sum(value.real for value in self.leading)

    @property
    def slowest(self) -> float:
        """The smaller of the two rates."""
        return min(abs(value.real) for value in self.leading)

    @property
    def growth(self) -> float:
        """How much longer an orbit takes when it comes e times closer."""
        return sum(1.0 / abs(value.real) for value in self.leading)


def saddles_of(problem: OrbitProblem, z: Array, own: int) -> tuple[Saddle, ...]:
    """Return the saddles near which an orbit is slow, each once, in the order of time.

    Parameters
    ----------
    problem : OrbitProblem
        The problem.
    z : array
        The orbit.
    own : int
        Number of the model's own states: distances are measured in these.
    """
    field, p = problem.field, problem.base(z)
    states = problem.sample(z, np.linspace(0.0, 1.0, _SAMPLES)[:-1])
    ranges = np.maximum(np.ptp(states, axis=1), 1e-4 * np.abs(states).max() + 1e-300)[:own, None]
    speeds = np.linalg.norm(field.f(states, p)[:own] / ranges, axis=0)
    dips = (speeds <= np.roll(speeds, 1)) & (speeds < np.roll(speeds, -1))
    dips &= speeds < _SLOW * speeds.mean()
    found: list[Saddle] = []
    for place in np.flatnonzero(dips):
        state = _equilibrium(problem, states[:, place], p)
        if state is None:
            continue
        away = np.linalg.norm((states[:own] - state[:own, None]) / ranges, axis=0)
        if away[place] > _BESIDE or _is_known(state, found):
            continue
        values = np.asarray(np.linalg.eigvals(field.f_x(state, p)), dtype=complex)
        values = values[np.argsort(-values.real)]
        if values[0].real > 0.0 > values[-1].real:
            found.append(Saddle(state, values, _nearest(problem, z, state, ranges[:, 0], own)))
    return tuple(found)


def _nearest(problem: OrbitProblem, z: Array, state: Array, ranges: Array, own: int) -> float:
    """Return the least distance of an orbit from a point, found on ever finer samples."""
    low, high = 0.0, 1.0
    least = np.inf
    for _ in range(3):
        fractions = np.linspace(low, high, _SAMPLES)
        states = problem.sample(z, np.clip(fractions % 1.0, 0.0, 1.0))[:own]
        away = np.linalg.norm((states - state[:own, None]) / ranges[:, None], axis=0)
        place = int(np.argmin(away))
        least = min(least, float(away[place]))
        reach = 2.0 * (high - low) / _SAMPLES
        low, high = fractions[place] - reach, fractions[place] + reach
    return least


def _equilibrium(problem: OrbitProblem, x: Array, p: Array) -> Array | None:
    """Return the equilibrium near a point by Newton's method; None where that finds none."""
    field, state = problem.field, np.array(x)
    size = np.abs(x).max() + 1e-300
    for _ in range(_ITERATIONS):
        try:
            step = np.linalg.solve(field.f_x(state, p), field.f(state, p))
        except np.linalg.LinAlgError:
            return None
        state = state - step
        if not np.all(np.isfinite(state)):
            return None
        if float(np.abs(step).max()) < _SOLVED * size:
            return state
    return None


def _is_known(state: Array, found: list[Saddle]) -> bool:
    return any(
        float(np.abs(state - other.state).max()) < _SAME * (1.0 + np.abs(state).max())
        for other in found
    )


def _order(value: complex) -> tuple[float, float]:
    return value.real, -value.imag
