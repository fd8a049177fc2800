"""Parameters that are functions of time."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import ParameterError, UsageError

if TYPE_CHECKING:
    from racs_bif.fractional.system import System
    from racs_bif.symbolic.field import Array

Signal = Callable[[float], float] | Mapping[float, float]
"""A smooth function of time, or the values it takes from given times on."""
_FINEST = 10_000


@dataclass(frozen=True)
class Inputs:
    """Base parameters as functions of time; before t = 0 they are the system's own.

    A signal is a callable, smooth for t >= 0, or a mapping of times to values: from each time on
    the parameter has that value. A signal that jumps while it moves is a callable whose jumps are
    named.

    Parameters
    ----------
    system : System
        Whose parameters.
    signals : mapping of str to callable or mapping
        By the name of the parameter, base or derived.
    jumps : tuple of float
        Further times at which callables jump; there they are continuous from the right.
    duration : float
        How long they are wanted [s].

    Raises
    ------
    ParameterError
        If a parameter is unknown, a value is not usable, or a law of the model depends on it.
    UsageError
        If a time is negative or not finite.
    """

    system: System
    signals: Mapping[str, Signal]
    duration: float
    jumps: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        """Check names, times and values."""
        for time in self._all_times():
            if not 0.0 <= time < math.inf:
                msg = f"an input cannot change at t = {time:g} s; give times from 0 on"
                raise UsageError(msg)
        base = self.system
        for name, signal in self.signals.items():
            known = isinstance(signal, Mapping)
            values = list(signal.values()) if known else [_call(name, signal, 0.0)]  # type: ignore[union-attr,arg-type]
            for value in values:
                moved = base.with_parameters({name: float(value)})
                self._check_laws(name, moved)

    def _check_laws(self, name: str, moved: System) -> None:
        laws = self.system.exact.laws(self.system.values)
        for law, other in zip(laws, moved.exact.laws(moved.values), strict=True):
            pairs = (law.numerator, other.numerator), (law.denominator, other.denominator)
            for one, two in pairs:
                if not (
                    np.array_equal(one.coefficients, two.coefficients)
                    and np.array_equal(one.exponents, two.exponents)
                ):
                    msg = (
                        f"'{name}' is in the law of '{law.name}', which cannot change with time; "
                        "use it outside the law, or keep it constant"
                    )
                    raise ParameterError(msg)

    def _all_times(self) -> list[float]:
        tables = [s for s in self.signals.values() if isinstance(s, Mapping)]
        return [*self.jumps, *(float(t) for table in tables for t in table)]

    @property
    def names(self) -> tuple[str, ...]:
        """The parameters that move."""
        return tuple(self.signals)

    @property
    def constant(self) -> bool:
        """Whether parameters are constant between jumps."""
        return all(isinstance(s, Mapping) for s in self.signals.values())

    @property
    def jump_times(self) -> tuple[float, ...]:
        """Times of jumps within the duration, ascending, t = 0 left out."""
        return tuple(sorted({t for t in self._all_times() if 0.0 < t < self.duration}))

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
            share = time / self.duration
            fraction = Fraction(share).limit_denominator(_FINEST)
            whole = math.lcm(whole, fraction.denominator)
            if abs(float(fraction) - share) > 1e-12 or whole > _FINEST:
                msg = (
                    f"no step fits both the duration {self.duration:g} s and the jump at "
                    f"{time:g} s; choose a duration that is a multiple of some step up to the jump"
                )
                raise UsageError(msg)
        return whole

    def values(self, t: float, *, before: bool = False) -> Array:
        """Return the base parameters (np,) at a time.

        Parameters
        ----------
        t : float
            Time, t >= 0.
        before : bool
            Whether, at a jump, the values just before it are meant; before t = 0 the model's own.
        """
        if not self.signals or (before and t <= 0.0):
            return self.system.values
        wanted = [_at(name, signal, t, before=before) for name, signal in self.signals.items()]
        rest = [v if v is not None else self.system.parameters[n] for n, v in wanted_pairs(self.names, wanted)]
        return self.system.path(*self.names).vector(rest)


def wanted_pairs(
    names: tuple[str, ...], wanted: list[float | None]
) -> list[tuple[str, float | None]]:
    return list(zip(names, wanted, strict=True))
