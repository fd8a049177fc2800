"""Diffusive realisation: fixed relaxation rates, weights fitted to the law by least squares.

A fractional operator is a continuous sum of first-order relaxations (G. Montseny, *ESAIM Proc.* 5
(1998) 159-175). Here that sum has a few rates, spaced evenly on a logarithmic scale around the
band, and their weights minimise the relative error of Z(i omega) over it. The static gain is a
constraint, so it is exact; the weights are smooth functions of the law, whose derivatives follow
from the normal equations.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import UsageError
from racs_bif.fractional.filter import Filter, Realisation
from racs_bif.fractional.residues import stack, static_slope

if TYPE_CHECKING:
    from racs_bif.fractional.laws import Complex, Law
    from racs_bif.symbolic.field import Array

_SAMPLES_PER_DECADE = 24


@dataclass(frozen=True, kw_only=True)
class Diffusive(Realisation):
    """Sum of first-order relaxations fitted over a band.

    Parameters
    ----------
    band : (float, float)
        Fitted frequencies [rad/s].
    order : int
        Number of relaxation rates; 0 takes five a decade.
    spread : float
        How far the rates reach beyond the band at either end, as a factor. With order 8 on 1 to 100
        rad/s, 6 gives the smallest error of the paper's law between 5 and 60 rad/s (6e-4).
    """

    order: int = 0
    spread: float = 6.0

    def __post_init__(self) -> None:
        """Check the settings."""
        super().__post_init__()
        if self.order == 0:
            decades = math.log10(self.band[1] / self.band[0])
            object.__setattr__(self, "order", max(4, math.ceil(5.0 * decades)))
        if self.order < 2:
            msg = f"order {self.order} is too small; use at least 2 relaxation rates"
            raise UsageError(msg)
        if not 0.0 < self.spread < float("inf"):
            msg = f"spread {self.spread:g} is not usable; give a positive factor"
            raise UsageError(msg)

    @property
    def name(self) -> str:
        """Name on the command line."""
        return "diffusive"

    @property
    def rates(self) -> Array:
        """Relaxation rates [rad/s] (order,)."""
        low, high = self.band
        return np.geomspace(low / self.spread, high * self.spread, self.order)

    def realise(self, law: Law) -> Filter:
        """Return the fitted filter; a law that integrates has one further state."""
        s = self._samples()
        target = law(s)
        basis, offset = self._basis(law, s)
        weight = self._taper() / np.abs(target)
        matrix = stack(weight * basis)
        free = _least_squares(matrix, stack(weight * (target - offset)))
        return self._filter(law, free, 0.0 if law.integrates else law.static_gain)

    def derivative(self, law: Law, direction: Law) -> Filter:
        """Return the exact derivative of the fitted filter."""
        s = self._samples()
        target, moved = law(s), law.along(direction, s)
        basis, offset = self._basis(law, s)
        gain_slope = static_slope(law, direction)
        offset_slope = gain_slope * self._static_shape(law, s)
        weight = self._taper() / np.abs(target)
        weight_slope = -weight * np.real(moved / target)
        matrix, right = stack(weight * basis), stack(weight * (target - offset))
        free = _least_squares(matrix, right)
        matrix_slope = stack(weight_slope * basis)
        right_slope = stack(weight_slope * (target - offset) + weight * (moved - offset_slope))
        first = _least_squares(matrix, right_slope - matrix_slope @ free)
        triangle = np.asarray(np.linalg.qr(matrix, mode="r"))
        residual = matrix_slope.T @ (right - matrix @ free)
        second = np.linalg.solve(triangle, np.linalg.solve(triangle.T, residual))
        change = self._filter(law, first + second, gain_slope)
        zero = np.zeros_like(change.A)
        return Filter(zero, np.zeros_like(change.B), change.C, change.D)

    def _samples(self) -> Complex:
        low, high = self.band
        return np.asarray(1j * np.geomspace(low, high, self._count), dtype=complex)

    @property
    def _count(self) -> int:
        low, high = self.band
        return max(8 * self.order, math.ceil(_SAMPLES_PER_DECADE * math.log10(high / low)))

    def _taper(self) -> Array:
        """Return weights that let the band's ends go, where a few rates cannot follow the law."""
        return np.cos(0.49 * np.pi * np.linspace(-1.0, 1.0, self._count))

    def _relaxations(self, s: Complex) -> Complex:
        rates = self.rates[:, None]
        return rates / (s + rates)

    def _static_shape(self, law: Law, s: Complex) -> Complex:
        """Return what carries the static gain: the feedthrough, or else the fastest relaxation."""
        if law.integrates:
            return np.zeros_like(s)
        return np.ones_like(s) if law.feedthrough else self._relaxations(s)[-1]

    def _basis(self, law: Law, s: Complex) -> tuple[Complex, Complex]:
        """Return the free functions (k, m) and the part of Z that the constraint fixes (m,)."""
        relaxations = self._relaxations(s)
        if law.integrates:
            constant = [np.ones_like(s)] if law.feedthrough else []
            return np.array([1.0 / s, *relaxations, *constant]), np.zeros_like(s)
        shape = self._static_shape(law, s)
        free = relaxations if law.feedthrough else relaxations[:-1]
        return free - shape, law.static_gain * shape

    def _filter(self, law: Law, free: Array, static: float) -> Filter:
        rates = self.rates
        if law.integrates:
            gains, through = free[1 : 1 + self.order], free[1 + self.order :].sum()
            A = np.diag(np.concatenate([[0.0], -rates]))
            B = np.concatenate([[1.0], rates])
            return Filter(A, B, np.concatenate([free[:1], gains]), float(through))
        if law.feedthrough:
            gains, through = free, static - float(free.sum())
        else:
            gains, through = np.append(free, static - free.sum()), 0.0
        return Filter(np.diag(-rates), rates.copy(), gains, float(through))


def _least_squares(matrix: Array, right: Array) -> Array:
    return np.asarray(np.linalg.lstsq(matrix, right, rcond=None)[0], dtype=float)
