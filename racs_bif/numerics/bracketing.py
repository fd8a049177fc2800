"""Roots in a bracket, and dips below zero between two values of the same sign."""

from __future__ import annotations

import math
from bisect import bisect, insort
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

_MOST = 100
_BEYOND = 0.2
_DIP_EVALUATIONS = 12
_DIP_PATIENCE = 3
_DIP_NOISE = 1e-13

Bracket = tuple[float, float, float, float]
"""Both ends and the values there."""


def root(
    function: Callable[[float, float, float], tuple[float, float]],
    bracket: Bracket,
    tolerance: float,
) -> Bracket | None:
    """Shrink a bracket of a sign change by inverse quadratic interpolation, or by bisection.

    Source: T. R. Chandrupatla, Adv. Eng. Softw. 28 (1997) 145: bisection wherever the quadratic
    would not be monotonic between the ends. The first trial is never at the root of the secant but
    a fifth of the bracket beyond: where the function is hard to evaluate at its root, at a branch
    point for instance, the surroundings are known first. None is nearer to an end than half of the
    tolerance: a root there is boxed in from its other side.

    Parameters
    ----------
    function : callable
        Called with (x, a, b), a < x < b; returns the abscissa it took, which may be another one
        between a and b, and the value there.
    bracket : tuple
        (a, b, value at a, value at b), the values of opposite signs.
    tolerance : float
        Largest width of the bracket returned.

    Returns
    -------
    tuple or None
        The smaller bracket; of no width where a value is exactly zero. None at a value that is not
        finite.
    """
    a, b, fa, fb = bracket
    secant = (fb * a - fa * b) / (fb - fa)
    x = secant + math.copysign(_BEYOND * (b - a), 0.5 * (a + b) - secant)
    for _ in range(_MOST):
        if b - a <= tolerance:
            break
        least = min(0.5 * tolerance, 0.25 * (b - a))
        x = min(max(x, a + least), b - least)
        if not a < x < b:
            break
        x, value = function(x, a, b)
        if not math.isfinite(value):
            return None
        if value == 0.0:
            return x, x, 0.0, 0.0
        if (value > 0.0) == (fa > 0.0):
            third, a, fa = (a, fa), x, value
            x = _next((a, fa), (b, fb), third)
        else:
            third, b, fb = (b, fb), x, value
            x = _next((b, fb), (a, fa), third)
    return a, b, fa, fb


def _next(
    latest: tuple[float, float], other: tuple[float, float], third: tuple[float, float]
) -> float:
    """Return the next trial from both ends of the bracket and the end before."""
    (x, f), (y, g), (z, h) = latest, other, third
    xi, phi = (x - y) / (z - y), (f - g) / (h - g)
    share = 0.5
    if phi * phi < xi and (1.0 - phi) ** 2 < 1.0 - xi:
        share = f / (g - f) * h / (g - h) + (z - x) / (y - x) * f / (h - f) * g / (h - g)
    return x + share * (y - x)


def vertex(xs: tuple[float, float, float], ys: tuple[float, float, float]) -> tuple[float, float]:
    """Return the vertex (x, y) of the parabola through three points; NaN unless it is a minimum.

    Examples
    --------
    >>> vertex((0.0, 1.0, 3.0), (5.0, 2.0, 2.0))
    (2.0, 1.0)
    """
    (x, y, z), (fx, fy, fz) = xs, ys
    left, right = y - x, z - y
    if left <= 0.0 or right <= 0.0:
        return math.nan, math.nan
    slope_left, slope_right = (fy - fx) / left, (fz - fy) / right
    bend = slope_right - slope_left
    if not bend > 0.0:
        return math.nan, math.nan
    slope = slope_left * right + slope_right * left
    offset = -0.5 * slope / bend
    return y + offset, fy + 0.5 * slope * offset / (left + right)


def dip(
    function: Callable[[float, float, float], tuple[float, float]],
    bracket: Bracket,
    guess: float,
) -> float | None:
    """Look for a place where a function that is positive at both ends is negative.

    Parameters
    ----------
    function : callable
        As of `root`.
    bracket : tuple
        (a, b, value at a, value at b), both values positive.
    guess : float
        Where the minimum may be, between a and b.

    Returns
    -------
    float or None
        The place; None where the minimum is positive, or zero but for rounding.
    """
    a, b, fa, fb = bracket
    noise = _DIP_NOISE * max(fa, fb)
    seen = [(a, fa), (b, fb)]
    trial = guess
    for evaluation in range(_DIP_EVALUATIONS):
        place = bisect(seen, (trial, -math.inf))
        low, high = seen[place - 1][0], seen[place][0]
        apart = 1e-3 * (high - low)
        trial, value = function(min(max(trial, low + apart), high - apart), low, high)
        if value < -noise:
            return trial
        if not value > noise:
            # NaN, or too near to zero to tell.
            return None
        insort(seen, (trial, value))
        lowest = min(range(len(seen)), key=lambda i: seen[i][1])
        middle = min(max(lowest, 1), len(seen) - 2)
        (x, fx), (y, fy), (z, fz) = seen[middle - 1 : middle + 2]
        trial, least = vertex((x, y, z), (fx, fy, fz))
        hopeless = evaluation >= _DIP_PATIENCE and not least < 0.9 * seen[lowest][1]
        if hopeless or not a < trial < b:
            return None
    return None
