"""Normal form of a Neimark-Sacker bifurcation of cycles (NS)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.errors import ConvergenceError
from racs_bif.orbits.critical_mode import Coefficient, CriticalForm, Mode, unit
from racs_bif.orbits.twisted_solver import Twisted, nearer

if TYPE_CHECKING:
    from racs_bif.orbits.variational import Variational

_ITERATIONS: Final = 8
_SETTLED: Final = 1e-12
"""Change of the angle at which it is found."""
_RESONANT: Final = 1e-3
"""Distance of the multiplier from a first to fourth root of 1 at which the form is another."""


class TorusForm(CriticalForm):
    """tau' = 1 + a |xi|^2, xi' = i omega xi + d xi |xi|^2, with integral_0^T |v|^2 dt = 1.

    With w = v exp(i omega t), that is w(T) = exp(i theta) w(0), theta = omega T, and H20 likewise:
    ``w' = A w``; ``H20' = A H20 + B(w, w)``, H20(T) = exp(2 i theta) H20(0);
    ``h11' = A h11 + B(w, conj w) - a u'``, h11(T) = h11(0);
    ``2 d = <w*, C(w, w, conj w) + 2 B(w, h11) + B(conj w, H20) - 2 a A w> + 2 i a omega`` with
    <w*, w> = 1. Re d < 0: the torus is stable where it exists (supercritical). Its radius is
    |xi| = (-sigma / Re d)^(1/2) at the real part sigma [1/time] of the critical exponent; a change
    of the length of v by s changes d by s^2.

    Parameters
    ----------
    own : int
        Number of leading states that count in the length of v.
    angle : float
        theta, nearly; between 0 and pi.
    """

    name = "d"

    def __init__(self, own: int, angle: float) -> None:
        self._own, self._angle = own, angle

    def mode(self, along: Variational, near: Mode | None = None) -> Mode:
        """Return the critical function; see `CriticalForm`."""
        twist = near.twist if near else complex(np.exp(1j * self._angle))
        function = near.function if near else None
        for _ in range(_ITERATIONS):
            solved = nearer(along, twist, function)
            function, exponent = solved.stages[0], -complex(solved.unknowns[0, 0])
            turned = exponent.imag * along.period
            if abs(turned) < _SETTLED:
                break
            twist *= complex(np.exp(1j * turned))
        found, length = unit(along, solved.stages[0], self._own)
        return Mode(found, solved.starts[0] / length, exponent, twist)

    def coefficient(self, along: Variational, mode: Mode) -> Coefficient:
        """Return d; see `CriticalForm`.

        Raises
        ------
        ConvergenceError
            Also at a strong resonance, where the normal form is another one.
        """
        for order in range(1, 5):
            if abs(mode.twist**order - 1.0) < _RESONANT:
                raise ConvergenceError(f"the multiplier is at the strong resonance 1:{order}")
        w, rates = mode.function, along.rates
        back = np.conj(w)
        static = Twisted(along, 1.0, (rates,), (rates,)).solve((along.second(w, back).real,))
        h11, a = static.stages[0], -float(static.unknowns[0, 0])
        h20 = Twisted(along, mode.twist**2).solve((along.second(w, w),)).stages[0]
        terms = (
            0.5 * along.third(w, w, back),
            along.second(w, h11),
            0.5 * along.second(back, h20),
            -a * along.times(w),
        )
        projected = Twisted(along, mode.twist, (w,), (w,)).solve(terms)
        omega = float(np.angle(mode.twist)) / along.period
        return Coefficient.of(np.append(-projected.unknowns[0], 1j * a * omega))
