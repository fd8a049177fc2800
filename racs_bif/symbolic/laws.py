"""Reading a transfer law: a quotient of sums of powers of the Laplace variable."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from racs_bif.errors import ModelError
from racs_bif.symbolic.model import LAPLACE

if TYPE_CHECKING:
    import sympy as sp


@dataclass(frozen=True)
class PowerSum:
    """A sum of ``coefficient * s**exponent``, both in terms of parameters."""

    coefficients: tuple[sp.Expr, ...]
    exponents: tuple[sp.Expr, ...]


def read_law(output: str, law: sp.Expr) -> tuple[PowerSum, PowerSum]:
    """Split a law into numerator and denominator.

    Parameters
    ----------
    output : str
        Name of the element's output, for messages.
    law : sympy expression
        The law Z(s).

    Returns
    -------
    (PowerSum, PowerSum)
        Numerator and denominator.

    Raises
    ------
    ModelError
        If the law is not a quotient of sums of powers of s.
    """
    import sympy as sp

    _check_functions(output, law)
    names = sorted({symbol.name for symbol in law.free_symbols} | {LAPLACE})
    positive = {name: sp.Symbol(name, positive=True) for name in names}
    plain = {symbol: positive[symbol.name] for symbol in law.free_symbols}
    s = positive[LAPLACE]
    numerator, denominator = sp.fraction(sp.together(law.subs(plain, simultaneous=True)))
    back = {symbol: sp.Symbol(name) for name, symbol in positive.items()}
    return (
        _power_sum(output, law, numerator, s, back),
        _power_sum(output, law, denominator, s, back),
    )


def _check_functions(output: str, law: sp.Expr) -> None:
    """Refuse functions of s before s is taken for positive, where the modulus of s is s."""
    import sympy as sp

    for part in sp.preorder_traversal(law):
        plain = part.is_Add or part.is_Mul or part.is_Pow or part.is_Atom
        if not plain and any(symbol.name == LAPLACE for symbol in part.free_symbols):
            raise _refusal(output, law)


def _refusal(output: str, law: sp.Expr) -> ModelError:
    return ModelError(
        f"law of '{output}', {law}, is not a quotient of sums of powers of s; "
        "write it as a sum of coefficients times s**order over another such sum"
    )


def _power_sum(
    output: str, law: sp.Expr, expression: sp.Expr, s: sp.Symbol, back: dict[sp.Symbol, sp.Symbol]
) -> PowerSum:
    import sympy as sp

    terms: dict[sp.Expr, sp.Expr] = {}
    for term in sp.Add.make_args(sp.expand(sp.powdenest(expression, force=True))):
        coefficient, rest = term.as_independent(s, as_Add=False)
        rest = sp.powsimp(rest, combine="exp")
        base, exponent = rest.as_base_exp() if rest != 1 else (s, sp.Integer(0))
        if base != s or exponent.has(s):
            raise _refusal(output, law)
        terms[exponent] = terms.get(exponent, sp.Integer(0)) + coefficient
    ordered = sorted(terms, key=sp.default_sort_key)
    return PowerSum(
        tuple(terms[e].subs(back) for e in ordered), tuple(e.subs(back) for e in ordered)
    )
