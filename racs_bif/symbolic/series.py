"""Taylor coefficients of elementary functions at a number, by the recurrences of their equations.

A. Griewank and A. Walther, *Evaluating Derivatives*, SIAM 2008, chapter 13. A list ``c`` stands for
``c[0] + c[1] t + c[2] t**2 + ...``, cut off after the degree wanted.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Callable

Series = list[float]


def _to_power(a: Series, exponent: float) -> Series:
    """Return a**exponent, where a[0] is not zero."""
    c = [math.pow(a[0], exponent)]
    for k in range(1, len(a)):
        terms = ((exponent * i - (k - i)) * a[i] * c[k - i] for i in range(1, k + 1))
        c.append(sum(terms) / (k * a[0]))
    return c


def _integrated(slope: Series, value: float) -> Series:
    return [value, *(s / (k + 1) for k, s in enumerate(slope[:-1]))]


def _parabola(x: float, degree: int, signs: tuple[float, float]) -> Series:
    """Return ``signs[0] + signs[1] * (x + t)**2``."""
    one, square = signs
    c = [one + square * x * x, 2.0 * square * x, square]
    return (c + [0.0] * degree)[: degree + 1]


def power(x: float, exponent: float, degree: int) -> Series:
    """Return the series of ``(x + t)**exponent``."""
    c, binomial = [], 1.0
    for k in range(degree + 1):
        c.append(binomial * math.pow(x, exponent - k) if binomial else 0.0)
        binomial *= (exponent - k) / (k + 1)
    return c


def _exp(x: float, degree: int) -> Series:
    return [math.exp(x) / math.factorial(k) for k in range(degree + 1)]


def _log(x: float, degree: int) -> Series:
    return [math.log(x), *(-((-1.0 / x) ** k) / k for k in range(1, degree + 1))]


def _cycle(values: tuple[float, ...], degree: int) -> Series:
    return [values[k % len(values)] / math.factorial(k) for k in range(degree + 1)]


def _sin(x: float, degree: int) -> Series:
    s, c = math.sin(x), math.cos(x)
    return _cycle((s, c, -s, -c), degree)


def _cos(x: float, degree: int) -> Series:
    s, c = math.sin(x), math.cos(x)
    return _cycle((c, -s, -c, s), degree)


def _riccati(value: float, sign: float, degree: int) -> Series:
    """Return the series of a solution of ``y' = 1 + sign y**2``."""
    c = [value]
    for k in range(degree):
        square = sum(c[i] * c[k - i] for i in range(k + 1))
        c.append(((1.0 if k == 0 else 0.0) + sign * square) / (k + 1))
    return c


def _from_slope(
    function: Callable[[float], float], signs: tuple[float, float], exponent: float, factor: float
) -> Callable[[float, int], Series]:
    """Make the series of a function whose slope is ``factor * (one + sign x**2)**exponent``."""

    def series(x: float, degree: int) -> Series:
        slope = _to_power(_parabola(x, degree, signs), exponent)
        return _integrated([factor * s for s in slope], function(x))

    return series


def _erf(x: float, degree: int) -> Series:
    linear = _parabola(x, degree, (0.0, -1.0))
    gauss = [2.0 / math.sqrt(math.pi) * math.exp(linear[0])]
    for k in range(1, degree + 1):
        terms = (i * linear[i] * gauss[k - i] for i in range(1, k + 1))
        gauss.append(sum(terms) / k)
    return _integrated(gauss, math.erf(x))


def _flat(value: float, slope: float, degree: int) -> Series:
    return ([value, slope] + [0.0] * degree)[: degree + 1]


def _sign(x: float) -> float:
    return math.copysign(1.0, x) if x else 0.0


ELEMENTARY: Final[dict[str, Callable[[float, int], Series]]] = {
    "exp": _exp,
    "log": _log,
    "sqrt": lambda x, degree: power(x, 0.5, degree),
    "sin": _sin,
    "cos": _cos,
    "tan": lambda x, degree: _riccati(math.tan(x), 1.0, degree),
    "tanh": lambda x, degree: _riccati(math.tanh(x), -1.0, degree),
    "sinh": lambda x, degree: _cycle((math.sinh(x), math.cosh(x)), degree),
    "cosh": lambda x, degree: _cycle((math.cosh(x), math.sinh(x)), degree),
    "asin": _from_slope(math.asin, (1.0, -1.0), -0.5, 1.0),
    "acos": _from_slope(math.acos, (1.0, -1.0), -0.5, -1.0),
    "atan": _from_slope(math.atan, (1.0, 1.0), -1.0, 1.0),
    "asinh": _from_slope(math.asinh, (1.0, 1.0), -0.5, 1.0),
    "acosh": _from_slope(math.acosh, (-1.0, 1.0), -0.5, 1.0),
    "atanh": _from_slope(math.atanh, (1.0, -1.0), -1.0, 1.0),
    "erf": _erf,
    "fabs": lambda x, degree: _flat(abs(x), _sign(x), degree),
    "sign": lambda x, degree: _flat(_sign(x), 0.0, degree),
}
"""The series of every function of one argument that compiled models call."""
