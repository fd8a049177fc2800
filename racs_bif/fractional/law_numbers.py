"""From a symbolic transfer law to one in numbers, without a model around it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import ParameterError, nearest
from racs_bif.fractional.laws import Law, read_numbers
from racs_bif.symbolic.laws import read_law

if TYPE_CHECKING:
    from collections.abc import Mapping

    import sympy as sp


def law_in_numbers(
    expression: sp.Expr, values: Mapping[str, float] | None = None, *, name: str = "Z"
) -> Law:
    """Return a transfer law in numbers.

    Parameters
    ----------
    expression : sympy expression
        Z(s), for example of `racs_bif.symbolic.named_laws`.
    values : mapping of str to float
        Values of its parameters.
    name : str
        Name for messages.

    Raises
    ------
    ModelError
        If it is not a quotient of sums of powers of s.
    ParameterError
        If a parameter has no value or a given one does not occur, or numbers are not finite.

    Examples
    --------
    >>> from racs_bif.symbolic.named_laws import springpot
    >>> law = law_in_numbers(springpot("c", "alpha"), {"c": 3.0, "alpha": 0.5})
    >>> print(law(4.0).real)
    6.0
    """
    import sympy as sp

    values = dict(values or {})
    numerator, denominator = read_law(name, sp.sympify(expression))
    parts = (
        *numerator.coefficients,
        *numerator.exponents,
        *denominator.coefficients,
        *denominator.exponents,
    )
    wanted = {symbol.name for part in parts for symbol in part.free_symbols}
    if unknown := sorted(set(values) - wanted):
        msg = f"law '{name}' has no parameter '{unknown[0]}'; {nearest(unknown[0], sorted(wanted))}"
        raise ParameterError(msg)
    if missing := sorted(wanted - set(values)):
        msg = f"law '{name}' needs a value of '{missing[0]}'"
        raise ParameterError(msg)
    given = {sp.Symbol(key): value for key, value in values.items()}
    numbers = [complex(part.subs(given)) for part in parts]
    if any(x.imag for x in numbers):
        msg = f"law '{name}' is not real at these parameters; keep its times positive"
        raise ParameterError(msg)
    sizes = len(numerator.exponents), len(denominator.exponents)
    return read_numbers(name, np.array([x.real for x in numbers]), sizes, feedthrough=True)
