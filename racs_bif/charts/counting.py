"""Roots right of a vertical line, counted for many parameter sets at once.

The phase of det Delta is followed down the upper half of the contour as
`racs_bif.fractional.argument` does for one set: a step counts when the change of log det Delta
agrees with the integral of its exact logarithmic derivative, and is halved otherwise. On the arcs
far out and near s = 0 one power of s dominates and the phase is known.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from racs_bif.charts.sums import Sums
    from racs_bif.fractional.laws import Complex
    from racs_bif.symbolic.field import Array

UNKNOWN = -1
_SPACING = 1.0
_LARGEST_PHASE = 1.3
_LARGEST_TURN = 1.0
_AGREEMENT = 0.25
_ON_CONTOUR = 1e-10
_TRUSTED = 0.05
_FEW = 1 << 14
_QUARTER = 0.5 * np.pi

Places = NDArray[np.int64]


@dataclass(frozen=True)
class Counts:
    """What was counted, for N parameter sets.

    Parameters
    ----------
    unstable : int array (N,)
        Roots right of the line; -1 where they cannot be counted, for instance with one on it.
    margin : array (N,)
        Least |det Delta| seen on the line, relative to the magnitudes of its terms: zero with a
        root on the line.
    omega : array (N,)
        Where that was, Im s.
    evaluations : int array (N,)
        Number of determinants for each.
    """

    unstable: NDArray[np.int64]
    margin: Array
    omega: Array
    evaluations: NDArray[np.int64]


@dataclass
class _Tally:
    """Sums over the contour as it is followed, one number for each parameter set."""

    phase: Array
    margin: Array
    omega: Array
    evaluations: NDArray[np.int64]
    lost: NDArray[np.bool_]

    def see(self, cells: Places, t: Complex, sizes: Array) -> None:
        """Note determinants of relative sizes at places t = log s."""
        np.add.at(self.evaluations, cells, 1)
        order = np.argsort(-sizes, kind="stable")
        cells, t, sizes = cells[order], t[order], sizes[order]
        # The last one written for a cell is its smallest.
        least, where = np.full(len(self.margin), np.inf), np.zeros(len(self.margin))
        least[cells], where[cells] = sizes, (np.exp(t)).imag
        better = least < self.margin
        self.margin[better], self.omega[better] = least[better], where[better]


def count_right(sums: Sums, above: Array | float = 0.0) -> Counts:
    """Count the roots of every sum with Re s > above, s = 0 left out.

    Parameters
    ----------
    sums : Sums
        N of them.
    above : float or array (N,)
        The lines. Left of zero the branch cut is left out.
    """
    count = len(sums)
    line = np.broadcast_to(np.asarray(above, dtype=float), (count,))
    tally = _Tally(
        np.zeros(count),
        np.full(count, np.inf),
        np.zeros(count),
        np.zeros(count, dtype=np.int64),
        ~np.isfinite(sums.coefficients).all(axis=0),
    )
    good = np.flatnonzero(~tally.lost)
    unstable = np.full(count, UNKNOWN, dtype=np.int64)
    if len(good):
        turns = _turns(sums, line, good, tally)
        number = np.round(turns)
        sure = (np.abs(turns - number) <= _TRUSTED) & (number >= 0.0) & ~tally.lost[good]
        unstable[good[sure]] = number[sure].astype(np.int64)
    return Counts(unstable, tally.margin, tally.omega, tally.evaluations)


def _turns(sums: Sums, line: Array, cells: Places, tally: _Tally) -> Array:
    """Return the change of the phase over pi along the upper half of the contours."""
    used = sums.take(cells)
    inner, outer = used.radii()
    above = line[cells]
    inside = np.abs(above) < np.exp(inner)
    outer = np.where(np.abs(above) >= np.exp(outer), np.log(np.abs(above) + 1e-300) + 1.0, outer)
    size, R, r = np.abs(above), np.exp(outer), np.exp(inner)
    zero = above == 0.0
    scale = np.where(zero, 1.0, size)
    begin = np.where(zero, outer, np.arcsinh(np.sqrt(R**2 - size**2) / scale))
    bottom = np.sqrt(np.maximum(r**2 - size**2, 0.0))
    end = np.where(zero, inner, np.arcsinh(bottom / scale))

    def upright(which: Places, x: Array) -> Complex:
        a = above[which]
        with np.errstate(over="ignore"):
            slanted = np.log(a + 1j * scale[which] * np.sinh(np.where(zero[which], 0.0, x)))
        return np.asarray(np.where(zero[which], x + 1j * _QUARTER, slanted))

    def lip(which: Places, x: Array) -> Complex:
        del which
        return np.asarray(x + 1j * np.pi)

    everywhere = np.arange(len(cells))
    _follow(used, cells, everywhere, upright, begin, end, tally)
    cut = np.flatnonzero(~inside & (above < 0.0))
    _follow(used, cells, cut, lip, np.log(scale), inner, tally)
    top = upright(everywhere, begin)
    last = upright(everywhere, end)
    last[cut] = inner[cut] + 1j * np.pi
    e_high, high, e_low, low = used.leading()
    phase = tally.phase[cells] + e_high * top.imag + _beyond(used, top, e_high, high)
    # With a line right of s = 0 the contour ends on the real axis, not at s = 0.
    closes = inside | (above < 0.0)
    inwards = e_low * last.imag + _beyond(used, last, e_low, low)
    phase -= np.where(closes, inwards, 0.0)
    phase -= np.where(closes, 0.0, 0.0)
    return np.asarray(phase / np.pi)


def _beyond(sums: Sums, t: Complex, exponent: Array, place: Places) -> Array:
    """Return the phase at t beyond that of the power that dominates there."""
    value = sums.evaluate(t, 0)[0]
    sign = np.sign(np.take_along_axis(sums.coefficients, place[None, :], axis=0)[0])
    return np.asarray(np.angle(value * sign * np.exp(-1j * exponent * t.imag)))


def _follow(
    sums: Sums,
    cells: Places,
    which: Places,
    contour: Callable[[Places, Array], Complex],
    begin: Array,
    end: Array,
    tally: _Tally,
) -> None:
    """Add to the tally the change of phase along a piece of the contour, x from begin to end."""
    if not len(which):
        return
    length = np.abs(end - begin)[which]
    steps = np.maximum(3, np.ceil(length / _SPACING)).astype(np.int64)
    owner = np.repeat(which, steps + 1)
    first = np.concatenate([[0], np.cumsum(steps + 1)[:-1]])
    share = (np.arange(len(owner)) - np.repeat(first, steps + 1)) / np.repeat(steps, steps + 1)
    x = begin[owner] + share * (end - begin)[owner]
    t, log, rate = _logarithms(sums, cells, owner, x, contour, tally)
    last = np.cumsum(steps + 1) - 1
    starts = np.delete(np.arange(len(owner)), last)
    left = [owner[starts], x[starts], t[starts], log[starts], rate[starts]]
    right = [a[starts + 1] for a in (owner, x, t, log, rate)]
    while len(left[0]):
        good, change = _judge(left, right)
        np.add.at(tally.phase, cells[left[0][good]], change[good])
        narrow = ~good & (np.abs(right[2] - left[2]) < _ON_CONTOUR)
        tally.lost[cells[left[0][narrow]]] = True
        bad = ~good & ~tally.lost[cells[left[0]]]
        left, right = [a[bad] for a in left], [a[bad] for a in right]
        owner, x = left[0], 0.5 * (left[1] + right[1])
        middle = [owner, x, *_logarithms(sums, cells, owner, x, contour, tally)]
        left, right = (
            [np.concatenate(pair) for pair in zip(left, middle, strict=True)],
            [np.concatenate(pair) for pair in zip(middle, right, strict=True)],
        )


def _logarithms(
    sums: Sums,
    cells: Places,
    owner: Places,
    x: Array,
    contour: Callable[[Places, Array], Complex],
    tally: _Tally,
) -> tuple[Complex, Complex, Complex]:
    """Return t, log det Delta and its derivative by t at places x of the owners' contours."""
    t = contour(owner, x)
    log, rate = np.empty(len(x), dtype=complex), np.empty(len(x), dtype=complex)
    sizes = np.empty(len(x))
    for k in range(0, len(x), _FEW):
        part = slice(k, k + _FEW)
        value, slope, scale = sums.take(owner[part]).evaluate(t[part])
        sizes[part] = np.abs(value)
        with np.errstate(divide="ignore", invalid="ignore"):
            log[part] = np.log(sizes[part]) + scale + 1j * np.angle(value)
            rate[part] = slope / value
    tally.see(cells[owner], t, sizes)
    return t, log, rate


def _judge(left: list[Array], right: list[Array]) -> tuple[NDArray[np.bool_], Array]:
    """Return which steps can be trusted, and the change of the phase in each."""
    step = right[2] - left[2]
    with np.errstate(invalid="ignore"):
        predicted = 0.5 * (left[4] + right[4]) * step
        raw = right[3] - left[3]
        phase = (raw.imag + np.pi) % (2.0 * np.pi) - np.pi
        error = np.abs(raw.real + 1j * phase - predicted)
        turn = np.abs((right[4] - left[4]) * step)
        good = (error <= _AGREEMENT) & (turn <= _LARGEST_TURN)
        good &= np.abs(predicted.imag) <= _LARGEST_PHASE
    return good, phase
