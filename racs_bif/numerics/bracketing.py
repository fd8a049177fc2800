"""Roots in a bracket, and dips below zero between two values of the same sign."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

_MOST = 100
_DIP_EVALUATIONS = 12
_DIP_NOISE = 1e-13

Bracket = tuple[float, float, float, float]
"""Both ends and the values there."""


def root(
    function: Callable[[float, float, float], tuple[float, float]],
    bracket: Bracket,
    tolerance: float,
) -> Bracket | None:
    """Shrink a bracket of a sign change by the ITP method.

    Source: I. F. D. Oliveira, R. H. C. Takahashi, ACM Trans. Math. Softw. 47 (2020) 5. It is never
    slower than bisection and needs no continuity.

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
    width = b - a
    budget = math.ceil(math.log2(max(width / tolerance, 1.0))) + 1
    for step in range(_MOST):
        if b - a <= tolerance:
            break
        middle = 0.5 * (a + b)
        secant = (fb * a - fa * b) / (fb - fa)
        truncation = 0.2 * (b - a) ** 2 / width
        sigma = math.copysign(1.0, middle - secant)
        x = secant + sigma * truncation if truncation <= abs(middle - secant) else middle
        reach = max(0.5 * tolerance * 2.0 ** (budget - step) - 0.5 * (b - a), 0.0)
        if abs(x - middle) > reach:
            x = middle - sigma * reach
        # A root within the tolerance of an end is boxed in from its other side.
        x = min(max(x, a + 0.4 * tolerance), b - 0.4 * tolerance)
        if not a < x < b:
            break
        x, value = function(x, a, b)
        if not math.isfinite(value):
            return None
        if value == 0.0:
            return x, x, 0.0, 0.0
        if (value > 0.0) == (fa > 0.0):
            a, fa = x, value
        else:
            b, fb = x, value
    return a, b, fa, fb


def vertex(xs: tuple[float, float, float], ys: tuple[float, float, float]) -> tuple[float, float]:
    """Return the vertex (x, y) of the parabola through three points; NaN unless it is a minimum.

    Examples
    --------
    >>> vertex((0.0, 1.0, 3.0), (5.0, 2.0, 2.0))
    (2.0, 1.0)
    """
    left, right = xs[1] - xs[0], xs[2] - xs[1]
    if left <= 0.0 or right <= 0.0:
        return math.nan, math.nan
    slope_left, slope_right = (ys[1] - ys[0]) / left, (ys[2] - ys[1]) / right
    curvature = (slope_right - slope_left) / (left + right)
    if not curvature > 0.0:
        return math.nan, math.nan
    slope = (slope_left * right + slope_right * left) / (left + right)
    offset = -0.5 * slope / curvature
    return xs[1] + offset, ys[1] + 0.5 * slope * offset


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
    margin = 1e-3 * (b - a)
    x, fx = function(min(max(guess, a + margin), b - margin), a, b)
    for _ in range(_DIP_EVALUATIONS):
        if fx < -noise:
            return x
        # Beyond the lower end, or too near to zero to tell.
        if not min(fa, fb) >= fx > noise:
            break
        trial, lowest = vertex((a, x, b), (fa, fx, fb))
        if not lowest < 0.9 * fx:
            break
        apart = 1e-3 * min(x - a, b - x)
        if abs(trial - x) < apart:
            trial = x + math.copysign(apart, (b - x) - (x - a))
        trial, value = function(trial, a, b)
        if not math.isfinite(value):
            break
        if value < fx:
            trial, x, value, fx = x, trial, fx, value
        if trial < x:
            a, fa = trial, value
        else:
            b, fb = trial, value
    return None
