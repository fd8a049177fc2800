"""From straight-line programs to Python source.

Every function comes in two parts: ``NAME_prepare(p)`` computes once what depends on parameters
only, ``NAME(c, x, ...)`` the rest. Both call elementary functions by name, so that the same text
runs on floats (with `math`) and on arrays (with numpy).
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from racs_bif.symbolic.graph import COMPARISONS, Graph

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

_INFIX: Final = {"add": "+", "sub": "-", "mul": "*", "div": "/"} | COMPARISONS
_DEPTH = 12
"""Deepest nesting of parentheses in one line of emitted code."""


@dataclass(frozen=True)
class Function:
    """A function to emit.

    Parameters
    ----------
    name : str
        Its name.
    groups : mapping of str to sequence of int
        Argument names and the input nodes that each unpacks to, parameters left out.
    outputs : sequence of int
        Nodes that it returns.
    """

    name: str
    groups: Mapping[str, Sequence[int]]
    outputs: Sequence[int]


def emit(graph: Graph, function: Function, parameters: Sequence[int]) -> list[str]:
    """Return the source lines of a function, unindented.

    Parameters
    ----------
    graph : Graph
        The program.
    function : Function
        What to emit.
    parameters : sequence of int
        Input nodes that ``p`` unpacks to.
    """
    nodes = graph.reachable(function.outputs)
    fixed = _fixed(graph, nodes, parameters)
    users = Counter(a for n in nodes if n not in fixed for a in set(graph.ops[n][1]))
    users.update(function.outputs)
    hoisted = [n for n in nodes if n in fixed and users[n] and graph.ops[n][0] != "const"]
    names = {n: f"c{k}" for k, n in enumerate(hoisted)}
    lines = [f"def {function.name}_prepare(p):"]
    lines += _unpack({"p": parameters}, set(nodes), {})
    before = _Writer(graph, {}, [n for n in nodes if n in fixed], hoisted)
    lines += before.lines
    lines.append(f"    return ({''.join(before.text(n) + ', ' for n in hoisted)})")
    arguments = "".join(f", {g}" for g in function.groups)
    lines.append(f"def {function.name}(c{arguments}):")
    if hoisted:
        lines.append(f"    {''.join(names[n] + ', ' for n in hoisted)} = c")
    lines += _unpack(function.groups, set(nodes), names)
    body = _Writer(graph, names, [n for n in nodes if n not in fixed], function.outputs)
    lines += body.lines
    lines.append(f"    return ({''.join(body.text(n) + ', ' for n in function.outputs)})")
    return lines


def _fixed(graph: Graph, nodes: Sequence[int], parameters: Sequence[int]) -> set[int]:
    fixed = set(parameters)
    for node in nodes:
        name, args, _ = graph.ops[node]
        if name == "const" or (args and all(a in fixed for a in args)):
            fixed.add(node)
    return fixed


def _unpack(
    groups: Mapping[str, Sequence[int]], needed: set[int], named: Mapping[int, str]
) -> list[str]:
    lines = []
    for group, members in groups.items():
        if not any(m in needed and m not in named for m in members):
            continue
        targets = "".join(f"i{m}, " if m in needed else "_, " for m in members)
        lines.append(f"    {targets} = {group}")
    return lines


class _Writer:
    """Write nodes as assignments; a node with one user is put into its user's line."""

    def __init__(
        self,
        graph: Graph,
        names: Mapping[int, str],
        nodes: Sequence[int],
        outputs: Sequence[int],
    ) -> None:
        self.graph = graph
        self.lines: list[str] = []
        self._names = dict(names)
        self._depth: dict[int, int] = {}
        self._pending: dict[int, str] = {}
        users = Counter(a for n in nodes for a in graph.ops[n][1])
        users.update(outputs)
        for node in nodes:
            name, _, payload = graph.ops[node]
            if name == "const":
                value = float(payload)
                self._names[node] = repr(value) if value >= 0 else f"({value!r})"
            elif name == "input":
                self._names[node] = f"i{node}"
            elif node not in self._names:
                self._write(node, users[node])

    def text(self, node: int) -> str:
        """Return what stands for a node: its name, or its expression if it has no name."""
        if node in self._names:
            return self._names[node]
        if node in self._pending:
            return self._pending[node]
        return repr(self.graph.value(node))

    def _write(self, node: int, users: int) -> None:
        name, args, payload = self.graph.ops[node]
        parts = [self.text(a) for a in args]
        if name in _INFIX:
            text = f"({parts[0]} {_INFIX[name]} {parts[1]})"
        elif name == "neg":
            text = f"(-{parts[0]})"
        elif name == "bundle":
            text = f"({''.join(part + ', ' for part in parts)})"
        elif name == "call":
            text = f"call_({int(float(payload))}, {', '.join(parts)})"
        else:
            text = f"{name}_({', '.join(parts)})"
        depth = 1 + max((self._depth.get(a, 0) for a in args), default=0)
        if users == 1 and depth < _DEPTH:
            self._pending[node] = text
            self._depth[node] = depth
        else:
            self._names[node] = f"t{node}"
            self.lines.append(f"    t{node} = {text}")
