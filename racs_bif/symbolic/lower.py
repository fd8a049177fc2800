"""From sympy expressions to straight-line programs."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from racs_bif.errors import ModelError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    import sympy as sp

    from racs_bif.symbolic.graph import Graph

_SAME_NAMES: Final = (
    *("exp", "log", "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh"),
    *("asinh", "acosh", "atanh", "erf", "sign"),
)
_FUNCTIONS: Final = {name: name for name in _SAME_NAMES} | {"Abs": "fabs"}
_RELATIONS: Final = {
    "StrictLessThan": "lt",
    "LessThan": "le",
    "StrictGreaterThan": "gt",
    "GreaterThan": "ge",
    "Equality": "eq",
    "Unequality": "ne",
}


class Lowering:
    """Turn sympy expressions into nodes of a graph.

    Parameters
    ----------
    graph : Graph
        Where the nodes go.
    symbols : mapping of str to int
        Node of every symbol by name.
    fixed : set of int
        Nodes that depend on parameters only: they are multiplied and added first, so that what
        does not depend on the state can be computed once.

    calls : mapping of str to int
        Names of external functions, and which result of `Graph.call` each is.

    Raises
    ------
    ModelError
        For a function, a number or an object that cannot be evaluated on real numbers.
    """

    def __init__(
        self,
        graph: Graph,
        symbols: Mapping[str, int],
        fixed: set[int],
        calls: Mapping[str, int] | None = None,
    ) -> None:
        self.graph = graph
        self.symbols = symbols
        self._calls = dict(calls or {})
        self._fixed = set(fixed)
        self._done: dict[sp.Basic, int] = {}

    def is_fixed(self, node: int) -> bool:
        """Say whether a node depends on parameters only."""
        ops = self.graph.ops
        inputs = (n for n in self.graph.reachable([node]) if ops[n][0] == "input")
        return all(n in self._fixed for n in inputs)

    def __call__(self, expression: sp.Basic) -> int:
        """Return the node of an expression."""
        node = self._done.get(expression)
        if node is None:
            node = self._lower(expression)
            self._done[expression] = node
            args = self.graph.ops[node][1]
            if (args and all(a in self._fixed for a in args)) or (
                self.graph.value(node) is not None
            ):
                self._fixed.add(node)
        return node

    def _lower(self, e: sp.Basic) -> int:
        if e.is_Symbol:
            return self.symbols[e.name]
        if e.is_number:
            return self.graph.constant(_real(e))
        kind = type(e).__name__
        if kind in _FUNCTIONS:
            return self.graph.unary(_FUNCTIONS[kind], self(e.args[0]))
        if kind in self._calls:
            return self.graph.call(self._calls[kind], [self.graph.bundle([*map(self, e.args)])])
        if kind in _RELATIONS:
            return self.graph.compare(_RELATIONS[kind], self(e.args[0]), self(e.args[1]))
        rule = self._rules().get(kind)
        if rule is None:
            msg = f"cannot evaluate '{kind}' in '{e}'; write it with elementary real functions"
            raise ModelError(msg)
        return rule(e)

    def _rules(self) -> dict[str, Callable[[sp.Basic], int]]:
        g = self.graph
        return {
            "Add": self._add,
            "Mul": self._mul,
            "Pow": self._pow,
            "Piecewise": self._piecewise,
            "Max": lambda e: self._extreme(e, "ge"),
            "Min": lambda e: self._extreme(e, "le"),
            "Heaviside": self._heaviside,
            "And": lambda e: g.logic("both", [self(a) for a in e.args]),
            "Or": lambda e: g.logic("either", [self(a) for a in e.args]),
            "ITE": self._either_condition,
            "Not": lambda e: g.logic("negated", [self(e.args[0])]),
            "BooleanTrue": lambda _: g.compare("eq", g.zero, g.zero),
            "BooleanFalse": lambda _: g.compare("ne", g.zero, g.zero),
        }

    def _ordered(self, nodes: list[int]) -> list[int]:
        return [n for n in nodes if n in self._fixed] + [n for n in nodes if n not in self._fixed]

    def _fold(self, operation: Callable[[int, int], int], nodes: list[int], empty: int) -> int:
        result = empty
        for node in self._ordered(nodes):
            merged = operation(result, node)
            if result in self._fixed and node in self._fixed:
                self._fixed.add(merged)
            result = merged
        return result

    def _add(self, e: sp.Basic) -> int:
        return self._fold(self.graph.add, [self(a) for a in e.args], self.graph.zero)

    def _mul(self, e: sp.Basic) -> int:
        above, below = [], []
        for factor in e.args:
            if factor.is_Pow and factor.exp.could_extract_minus_sign():
                below.append(self(1 / factor))
            else:
                above.append(self(factor))
        result = self._fold(self.graph.mul, above, self.graph.one)
        if not below:
            return result
        return self.graph.div(result, self._fold(self.graph.mul, below, self.graph.one))

    def _pow(self, e: sp.Basic) -> int:
        if type(e.base).__name__ == "Exp1":
            return self.graph.unary("exp", self(e.exp))
        return self.graph.power(self(e.base), self(e.exp))

    def _piecewise(self, e: sp.Basic) -> int:
        import sympy as sp

        if e.args[-1].cond is not sp.true:
            msg = f"'{e}' is undefined somewhere; end the Piecewise with a (value, True) pair"
            raise ModelError(msg)
        result = self(e.args[-1].expr)
        for pair in reversed(e.args[:-1]):
            result = self.graph.where(self(pair.cond), self(pair.expr), result)
        return result

    def _extreme(self, e: sp.Basic, comparison: str) -> int:
        result = self(e.args[0])
        for argument in e.args[1:]:
            other = self(argument)
            condition = self.graph.compare(comparison, result, other)
            result = self.graph.where(condition, result, other)
        return result

    def _either_condition(self, e: sp.Basic) -> int:
        g, (condition, yes, no) = self.graph, [self(a) for a in e.args]
        otherwise = g.logic("both", [g.logic("negated", [condition]), no])
        return g.logic("either", [g.logic("both", [condition, yes]), otherwise])

    def _heaviside(self, e: sp.Basic) -> int:
        g, x = self.graph, self(e.args[0])
        at_zero = self(e.args[1]) if len(e.args) > 1 else g.constant(0.5)
        beyond = g.where(g.compare("gt", x, g.zero), g.one, at_zero)
        return g.where(g.compare("lt", x, g.zero), g.zero, beyond)


def _short(number: sp.Expr) -> str:
    """Return a number as a short text; one of many digits by its size."""
    return str(number.evalf(4) if number.is_Rational or number.is_Float else number)[:60]


def _real(number: sp.Expr) -> float:
    """Return a number as a float, refusing what is infinite, complex or too large."""
    try:
        value = float(number)
    except (TypeError, ValueError, OverflowError):
        value = math.nan
    if not math.isfinite(value):
        msg = f"'{_short(number)}' is not a finite real number; write the term another way"
        raise ModelError(msg)
    return value
