"""Relaxation and creep of transfer laws, where Mittag-Leffler functions give them in closed form.

The relaxation modulus is the inverse Laplace transform of Z(s)/s, the creep compliance that of
1/(s Z(s)). With a denominator of one term ``d s**q`` every term of the numerator is a power of t;
with two, ``d (s**a + lambda) s**q``, it is ``t**(b-1) E_{a,b}(-lambda t**a)``. That covers
springpot, Kelvin-Voigt, Maxwell, Zener and the laws (1a), (1b), (2a), (2b), but for creep where Z
has three terms above.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import UsageError
from racs_bif.fractional.mittag_leffler import mittag_leffler
from racs_bif.fractional.power_sums import merged

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from racs_bif.fractional.laws import Law, PowerSum
    from racs_bif.symbolic.field import Array


def relaxation(law: Law, t: ArrayLike) -> Array:
    """Return the stress after a unit step of strain.

    Parameters
    ----------
    law : Law
        The law in numbers.
    t : array_like
        Times after the step, t > 0 [s]; an impulse at t = 0 does not show.

    Raises
    ------
    UsageError
        If a time is not positive, or the law's denominator has more than two terms or an order
        over 2.
    """
    return _step_response(law.numerator, law.denominator, t, f"relaxation of '{law.name}'")


def creep(law: Law, t: ArrayLike) -> Array:
    """Return the strain after a unit step of stress.

    Parameters
    ----------
    law : Law
        The law in numbers.
    t : array_like
        Times after the step, t > 0 [s].

    Raises
    ------
    UsageError
        If a time is not positive, or the law's numerator has more than two terms or an order over
        2.
    """
    return _step_response(law.denominator, law.numerator, t, f"creep of '{law.name}'")


def _step_response(above: PowerSum, below: PowerSum, t: ArrayLike, what: str) -> Array:
    t = np.asarray(t, dtype=float)
    if not np.all((t > 0.0) & np.isfinite(t)):
        msg = f"the {what} is there for times above zero; give finite, positive ones"
        raise UsageError(msg)
    above, below = merged(above), merged(below)
    terms = len(below.exponents)
    if terms not in {1, 2}:
        msg = (
            f"the {what} has no closed form: {terms} powers of s to divide by, one or two can be; "
            "simulate it instead"
        )
        raise UsageError(msg)
    if terms == 1:
        return _powers(above, below, t)
    order = float(below.exponents[1] - below.exponents[0])
    if order > 2.0:
        msg = f"the {what} has no closed form here: the order {order:g} is over 2; simulate it"
        raise UsageError(msg)
    rate = float(below.coefficients[0] / below.coefficients[1])
    total = np.zeros(t.shape)
    for c, e in zip(above.coefficients, above.exponents, strict=True):
        b = float(order - e + 1.0 + below.exponents[0])
        total += (
            c / below.coefficients[1] * t ** (b - 1.0) * mittag_leffler(order, b, -rate * t**order)
        )
    return total


def _powers(above: PowerSum, below: PowerSum, t: Array) -> Array:
    from scipy.special import rgamma

    powers = below.exponents[0] - above.exponents
    weights = above.coefficients / below.coefficients[0] * rgamma(1.0 + powers)
    return np.asarray((weights * t[..., None] ** powers).sum(axis=-1))
