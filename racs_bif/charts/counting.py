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
_MANY = 1 << 11
_QUARTER = 0.5 * np.pi

Places = NDArray[np.intp]


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


@dataclass(frozen=True)
class _Steps:
    """Steps along contours: whose, and x, t = log s, log det Delta and its rate at both ends."""

    owner: Places
    left: tuple[Complex, ...]
    right: tuple[Complex, ...]

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self.owner)

    def take(self, which: NDArray[np.bool_]) -> _Steps:
        """Return some of them."""
        return _Steps(
            self.owner[which],
            tuple(a[which] for a in self.left),
            tuple(a[which] for a in self.right),
        )

    def split(self, middle: tuple[Complex, ...]) -> _Steps:
        """Return twice as many, given what is in the middle of each."""
        left = tuple(map(np.concatenate, zip(self.left, middle, strict=True)))
        right = tuple(map(np.concatenate, zip(middle, self.right, strict=True)))
        return _Steps(np.concatenate([self.owner, self.owner]), left, right)


class _Tally:
    """What is summed up along the contours of N sums."""

    def __init__(self, sums: Sums) -> None:
        count = len(sums)
        self.sums = sums
        self.phase, self.omega = np.zeros(count), np.zeros(count)
        self.margin = np.full(count, np.inf)
        self.evaluations = np.zeros(count, dtype=np.int64)
        self.lost = np.zeros(count, dtype=bool)

    def at(self, owner: Places, x: Array, t: Complex) -> tuple[Complex, ...]:
        """Return x, t, log det Delta and its derivative at places t of the owners' contours."""
        log, rate = np.empty(len(x), dtype=complex), np.empty(len(x), dtype=complex)
        sizes = np.empty(len(x))
        for k in range(0, len(x), _FEW):
            part = slice(k, k + _FEW)
            value, slope, scale = self.sums.take(owner[part]).evaluate(t[part])
            sizes[part] = np.abs(value)
            log[part], rate[part] = _logarithm(value, slope, scale)
        np.add.at(self.evaluations, owner, 1)
        # Of several places of one owner the last one written is the smallest.
        order = np.argsort(-sizes, kind="stable")
        least, where = np.full(len(self.margin), np.inf), np.zeros(len(self.margin))
        least[owner[order]], where[owner[order]] = sizes[order], np.exp(t[order]).imag
        self.see(least, where)
        return x.astype(complex), t, log, rate

    def see(self, least: Array, where: Array) -> None:
        """Note the least size (N,) of determinants and the frequency there."""
        better = least < self.margin
        self.margin[better], self.omega[better] = least[better], where[better]

    def follow(self, steps: _Steps, contour: Callable[[Places, Array], Complex]) -> None:
        """Add up the changes of the phase, halving steps until they can be trusted."""
        while len(steps):
            good, change = _judge(steps)
            np.add.at(self.phase, steps.owner[good], change[good])
            narrow = ~good & (np.abs(steps.right[1] - steps.left[1]) < _ON_CONTOUR)
            self.lost[steps.owner[narrow]] = True
            steps = steps.take(~good & ~self.lost[steps.owner])
            x = 0.5 * (steps.left[0] + steps.right[0]).real
            steps = steps.split(self.at(steps.owner, x, contour(steps.owner, x)))


def count_right(sums: Sums, above: Array | float = 0.0) -> Counts:
    """Count the roots of every sum with Re s > above, s = 0 left out.

    Parameters
    ----------
    sums : Sums
        N of them.
    above : float or array (N,)
        The lines. Left of zero the branch cut is left out.
    """
    parts = [
        _count(sums.take(np.arange(k, min(k + _MANY, len(sums)))), _part(above, k))
        for k in range(0, len(sums), _MANY)
    ]
    return Counts(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def _part(above: Array | float, k: int) -> Array | float:
    return above[k : k + _MANY] if isinstance(above, np.ndarray) else above


def _count(
    sums: Sums, above: Array | float
) -> tuple[NDArray[np.int64], Array, Array, NDArray[np.int64]]:
    line = np.broadcast_to(np.asarray(above, dtype=float), (len(sums),))
    good = np.flatnonzero(
        np.isfinite(sums.coefficients).all(axis=0) & sums.coefficients.any(axis=0)
    )
    columns = (
        np.full(len(sums), UNKNOWN, dtype=np.int64),
        np.zeros(len(sums)),
        np.zeros(len(sums)),
        np.zeros(len(sums), dtype=np.int64),
    )
    if len(good):
        tally = _Tally(sums.take(good))
        turns = _on_axis(tally) if not line.any() else _on_lines(tally, line[good])
        number = np.round(turns)
        sure = (np.abs(turns - number) <= _TRUSTED) & (number >= 0.0) & ~tally.lost
        columns[0][good] = np.where(sure, number, UNKNOWN).astype(np.int64)
        columns[1][good], columns[2][good] = tally.margin, tally.omega
        columns[3][good] = tally.evaluations
    return columns


def _on_axis(tally: _Tally) -> Array:
    """Return the change of the phase over pi around the right half plane, its upper half."""
    sums = tally.sums
    inner, outer = _rims(sums, common=True)

    def contour(_: Places, x: Array) -> Complex:
        return np.asarray(x + 1j * _QUARTER)

    return _around(tally, (contour, outer, inner), None, np.ones(len(sums), dtype=bool))


def _rims(sums: Sums, *, common: bool) -> tuple[Array, Array]:
    """Return log |s| of the circles where contours end; the same for all where that may be."""
    inner, outer = sums.radii()
    if common and sums.exponents.shape[1] == 1:
        return np.full(len(sums), inner.min()), np.full(len(sums), outer.max())
    return inner, outer


def _on_lines(tally: _Tally, above: Array) -> Array:
    """Return the change of the phase over pi around what is right of the lines, its upper half."""
    inner, outer = _rims(tally.sums, common=bool(np.ptp(above) == 0.0))
    # Where every power is whole there is no cut, and the contour ends on the real axis.
    whole = bool(np.all(tally.sums.exponents == np.round(tally.sums.exponents)))
    size = np.maximum(np.abs(above), 1e-280)
    outer = np.maximum(outer, np.log(size) + 1.0)
    begin = np.arcsinh(np.sqrt(np.exp(2.0 * outer) - size**2) / size)
    end = np.arcsinh(np.sqrt(np.maximum(np.exp(2.0 * inner) - size**2, 0.0)) / size)

    def upright(which: Places, x: Array) -> Complex:
        # On the line's foot left of zero the upper lip of the branch cut is meant.
        return np.asarray(np.log(above[which] + 1j * np.maximum(size[which] * np.sinh(x), 0.0)))

    def lip(_: Places, x: Array) -> Complex:
        return np.asarray(x + 1j * np.pi)

    within = np.log(size) <= inner
    cut = np.flatnonzero(~within & (above < 0.0) & (not whole))
    turns = _around(tally, (upright, begin, end), (lip, np.log(size), inner, cut), within)
    # Roots s = 0 that such a contour goes around are left out.
    around = whole & ~within & (above < 0.0)
    return np.asarray(turns - np.where(around, tally.sums.leading()[2], 0.0))


def _around(
    tally: _Tally,
    down: tuple[Callable[[Places, Array], Complex], Array, Array],
    lip: tuple[Callable[[Places, Array], Complex], Array, Array, Places] | None,
    arrives: NDArray[np.bool_],
) -> Array:
    """Follow the line down, then the lip of the cut where there is one.

    `arrives` says which contours end on the inner circle even without a cut.
    """
    arrives = arrives.copy()
    contour, begin, end = down
    everyone = np.arange(len(tally.sums))
    tally.follow(_divided(tally, everyone, contour, begin, end), contour)
    last = contour(everyone, end)
    if lip is not None:
        along, start, inner, cut = lip
        tally.follow(_divided(tally, cut, along, start, inner), along)
        last[cut] = inner[cut] + 1j * np.pi
        arrives[cut] = True
    return _closed(tally, contour(everyone, begin), last, arrives)


def _closed(tally: _Tally, top: Complex, last: Complex, arrives: NDArray[np.bool_]) -> Array:
    """Add the arcs beyond the first and behind the last place t, where one power dominates.

    Contours that do not arrive at the inner circle end on the real axis, where the determinant is
    real.
    """
    sums = tally.sums
    e_high, high, e_low, low = sums.leading()
    phase = tally.phase + e_high * top.imag + _beyond(sums, top, e_high, high)
    inwards = e_low * last.imag + _beyond(sums, last, e_low, low)
    return np.asarray((phase - np.where(arrives, inwards, 0.0)) / np.pi)


def _beyond(sums: Sums, t: Complex, exponent: Array, place: Places) -> Array:
    """Return the phase at t beyond that of the power that dominates there."""
    value = sums.evaluate(t, 0)[0]
    sign = np.sign(np.take_along_axis(sums.coefficients, place[None, :], axis=0)[0])
    return np.asarray(np.angle(value * sign * np.exp(-1j * exponent * t.imag)))


def _divided(
    tally: _Tally,
    which: Places,
    contour: Callable[[Places, Array], Complex],
    begin: Array,
    end: Array,
) -> _Steps:
    """Return first steps along the contours of some, x from begin to end."""
    all_alike = tally.sums.exponents.shape[1] == 1 and len(which) == len(tally.sums)
    if all_alike and np.ptp(begin) == 0.0 and np.ptp(end) == 0.0:
        return _swept(tally, contour, float(begin[0]), float(end[0]))
    steps = np.maximum(3, np.ceil(np.abs(end - begin)[which] / _SPACING)).astype(np.int64)
    owner = np.repeat(which, steps + 1)
    stop = np.cumsum(steps + 1)
    share = (np.arange(len(owner)) - np.repeat(stop - steps - 1, steps + 1)) / np.repeat(
        steps, steps + 1
    )
    x = begin[owner] + share * (end - begin)[owner]
    columns = tally.at(owner, x, contour(owner, x))
    starts = np.delete(np.arange(len(owner)), stop - 1)
    left, right = tuple(c[starts] for c in columns), tuple(c[starts + 1] for c in columns)
    return _Steps(owner[starts], left, right)


def _swept(
    tally: _Tally, contour: Callable[[Places, Array], Complex], begin: float, end: float
) -> _Steps:
    """Return first steps along a contour that all share: products of matrices give them."""
    x = np.linspace(begin, end, max(4, int(np.ceil(abs(end - begin) / _SPACING)) + 1))
    t = contour(np.zeros(len(x), dtype=np.intp), x)
    value, slope, scale = tally.sums.at_common(t)
    everyone, sizes = np.arange(len(tally.sums)), np.abs(value)
    lowest = sizes.argmin(axis=0)
    tally.see(sizes[lowest, everyone], np.exp(t[lowest]).imag)
    tally.evaluations += len(x)
    log, rate = _logarithm(value, slope, scale)
    wide = [np.broadcast_to(row[:, None], log.shape) for row in (x.astype(complex), t)]
    columns = (*wide, log, rate)
    owner = np.broadcast_to(everyone, (len(x) - 1, len(everyone))).ravel()
    left = tuple(c[:-1].reshape(-1) for c in columns)
    return _Steps(owner, left, tuple(c[1:].reshape(-1) for c in columns))


def _logarithm(value: Complex, slope: Complex, scale: Array | Complex) -> tuple[Complex, Complex]:
    """Return the logarithm of a value, and its derivative."""
    with np.errstate(divide="ignore", invalid="ignore"):
        log = np.log(np.abs(value)) + scale + 1j * np.angle(value)
        return np.asarray(log), np.asarray(slope / value)


def _judge(steps: _Steps) -> tuple[NDArray[np.bool_], Array]:
    """Return which steps can be trusted, and the change of the phase in each."""
    _, t0, log0, rate0 = steps.left
    _, t1, log1, rate1 = steps.right
    step = t1 - t0
    with np.errstate(invalid="ignore"):
        predicted = 0.5 * (rate0 + rate1) * step
        raw = log1 - log0
        phase = (raw.imag + np.pi) % (2.0 * np.pi) - np.pi
        error = np.abs(raw.real + 1j * phase - predicted)
        turn = np.abs((rate1 - rate0) * step)
        good = (error <= _AGREEMENT) & (turn <= _LARGEST_TURN)
        good &= np.abs(predicted.imag) <= _LARGEST_PHASE
    return good, np.asarray(phase)
