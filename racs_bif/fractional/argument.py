"""Counting characteristic roots by the argument principle.

The phase of det Delta is followed along contours over t = log s. A step counts when the change of
log det Delta agrees, in modulus and phase, with the integral of its exact logarithmic derivative;
otherwise it is halved. det Delta has zeros but no poles, so a root beside the contour cannot hide:
the logarithmic derivative grows like one over the distance.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from racs_bif.errors import ConvergenceError
from racs_bif.fractional.characteristic import Characteristic
from racs_bif.fractional.polish import polish
from racs_bif.fractional.radii import Annulus, annulus

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from racs_bif.fractional.exact import ExactModel
    from racs_bif.fractional.laws import Complex
    from racs_bif.symbolic.field import Array

_SPACING = 0.4
_LARGEST_PHASE = 1.3
_LARGEST_TURN = 1.0
_AGREEMENT = 0.25
_ON_CONTOUR = 1e-9  # distance in log s
_ON_LINE = 1e-6
_SHIFTS = (1e-7, 1e-6, 1e-5, 1e-4)
_MOST_POINTS = 400_000

_Ends: TypeAlias = "tuple[np.ndarray, ...]"


class OnContourError(ConvergenceError):
    """Roots lie on a contour.

    Attributes
    ----------
    places : array
        Where on it, as log s.
    """

    def __init__(self, places: Complex) -> None:
        where = ", ".join(f"{s:.9g}" for s in np.exp(places[:3]))
        super().__init__(f"characteristic roots lie on the contour, at {where}")
        self.places = places


@dataclass(frozen=True)
class Piece:
    """A piece of a contour: t(x) for x from `start` to `stop`."""

    t: Callable[[Array], Complex]
    start: float
    stop: float


@dataclass(frozen=True)
class Change:
    """Change of log det Delta along a contour.

    Parameters
    ----------
    log : complex
        The change; its imaginary part is the phase, not wrapped.
    discrepancy : float
        Largest difference in a step to the integral of the logarithmic derivative.
    evaluations : int
        Number of determinants.
    """

    log: complex
    discrepancy: float
    evaluations: int


@dataclass(frozen=True)
class Count:
    """Number of characteristic roots right of a vertical line.

    Parameters
    ----------
    unstable : int
        Roots strictly right of the line, with multiplicity; s = 0 and roots on the line left out.
    above : float
        The line, Re s = above.
    on_line : tuple of complex
        Roots on the line, within about 1e-9 of their modulus, with Im s >= 0.
    at_zero : bool
        Whether s = 0 is a root.
    distance : float
        How far the phase was from a whole number of turns, as a number of roots.
    discrepancy : float
        Largest difference, in any step, to the integral of the logarithmic derivative [rad].
    evaluations : int
        Number of determinants.
    """

    unstable: int
    above: float
    on_line: tuple[complex, ...]
    at_zero: bool
    distance: float
    discrepancy: float
    evaluations: int


def follow(ch: Characteristic, pieces: Sequence[Piece]) -> Change:
    """Follow log det Delta along a contour.

    Raises
    ------
    OnContourError
        If roots lie on it.
    """
    if not pieces:
        return Change(0.0j, 0.0, 0)
    left, right = _begun(ch, pieces)
    total, worst, evaluations = 0.0j, 0.0, len(left[0]) + len(pieces)
    lost: list[complex] = []
    while len(left[0]):
        good, measured, error = _judge(left, right)
        total += complex(measured[good].sum())
        worst = max(worst, float(error[good].max(initial=0.0)))
        tiny = ~good & (np.abs(right[2] - left[2]) < _ON_CONTOUR)
        lost.extend(left[2][tiny])
        left, right = (tuple(a[~(good | tiny)] for a in side) for side in (left, right))
        which, x = left[0], 0.5 * (left[1] + right[1])
        t = _places(pieces, which, x)
        middle = (which, x, t, *ch.log_det(t)) if len(x) else left
        evaluations += len(x)
        if evaluations > _MOST_POINTS:
            msg = "the phase of det Delta varies too fast to be followed; scale the model"
            raise ConvergenceError(msg)
        left, right = (
            tuple(np.concatenate(pair) for pair in zip(left, middle, strict=True)),
            tuple(np.concatenate(pair) for pair in zip(middle, right, strict=True)),
        )
    if lost:
        raise OnContourError(_apart(np.array(lost)))
    return Change(total, worst, evaluations)


def _begun(ch: Characteristic, pieces: Sequence[Piece]) -> tuple[_Ends, _Ends]:
    """Return the ends of the first steps: which piece, x, t, log det Delta and its derivative."""
    counts = [max(3, int(np.ceil(abs(p.stop - p.start) / _SPACING))) + 1 for p in pieces]
    which = np.repeat(np.arange(len(pieces)), counts)
    x = np.concatenate(
        [np.linspace(p.start, p.stop, count) for p, count in zip(pieces, counts, strict=True)]
    )
    t = _places(pieces, which, x)
    values = (which, x, t, *ch.log_det(t))
    steps = np.flatnonzero(which[1:] == which[:-1])
    return tuple(a[steps] for a in values), tuple(a[steps + 1] for a in values)


def _places(pieces: Sequence[Piece], which: np.ndarray, x: Array) -> Complex:
    t = np.empty(len(x), dtype=complex)
    for k in np.unique(which):
        t[which == k] = pieces[k].t(x[which == k])
    return t


def _apart(places: Complex) -> Complex:
    """Return one place for each group that is close together."""
    kept: list[complex] = []
    for t in places:
        if all(abs(t - other) > 1e3 * _ON_CONTOUR for other in kept):
            kept.append(complex(t))
    return np.array(kept)


def _judge(left: _Ends, right: _Ends) -> tuple[np.ndarray, Complex, Array]:
    """Return which steps are good, the measured changes, and their difference to the predicted."""
    t0, log0, rate0 = left[2:]
    t1, log1, rate1 = right[2:]
    step = t1 - t0
    with np.errstate(invalid="ignore"):
        predicted = 0.5 * (rate0 + rate1) * step
        raw = log1 - log0
        phase = (raw.imag + np.pi) % (2.0 * np.pi) - np.pi
        measured = raw.real + 1j * phase
        error = np.abs(measured - predicted)
        turn = np.abs((rate1 - rate0) * step)
        good = (error <= _AGREEMENT) & (turn <= _LARGEST_TURN)
        good &= np.abs(predicted.imag) <= _LARGEST_PHASE
    return good, measured, error


def segment(a: complex, b: complex) -> Piece:
    """Return the straight piece from t = a to t = b."""
    length = abs(b - a)
    unit = (b - a) / length if length else 0.0
    return Piece(lambda x: np.asarray(a + unit * x, dtype=complex), 0.0, length)


def count_rectangle(ch: Characteristic, low: complex, high: complex) -> tuple[int, Change]:
    """Return the number of zeros of det Delta(exp(t)) in a rectangle over t.

    Raises
    ------
    OnContourError
        If a root lies on its boundary.
    """
    corners = [low, complex(high.real, low.imag), high, complex(low.real, high.imag), low]
    change = follow(ch, [segment(a, b) for a, b in itertools.pairwise(corners)])
    return round(change.log.imag / (2.0 * np.pi)), change


def count_unstable(model: ExactModel, X: Array, p: Array, above: float = 0.0) -> Count:
    """Count the characteristic roots right of the line Re s = above by the argument principle.

    Parameters
    ----------
    model : ExactModel
        The model.
    X : array (size,)
        States and outputs of elements at an equilibrium.
    p : array (np,)
        Base parameters.
    above : float
        The line. Left of zero the branch cut is left out.

    Raises
    ------
    ConvergenceError
        If the count cannot be trusted.
    """
    return count_right(Characteristic.of_model(model, X, p), above)


def count_right(ch: Characteristic, above: float = 0.0, *, ring: Annulus | None = None) -> Count:
    """Count roots right of Re s = above; see `count_unstable`.

    Parameters
    ----------
    ch : Characteristic
        The characteristic matrix.
    above : float
        The line.
    ring : Annulus, optional
        Where roots are, if that is known already.
    """
    ring = annulus(ch) if ring is None else ring
    try:
        change = follow(ch, _contour(ch, ring, above, 0.0))
    except OnContourError as error:
        return _count_beside(ch, ring, above, error.places)
    return _read(change, above, (), ring, ch)


def _read(
    change: Change,
    above: float,
    on_line: tuple[complex, ...],
    ring: Annulus,
    ch: Characteristic,
) -> Count:
    turns = change.log.imag / np.pi
    if ch.integer and above <= -np.exp(ring.inner):
        # Without a branch cut the contour goes around s = 0.
        turns -= round(ring.zero_order)
    number = round(turns)
    distance = abs(turns - number)
    if distance > 0.05 or number < 0:
        msg = (
            f"the argument principle gives {turns:.3f} roots right of Re s = {above:g}, which is "
            "no count; move the line or scale the model"
        )
        raise ConvergenceError(msg)
    return Count(
        number, above, on_line, ring.at_zero, distance, change.discrepancy, change.evaluations
    )


def _count_beside(ch: Characteristic, ring: Annulus, above: float, places: Complex) -> Count:
    """Count with the contour moved off roots that lie on it."""
    s = np.exp(polish(ch, places)[0])
    s = s[np.abs(s.real - above) <= _ON_LINE * np.abs(s)]
    on_line = tuple(complex(above, max(x.imag, 0.0)) for x in s[np.argsort(s.imag)])
    size = float(np.abs(s).max(initial=0.0))
    number = sum(2 if x.imag > _ON_LINE * abs(x) else 1 for x in on_line)
    for shift in _SHIFTS:
        try:
            right = follow(ch, _contour(ch, ring, above + shift * size, shift))
            left = follow(ch, _contour(ch, ring, above - shift * size, shift)) if number else right
        except OnContourError:
            continue
        if round((left.log.imag - right.log.imag) / np.pi) == number:
            return _read(right, above, on_line, ring, ch)
    msg = f"the roots on Re s = {above:g} cannot be counted, or are multiple; move the line"
    raise ConvergenceError(msg)


def _contour(ch: Characteristic, ring: Annulus, above: float, lip: float) -> list[Piece]:
    """Return the upper half of the boundary of the region, counter-clockwise; both ends are real.

    `lip` is how far below the branch cut, in arg s, the contour passes.
    """
    R, r = np.exp(ring.outer), np.exp(ring.inner)
    if above >= R:
        return []
    meets = above > -R
    angle = float(np.arccos(above / R)) if meets else np.pi - lip * (not ch.integer)
    pieces = [segment(complex(ring.outer, 0.0), complex(ring.outer, angle))]
    end = ring.outer
    if meets:
        pieces.append(_line(above, R, r))
        last = complex(pieces[-1].t(np.array([pieces[-1].stop]))[0])
        angle, end = last.imag, last.real
    inside = abs(above) < r
    if not inside and (above > 0.0 or ch.integer):
        return pieces
    if not inside:
        start = complex(end, np.pi - lip)
        if lip:
            pieces.append(segment(complex(end, angle), start))
        angle = start.imag
        pieces.append(segment(start, complex(ring.inner, angle)))
    pieces.append(segment(complex(ring.inner, angle), complex(ring.inner, 0.0)))
    return pieces


def _line(above: float, R: float, r: float) -> Piece:
    """Return the part of the line Re s = above between the circles, from the top downwards."""
    if above == 0.0:
        return Piece(lambda x: np.asarray(x + 0.5j * np.pi), float(np.log(R)), float(np.log(r)))
    size = abs(above)
    top = R * np.sqrt(max(1.0 - (above / R) ** 2, 0.0))
    bottom = r * np.sqrt(max(1.0 - (above / r) ** 2, 0.0))

    def t(x: Array) -> Complex:
        return np.asarray(np.log(above + 1j * size * np.sinh(x)))

    return Piece(t, float(np.arcsinh(top / size)), float(np.arcsinh(bottom / size)))
