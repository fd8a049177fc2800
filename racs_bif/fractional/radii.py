"""Circles beyond which, and within which, there is no characteristic root.

Outside: rows scaled to their leading powers are diagonally dominant in some scaling of the
columns, which is to say that the spectral radius of the matrix of ratios is below one (an
H-matrix; A. Berman, R. J. Plemmons, *Nonnegative Matrices in the Mathematical Sciences*, ch. 6).
Inside: ``Delta(s) = Delta(0) (I + K(s))`` with the spectral radius of ``|K|`` below one. Both
radii of spectra are monotone in |s|, so that one value of |s| decides for all beyond.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import ConvergenceError

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from racs_bif.fractional.characteristic import Characteristic
    from racs_bif.fractional.laws import Complex, PowerSum
    from racs_bif.symbolic.field import Array

_BELOW_ONE = 0.9
_SINGULAR = 1e-13
_SHARP = 0.05  # how well log |s| of a circle is determined
_LARGEST = 650.0  # log |s|: beyond, numbers overflow
_PLATEAU = 1e-2
_REACH = 0.45  # in exponents: at most a right angle on the whole sheet


@dataclass(frozen=True)
class Annulus:
    """Where the characteristic roots other than zero are, and what det Delta is like on its rims.

    Parameters
    ----------
    inner, outer : float
        log |s| of the two circles.
    degree : float
        Exponent of the leading power of det Delta at infinity.
    zero_order : float
        Exponent of the leading power at s = 0: positive where s = 0 is a root.
    """

    inner: float
    outer: float
    degree: float
    zero_order: float

    @property
    def at_zero(self) -> bool:
        """Whether s = 0 is a root."""
        return self.zero_order > 0.0


def annulus(ch: Characteristic) -> Annulus:
    """Enclose all characteristic roots other than zero.

    Raises
    ------
    ConvergenceError
        If there is no bound, or the behaviour at a root s = 0 cannot be told.
    """
    # Overflow on the way is a bound that does not hold there.
    with np.errstate(over="ignore", invalid="ignore"):
        return _annulus(ch)


def _annulus(ch: Characteristic) -> Annulus:
    degree = float(sum(row.exponents[-1] for row in ch.left))
    outer = _outer(ch)
    static = _static(ch)
    if _is_singular(static):
        inner, order = _plateau(ch, outer)
    else:
        inner, order = _inner(ch, static), 0.0
    return Annulus(min(inner, outer - 1.0), outer, degree, order)


def _outer(ch: Characteristic) -> float:
    reach = next((x for x in (_REACH, 0.0) if not _grows(ch, x)), None)
    if reach is None:
        msg = (
            "det Delta(s) has no leading power that can be told from its rows: an element that "
            "differentiates once closes a loop; put its input's derivative into the equations"
        )
        raise ConvergenceError(msg)
    ratios = _outer_ratios(ch, reach)
    return _search(lambda x: _radius(ratios(x)) < _BELOW_ONE, +1.0)


def _outer_ratios(ch: Characteristic, reach: float) -> Callable[[float], Array]:
    """Return bounds (n, n), at log |s|, of entries over their diagonal: inf where that may be 0.

    A diagonal over its highest power of |s| is at least what its `helpers` are for |arg s| <= pi,
    less all other terms.
    """
    coefficients, exponents = ch.left_powers
    highest = np.array([row.exponents[-1] for row in ch.left])
    lower = np.where(coefficients != 0.0, highest[:, None] - exponents, 0.0)
    helps = np.zeros(coefficients.shape, dtype=bool)
    for i, row in enumerate(ch.left):
        helps[i, : len(row.exponents)] = _helpers(row, reach)
    least = np.abs(coefficients) * np.where(helps, np.cos(np.pi * lower), -1.0)
    weights = ch.right_powers[0], ch.right_powers[1] - highest[:, None]
    absolute = np.abs(ch.core)
    own = absolute.diagonal()

    def ratios(log_radius: float) -> Array:
        weight = _bounds(*weights, log_radius)
        diagonal = (least * np.exp(-lower * log_radius)).sum(axis=1)
        diagonal -= np.where(own > 0.0, weight, 0.0) * own
        fine = diagonal > 0.0
        size = weight[:, None] * absolute / np.where(fine, diagonal, 1.0)[:, None]
        size[~fine] = np.inf
        np.fill_diagonal(size, np.where(fine, 0.0, np.inf))
        return np.asarray(size)

    return ratios


def _helpers(row: PowerSum, reach: float) -> NDArray[np.bool_]:
    """Return which terms cannot cancel the leading one: of its sign and nearly its exponent.

    Seen from its direction, they are at less than a right angle. With the first term that works
    against it the helpers end, or the bound would not be monotone.
    """
    sign = np.sign(row.coefficients) == np.sign(row.coefficients[-1])
    beside = sign & (row.exponents[-1] - row.exponents <= reach)
    return np.logical_and.accumulate(beside[::-1])[::-1]


def outer_phase(ch: Characteristic, angle: float, log_radius: float) -> float:
    """Return the phase of det Delta beyond its leading term's, outside the outer circle."""
    t = np.array([log_radius + 1j * angle])
    matrix = ch.matrix(t, ch.shift(t))[0]
    diagonal = matrix.diagonal()
    leading = np.array([r.coefficients[-1] * np.exp(1j * r.exponents[-1] * angle) for r in ch.left])
    # I + K for K of spectral radius below one: no eigenvalue turns past the imaginary axis.
    eigenvalues = np.linalg.eigvals(matrix / diagonal[:, None])
    return float(np.angle(diagonal / leading).sum() + np.angle(eigenvalues).sum())


def inner_phase(ch: Characteristic, angle: float, log_radius: float) -> float:
    """Return the phase of det Delta against det Delta(0), on or within the inner circle."""
    matrix = ch.matrix(np.array([log_radius + 1j * angle]))[0]
    return float(np.angle(np.linalg.eigvals(np.linalg.solve(_static(ch), matrix))).sum())


def _grows(ch: Characteristic, reach: float) -> bool:
    """Say whether some loop of entries may grow against the diagonals at infinity."""
    n = ch.size
    gain = np.full((n, n), -np.inf)
    for i, (left, right) in enumerate(zip(ch.left, ch.right, strict=True)):
        if len(right.exponents):
            lowest = left.exponents[_helpers(left, reach)][0]
            gain[i, ch.core[i] != 0.0] = right.exponents[-1] - lowest
    for k in range(n):
        gain = np.maximum(gain, gain[:, k : k + 1] + gain[k : k + 1, :])
    return bool(np.any(gain.diagonal() > 1e-12))


def _static(ch: Characteristic) -> Array:
    left = np.array([row.at_zero for row in ch.left])
    right = np.array([row.at_zero for row in ch.right])
    return np.asarray(np.diag(left) - right[:, None] * ch.core)


def _is_singular(matrix: Array) -> bool:
    scaled = np.array(matrix)
    for axis in (1, 0, 1):
        size = np.abs(scaled).max(axis=axis, keepdims=True)
        if np.any(size == 0.0):
            return True
        scaled = scaled / size
    return bool(np.linalg.svd(scaled, compute_uv=False)[-1] < _SINGULAR * len(scaled))


def _inner(ch: Characteristic, static: Array) -> float:
    inverse, absolute = np.abs(np.linalg.inv(static)), np.abs(ch.core)
    left, right = (
        (np.where(exponents > 0.0, coefficients, 0.0), exponents)
        for coefficients, exponents in (ch.left_powers, ch.right_powers)
    )
    index = np.arange(ch.size)

    def small(log_radius: float) -> bool:
        change = _bounds(*right, log_radius)[:, None] * absolute
        change[index, index] += _bounds(*left, log_radius)
        return _radius(inverse @ change) < _BELOW_ONE

    return _search(small, -1.0)


def _plateau(ch: Characteristic, outer: float) -> tuple[float, float]:
    """Return log |s| of a circle on which det Delta goes like one power of s, and the exponent."""
    radii = np.arange(outer, outer - 45.0, -0.25)
    t: Complex = radii[:, None] + 1j * np.array([0.0, 0.25, 0.5, 0.75, 1.0]) * np.pi
    rate = ch.log_det(t.ravel())[1].reshape(t.shape)
    order = rate[:, 0].real
    steady = np.abs(rate - order[:, None]).max(axis=1) < _PLATEAU
    steady &= np.abs(order - np.roll(order, -4)) < _PLATEAU
    # Lower down rounding takes over, and det Delta is a constant.
    steady &= order > 2.0 * _PLATEAU
    steady[-4:] = False
    if not np.any(steady):
        msg = "s = 0 is a characteristic root, of an order that cannot be told; scale the model"
        raise ConvergenceError(msg)
    # Plateaus higher up lie between roots of different sizes: the last one is that of s = 0.
    last = len(steady) - 1 - int(np.argmax(steady[::-1]))
    first = last - int(np.argmin(np.append(steady[: last + 1][::-1], False)))
    return float(radii[first + 1]), float(order[last])


def _bounds(coefficients: Array, exponents: Array, log_radius: float) -> Array:
    """Return the most that sums of powers (n, k) can be on a circle."""
    powers = np.exp(np.minimum(exponents * log_radius, _LARGEST))
    return np.asarray((np.abs(coefficients) * powers).sum(axis=1))


def _radius(matrix: Array) -> float:
    if not np.all(np.isfinite(matrix)):
        return np.inf
    return float(np.abs(np.linalg.eigvals(matrix)).max())


def _search(good: Callable[[float], bool], direction: float) -> float:
    """Return the nearest place, seen from the other side, from which on `good` holds."""
    found, bad, step = 0.0, 0.0, 1.0
    if good(0.0):
        while good(found - direction * step):
            found -= direction * step
            step *= 2.0
            if abs(found) + step > _LARGEST:
                return found
        bad = found - direction * step
    else:
        while not good(bad + direction * step):
            bad += direction * step
            step *= 2.0
            if abs(bad) + step > _LARGEST:
                msg = (
                    "characteristic roots cannot be bounded within 1e-260 .. 1e260; scale the model"
                )
                raise ConvergenceError(msg)
        found = bad + direction * step
    while abs(found - bad) > _SHARP:
        middle = 0.5 * (found + bad)
        found, bad = (middle, bad) if good(middle) else (found, middle)
    return found
