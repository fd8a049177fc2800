"""Recording what a plain Python function computes, as sympy expressions.

The function runs on numbers that remember how they came about. Where it branches on one of them it
is run again for the other answer, and the results are joined by the condition: every path through
the function becomes part of one straight-line program. Long expressions get a name of their own, so
that what is used many times is written once.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from racs_bif.symbolic.overload import NotTraceable, Overloaded

if TYPE_CHECKING:
    import sympy as sp

_LONGEST = 60
"""Operations that an expression may have before it becomes a term with a name."""
_PATHS = 64
"""Paths through a function that are recorded; one with more is not straight-line enough."""
_QUESTIONS = 24
"""Conditions that one path may depend on."""
_RELATIONS: Final = {"lt": "Lt", "le": "Le", "gt": "Gt", "ge": "Ge", "eq": "Eq", "ne": "Ne"}
_UNARY: Final = {
    **{"fabs": "Abs", "sign": "sign", "erf": "erf", "exp": "exp", "log": "log", "sqrt": "sqrt"},
    **{name: name for name in ("sin", "cos", "tan", "asin", "acos", "atan")},
    **{name: name for name in ("sinh", "cosh", "tanh", "asinh", "acosh", "atanh")},
}


@dataclass
class Tape:
    """What was recorded.

    Attributes
    ----------
    prefix : str
        How the names of terms begin.
    terms : dict of expression to symbol
        The terms, in the order in which they were made.
    answers : list of bool
        What the conditions of this path are taken to be; it grows as they are asked.
    asked : list of condition
        The conditions of this path.
    """

    prefix: str
    terms: dict[sp.Expr, sp.Symbol] = field(default_factory=dict)
    answers: list[bool] = field(default_factory=list)
    asked: list[sp.Basic] = field(default_factory=list)

    def answer(self, condition: sp.Basic) -> bool:
        """Return what a condition is on this path."""
        if condition in self.asked:
            return self.answers[self.asked.index(condition)]
        k = len(self.asked)
        if k == _QUESTIONS:
            msg = f"it branches on more than {_QUESTIONS} conditions in one call"
            raise NotTraceable(msg)
        self.asked.append(condition)
        if k == len(self.answers):
            self.answers.append(True)
        return self.answers[k]

    def short(self, expression: sp.Expr, size: int) -> tuple[sp.Expr, int]:
        """Return an expression, or the name of its term where it is long, with its length."""
        import sympy as sp

        if size <= _LONGEST:
            return expression, size
        symbol = self.terms.get(expression)
        if symbol is None:
            symbol = sp.Symbol(f"{self.prefix}{len(self.terms) + 1}")
            self.terms[expression] = symbol
        return symbol, 1


class Traced(Overloaded):
    """A number that is an expression.

    Parameters
    ----------
    tape : Tape
        Where conditions and terms are kept.
    expression : sympy expression
        What it is.
    size : int
        How many operations the expression has.
    """

    __slots__ = ("expression", "size", "tape")

    def __init__(self, tape: Tape, expression: sp.Expr, size: int = 1) -> None:
        self.tape, self.expression, self.size = tape, expression, size

    def __repr__(self) -> str:
        return str(self.expression)

    def __bool__(self) -> bool:
        return bool(self.compare("ne", self, 0.0))

    def primitive(self, name: str, *args: Any) -> Traced:  # noqa: ANN401 - numbers
        """Return an operation as a further expression."""
        import sympy as sp

        parts = [self._part(a) for a in args]
        operands = [expression for expression, _ in parts]
        if name in _UNARY:
            value = getattr(sp, _UNARY[name])(*operands)
        else:
            value = _ARITHMETIC[name](*operands)
        return Traced(self.tape, value, 1 + sum(size for _, size in parts))

    def compare(self, name: str, a: Any, b: Any) -> Condition | bool:  # noqa: ANN401 - numbers
        """Return a condition."""
        import sympy as sp

        left, right = self._part(a)[0], self._part(b)[0]
        relation = getattr(sp, _RELATIONS[name])
        if left.is_number and right.is_number:
            return bool(relation(left, right))
        return Condition(self.tape, relation(left, right, evaluate=False))

    def _part(self, number: Any) -> tuple[sp.Expr, int]:  # noqa: ANN401 - a number
        if isinstance(number, Traced):
            return self.tape.short(number.expression, number.size)
        return _exactly(number), 1


@dataclass(frozen=True, eq=False)
class Condition:
    """A comparison that the function may branch on; in sums and products it is one or zero."""

    tape: Tape
    relation: sp.Basic

    def __bool__(self) -> bool:
        return self.tape.answer(self.relation)

    def choose(self, a: Any, b: Any) -> Traced:  # noqa: ANN401 - numbers
        """Return `a` where the condition holds, `b` elsewhere."""
        traced = Traced(self.tape, _exactly(0))
        first, second = traced._part(a), traced._part(b)
        value = _joined(self.relation, first[0], second[0])
        return Traced(self.tape, value, 2 + first[1] + second[1])

    def __and__(self, other: object) -> Condition | bool:
        return self._joint("And", other)

    __rand__ = __and__

    def __or__(self, other: object) -> Condition | bool:
        return self._joint("Or", other)

    __ror__ = __or__

    def __invert__(self) -> Condition:
        import sympy as sp

        return Condition(self.tape, sp.Not(self.relation))

    def _joint(self, name: str, other: object) -> Condition | bool:
        import sympy as sp

        relation = other.relation if isinstance(other, Condition) else sp.sympify(bool(other))
        value = getattr(sp, name)(self.relation, relation)
        return bool(value) if value in (sp.true, sp.false) else Condition(self.tape, value)

    def _times(self, other: Any) -> Any:  # noqa: ANN401 - a number
        return self.choose(1, 0) * other

    def _plus(self, other: Any) -> Any:  # noqa: ANN401 - a number
        return self.choose(1, 0) + other

    def _minus(self, other: Any) -> Any:  # noqa: ANN401 - a number
        return self.choose(1, 0) - other

    def _from(self, other: Any) -> Any:  # noqa: ANN401 - a number
        return other - self.choose(1, 0)

    __mul__ = __rmul__ = _times
    __add__ = __radd__ = _plus
    __sub__, __rsub__ = _minus, _from


def _joined(condition: sp.Basic, a: sp.Expr, b: sp.Expr) -> sp.Expr:
    import sympy as sp

    return a if a == b else sp.Piecewise((a, condition), (b, True), evaluate=False)


def _power(a: sp.Expr, b: sp.Expr) -> sp.Expr:
    import sympy as sp

    return a ** (sp.Integer(int(b)) if b.is_Float and b == int(b) and abs(b) < 1e9 else b)


_ARITHMETIC: Final[dict[str, Callable[..., Any]]] = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "pow": _power,
    "neg": lambda a: -a,
}


def _exactly(number: Any) -> sp.Expr:  # noqa: ANN401 - a number
    """Return a plain number as sympy's, bit for bit."""
    import sympy as sp

    if isinstance(number, bool | np.bool_):
        return sp.Integer(int(number))
    if isinstance(number, int | np.integer):
        return sp.Integer(int(number))
    if isinstance(number, float | np.floating) and math.isfinite(number):
        return sp.Float(float(number))
    msg = f"'{number}' is not a finite real number"
    raise NotTraceable(msg)


@dataclass(frozen=True)
class Recording:
    """A function as expressions.

    Attributes
    ----------
    results : list of sympy expression
        What it returns.
    terms : dict of str to sympy expression
        Terms that `results` and later terms use, in order.
    paths : int
        How many ways there are through the function.
    """

    results: list[sp.Expr]
    terms: dict[str, sp.Expr]
    paths: int


def record(
    call: Callable[[Mapping[str, Any]], Sequence[Any]], names: Sequence[str], prefix: str
) -> Recording:
    """Run a function on numbers that remember.

    Parameters
    ----------
    call : callable
        Maps values by name to a list of numbers.
    names : sequence of str
        The names.
    prefix : str
        How the names of terms begin.

    Raises
    ------
    NotTraceable
        If an operation cannot be recorded or there are too many paths.
    Exception
        Whatever the function raises on such numbers.
    """
    import sympy as sp

    tape = Tape(prefix)
    found: list[tuple[list[sp.Basic], list[bool], list[sp.Expr]]] = []
    answers: list[bool] = []
    while True:
        tape.answers, tape.asked = answers, []
        given = {name: Traced(tape, sp.Symbol(name)) for name in names}
        values = [_result(tape, value) for value in call(given)]
        if len(tape.asked) < len(answers):
            msg = "it does not branch in the same way when it is called again"
            raise NotTraceable(msg)
        found.append((tape.asked, list(tape.answers), values))
        while answers and not answers[-1]:
            answers.pop()
        if not answers:
            break
        if len(found) == _PATHS:
            msg = f"there are more than {_PATHS} paths through it"
            raise NotTraceable(msg)
        answers[-1] = False
    results = _merged(found, 0)
    terms = _needed(results, tape)
    for value in (*results, *terms.values()):
        if value.has(sp.zoo, sp.nan, sp.oo, -sp.oo, sp.I):
            msg = f"'{value}' is not a finite real expression"
            raise NotTraceable(msg)
    return Recording(results, terms, len(found))


def _result(tape: Tape, value: object) -> sp.Expr:
    if isinstance(value, Condition):
        value = value.choose(1, 0)
    expression, size = (
        (value.expression, value.size) if isinstance(value, Traced) else (_exactly(value), 1)
    )
    return tape.short(expression, size)[0]


def _merged(
    found: Sequence[tuple[list[sp.Basic], list[bool], list[sp.Expr]]], depth: int
) -> list[sp.Expr]:
    """Join paths that agree on their first `depth` answers."""
    if len(found) == 1:
        return found[0][2]
    condition = found[0][0][depth]
    yes = _merged([f for f in found if f[1][depth]], depth + 1)
    no = _merged([f for f in found if not f[1][depth]], depth + 1)
    if len(yes) != len(no):
        msg = "it returns lists of different lengths"
        raise NotTraceable(msg)
    return [_joined(condition, a, b) for a, b in zip(yes, no, strict=True)]


def _needed(results: Sequence[sp.Expr], tape: Tape) -> dict[str, sp.Expr]:
    """Return the terms that are used, in their order."""
    used = {symbol for e in results for symbol in e.free_symbols}
    kept = []
    for expression, symbol in reversed(tape.terms.items()):
        if symbol in used:
            kept.append((symbol.name, expression))
            used |= expression.free_symbols
    return dict(reversed(kept))
