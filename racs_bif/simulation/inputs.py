"""Parameters that are functions of time."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import ParameterError, UsageError

if TYPE_CHECKING:
    from racs_bif.fractional.laws import Law
    from racs_bif.fractional.system import System
    from racs_bif.symbolic.field import Array

Signal = Callable[[float], float] | Mapping[float, float]
"""A function of time, or the values a parameter takes from given times on."""
_FINEST = 10_000


@dataclass(frozen=True, kw_only=True)
class Inputs:
    """Base parameters as functions of time; before t = 0 they are the system's own.

    Parameters
    ----------
    system : System
        Whose parameters.
    duration : float
        How long they are wanted [s].
    signals : mapping of str to callable or mapping
        By the name of a parameter, base or derived: a callable that is smooth for t >= 0, or a
        mapping of times to the values that the parameter takes from then on.
    jumps : sequence of float
        Times at which callables jump all the same; there they are continuous from the right.

    Raises
    ------
    ParameterError
        If a parameter is unknown, a value is not usable, or a law of the model depends on it.
    UsageError
        If a time is negative or not finite.
    """

    system: System
    duration: float
    signals: Mapping[str, Signal] = field(default_factory=dict)
    jumps: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        """Check names, times and values."""
        for time in self._all_jumps():
            if not 0.0 <= time < math.inf:
                msg = f"an input cannot change at t = {time:g} s; give times from 0 on"
                raise UsageError(msg)
        laws = self.system.exact.laws(self.system.values)
        for name, signal in self.signals.items():
            given: object = signal
            if not (callable(given) or isinstance(given, Mapping)):
                msg = (
                    f"the input '{name}' is {given!r}; give a function of time, or a dict of the "
                    f"times it jumps at, such as {{0.0: {given!r}}}"
                )
                raise UsageError(msg)
            values = signal.values() if isinstance(signal, Mapping) else [signal(0.0)]
            for value in values:
                moved = self.system.with_parameters({name: float(value)})
                if not all(map(_same, laws, moved.exact.laws(moved.values))):
                    msg = (
                        f"a law of the model depends on '{name}', which therefore cannot change "
                        "with time; keep it constant"
                    )
                    raise ParameterError(msg)

    def _all_jumps(self) -> list[float]:
        tables = [s for s in self.signals.values() if isinstance(s, Mapping)]
        return [*map(float, self.jumps), *(float(t) for table in tables for t in table)]

    @property
    def constant(self) -> bool:
        """Whether parameters are constant between jumps."""
        return all(isinstance(s, Mapping) for s in self.signals.values())

    @property
    def jump_times(self) -> tuple[float, ...]:
        """Times of jumps within the duration, ascending, t = 0 left out."""
        return tuple(sorted({t for t in self._all_jumps() if 0.0 < t < self.duration}))

    @property
    def divisor(self) -> int:
        """Of what the number of steps must be a multiple so that jumps fall between steps.

        Raises
        ------
        UsageError
            If there is no such number.
        """
        whole = 1
        for time in self.jump_times:
            share = Fraction(time / self.duration).limit_denominator(_FINEST)
            whole = math.lcm(whole, share.denominator)
            if abs(float(share) * self.duration - time) > 1e-9 * time or whole > _FINEST:
                msg = (
                    f"no step divides both the duration {self.duration:g} s and the time "
                    f"{time:g} s of a jump; choose round numbers"
                )
                raise UsageError(msg)
        return whole

    def times(self, count: int) -> Array:
        """Return count + 1 equidistant times, jumps exactly where they are."""
        times = np.linspace(0.0, self.duration, count + 1)
        for jump in self.jump_times:
            times[round(jump / self.duration * count)] = jump
        return times

    def values(self, t: float, *, before: bool = False) -> Array:
        """Return the base parameters (np,) at a time.

        Parameters
        ----------
        t : float
            Time, t >= 0.
        before : bool
            Whether, at a jump, the values just before it are meant; at t = 0 the system's own.
        """
        if not self.signals or (before and t <= 0.0):
            return self.system.values
        names = tuple(self.signals)
        wanted = [self._value(name, t, before=before) for name in names]
        return self.system.path(*names).vector(wanted)

    def column(self, name: str, times: Array) -> Array:
        """Return a parameter that moves, at times (nt,); just before it where it jumps."""
        return np.array([self._value(name, float(t), before=bool(t > 0.0)) for t in times])

    def _value(self, name: str, t: float, *, before: bool) -> float:
        signal = self.signals[name]
        if not isinstance(signal, Mapping):
            return float(signal(math.nextafter(t, -math.inf) if before and t in self.jumps else t))
        past = [time for time in signal if time < t or (time == t and not before)]
        return float(signal[max(past)]) if past else self.system.parameters[name]


def _same(one: Law, other: Law) -> bool:
    pairs = (one.numerator, other.numerator), (one.denominator, other.denominator)
    return all(
        np.array_equal(a.coefficients, b.coefficients) and np.array_equal(a.exponents, b.exponents)
        for a, b in pairs
    )
