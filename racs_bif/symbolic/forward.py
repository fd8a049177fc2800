"""Forward-mode derivatives of straight-line programs, as further nodes of the same graph.

Applied once this gives columns of Jacobians, applied k times with k sets of directions the
multilinear forms of order k (A. Griewank and A. Walther, *Evaluating Derivatives*, SIAM 2008,
chapter 3).
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Final

from racs_bif.symbolic.graph import COMPARISONS, LOGIC, Graph


def tangent(graph: Graph, outputs: Sequence[int], seeds: Mapping[int, int]) -> list[int]:
    """Differentiate `outputs` in the direction given at input nodes.

    Parameters
    ----------
    graph : Graph
        The program; the derivative's nodes are added to it.
    outputs : sequence of int
        Nodes to differentiate.
    seeds : mapping of int to int
        Input node to the node of its direction; inputs left out do not move.

    Returns
    -------
    list of int
        The derivatives, the zero node where an output does not depend on the seeds.
    """
    dots: dict[int, int] = {}
    for node in graph.reachable(outputs):
        name, args, _ = graph.ops[node]
        if name == "input":
            dots[node] = seeds.get(node, graph.zero)
        elif all(dots[a] == graph.zero for a in args) or (name in COMPARISONS or name in LOGIC):
            dots[node] = graph.zero
        else:
            dots[node] = _RULES[name](graph, node, args, [dots[a] for a in args])
    return [dots[node] for node in outputs]


def columns(
    graph: Graph, outputs: Sequence[int], inputs: Sequence[int]
) -> Iterator[tuple[int, int, int]]:
    """Differentiate `outputs` by each of the input nodes `inputs`.

    For each input only what depends on it is visited, so that the work grows with the number of
    entries that are not zero.

    Yields
    ------
    (int, int, int)
        Row, column and node of an entry that is not zero, column by column.
    """
    nodes = graph.reachable(outputs)
    users: dict[int, list[int]] = defaultdict(list)
    for node in nodes:
        for argument in set(graph.ops[node][1]):
            users[argument].append(node)
    rows: dict[int, list[int]] = defaultdict(list)
    for row, node in enumerate(outputs):
        rows[node].append(row)
    for column, source in enumerate(inputs):
        dots = {source: graph.one}
        for node in _above(users, source):
            name, args, _ = graph.ops[node]
            parts = [dots.get(a, graph.zero) for a in args]
            still = name in COMPARISONS or name in LOGIC or all(d == graph.zero for d in parts)
            dots[node] = graph.zero if still else _RULES[name](graph, node, args, parts)
        found = ((row, dot) for node, dot in dots.items() for row in rows.get(node, ()))
        yield from ((row, column, dot) for row, dot in sorted(found) if dot != graph.zero)


def _above(users: Mapping[int, Sequence[int]], source: int) -> list[int]:
    """Return the nodes that depend on one, arguments before their users, itself left out."""
    stack, seen = [source], {source}
    while stack:
        for user in users.get(stack.pop(), ()):
            if user not in seen:
                seen.add(user)
                stack.append(user)
    return sorted(seen - {source})


Rule = Callable[[Graph, int, tuple[int, ...], list[int]], int]


def _mul(g: Graph, _: int, args: tuple[int, ...], dots: list[int]) -> int:
    return g.add(g.mul(args[0], dots[1]), g.mul(dots[0], args[1]))


def _div(g: Graph, node: int, args: tuple[int, ...], dots: list[int]) -> int:
    return g.div(g.sub(dots[0], g.mul(node, dots[1])), args[1])


def _pow(g: Graph, node: int, args: tuple[int, ...], dots: list[int]) -> int:
    # Absorbing products: x**2 with a parameter for the 2 has a third derivative at x = 0, and
    # derivatives along other parameters where the logarithm is undefined.
    a, b = args
    result = g.zero
    if dots[0] != g.zero:
        result = g.mul(g.absorb(g.power(a, g.sub(b, g.one)), b), dots[0])
    if dots[1] != g.zero:
        result = g.add(result, g.absorb(g.absorb(g.unary("log", a), node), dots[1]))
    return result


def _absorb(g: Graph, _: int, args: tuple[int, ...], dots: list[int]) -> int:
    return g.add(g.absorb(args[0], dots[1]), g.absorb(dots[0], args[1]))


def _chain(slope: Callable[[Graph, int, int], int]) -> Rule:
    """Make a rule from the derivative of a function of one argument (graph, node, argument)."""

    def rule(g: Graph, node: int, args: tuple[int, ...], dots: list[int]) -> int:
        return g.mul(slope(g, node, args[0]), dots[0])

    return rule


def _over(denominator: Callable[[Graph, int, int], int]) -> Rule:
    """Make a rule for a function whose derivative is one over something."""

    def rule(g: Graph, node: int, args: tuple[int, ...], dots: list[int]) -> int:
        return g.div(dots[0], denominator(g, node, args[0]))

    return rule


def _square(g: Graph, a: int) -> int:
    return g.mul(a, a)


def _where(g: Graph, _: int, args: tuple[int, ...], dots: list[int]) -> int:
    return g.where(args[0], dots[1], dots[2])


def _call(g: Graph, node: int, args: tuple[int, ...], dots: list[int]) -> int:
    """Differentiate a form of derivatives of an external function, linear in its directions."""
    output = int(float(g.ops[node][2]))
    result = g.zero
    if dots[0] != g.zero:
        result = g.call(output, (*args, dots[0]))
    for k in range(1, len(args)):
        if dots[k] != g.zero:
            result = g.add(result, g.call(output, (*args[:k], dots[k], *args[k + 1 :])))
    return result


def _gauss(g: Graph, _: int, a: int) -> int:
    two_over_root_pi = g.constant(1.1283791670955126)
    return g.mul(two_over_root_pi, g.unary("exp", g.neg(_square(g, a))))


_RULES: Final[dict[str, Rule]] = {
    "add": lambda g, _, __, d: g.add(d[0], d[1]),
    "sub": lambda g, _, __, d: g.sub(d[0], d[1]),
    "neg": lambda g, _, __, d: g.neg(d[0]),
    "mul": _mul,
    "div": _div,
    "pow": _pow,
    "absorb": _absorb,
    "where": _where,
    "bundle": lambda g, _, __, d: g.bundle(d),
    "call": _call,
    "exp": _chain(lambda _, node, __: node),
    "log": _over(lambda _, __, a: a),
    "sqrt": _over(lambda g, node, _: g.mul(g.constant(2.0), node)),
    "sin": _chain(lambda g, _, a: g.unary("cos", a)),
    "cos": _chain(lambda g, _, a: g.neg(g.unary("sin", a))),
    "tan": _chain(lambda g, node, _: g.add(g.one, _square(g, node))),
    "asin": _over(lambda g, _, a: g.unary("sqrt", g.sub(g.one, _square(g, a)))),
    "acos": _over(lambda g, _, a: g.neg(g.unary("sqrt", g.sub(g.one, _square(g, a))))),
    "atan": _over(lambda g, _, a: g.add(g.one, _square(g, a))),
    "sinh": _chain(lambda g, _, a: g.unary("cosh", a)),
    "cosh": _chain(lambda g, _, a: g.unary("sinh", a)),
    "tanh": _chain(lambda g, node, _: g.sub(g.one, _square(g, node))),
    "asinh": _over(lambda g, _, a: g.unary("sqrt", g.add(_square(g, a), g.one))),
    "acosh": _over(lambda g, _, a: g.unary("sqrt", g.sub(_square(g, a), g.one))),
    "atanh": _over(lambda g, _, a: g.sub(g.one, _square(g, a))),
    "erf": _chain(_gauss),
    "fabs": _chain(lambda g, _, a: g.unary("sign", a)),
    "sign": _chain(lambda g, _, __: g.zero),
}
