"""Functions with a removable singularity, written so that they and their derivatives are finite.

``z/(exp(z) - 1)`` is smooth, but evaluates to 0/0 at z = 0, and its derivatives cancel near it.
Near zero it is replaced by its Taylor polynomial, and what stands on the other side is kept away
from zero, so that neither value nor derivative of any order meets the quotient where it fails.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import sympy as sp

_ORDER = 26
"""Degree of the polynomial: its remainder, 2 (z/2 pi)**28, is below 1e-21 for z**2 < 1.

The third derivative, which normal forms need, is then still exact to rounding.
"""


def over_expm1(z: sp.Expr) -> sp.Expr:
    """Return ``z/(exp(z) - 1)``, 1 at z = 0: the rate of a gate, the flux through a membrane.

    Parameters
    ----------
    z : sympy expression
        The argument, real.

    Returns
    -------
    sympy expression
        Equal to the quotient to rounding everywhere, up to its third derivative.

    Examples
    --------
    >>> import sympy as sp
    >>> over_expm1(sp.Symbol("V")).subs("V", 0)
    1
    """
    import sympy as sp

    square = z**2
    # Bernoulli numbers: those of odd index vanish but for the first. Horner, in the square.
    polynomial = sp.Integer(0)
    for k in range(_ORDER, 0, -2):
        polynomial = square * (sp.bernoulli(k) / sp.factorial(k) + polynomial)
    near = square < 1
    away = sp.Piecewise((sp.Integer(1), near), (z, True))
    return sp.Piecewise((1 - z / 2 + polynomial, near), (away / (sp.exp(away) - 1), True))
