"""Derivatives of large models: only what is not zero is worked on, and none of it is lost."""

import numpy as np
import pytest

from racs_bif.symbolic.compiled import compile_model
from racs_bif.symbolic.forward import columns, tangent
from racs_bif.symbolic.graph import Graph
from racs_bif.symbolic.lower import Lowering
from racs_bif.symbolic.strings import model_from_strings

NAMES = ("x", "y", "z", "a", "b", "q")


def program(expressions):
    graph = Graph()
    symbols = {name: graph.input(name) for name in NAMES}
    lower = Lowering(graph, symbols, set())
    return graph, [lower(e) for e in expressions], list(symbols.values())


def test_columns_are_tangents_along_single_inputs(shallow):
    graph, outputs, inputs = program([*shallow.expressions, shallow.expressions[0]])
    found = list(columns(graph, outputs, inputs))
    expected = [
        (row, column, entry)
        for column, node in enumerate(inputs)
        for row, entry in enumerate(tangent(graph, outputs, {node: graph.one}))
        if entry != graph.zero
    ]
    assert found == expected


def test_an_output_that_is_an_input_or_a_number():
    graph = Graph()
    x, y = graph.input("x"), graph.input("y")
    outputs = [x, graph.constant(2.0), graph.mul(x, y), x]
    expected = [(0, 0, graph.one), (2, 0, y), (3, 0, graph.one), (2, 1, x)]
    assert list(columns(graph, outputs, [x, y])) == expected


def chain(count):
    return {f"x{k}": f"x{max(k - 1, 0)}*x{min(k + 1, count - 1)} - c*x{k}**3" for k in range(count)}


class Counted(list):
    """A list that knows how often its items were asked for."""

    asked = 0

    def __getitem__(self, place):
        self.asked += 1
        return super().__getitem__(place)


def test_the_work_grows_with_the_entries():
    asked = {}
    for count in (100, 200):
        graph = Graph()
        symbols = {name: graph.input(name) for name in (*chain(count), "c")}
        lower = Lowering(graph, symbols, set())
        model = model_from_strings("chain", chain(count), parameters={"c": 1.0})
        outputs = [lower(e) for e in model.equations.values()]
        graph.ops = Counted(graph.ops)
        entries = list(columns(graph, outputs, list(symbols.values())[:-1]))
        assert len(entries) == 3 * count - 2
        asked[count] = graph.ops.asked
    assert asked[200] < 2.1 * asked[100]


def test_sparse_jacobians_are_the_full_ones(shallow):
    for p in (shallow.p, 1.1 * shallow.p):
        full = shallow.compiled.core_jacobian(shallow.x, p)
        found = shallow.compiled.core_jacobian_sparse(shallow.x, p)
        assert found.format == "csc"
        assert found.has_sorted_indices
        np.testing.assert_array_equal(found.toarray(), full)


def test_a_sparse_jacobian_may_be_written_on():
    compiled = compile_model(model_from_strings("chain", chain(9), parameters={"c": 2.0}))
    x, p = np.linspace(0.1, 1.0, 9), np.array([2.0])
    first = compiled.core_jacobian_sparse(x, p)
    kept = first.toarray()
    first.data[:] = 0.0
    first.indices[:] = 0
    np.testing.assert_array_equal(compiled.core_jacobian_sparse(x, p).toarray(), kept)


@pytest.mark.parametrize("change", ["name", "state", "equation", "value"])
def test_models_that_differ_anywhere_are_compiled_apart(change):
    def build(*, output="w", state="x", factor="2", value=1.0):
        equations = {state: f"-{factor}*{state} + k"}
        return compile_model(
            model_from_strings(
                "small", equations, parameters={"k": value}, outputs={output: f"{state}**2"}
            )
        )

    other = {
        "name": {"output": "v"},
        "state": {"state": "y"},
        "equation": {"factor": "2.0"},
        "value": {"value": 2.0},
    }[change]
    assert build().digest != build(**other).digest
