"""All positive zeros of a sum of real powers, none missed.

``f(x) = sum of c_k x**e_k`` divided by its lowest power has a derivative with one term less, whose
zeros part the half line into intervals in which f is monotone: Rolle's theorem, as in the proof of
Descartes' rule of signs for real exponents.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from racs_bif.fractional.laws import PowerSum
from racs_bif.fractional.power_sums import merged
from racs_bif.numerics.bracketing import root

if TYPE_CHECKING:
    from racs_bif.symbolic.field import Array

_NOISE = 1e-14
_FARTHEST = 650.0  # log x


def positive_zeros(coefficients: Array, exponents: Array) -> Array:
    """Return the places where a sum of real powers changes its sign.

    Parameters
    ----------
    coefficients, exponents : array (k,)
        The sum's terms.

    Returns
    -------
    array
        Logarithms of the zeros of odd multiplicity, ascending, each to about 1e-14. What is zero
        but for rounding counts as positive.
    """
    row = merged(PowerSum(coefficients, exponents))
    return _zeros(row.coefficients, row.exponents)


def _zeros(c: Array, e: Array) -> Array:
    signs = np.sign(c)
    if len(c) < 2 or np.all(signs == signs[0]):
        return np.zeros(0)
    e = e - e[0]
    turning = _zeros(c[1:] * e[1:], e[1:])
    edges = np.concatenate([[-_FARTHEST], turning, [_FARTHEST]])

    def value(y: float) -> float:
        # Over its largest term: the sign is what matters, and nothing overflows.
        logs = e * y + np.log(np.abs(c))
        total = float((signs * np.exp(logs - logs.max())).sum())
        return total if abs(total) > _NOISE else 0.0

    found = []
    values = [float(signs[0]), *(value(y) for y in turning), float(signs[-1])]
    for a, b, fa, fb in zip(edges, edges[1:], values, values[1:], strict=False):
        if fa * fb < 0.0:
            bracket = root(
                lambda y, _a, _b: (y, value(y)), (a, b, fa, fb), 1e-14 * max(1.0, abs(a))
            )
            if bracket is not None:
                found.append(0.5 * (bracket[0] + bracket[1]))
    return np.array(found)
