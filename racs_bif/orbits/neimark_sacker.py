"""NS: a pair of complex multipliers passes through the unit circle."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from racs_bif.continuation.problem import Detector
from racs_bif.orbits.normal_forms import cycle_normal_form
from racs_bif.orbits.problem import OrbitProblem, describe

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from racs_bif.continuation.points import Point
    from racs_bif.symbolic.field import Array

_NEAR: Final = 1e-2
_REAL: Final = 1e-6
_DEEP: Final = 0.3


class NeimarkSacker(Detector):
    """Two multipliers have the product 1: a torus branches off where they are complex."""

    label = "NS"
    crossings = 2

    def value(self, problem: OrbitProblem, point: Point) -> float:
        """Return the smallest |mu_i mu_j - 1| that can change sign, with the sign of the product.

        Those are the products of conjugates and of two real multipliers; the others come in
        conjugate pairs themselves.
        """
        del problem
        products = _real_products(point.spectrum[1:])[0]
        if not len(products):
            return math.nan
        sign = -1.0 if np.count_nonzero(products < 1.0) % 2 else 1.0
        return float(sign * np.abs(products - 1.0).min())

    def dismisses(self, before: Point, after: Point) -> bool:
        """Return whether real multipliers alone change the sign: at a neutral saddle of cycles.

        There are as many complex pairs outside the unit circle as before, and inside near it. If
        more has happened between the points, the number of multipliers outside tells.
        """
        return _pairs(before.spectrum[1:]) == _pairs(after.spectrum[1:])

    def data(self, problem: OrbitProblem, point: Point) -> dict[str, Any] | None:
        """Return angle, period, multipliers, normal form; None at a neutral saddle of cycles."""
        products, angles = _real_products(point.spectrum[1:])
        k = int(np.argmin(np.abs(products - 1.0)))
        if abs(products[k] - 1.0) > _NEAR or angles[k] < _REAL or angles[k] > math.pi - _REAL:
            return None
        angle = float(angles[k])
        form = cycle_normal_form(problem, point, self.label, angle)
        return {**describe(problem, point), "angle": angle, **form}


def _pairs(multipliers: NDArray[np.complex128]) -> tuple[int, int]:
    """Return the number of complex pairs outside the unit circle, and inside but not deep."""
    sizes = np.abs(multipliers[multipliers.imag > 0.0])
    return int(np.count_nonzero(sizes >= 1.0)), int(np.count_nonzero(sizes >= _DEEP))


def _real_products(multipliers: NDArray[np.complex128]) -> tuple[Array, Array]:
    """Return the products of two multipliers that are real, and their angles (0 if both are)."""
    upper = multipliers[multipliers.imag > 0.0]
    real = multipliers[(multipliers.imag == 0.0) & np.isfinite(multipliers)].real
    i, j = np.triu_indices(len(real), 1)
    products = np.concatenate([np.abs(upper) ** 2, real[i] * real[j]])
    return products, np.concatenate([np.angle(upper), np.zeros(len(i))])
