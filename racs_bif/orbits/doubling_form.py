"""Normal form of a period doubling of cycles (PD)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from racs_bif.orbits.critical_mode import Coefficient, CriticalForm, Mode, unit
from racs_bif.orbits.twisted_solver import Twisted, kernel

if TYPE_CHECKING:
    from racs_bif.orbits.variational import Variational


class DoublingForm(CriticalForm):
    """tau' = 1 + a xi^2, xi' = c xi^3, with v(T) = -v(0) and integral_0^T |v|^2 dt = 1.

    ``v' = A v``; ``h' = A h + B(v, v) - 2 a u'``, h(T) = h(0);
    ``6 c = <v*, C(v, v, v) + 3 B(v, h) - 6 a A v>`` with <v*, v> = 1. c < 0: the doubled orbit is
    stable where it exists (supercritical). Its period-2T points are xi = +-(-sigma / c)^(1/2) at
    the critical exponent sigma [1/time]; a change of the length of v by s changes c by s^2.

    Parameters
    ----------
    own : int
        Number of leading states that count in the length of v.
    """

    name = "c"

    def __init__(self, own: int) -> None:
        self._own = own

    def mode(self, along: Variational, near: Mode | None = None) -> Mode:
        """Return the critical function; see `CriticalForm`."""
        solved = kernel(along, -1.0, near.function if near else None)
        found, length = unit(along, solved.stages[0], self._own)
        return Mode(found, solved.starts[0] / length, -float(solved.unknowns[0, 0]), -1.0)

    def coefficient(self, along: Variational, mode: Mode) -> Coefficient:
        """Return c; see `CriticalForm`."""
        v, rates = mode.function, along.rates
        solved = Twisted(along, 1.0, (rates,), (rates,)).solve((along.second(v, v),))
        h, a = solved.stages[0], -0.5 * solved.unknowns[0, 0]
        terms = along.third(v, v, v), 3.0 * along.second(v, h), -6.0 * a * along.times(v)
        projected = Twisted(along, -1.0, (v,), (v,)).solve(terms)
        return Coefficient.of(-projected.unknowns[0] / 6.0)
