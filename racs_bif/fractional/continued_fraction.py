r"""Continued fraction of each power of s about the centre of the band.

The continued fractions of (1 + x)**a, Carlson's and "CFE", are Pade approximants about one
frequency (I. Podlubny, I. Petras, B. M. Vinagre, P. O'Leary, L. Dorcak, *Nonlinear Dynamics* 29
(2002) 281-296). The one used here keeps s**a = 0 at s = 0, which makes static gains exact: it is s
times the [n-1/n] approximant of s**(a-1) about c, the convergent of its J-fraction and so the
Gauss-Jacobi rule of

.. math:: (s/c)^a = \frac{\sin \pi a}{\pi} \int_{-1}^{1} (1-t)^{a-1} (1+t)^{-a}
          \frac{2 s}{s (1+t) + c (1-t)} \, dt .

Poles are real and negative, gains are positive. The rule takes no note of how wide the band is.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.fractional.powers import PowerRealisation, Side

if TYPE_CHECKING:
    from racs_bif.symbolic.field import Array


@dataclass(frozen=True, kw_only=True)
class ContinuedFraction(PowerRealisation):
    """Continued fractions about the geometric centre of a band, for the powers of a law."""

    density = 3.0

    @property
    def name(self) -> str:
        """Name on the command line."""
        return "continued-fraction"

    def power(self, order: float) -> Side:
        """Return the filter of s**order."""
        nodes, vectors = _nodes(order, self.sections)
        rates, tops = self._parts(order, nodes, vectors[0])
        return Side(float(tops.sum()), rates, -tops)

    def power_slope(self, order: float) -> Side:
        """Return the derivative of `power` by the order."""
        nodes, vectors = _nodes(order, self.sections)
        moved = vectors.T @ _jacobi_slope(order, self.sections) @ vectors
        gaps = nodes[None, :] - nodes[:, None] + np.eye(self.sections)
        turn = moved / gaps
        np.fill_diagonal(turn, 0.0)
        nodes_p, first = np.diag(moved), vectors[0]
        first_p = first @ turn
        rates, tops = self._parts(order, nodes, first)
        rates_p = -rates * nodes_p * 2.0 / (1.0 - nodes**2)
        log_tops_p = 2.0 * first_p / first - nodes_p / (1.0 + nodes) + math.log(self._centre)
        tops_p = tops * log_tops_p
        return Side(float(tops_p.sum()), rates_p, -tops_p)

    @property
    def _centre(self) -> float:
        return math.sqrt(self.band[0] * self.band[1])

    def _parts(self, order: float, nodes: Array, first: Array) -> tuple[Array, Array]:
        """Return rates and gains of s / (s + rate)."""
        rates = self._centre * (1.0 - nodes) / (1.0 + nodes)
        # the mass pi / sin(pi a) of the weight cancels the factor before the integral
        return rates, self._centre**order * 2.0 * first**2 / (1.0 + nodes)


def _nodes(order: float, count: int) -> tuple[Array, Array]:
    """Return Gauss-Jacobi nodes (k,) and normed eigenvectors (k, k) of their matrix."""
    nodes, vectors = np.linalg.eigh(_jacobi(order, count))
    return nodes, vectors


def _jacobi(order: float, count: int) -> Array:
    """Return the symmetric matrix of the orthogonal polynomials of (1-t)**(a-1) (1+t)**-a."""
    n = np.arange(1.0, count)
    diagonal = (2.0 * order - 1.0) / (4.0 * np.arange(count) ** 2 - 1.0)
    squares = (n - order) * (n - 1.0 + order) / (2.0 * n - 1.0) ** 2
    squares[:1] = 2.0 * order * (1.0 - order)
    off = np.sqrt(squares)
    return np.asarray(np.diag(diagonal) + np.diag(off, 1) + np.diag(off, -1))


def _jacobi_slope(order: float, count: int) -> Array:
    """Return the derivative of `_jacobi` by the order."""
    n = np.arange(1.0, count)
    diagonal = 2.0 / (4.0 * np.arange(count) ** 2 - 1.0)
    squares = (n - order) * (n - 1.0 + order) / (2.0 * n - 1.0) ** 2
    slopes = (1.0 - 2.0 * order) / (2.0 * n - 1.0) ** 2
    squares[:1], slopes[:1] = 2.0 * order * (1.0 - order), 2.0 - 4.0 * order
    off = 0.5 * slopes / np.sqrt(squares)
    return np.asarray(np.diag(diagonal) + np.diag(off, 1) + np.diag(off, -1))
