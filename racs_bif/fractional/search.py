"""All zeros of det Delta(exp(t)) in a rectangle over t = log s: estimated, polished, counted.

Each rectangle's zeros are counted by the argument principle, estimated by Beyn's method and
polished by Newton's. A rectangle whose number does not come out is cut in two; what cannot be cut
any more is a multiple zero.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import ConvergenceError
from racs_bif.fractional.argument import OnContourError, count_rectangle
from racs_bif.fractional.beyn import roots_in_disc
from racs_bif.fractional.polish import polish

if TYPE_CHECKING:
    from racs_bif.fractional.characteristic import Characteristic
    from racs_bif.fractional.laws import Complex
    from racs_bif.symbolic.field import Array

_AT_ONCE = 6
_ASPECT = 2.0
_CONVERGED = 1e-9
_CLOSE = 1e-4
_CUTS = (0.5137, 0.4561, 0.5823, 0.3947, 0.6411)
_CIRCLES = (1.0, 0.1, 10.0, 0.01)
_CLEAR = 0.4
"""Circles around groups of estimates reach so far towards others."""
_FELT = 1e2
"""A sum of powers that is so many times its error is none of rounding."""
_EPSILON = float(np.finfo(float).eps)


@dataclass(frozen=True)
class Zeros:
    """Zeros of det Delta(exp(t)).

    Parameters
    ----------
    t : array (k,)
        The zeros.
    errors : array (k,)
        Last Newton corrections; for a multiple zero what is left of the error of the mean, or how
        far the zeros lie apart where that is felt.
    multiplicities : array (k,) of int
        Multiplicities.
    """

    t: Complex
    errors: Array
    multiplicities: np.ndarray


@dataclass(frozen=True)
class _Box:
    low: complex
    high: complex

    @property
    def centre(self) -> complex:
        return 0.5 * (self.low + self.high)

    @property
    def radius(self) -> float:
        return 0.5 * abs(self.high - self.low)

    def holds(self, t: Complex) -> np.ndarray:
        real = (self.low.real < t.real) & (t.real < self.high.real)
        return np.asarray(real & (self.low.imag < t.imag) & (t.imag < self.high.imag))

    def halves(self, fraction: float) -> tuple[_Box, _Box]:
        size = self.high - self.low
        if size.real >= size.imag:
            x = self.low.real + fraction * size.real
            return _Box(self.low, complex(x, self.high.imag)), _Box(
                complex(x, self.low.imag), self.high
            )
        y = self.low.imag + fraction * size.imag
        return _Box(self.low, complex(self.high.real, y)), _Box(
            complex(self.low.real, y), self.high
        )

    @property
    def aspect(self) -> float:
        size = self.high - self.low
        return max(size.real, size.imag) / min(size.real, size.imag)


def zeros_in_rectangle(ch: Characteristic, low: complex, high: complex) -> Zeros:
    """Find all zeros in a rectangle.

    Parameters
    ----------
    ch : Characteristic
        The characteristic matrix.
    low, high : complex
        Lower left and upper right corner.

    Raises
    ------
    OnContourError
        If a zero lies on the boundary.
    ConvergenceError
        If the zeros found do not agree with their number.
    """
    box = _Box(low, high)
    number, _ = count_rectangle(ch, low, high)
    found: list[Zeros] = []
    pending = [(box, number)]
    while pending:
        box, number = pending.pop()
        if number < 0:
            msg = "the argument principle gives a negative number of roots; scale the model"
            raise ConvergenceError(msg)
        if number == 0:
            continue
        if number <= _AT_ONCE and box.aspect <= _ASPECT:
            zeros = _solve(ch, box, number)
            if zeros is not None:
                found.append(zeros)
                continue
        pending.extend(_cut(ch, box, number))
    return _joined(found)


def _cut(ch: Characteristic, box: _Box, number: int) -> list[tuple[_Box, int]]:
    if box.radius < 1e-7:
        msg = f"{number} roots near {np.exp(box.centre):.9g} cannot be told apart; scale the model"
        raise ConvergenceError(msg)
    for fraction in _CUTS:
        first, second = box.halves(fraction)
        try:
            inside, _ = count_rectangle(ch, first.low, first.high)
        except OnContourError:
            continue
        return [(first, inside), (second, number - inside)]
    msg = f"roots near {np.exp(box.centre):.9g} cannot be separated; scale the model"
    raise ConvergenceError(msg)


def _solve(ch: Characteristic, box: _Box, number: int) -> Zeros | None:
    """Return all zeros in a box, None if their number does not come out."""
    try:
        estimates = roots_in_disc(ch, box.centre, 1.05 * box.radius, number + 2)
    except np.linalg.LinAlgError:
        return None
    near = np.abs(estimates - box.centre) < 1.5 * box.radius
    t, errors = polish(ch, estimates[near])
    keep = box.holds(t)
    t, errors = t[keep], errors[keep]
    good = errors <= _CONVERGED
    zeros = _distinct(t[good], errors[good])
    if len(zeros.t) == number:
        return zeros
    return _with_multiple(ch, box, (t, zeros), number)


def _distinct(t: Complex, errors: Array) -> Zeros:
    """Keep one of each group of estimates that agree within their errors, the best."""
    kept: list[int] = []
    for k in np.argsort(errors, kind="stable"):
        if all(abs(t[k] - t[j]) > 1e2 * (errors[k] + errors[j]) for j in kept):
            kept.append(int(k))
    return Zeros(t[kept], errors[kept], np.ones(len(kept), dtype=int))


def _with_multiple(
    ch: Characteristic, box: _Box, estimates: tuple[Complex, Zeros], number: int
) -> Zeros | None:
    """Return the zeros of a box, some of them multiple; None if the number does not come out."""
    t, simple = estimates
    parts: list[Zeros] = []
    groups: list[Complex] = []
    for x in t:
        for k, group in enumerate(groups):
            if np.abs(group - x).min() < _CLOSE:
                groups[k] = np.append(group, x)
                break
        else:
            groups.append(np.array([x]))
    for group in groups:
        others = np.concatenate([simple.t, *(other for other in groups if other is not group)])
        away = np.abs(others - group.mean())
        clear = _CLEAR * away[away > np.abs(group - group.mean()).max() + _CLOSE].min(
            initial=np.inf
        )
        part = _group(ch, group, simple, clear)
        if part is None:
            return None
        parts.append(part)
    zeros = _joined(parts)
    if int(zeros.multiplicities.sum()) != number or not box.holds(zeros.t).all():
        return None
    return zeros


def _group(ch: Characteristic, group: Complex, simple: Zeros, clear: float) -> Zeros | None:
    """Return the zeros near a group of estimates, no others being nearer than `clear`."""
    centre = complex(group.mean())
    for factor in _CIRCLES:
        radius = min(factor * _CLOSE * 3.0, clear)
        corner = radius * (1.0 + 1.0j)
        try:
            number, _ = count_rectangle(ch, centre - corner, centre + corner)
        except OnContourError:
            continue
        inside = np.abs(simple.t - centre) < radius
        if number == inside.sum():
            return Zeros(simple.t[inside], simple.errors[inside], simple.multiplicities[inside])
        if number == 0:
            return Zeros(np.zeros(0, complex), np.zeros(0), np.zeros(0, dtype=int))
        (coarse, rough), (fine, sums) = (
            _power_sums(ch, centre, 1.5 * radius, number, n) for n in (32, 64)
        )
        if np.abs(group - fine).max() < radius:
            felt = np.abs(sums) > _FELT * np.abs(sums - rough)
            sizes = np.abs(sums) ** (1.0 / np.arange(2, number + 1))
            error = max(abs(fine - coarse), _EPSILON, *sizes[felt])
            return Zeros(np.array([fine]), np.array([error]), np.array([number]))
    return None


def _power_sums(
    ch: Characteristic, centre: complex, radius: float, number: int, nodes: int
) -> tuple[complex, Complex]:
    """Return the mean of the zeros in a disc, and sums of the powers 2... of what they are off it.

    They are well conditioned where the zeros coincide; so much as one is off the mean, some sum has
    a root of about that size (P. Turan's second main theorem).
    """
    unit = np.exp(2j * np.pi * (np.arange(nodes) + 0.5) / nodes)
    weight = unit * ch.log_det(centre + radius * unit)[1] * radius / nodes
    mean = complex((weight @ (radius * unit)) / number)
    powers = (radius * unit - mean) ** np.arange(2, number + 1)[:, None]
    return centre + mean, np.asarray(powers @ weight)


def _joined(parts: list[Zeros]) -> Zeros:
    if not parts:
        return Zeros(np.zeros(0, complex), np.zeros(0), np.zeros(0, dtype=int))
    return Zeros(
        np.concatenate([p.t for p in parts]),
        np.concatenate([p.errors for p in parts]),
        np.concatenate([p.multiplicities for p in parts]),
    )
