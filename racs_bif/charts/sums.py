"""det Delta(s) as a sum of real powers of s, for many parameter sets at once.

``Delta = diag(L) - diag(R) C``. Its determinant is the sum over all sets S of rows of
``(-1)^|S| det C[S, S]`` times R over S and L over the rest. Rows of the model's states have L = s,
R = 1; those of its elements D(s) and N(s), sums of powers themselves.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from racs_bif.charts.members import Laws
    from racs_bif.fractional.laws import Complex
    from racs_bif.symbolic.field import Array

LARGEST = 10
"""Most rows; there are 2**n minors."""
_NOISE = 1e-14
_MERGED = 1e-12


@dataclass(frozen=True)
class Sums:
    """N sums of K powers of s.

    Parameters
    ----------
    coefficients : array (K, N)
        Real; zero where a term is absent.
    exponents : array (K, N) or (K, 1)
        Not negative.
    """

    coefficients: Array
    exponents: Array

    def __len__(self) -> int:
        """Return N."""
        return int(self.coefficients.shape[1])

    def take(self, which: NDArray[np.intp]) -> Sums:
        """Return some of the sums, by their places."""
        wide = self.exponents.shape[1] > 1
        at = self.exponents[:, which] if wide else self.exponents
        return Sums(self.coefficients[:, which], at)

    @property
    def static(self) -> Array:
        """Values (N,) at s = 0, relative to the coefficients' magnitudes."""
        constant = np.where(self.exponents == 0.0, self.coefficients, 0.0).sum(axis=0)
        return np.asarray(constant)

    def evaluate(self, t: Complex, order: int = 1) -> tuple[Complex, ...]:
        """Return the sum at ``s = exp(t)`` and its derivatives by t, scaled, and the scale.

        Parameters
        ----------
        t : complex array (N,) or (M, N)
            Logarithms of s.
        order : int
            Of the highest derivative, 0 to 2.

        Returns
        -------
        tuple of complex arrays
            The value and its derivatives, divided by the sum of the terms' magnitudes; then the
            logarithm of the latter.
        """
        with np.errstate(divide="ignore"):
            logs = np.log(np.abs(self.coefficients))
        e = self.exponents
        if t.ndim == 2:
            e, logs = e[:, None, :], logs[:, None, :]
        sizes = logs + e * t.real
        top = sizes.max(axis=0)
        sizes = np.exp(sizes - top)
        total = sizes.sum(axis=0)
        sign = np.sign(self.coefficients)
        sizes *= sign[:, None, :] if t.ndim == 2 else sign
        # On one ray the angles do not differ from place to place.
        ray = t.size > 0 and np.ptp(t.imag) == 0.0
        angle = e * (t.imag.flat[0] if ray else t.imag)
        real, imaginary = sizes * np.cos(angle), sizes * np.sin(angle)
        values = []
        for k in range(order + 1):
            if k:
                real, imaginary = real * e, imaginary * e
            values.append((real.sum(axis=0) + 1j * imaginary.sum(axis=0)) / total)
        return (*values, top + np.log(total))

    def at_common(self, t: Complex) -> tuple[Complex, Complex, Array]:
        """Return all sums at the same M places, for exponents that all share.

        Parameters
        ----------
        t : complex array (M,)
            Logarithms of s.

        Returns
        -------
        (complex array (M, N), complex array (M, N), array (M, N))
            The value and its derivative by t, and the logarithm of their scale, as `evaluate`.
        """
        e = self.exponents[:, 0]
        powers = np.outer(t.real, e)
        top = powers.max(axis=1)
        powers = np.exp(powers - top[:, None])
        total = powers @ np.abs(self.coefficients)
        turned = powers * np.exp(1j * np.outer(t.imag, e))
        # One real product for the value and the derivative, real and imaginary parts.
        stacked = np.concatenate([turned.real, turned.imag, turned.real * e, turned.imag * e])
        parts = (stacked @ self.coefficients).reshape(4, len(t), -1) / total
        value, slope = parts[0] + 1j * parts[1], parts[2] + 1j * parts[3]
        return value, slope, np.log(total) + top[:, None]

    def leading(self) -> tuple[Array, NDArray[np.intp], Array, NDArray[np.intp]]:
        """Return exponents (N,) and places (N,) of the highest and of the lowest power."""
        e = np.broadcast_to(self.exponents, self.coefficients.shape)
        there = self.coefficients != 0.0
        high = np.where(there, e, -np.inf).argmax(axis=0)
        low = np.where(there, e, np.inf).argmin(axis=0)
        return _pick(e, high), high, _pick(e, low), low

    def radii(self) -> tuple[Array, Array]:
        """Return log |s| (N,) within and beyond which the first and last power dominate.

        There the other terms together are at most half of it, so that no root is there in the right
        half plane, nor anywhere on the sheet, and the phase is within 30 degrees of that power's.
        """
        e_high, high, e_low, low = self.leading()
        count = max(len(self.coefficients) - 1, 1)
        with np.errstate(divide="ignore", invalid="ignore"):
            logs = np.log(np.abs(self.coefficients))
            over = (logs - _pick(logs, high) + np.log(2.0 * count)) / (e_high - self.exponents)
            under = (_pick(logs, low) - logs - np.log(2.0 * count)) / (self.exponents - e_low)
        e = np.broadcast_to(self.exponents, self.coefficients.shape)
        there = self.coefficients != 0.0
        outer = np.where(there & (e < e_high), over, -np.inf).max(axis=0)
        inner = np.where(there & (e > e_low), under, np.inf).min(axis=0)
        # A single power has no root at all.
        inner, outer = (
            np.where(np.isfinite(inner), inner, -1.0),
            np.where(np.isfinite(outer), outer, 1.0),
        )
        return np.minimum(inner, outer - 1.0), outer


def expand(core: Array, laws: tuple[Laws, ...]) -> Sums:
    """Expand determinants of characteristic matrices.

    Parameters
    ----------
    core : array (N, n, n)
        The core's Jacobians; the rows of the elements are the last ones.
    laws : tuple of Laws
        Their laws.
    """
    ne = len(laws)
    ny = core.shape[1] - ne
    coefficients: list[Array] = []
    exponents: list[Array] = []
    minors, bounds = _minors(core, ny)
    for elements in itertools.product((0, 1), repeat=ne):
        rows = [
            law.numerator if on else law.denominator for law, on in zip(laws, elements, strict=True)
        ]
        for k in range(ny + 1):
            key = (k, elements)
            minor = np.where(np.abs(minors[key]) > _NOISE * bounds[key], minors[key], 0.0)
            if not minor.any():
                continue
            sign = (-1.0) ** (k + sum(elements))
            for terms in itertools.product(*(range(len(row[0])) for row in rows)):
                c, e = sign * minor, np.full(len(core), float(ny - k))
                for row, term in zip(rows, terms, strict=True):
                    c, e = c * row[0][term], e + row[1][term]
                coefficients.append(c)
                exponents.append(e)
    return _merged(np.array(coefficients), np.array(exponents))


def _minors(
    core: Array, ny: int
) -> tuple[dict[tuple[int, tuple[int, ...]], Array], dict[tuple[int, tuple[int, ...]], Array]]:
    """Return sums of principal minors by how many states and which elements, and their bounds."""
    count, n = core.shape[:2]
    sums: dict[tuple[int, tuple[int, ...]], Array] = {}
    bounds: dict[tuple[int, tuple[int, ...]], Array] = {}
    for picked in itertools.product((0, 1), repeat=n):
        rows = np.flatnonzero(picked)
        key = (sum(picked[:ny]), picked[ny:])
        value, bound = np.ones(count), np.ones(count)
        if len(rows):
            part = core[:, rows[:, None], rows]
            value = _determinant(part)
            bound = np.prod(np.abs(part).sum(axis=2), axis=1)
        sums[key] = sums.get(key, 0.0) + value
        bounds[key] = bounds.get(key, 0.0) + bound
    return sums, bounds


def _determinant(a: Array) -> Array:
    n = a.shape[1]
    if n == 1:
        return np.asarray(a[:, 0, 0])
    if n == 2:
        return np.asarray(a[:, 0, 0] * a[:, 1, 1] - a[:, 0, 1] * a[:, 1, 0])
    if n == 3:
        return np.asarray(np.einsum("ni,ni->n", a[:, 0], np.cross(a[:, 1], a[:, 2])))
    return np.asarray(np.linalg.det(a))


def _merged(coefficients: Array, exponents: Array) -> Sums:
    """Add terms whose exponents are the same at all parameter sets."""
    same = np.ptp(exponents, axis=1) <= _MERGED
    kept_c: list[Array] = []
    kept_e: list[Array] = []
    for c, e, constant in zip(coefficients, exponents, same, strict=True):
        near = (np.abs(e - other).max() <= _MERGED for other in kept_e)
        place = next((k for k, close in enumerate(near) if close), None)
        if place is None:
            kept_c.append(c)
            kept_e.append(np.full(len(e), round(e[0], 12)) if constant else e)
        else:
            kept_c[place] = kept_c[place] + c
    at = np.array(kept_e)
    return Sums(np.array(kept_c), at[:, :1] if same.all() else at)


def _pick(rows: Array, places: NDArray[np.intp]) -> Array:
    return np.asarray(np.take_along_axis(rows, places[None, :], axis=0)[0])
