"""Dense output: the collocation polynomials of the steps, their extrema and their error."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.orbits.radau import ABSCISSAE, STAGES

if TYPE_CHECKING:
    from racs_bif.orbits.mesh import Mesh
    from racs_bif.symbolic.field import Array

ORDER: Final = STAGES + 1
"""Power of the step width with which the error of the collocation polynomials falls."""

_POINTS: Final[Array] = np.concatenate(([0.0], ABSCISSAE))
_TO_POWERS: Final[Array] = np.asarray(
    np.linalg.inv(np.vander(_POINTS, increasing=True)), dtype=float
)
_ERROR: Final[Array] = np.polynomial.polynomial.polyint(
    np.polynomial.polynomial.polyfromroots(ABSCISSAE) / 6.0
)
"""Coefficients of E(s), the integral of (s - c1)(s - c2)(s - c3) / 3! from 0 to s.

To leading order h^4 x'''' E is what the collocation polynomial misses; E vanishes at both ends.
"""


def _largest_error() -> float:
    s = np.linspace(0.0, 1.0, 2001)
    return float(np.abs(np.polynomial.polynomial.polyval(s, _ERROR)).max())


_CONSTANT: Final = _largest_error()


class Profile:
    """A function of time over one period: a polynomial on every step of a mesh.

    Parameters
    ----------
    mesh : Mesh
        The steps.
    origins : array (N, n)
        Values at the starts of the steps.
    stages : array (N, 3, n)
        Values at the Radau points, the last of them the end of the step.
    """

    def __init__(self, mesh: Mesh, origins: Array, stages: Array) -> None:
        self.mesh = mesh
        self.points = np.concatenate((origins[:, None, :], stages), axis=1)
        self.powers: Array = _TO_POWERS @ self.points

    def __call__(self, times: Array) -> Array:
        """Return the values, shaped like `times` with n appended; times in [0, 1]."""
        nodes = self.mesh.nodes
        step = np.clip(np.searchsorted(nodes, times, side="right") - 1, 0, self.mesh.steps - 1)
        local = ((times - nodes[step]) / self.mesh.widths[step])[..., None]
        return _horner(np.moveaxis(self.powers[step], -2, 0), local)

    def extrema(self) -> tuple[Array, Array]:
        """Return the highest and the lowest values (n,) of a periodic function.

        They lie at the ends of steps or where a collocation polynomial is stationary; there its
        leading error is taken off: extrema are one order more accurate than the polynomials.
        """
        within = self._stationary()
        quartic = np.concatenate((self.powers, np.zeros_like(self.powers[:, :1])), axis=1)
        quartic += (self.mesh.widths[:, None] ** ORDER * self._fourth())[:, None] * _ERROR[:, None]
        values = _horner(np.moveaxis(quartic, 1, 0)[:, :, None], within)
        ends = self.points[:, 0]
        return (
            np.maximum(values.max(axis=(0, 1)), ends.max(axis=0)),
            np.minimum(values.min(axis=(0, 1)), ends.min(axis=0)),
        )

    def ranges(self) -> Array:
        """Return highest minus lowest value of the points, (n,)."""
        return np.asarray(np.ptp(self.points.reshape(-1, self.points.shape[-1]), axis=0))

    def errors(self, scales: Array) -> Array:
        """Estimate the error of the polynomials, (N,): the largest of the states over `scales`."""
        sizes = _CONSTANT * self.mesh.widths[:, None] ** ORDER * np.abs(self._fourth())
        errors = np.max(sizes / scales, axis=1)
        # an estimate that changes sign between two steps is zero in one of them: look at both
        return np.asarray(np.maximum(errors, np.roll(errors, -1)))

    def _fourth(self) -> Array:
        """Return the fourth derivative (N, n), from the jumps of the third from step to step.

        De Boor's estimate, the one that AUTO distributes its mesh by, periodically continued.
        """
        widths = self.mesh.widths
        third = 6.0 * self.powers[:, STAGES] / widths[:, None] ** STAGES
        before = np.roll(third, 1, axis=0)
        after = np.roll(third, -1, axis=0)
        between = widths + 0.5 * (np.roll(widths, 1) + np.roll(widths, -1))
        return np.asarray((after - before) / between[:, None])

    def _stationary(self) -> Array:
        """Return the fractions (N, 2, n) where the cubics are flat; 0 where there are none."""
        c1, c2, c3 = self.powers[:, 1], 2.0 * self.powers[:, 2], 3.0 * self.powers[:, 3]
        root = np.sqrt(np.maximum(c2 * c2 - 4.0 * c1 * c3, 0.0))
        q = -0.5 * (c2 + np.where(c2 < 0.0, -root, root))
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            roots = np.stack((q / c3, c1 / q), axis=1)
        return np.where((roots > 0.0) & (roots < 1.0), roots, 0.0)


def _horner(powers: Array, at: Array) -> Array:
    """Return sum powers[k] at^k; the first axis of `powers` is k."""
    value: Array = powers[-1]
    for coefficient in powers[-2::-1]:
        value = value * at + coefficient
    return value
