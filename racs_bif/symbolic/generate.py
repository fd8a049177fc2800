"""From a `Model` to the source text of its compiled modules.

The states of a fractional element's realisation do not appear here. The compiled core takes
``X = (y, zeta)``, the model's own states and the memory of every element, with an element's output
``w = zeta + D e``; ``P = (p, D)`` are the base parameters and the direct feedthroughs. It returns
``(y', e)``. With ``D = 0`` memory and output coincide: that is the exact model.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from racs_bif.errors import ModelError
from racs_bif.symbolic.emit import Function, emit
from racs_bif.symbolic.forward import columns, tangent
from racs_bif.symbolic.graph import LOGIC, UNARY, Graph
from racs_bif.symbolic.laws import PowerSum, read_law
from racs_bif.symbolic.lower import Lowering
from racs_bif.symbolic.mass import solve_mass
from racs_bif.symbolic.metadata import describe

if TYPE_CHECKING:
    from collections.abc import Sequence

    import sympy as sp

    from racs_bif.symbolic.model import Model


@dataclass(frozen=True)
class Sources:
    """The texts of the two modules of a compiled model.

    Parameters
    ----------
    main : str
        Right-hand side, Jacobian, parameter derivatives, laws, and the description ``META``.
    forms : str
        Second and third derivatives, which are loaded when a normal form is asked for, and the
        equations before a mass matrix is inverted.
    """

    main: str
    forms: str


def generate(model: Model) -> Sources:
    """Differentiate a model and write its compiled modules.

    Raises
    ------
    ModelError
        If the equations cannot be evaluated, the mass matrix is singular, a law cannot be read, or
        elements with direct feedthrough feed each other in a loop.
    """
    return _Generator(model).sources()


class _Generator:
    def __init__(self, model: Model) -> None:
        self.model = model
        g = self.graph = Graph()
        self.base = [g.input(f"p:{p.name}") for p in model.parameters]
        self.through = [g.input(f"D:{e.output}") for e in model.elements]
        self.y = [g.input(f"y:{name}") for name in model.states]
        self.zeta = [g.input(f"zeta:{e.output}") for e in model.elements]
        self.laws = [read_law(e.output, e.law) for e in model.elements]
        symbols = {p.name: node for p, node in zip(model.parameters, self.base, strict=True)}
        symbols |= dict(zip(model.states, self.y, strict=True))
        self.fixed = set(self.base) | set(self.through)
        self.symbols = symbols
        self.proper = [self._strictly_proper(k) for k in range(len(self.laws))]
        calls = {} if model.external is None else model.external.calls
        lower = self.lower = Lowering(g, self.symbols, self.fixed, calls)
        inputs = self._element_inputs()
        right = [lower(e) for e in model.equations.values()]
        self.forces, self.inertia = right, g.one
        if model.mass is not None:
            right, self.inertia = solve_mass(model, lower, right)
        self.core = [*right, *inputs]
        self.x = [*self.y, *self.zeta]
        self.parameters = [*self.base, *self.through]

    def _strictly_proper(self, k: int) -> bool:
        """Say whether Z tends to zero at high frequency, at the default orders."""
        numbers = self.default_numbers()
        top = [
            max(float(e.subs(numbers)) for e in power_sum.exponents) for power_sum in self.laws[k]
        ]
        return top[0] < top[1]

    def default_numbers(self) -> dict[sp.Symbol, float]:
        """Return default values; a default that is still to be calibrated counts as one."""
        import sympy as sp

        return {
            sp.Symbol(p.name): float(p.default) if isinstance(p.default, (int, float)) else 1.0
            for p in self.model.parameters
        }

    def _element_inputs(self) -> list[int]:
        """Lower terms and elements' inputs in an order in which feedthrough never meets itself."""
        g = self.graph
        terms = dict(self.model.terms)
        waiting = dict(enumerate(self.model.elements))
        for k, element in enumerate(self.model.elements):
            if self.proper[k]:
                self.symbols[element.output] = self.zeta[k]
        nodes: dict[int, int] = {}
        while waiting or terms:
            known = self._lower_terms(terms)
            ready = [
                k
                for k, e in waiting.items()
                if all(symbol.name in self.symbols for symbol in e.input.free_symbols)
            ]
            if waiting and not ready and not known:
                names = ", ".join(e.output for e in waiting.values())
                msg = (
                    f"model '{self.model.name}': elements {names} feed each other without delay; "
                    "make one input depend on states alone"
                )
                raise ModelError(msg)
            lower = Lowering(g, self.symbols, self.fixed)
            for k in ready:
                element = waiting.pop(k)
                nodes[k] = lower(element.input)
                if not self.proper[k]:
                    fed = g.add(self.zeta[k], g.mul(self.through[k], nodes[k]))
                    self.symbols[element.output] = fed
        return [nodes[k] for k in range(len(self.model.elements))]

    def _lower_terms(self, terms: dict[str, sp.Expr]) -> bool:
        """Lower those of the terms that can be, and take them away; say whether there were any."""
        found = False
        for name, expression in list(terms.items()):
            if all(symbol.name in self.symbols for symbol in expression.free_symbols):
                self.symbols[name] = self.lower(terms.pop(name))
                found = True
        return found

    def sources(self) -> Sources:
        """Return both module texts."""
        pattern = self._jacobian()
        main = [self._function("core", {"x": self.x}, self.core), *pattern.functions]
        main += self._parameter_functions()
        outputs = [self.lower(e) for e in self.model.outputs.values()]
        main.append(self._function("outputs", {"x": self.x}, outputs))
        varies = self.graph.value(self.inertia) is None
        if varies:
            main.append(self._function("inertia", {"x": self.x}, [self.inertia]))
        meta = describe(self.model) | {
            "fixed": pattern.fixed,
            "varying": pattern.varying,
            "law_sizes": [(len(n.exponents), len(d.exponents)) for n, d in self.laws],
            "feedthrough": [not proper for proper in self.proper],
            "inertia": varies,
        }
        forms = self._forms() + (self._unsolved() if varies else [])
        return Sources(module(main, meta), module(forms, {}))

    def _function(self, name: str, groups: dict[str, Sequence[int]], outputs: list[int]) -> str:
        function = Function(name, groups, outputs)
        return "\n".join(f"    {line}" for line in emit(self.graph, function, self.parameters))

    def _directions(self, name: str, inputs: Sequence[int]) -> list[int]:
        return [self.graph.input(f"{name}:{k}") for k in range(len(inputs))]

    def _derivative(self, outputs: list[int], along: Sequence[int], by: Sequence[int]) -> list[int]:
        return tangent(self.graph, outputs, dict(zip(along, by, strict=True)))

    def _jacobian(self) -> _Pattern:
        entries = list(columns(self.graph, self.core, self.x))
        moving = self.graph.dependent(self.x)
        fixed = [entry for entry in entries if entry[2] not in moving]
        varying = [entry for entry in entries if entry[2] in moving]
        functions = [
            self._function("jacobian_fixed", {}, [e for *_, e in fixed]),
            self._function("jacobian_varying", {"x": self.x}, [e for *_, e in varying]),
        ]
        return _Pattern(functions, [f[:2] for f in fixed], [v[:2] for v in varying])

    def _parameter_functions(self) -> list[str]:
        dp = self._directions("dp", self.parameters)
        dbase = dp[: len(self.base)]
        core_p = self._derivative(self.core, self.parameters, dp)
        numbers = [self.lower(e) for law in self.laws for e in _law_expressions(law)]
        functions = [
            self._function("core_p", {"x": self.x, "dp": dp}, core_p),
            self._function("laws", {}, numbers),
            self._function("laws_p", {"dp": dp}, self._derivative(numbers, self.base, dbase)),
        ]
        derived = [self.lower(d.expression) for d in self.model.derived]
        functions.append(self._function("derived", {}, derived))
        for k, d in enumerate(self.model.derived):
            value, slope = self.graph.input(f"value:{k}"), self.graph.input(f"slope:{k}")
            inverse = _inverse(self.model, d.name, d.expression, d.sets)
            node = Lowering(self.graph, self.symbols | {d.name: value}, self.fixed)(inverse)
            groups: dict[str, Sequence[int]] = {"value": [value]}
            functions.append(self._function(f"inverse{k}", groups, [node]))
            dots = self._derivative([node], [*self.base, value], [*dbase, slope])
            groups = {"value": [value], "dp": dp, "slope": [slope]}
            functions.append(self._function(f"inverse{k}_p", groups, dots))
        return functions

    def _forms(self) -> list[str]:
        u, v, w = (self._directions(name, self.x) for name in "uvw")
        dp = self._directions("dp", self.parameters)
        first = self._derivative(self.core, self.x, u)
        second = self._derivative(first, self.x, v)
        third = self._derivative(second, self.x, w)
        mixed = self._derivative(first, self.parameters, dp)
        groups: dict[str, Sequence[int]] = {"x": self.x, "u": u}
        return [
            self._function("core_xx", groups | {"v": v}, second),
            self._function("core_xp", groups | {"dp": dp}, mixed),
            self._function("core_xxx", groups | {"v": v, "w": w}, third),
        ]

    def _unsolved(self) -> list[str]:
        """Return the forces and the determinant of a mass matrix that may become singular."""
        dx, dp = self._directions("dx", self.x), self._directions("dp", self.parameters)
        values = [*self.forces, self.inertia]
        slopes = self._derivative(values, [*self.x, *self.parameters], [*dx, *dp])
        groups: dict[str, Sequence[int]] = {"x": self.x}
        return [
            self._function("forces", groups, values),
            self._function("forces_d", groups | {"dx": dx, "dp": dp}, slopes),
        ]


@dataclass(frozen=True)
class _Pattern:
    functions: list[str]
    fixed: list[tuple[int, int]]
    varying: list[tuple[int, int]]


def _law_expressions(law: tuple[PowerSum, PowerSum]) -> list[sp.Expr]:
    return [e for part in law for e in (*part.coefficients, *part.exponents)]


def _inverse(model: Model, name: str, expression: sp.Expr, sets: str) -> sp.Expr:
    import sympy as sp

    target = next((s for s in expression.free_symbols if s.name == sets), sp.Symbol(sets))
    solutions = sp.solve(sp.Eq(expression, sp.Symbol(name)), target)
    if len(solutions) != 1:
        msg = (
            f"model '{model.name}': derived parameter '{name}' does not determine '{sets}' "
            "uniquely; let it set a parameter in which it is linear"
        )
        raise ModelError(msg)
    return solutions[0]


def module(functions: Sequence[str], meta: dict[str, Any]) -> str:
    """Return the text of a module of emitted functions."""
    names = re.findall(r"^    def (\w+)\(", "\n".join(functions), re.MULTILINE)
    body = "\n".join(functions)
    table = "".join(f"{name!r}: {name}, " for name in names)
    # The functions of `m` become locals of make, so that emitted code reaches them quickly.
    called = (*_CALLED, "call") if "call_(" in body else _CALLED
    calls = "\n".join(f"    {name}_ = m.{name}" for name in called)
    return f"META = {meta!r}\n\n\ndef make(m):\n{calls}\n{body}\n    return {{{table}}}\n"


_CALLED = (*UNARY, *LOGIC, "pow", "where", "absorb")
