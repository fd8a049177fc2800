"""Matsuda's continued fraction of each power of s, with an exact static gain.

K. Matsuda, H. Fujii, *J. Guidance, Control, and Dynamics* 16 (1993) 1146-1153: Thiele's continued
fraction ``b0 + (s - s0)/(b1 + (s - s1)/(b2 + ...))`` through the moduli |(i omega)**a| at omega =
s0, s1, ..., which are the values of s**a at s > 0. Here s = 0 is one of the points: the static
gain is exact. A power with 0 < a < 1 is a complete Bernstein function, of which such a fraction
has poles and zeros that are real, negative and alternate.

The denominator is evaluated by its three-term recurrence, with its derivatives; poles are polished
on it, and poles and residues differentiated by the implicit function theorem.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.fractional.powers import PowerRealisation, Side
from racs_bif.fractional.residues import checked_rates

if TYPE_CHECKING:
    from racs_bif.symbolic.field import Array


@dataclass(frozen=True, kw_only=True)
class Matsuda(PowerRealisation):
    """Continued fractions through 0 and points spaced over a band, for the powers of a law.

    More than about four sections a decade cannot be told apart in double precision: the poles are
    then refused.
    """

    density = 3.0

    @property
    def name(self) -> str:
        """Name on the command line."""
        return "matsuda"

    def power(self, order: float) -> Side:
        """Return the filter of s**order.

        Raises
        ------
        ParameterError
            If a pole is not real, negative and simple.
        """
        b, b_p = self._fraction(order)
        rates = self._rates(b)
        gains = _residues(*self._at_poles(b, b_p, rates)) / rates
        return Side(-float(gains.sum()), rates, gains)

    def power_slope(self, order: float) -> Side:
        """Return the derivative of `power` by the order."""
        b, b_p = self._fraction(order)
        rates = self._rates(b)
        above, below = self._at_poles(b, b_p, rates)
        residues = _residues(above, below)
        poles_p = -below[3] / below[1]
        residues_p = above[3] + above[1] * poles_p - residues * (below[4] + below[2] * poles_p)
        gains_p = (residues_p / below[1] + residues / rates * poles_p) / rates
        return Side(-float(gains_p.sum()), -poles_p, gains_p)

    @property
    def _points(self) -> Array:
        """Points (2 sections + 1,), the last one 0."""
        # descending: the differences from the first point are then the best conditioned
        return np.append(np.geomspace(*self.band[::-1], 2 * self.sections), 0.0)

    def _fraction(self, order: float) -> tuple[Array, Array]:
        points = self._points
        values = points**order
        slopes = np.append(values[:-1] * np.log(points[:-1]), 0.0)
        return _thiele(points, values, slopes)

    def _at_poles(self, b: Array, b_p: Array, rates: Array) -> tuple[Array, Array]:
        return _recur(b, self._points, -rates, b_p)

    def _rates(self, b: Array) -> Array:
        """Return the rates of the poles, eigenvalues of the fraction's tridiagonal pencil."""
        from scipy.linalg import eigvals

        points, count = self._points, len(b) - 1
        constant = np.diag(b[1:]) - np.diag(points[1:-1], 1) - np.eye(count, k=-1)
        found = eigvals(constant, -np.eye(count, k=1), homogeneous_eigvals=True)
        finite = np.argsort(np.abs(found[1] / np.abs(found).max(axis=0)))[-self.sections :]
        poles = found[0, finite] / found[1, finite]
        rates = checked_rates(poles, self.name, "s**a")
        for _ in range(3):
            _, below = self._at_poles(b, np.zeros_like(b), rates)
            rates = rates + below[0] / below[1]
        return checked_rates(-rates, self.name, "s**a")


def _residues(above: Array, below: Array) -> Array:
    return np.asarray(above[0] / below[1])


def _thiele(nodes: Array, values: Array, slopes: Array) -> tuple[Array, Array]:
    """Return coefficients (n,) of Thiele's fraction and their derivatives along `slopes`."""
    v, v_p = values.copy(), slopes.copy()
    b, b_p = np.empty_like(v), np.empty_like(v)
    for k, node in enumerate(nodes):
        b[k], b_p[k] = v[0], v_p[0]
        gap, gap_p = v[1:] - v[0], v_p[1:] - v_p[0]
        v = (nodes[k + 1 :] - node) / gap
        v_p = -v * gap_p / gap
    return b, b_p


def _recur(b: Array, nodes: Array, s: Array, b_p: Array) -> tuple[Array, Array]:
    """Return numerator and denominator at s (m,), each (5, m): f, f_s, f_ss, f_p, f_ps."""
    zero, one = np.zeros_like(s), np.ones_like(s)
    start = np.array([one, zero, zero, zero, zero])
    P2, P1 = start, np.array([b[0] * one, zero, zero, b_p[0] * one, zero])
    Q2, Q1 = np.zeros_like(start), start
    for k in range(1, len(b)):
        t = s - nodes[k - 1]
        P2, P1 = P1, _advance(P1, P2, t, b[k], b_p[k])
        Q2, Q1 = Q1, _advance(Q1, Q2, t, b[k], b_p[k])
        size = np.maximum(np.abs(P1[0]).max(), np.abs(Q1[0]).max())
        P1, P2, Q1, Q2 = P1 / size, P2 / size, Q1 / size, Q2 / size
    return P1, Q1


def _advance(f1: Array, f2: Array, t: Array, b: float, b_p: float) -> Array:
    new = b * f1 + t * f2
    new[1] += f2[0]
    new[2] += 2.0 * f2[1]
    new[3] += b_p * f1[0]
    new[4] += b_p * f1[1] + f2[3]
    return new
