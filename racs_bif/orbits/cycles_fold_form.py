"""Normal form of a fold of cycles (LPC)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.errors import ConvergenceError
from racs_bif.orbits.critical_mode import Coefficient, CriticalForm, Mode
from racs_bif.orbits.twisted_solver import Twisted

if TYPE_CHECKING:
    from racs_bif.orbits.variational import Variational

_ITERATIONS: Final = 6
_SETTLED: Final = 1e-6
"""Relative change of the growth at which it is found; that over T is no growth at all."""
_FLAT: Final = 1e-8
"""Relative change of the period along the branch, over that of the orbit, that counts as none."""


class FoldForm(CriticalForm):
    """tau' = 1 - xi + a xi^2, xi' = b xi^2, with v' = A v + u', v(T) = v(0), <u', v> = 0.

    ``2 b = <p, B(v, v) + 2 A v>`` with p the adjoint null function and <p, v> = 1. The coordinate
    xi is measured by the period, which is T (1 + xi + ...) along the branch: b [1/time] depends on
    no length, and is what MatCont prints. b != 0 at a fold; b = 0 is a cusp of cycles (CPC).

    Where the period does not change along the branch to first order (a rotation of constant speed,
    for instance) there is no such coordinate and no b.
    """

    name = "b"

    def mode(self, along: Variational, near: Mode | None = None) -> Mode:
        """Return the critical function, in which the period grows by itself; see `CriticalForm`."""
        rates, found = along.rates, near.function if near else along.noise(1)
        zero, one = np.zeros((1, *along.shape)), np.array([[0.0], [1.0]])
        growth = np.inf
        for _ in range(_ITERATIONS):
            solved = Twisted(along, 1.0, (rates, found), (rates, found)).solve(zero, one)
            length = along.size(solved.stages[0])
            found, starts = solved.stages[0] / length, solved.starts[0] / length
            before, (stretch, growth) = growth, solved.unknowns[:, 0] / length
            if abs(growth - before) <= _SETTLED * max(abs(growth), _SETTLED / along.period):
                break
        if abs(stretch) * along.period * along.size(rates) < _FLAT:
            raise ConvergenceError(
                "the period does not change along the branch to first order, so that the normal "
                "form has no coordinate"
            )
        return Mode(found / stretch, starts / stretch, -float(growth), 1.0)

    def coefficient(self, along: Variational, mode: Mode) -> Coefficient:
        """Return b; see `CriticalForm`."""
        v, rates = mode.function, along.rates
        terms = 0.5 * along.second(v, v), along.times(v)
        projected = Twisted(along, 1.0, (rates, v), (rates, v)).solve(terms)
        return Coefficient.of(-projected.unknowns[1])
