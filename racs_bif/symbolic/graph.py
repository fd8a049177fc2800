"""Straight-line programs as graphs in which equal expressions are one node.

A node is an integer; its operation and arguments are looked up in the `Graph`. Building a node that
exists returns the old one (value numbering), and constants fold, so common subexpressions, zero
derivatives and unit factors disappear as the graph is built.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

UNARY: Final[dict[str, Callable[[float], float]]] = {
    "exp": math.exp,
    "log": math.log,
    "sqrt": math.sqrt,
    "sin": math.sin,
    "cos": math.cos,
    "tan": math.tan,
    "asin": math.asin,
    "acos": math.acos,
    "atan": math.atan,
    "sinh": math.sinh,
    "cosh": math.cosh,
    "tanh": math.tanh,
    "asinh": math.asinh,
    "acosh": math.acosh,
    "atanh": math.atanh,
    "erf": math.erf,
    "fabs": math.fabs,
    "sign": lambda x: math.copysign(1.0, x) if x else 0.0,
}
"""Functions of one argument, under the names that the emitted code calls."""
COMPARISONS: Final = {"lt": "<", "le": "<=", "gt": ">", "ge": ">=", "eq": "==", "ne": "!="}

LOGIC: Final = ("both", "either", "negated")

Op = tuple[str, tuple[int, ...], float | str]


class Graph:
    """A growing set of nodes ``(operation, arguments, payload)`` without duplicates."""

    def __init__(self) -> None:
        self.ops: list[Op] = []
        self._known: dict[Op, int] = {}
        self.zero = self.constant(0.0)
        self.one = self.constant(1.0)

    def _node(self, name: str, args: tuple[int, ...] = (), payload: float | str = 0.0) -> int:
        op = (name, args, payload)
        node = self._known.get(op)
        if node is None:
            node = len(self.ops)
            self.ops.append(op)
            self._known[op] = node
        return node

    def constant(self, value: float) -> int:
        """Return the node of a number."""
        return self._node("const", (), float(value) + 0.0)

    def input(self, name: str) -> int:
        """Return the node of a named input."""
        return self._node("input", (), name)

    def value(self, node: int) -> float | None:
        """Return the number behind a constant node, None for any other."""
        name, _, payload = self.ops[node]
        return float(payload) if name == "const" else None

    def _folded(self, name: str, args: tuple[int, ...], compute: Callable[[], float]) -> int:
        """Return the node of a number, or of its operation where it is not finite."""
        try:
            value = compute()
        except (ArithmeticError, ValueError):
            value = math.nan
        return self.constant(value) if math.isfinite(value) else self._node(name, args)

    def add(self, a: int, b: int) -> int:
        """Return a + b."""
        x, y = self.value(a), self.value(b)
        if x is not None and y is not None:
            return self._folded("add", (a, b), lambda: x + y)
        if x == 0.0:
            return b
        if y == 0.0:
            return a
        if self.ops[b][0] == "neg":
            return self.sub(a, self.ops[b][1][0])
        if self.ops[a][0] == "neg":
            return self.sub(b, self.ops[a][1][0])
        return self._node("add", (min(a, b), max(a, b)))

    def sub(self, a: int, b: int) -> int:
        """Return a - b."""
        x, y = self.value(a), self.value(b)
        if x is not None and y is not None:
            return self._folded("sub", (a, b), lambda: x - y)
        if a == b:
            return self.zero
        if y == 0.0:
            return a
        if x == 0.0:
            return self.neg(b)
        if self.ops[b][0] == "neg":
            return self.add(a, self.ops[b][1][0])
        return self._node("sub", (a, b))

    def neg(self, a: int) -> int:
        """Return -a."""
        name, args, payload = self.ops[a]
        if name == "const":
            return self.constant(-float(payload))
        if name == "neg":
            return args[0]
        if name == "sub":
            return self.sub(args[1], args[0])
        return self._node("neg", (a,))

    def mul(self, a: int, b: int) -> int:
        """Return a * b."""
        for left, right in ((a, b), (b, a)):
            x = self.value(left)
            if x is not None:
                return self._scaled(x, left, right)
        if self.ops[a][0] == "neg":
            return self.neg(self.mul(self.ops[a][1][0], b))
        if self.ops[b][0] == "neg":
            return self.neg(self.mul(a, self.ops[b][1][0]))
        return self._node("mul", (min(a, b), max(a, b)))

    def _scaled(self, x: float, left: int, right: int) -> int:
        """Return the product of the constant x, which is node `left`, and node `right`."""
        y = self.value(right)
        if y is not None:
            return self._folded("mul", (left, right), lambda: x * y)
        if x == 0.0:
            return self.zero
        if abs(x) == 1.0:
            return right if x > 0.0 else self.neg(right)
        if self.ops[right][0] == "neg":
            return self.neg(self.mul(left, self.ops[right][1][0]))
        return self._node("mul", (min(left, right), max(left, right)))

    def absorb(self, a: int, b: int) -> int:
        """Return a * b, zero where b is zero even if a is not finite there."""
        if self.value(b) is not None or self.value(a) is not None:
            return self.mul(a, b)
        return self._node("absorb", (a, b))

    def div(self, a: int, b: int) -> int:
        """Return a / b."""
        x, y = self.value(a), self.value(b)
        if y == 1.0:
            return a
        if x is not None and y is not None:
            return self._folded("div", (a, b), lambda: x / y)
        if y is not None and y != 0.0 and math.isfinite(1.0 / y):
            return self.mul(self.constant(1.0 / y), a)
        if x == 0.0:
            return self.zero
        if self.ops[a][0] == "neg":
            return self.neg(self.div(self.ops[a][1][0], b))
        return self._node("div", (a, b))

    def power(self, a: int, b: int) -> int:
        """Return a ** b; small whole and half exponents become products and roots."""
        exponent, base = self.value(b), self.value(a)
        if exponent == 0.0 or base == 1.0:
            return self.one
        if exponent is not None and base is not None:
            return self._folded("pow", (a, b), lambda: math.pow(base, exponent))
        if exponent is not None and exponent < 0.0:
            return self.div(self.one, self.power(a, self.constant(-exponent)))
        if exponent == 0.5:
            return self.unary("sqrt", a)
        if exponent is not None and exponent <= 64 and exponent == int(exponent):
            return self._whole_power(a, int(exponent))
        return self._node("pow", (a, b))

    def _whole_power(self, a: int, exponent: int) -> int:
        if exponent == 1:
            return a
        half = self._whole_power(a, exponent // 2)
        square = self.mul(half, half)
        return self.mul(square, a) if exponent % 2 else square

    def unary(self, name: str, a: int) -> int:
        """Return a function of one argument, a name of `UNARY`."""
        x = self.value(a)
        if x is not None:
            return self._folded(name, (a,), lambda: UNARY[name](x))
        if self.ops[a][0] == "neg" and name in {"sin", "tan", "asin", "atan", "sinh", "tanh"}:
            return self.neg(self.unary(name, self.ops[a][1][0]))
        return self._node(name, (a,))

    def compare(self, name: str, a: int, b: int) -> int:
        """Return a comparison, a name of `COMPARISONS`."""
        return self._node(name, (a, b))

    def logic(self, name: str, args: Sequence[int]) -> int:
        """Return ``both`` or ``either`` of conditions, or ``negated`` of one."""
        node = args[0]
        if name == "negated":
            return self._node(name, (node,))
        for other in args[1:]:
            node = self._node(name, (node, other))
        return node

    def where(self, condition: int, a: int, b: int) -> int:
        """Return `a` where the condition holds and `b` elsewhere."""
        return a if a == b else self._node("where", (condition, a, b))

    def bundle(self, args: Sequence[int]) -> int:
        """Return several nodes as one argument of `call`."""
        return self._node("bundle", tuple(args))

    def call(self, output: int, bundles: Sequence[int]) -> int:
        """Return a result of the model's external function, or a form of its derivatives.

        Parameters
        ----------
        output : int
            Which result.
        bundles : sequence of int
            Its arguments and, for a derivative, directions, as nodes made by `bundle`.
        """
        return self._node("call", tuple(bundles), float(output))

    def reachable(self, outputs: Iterable[int]) -> list[int]:
        """Return the nodes that `outputs` need, arguments before their users."""
        stack, seen = list(outputs), set[int]()
        while stack:
            node = stack.pop()
            if node not in seen:
                seen.add(node)
                stack.extend(self.ops[node][1])
        return sorted(seen)

    def dependent(self, inputs: Iterable[int]) -> set[int]:
        """Return all nodes that depend on any of `inputs`."""
        found = set(inputs)
        for node, (_, args, _) in enumerate(self.ops):  # arguments come before their users
            if not found.isdisjoint(args):
                found.add(node)
        return found
