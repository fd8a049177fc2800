"""Periodic piecewise polynomials: values, true extrema, and an estimate of their error."""

from __future__ import annotations

from functools import cached_property
from math import factorial
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.orbits.gauss import Gauss, gauss

if TYPE_CHECKING:
    from racs_bif.orbits.mesh import Mesh
    from racs_bif.symbolic.field import Array

_NEWTON: Final = 5
"""Iterations to an extremum from the nearest of 2 m + 1 samples of its interval."""


class Piecewise:
    """A periodic function of time: a polynomial of degree m on every interval of a mesh.

    Parameters
    ----------
    mesh : Mesh
        The N intervals.
    nodes : array (N, m, n)
        Values at the first m of the m + 1 equidistant nodes of the intervals; the last is the
        first of the next interval.
    end : array (n,), optional
        Value at the end, by default that at the beginning.
    """

    def __init__(self, mesh: Mesh, nodes: Array, end: Array | None = None) -> None:
        self.mesh = mesh
        self.nodes = nodes
        self._end = end
        self.gauss: Gauss = gauss(nodes.shape[1])

    @cached_property
    def closed(self) -> Array:
        """Values at all nodes of the intervals, (N, m + 1, n)."""
        nodes = closed(self.nodes)
        if self._end is not None:
            nodes[-1, -1] = self._end
        return nodes

    @cached_property
    def powers(self) -> Array:
        """Coefficients of the monomials of the time within the interval, (N, m + 1, n)."""
        return np.asarray(self.gauss.powers @ self.closed)

    def __call__(self, times: Array) -> Array:
        """Return the values, shaped like `times` with n appended; times in [0, 1]."""
        mesh = self.mesh
        place = np.clip(np.searchsorted(mesh.nodes, times, side="right") - 1, 0, mesh.steps - 1)
        local = ((times - mesh.nodes[place]) / mesh.widths[place])[..., None]
        return _horner(np.moveaxis(self.powers[place], -2, 0), local)

    def stages(self) -> Array:
        """Return the values at the Gauss points (N, m, n)."""
        return self._stages

    @cached_property
    def _stages(self) -> Array:
        return np.asarray(self.gauss.values @ self.closed)

    def velocities(self) -> Array:
        """Return the derivatives there by time in units of the period (N, m, n)."""
        return np.asarray((self.gauss.slopes @ self.closed) / self.mesh.widths[:, None, None])

    def mean(self) -> Array:
        """Return the mean over a period, (n,)."""
        g, widths = self.gauss, self.mesh.widths
        return np.asarray(widths @ (g.weights @ self.stages()))

    def ranges(self) -> Array:
        """Return highest minus lowest value at the nodes, (n,)."""
        return np.asarray(np.ptp(self.nodes.reshape(-1, self.nodes.shape[-1]), axis=0))

    def errors(self, scales: Array) -> Array:
        """Estimate the error of the polynomials, (N,): the largest of the states over `scales`.

        Ends of intervals, and with them period and multipliers, are far more accurate.
        """
        sizes = _largest_error(self.gauss.degree) * np.abs(self._missing)
        errors = np.max(sizes / scales, axis=1)
        # an estimate that changes sign between two intervals is zero in one: look at both
        return np.asarray(np.maximum(errors, np.roll(errors, -1)))

    def extrema(self) -> tuple[Array, Array]:
        """Return the highest and the lowest values (n,), the leading error taken off."""
        powers = np.concatenate((self.powers, np.zeros_like(self.powers[:, :1])), axis=1)
        powers += self._missing[:, None] * self.gauss.error[:, None]
        count, size = 2 * self.gauss.degree, powers.shape[1]
        fractions = np.linspace(0.0, 1.0, count + 1)
        samples = (np.vander(fractions, size, increasing=True) @ powers).reshape(
            -1, powers.shape[2]
        )
        places = np.stack((samples.argmax(axis=0), samples.argmin(axis=0)))
        interval, local = np.divmod(places, count + 1)
        state, sign = np.arange(powers.shape[2]), np.array([[1.0], [-1.0]])
        exponents = np.arange(1, size)[:, None, None]
        # an extremum next to a mesh point may lie on the other side of it: the slope tells
        slopes = np.moveaxis(powers[interval, 1:, state], -1, 0) * exponents
        back = (local == 0) & (sign * slopes[0] < 0.0)
        ahead = (local == count) & (sign * slopes.sum(axis=0) > 0.0)
        interval = (interval + ahead - back) % self.mesh.steps
        s = fractions[np.where(back, count, np.where(ahead, 0, local))]
        own = np.moveaxis(powers[interval, :, state], -1, 0)
        first = own[1:] * exponents
        second = first[1:] * exponents[:-1]
        low, high = np.maximum(s - 1.0 / count, 0.0), np.minimum(s + 1.0 / count, 1.0)
        for _ in range(_NEWTON):
            bend = _horner(second, s)
            curved = sign * bend < 0.0
            step = np.where(curved, _horner(first, s) / np.where(curved, bend, 1.0), 0.0)
            s = np.clip(s - step, low, high)
        found = sign * np.maximum(sign * _horner(own, s), sign * samples[places, state])
        return found[0], found[1]

    @cached_property
    def _missing(self) -> Array:
        """Width^(m+1) times the (m+1)-th derivative (N, n), from the jumps of the m-th.

        De Boor's estimate, the one that AUTO distributes its mesh by, periodically continued.
        """
        degree, widths = self.gauss.degree, self.mesh.widths
        highest = factorial(degree) * self.powers[:, degree] / widths[:, None] ** degree
        jump = np.roll(highest, -1, axis=0) - np.roll(highest, 1, axis=0)
        between = widths + 0.5 * (np.roll(widths, 1) + np.roll(widths, -1))
        return np.asarray(jump * (widths ** (degree + 1) / between)[:, None])


def closed(nodes: Array) -> Array:
    """Return nodes (N, m, n) with the first node of the next interval appended (N, m + 1, n)."""
    last = np.roll(nodes[:, :1], -1, axis=0)
    return np.concatenate((nodes, last), axis=1)


def equidistant(mesh: Mesh, degree: int) -> Array:
    """Return the times (N, m) of the nodes of the intervals, without the last of each."""
    return mesh.times(np.arange(degree) / degree)


def _largest_error(degree: int) -> float:
    s = np.linspace(0.0, 1.0, 401)
    return float(np.abs(np.polynomial.polynomial.polyval(s, gauss(degree).error)).max())


def _horner(powers: Array, at: Array) -> Array:
    """Return sum powers[k] at^k; the first axis of `powers` is k."""
    value: Array = powers[-1]
    for coefficient in powers[-2::-1]:
        value = value * at + coefficient
    return value
