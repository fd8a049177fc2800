"""Derivatives of a function that can only be called with numbers.

The one place of this package where derivatives are differences, for functions that cannot be
recorded nor run on power series; models that need it say so. Central formulas over nine points
(B. Fornberg, *Math. Comp.* 51 (1988) 699), by polarisation for mixed forms; the first derivative by
a complex step where the function allows that (W. Squire and G. Trapp, *SIAM Rev.* 40 (1998) 110),
which has no error but rounding.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Plain = Callable[[Array], Array]

_STEPS: Final = {1: 2e-3, 2: 1e-2, 3: 2e-2}
"""Distances between points, relative to the larger of one and the size of the variables."""
_TINY = 1e-100


@cache
def _weights(order: int, reach: int) -> tuple[float, ...]:
    """Return the weights of the points -reach ... reach for a derivative at 0, at distance one."""
    points = np.arange(-reach, reach + 1, dtype=float)
    powers = np.vander(points, increasing=True).T
    right = np.zeros(len(points))
    right[order] = math.factorial(order)
    return tuple(np.linalg.solve(powers, right))


def derivative(
    function: Plain, x: Array, directions: Sequence[Array], *, complex_step: bool, reach: int = 4
) -> Array:
    """Return a multilinear form of derivatives of a function of real numbers.

    Parameters
    ----------
    function : callable
        Maps (n,) to (k,).
    x : array (n,)
        Where.
    directions : sequence of array (n,)
        One to three directions, which may be complex.
    complex_step : bool
        Whether the function is analytic on complex numbers too.
    reach : int
        Points on each side; fewer give another value, which tells the error.
    """
    parts = [_real_parts(d) for d in directions]
    total: Array | float = 0.0
    for chosen in itertools.product(*parts):
        factor = math.prod(f for f, _ in chosen) if chosen else 1.0
        real = [d for _, d in chosen]
        total = total + factor * _polarised(
            function, x, real, complex_step=complex_step, reach=reach
        )
    return np.asarray(total)


def _real_parts(direction: Array) -> list[tuple[complex | float, Array]]:
    parts: list[tuple[complex | float, Array]] = [(1.0, np.asarray(direction.real, dtype=float))]
    if np.iscomplexobj(direction) and np.any(direction.imag):
        parts.append((1j, np.asarray(direction.imag, dtype=float)))
    return parts


def _polarised(
    function: Plain, x: Array, directions: list[Array], *, complex_step: bool, reach: int
) -> Array:
    """Return the mixed form from those along one direction."""
    sizes = [_size(x, d) for d in directions]
    if not all(sizes):
        return np.zeros(len(function(x)))
    first, *others = (d / s for d, s in zip(directions, sizes, strict=True))
    order = len(directions)
    total: Array | float = 0.0
    for signs in itertools.product((1.0, -1.0), repeat=len(others)):
        along = first + sum((s * d for s, d in zip(signs, others, strict=True)), np.zeros(len(x)))
        total = total + math.prod(signs) * _along(
            function, x, along, order, complex_step=complex_step, reach=reach
        )
    return np.asarray(total) * (math.prod(sizes) / (2.0 ** len(others) * math.factorial(order)))


def _size(x: Array, direction: Array) -> float:
    """Return how far a direction goes, relative to the size of the variables."""
    return float(np.max(np.abs(direction) / np.maximum(1.0, np.abs(x)), initial=0.0))


def _along(
    function: Plain, x: Array, along: Array, order: int, *, complex_step: bool, reach: int
) -> Array:
    """Return the derivative of an order of f(x + t along) by t at zero."""
    size = _size(x, along)
    if size == 0.0:
        return np.zeros(len(function(x)))
    along = along / size
    if complex_step:
        return _sum(lambda y: slope(function, y, along), x, along, order - 1, reach) * size**order
    return _sum(function, x, along, order, reach) * size**order


def _sum(function: Plain, x: Array, along: Array, order: int, reach: int) -> Array:
    if order == 0:
        return function(x)
    h = _STEPS[order]
    total: Array | float = 0.0
    for k, weight in zip(range(-reach, reach + 1), _weights(order, reach), strict=True):
        if abs(weight) > 1e-14:
            total = total + weight * function(x + k * h * along)
    return np.asarray(total) / h**order


def slope(function: Plain, x: Array, along: Array) -> Array:
    """Return the derivative of an analytic function by a complex step."""
    return np.asarray(function(x + 1j * _TINY * along).imag / _TINY)
