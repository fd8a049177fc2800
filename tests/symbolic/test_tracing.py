"""Recording plain functions: conditions, arrays, and what is refused with its reason."""

import functools
import math
import re
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp

from racs_bif.symbolic.arguments import read_arguments
from racs_bif.symbolic.compiled import compile_model
from racs_bif.symbolic.functions import model_from_function
from racs_bif.symbolic.overload import NotTraceable
from racs_bif.symbolic.rebinding import rebind
from racs_bif.symbolic.tracing import record

BY_NAME = {"sine": np.sin, "floor": np.floor, "add": np.add}


def joined_conditions(x, p):
    u, v = x
    inside = (u > -1.0) & (v < 0.5)
    outside = (u > 1.0) | ~(v > -0.5)
    return [np.where(inside, u, v), np.where(outside | False, p.a * u, u * v)]


def counted_conditions(x, p):
    u, v = x
    beyond, above = u > p.a, v > 0.0
    return [beyond + u, (1 - beyond) * v + (above - 0.5)]


def conditions_as_rates(x, p):
    return [x[0] > 0.0, x[1] < p.a]


def conditions_that_are_known(x, p):
    u, v = x
    always = (u - u) < 1.0
    never = (u > 0.0) & False
    return [u if always else v, v if never else p.a * u]


def asked_twice(x, p):
    total = 0.0
    for _ in range(40):
        if x[0] > 0.0:
            total += p.a
    return [total - x[0], x[1]]


def zeros_are_false(x, p):
    u, v = x
    return [p.a * v if u else 1.0, 2.0 if not (u * v) else u]


def into_arrays(x, p):
    rates = np.empty(2)
    np.sin(x, out=rates)
    return rates + p.a * BY_NAME["sine"](x)


def numpy_numbers(x, p):
    u, v = x
    return [np.conj(x)[0] + u.conjugate(), p.a * v.item() + np.logaddexp(u, v)]


def plain_numbers_inside(x, p):
    weights = np.asarray([1.0, 2.0])
    return [min(3.0, 2.0) * x[0] + math.atan2(0.0, -0.0), weights @ x + p.a * max([1, 5, 2])]


def from_the_right(x, p):
    u, v = x
    return np.array([1.0, 2.0]) * u - v + (np.array([p.a, 0.5]) / (2.0 + u**2))


def on_the_axis(x, p):
    zero = 0.0 * p.a
    return [math.atan2(x[0] - x[0], x[1]) + zero, math.atan2(0.0, p.a) + x[0]]


def angles_of_lists(x, p):
    return np.arctan2([0.0, x[0]], [p.a, 2.0]) + np.arctan2([-1.0, 0.0], [0.0, x[1] ** 2 + 1.0])


def parameters_as_an_array(x, p):
    values = np.array(p)
    return [values[0] * x[0] + p.get("b", 2.0), p[0] * x[1] - p[-1]]


def by_keyword(x, *, a):
    return [a * x[1], -x[0]]


RECORDED = (
    *(joined_conditions, counted_conditions, conditions_as_rates, conditions_that_are_known),
    *(asked_twice, zeros_are_false, into_arrays, numpy_numbers, plain_numbers_inside),
    *(from_the_right, on_the_axis, angles_of_lists, parameters_as_an_array, by_keyword),
)


@pytest.mark.parametrize("function", RECORDED, ids=lambda f: f.__name__)
def test_what_is_recorded_has_the_values_of_the_function(function):
    model = model_from_function("m", function, states="x y", parameters={"a": 0.7})
    assert model.external is None
    compiled = compile_model(model)
    arguments = read_arguments("m", function, ("x", "y"), ("a",), ())
    rng = np.random.default_rng(5)
    points = [*rng.uniform(-1.5, 1.5, (25, 2)), np.zeros(2)]
    for x in points:
        given = {"x": float(x[0]), "y": float(x[1]), "a": 0.7}
        wanted = arguments.floats(arguments.call(function, given))
        np.testing.assert_allclose(
            compiled.core(x, np.array([0.7])), wanted, rtol=1e-14, atol=1e-15
        )


def seven_questions(x, p):
    return [sum(p.a if x[0] > 0.1 * k else 1.0 for k in range(1, 8))]


def not_finite(x, p):
    return [1.0 / (x[0] - x[0]) if x[0] > 5.0 else p.a * x[0]]


def by_its_kind(x, p):
    return [p.a * x[0] + isinstance(x[0], float)]


def by_its_text(x, p):
    return [p.a * float(str(x[0]))]


def shorter_beyond(x, p):
    return [] if x[0] > 5.0 else [p.a * x[0]]


def floors(x, p):
    return [BY_NAME["floor"](x[0]) + p.a]


def summed_by_numpy(x, p):
    return [BY_NAME["add"].outer(x[0], p.a)]


def into_a_buffer(x, p):
    return [np.sin(x[0], out=np.empty(())) * p.a]


def exact_fractions(x, p):
    return [Fraction(1, 4) * x[0] + p.a]


REASONS = {
    exact_fractions: "unsupported operand type",
    seven_questions: "there are more than 64 paths through it",
    not_finite: "zoo.* is not a finite real expression",
    by_its_kind: "what was recorded gives other values than it does",
    by_its_text: "it raises ValueError: could not convert string to float: 'x'",
    shorter_beyond: "returns 0 numbers; return 1, one for each of x",
    floors: r"numpy\.floor cannot be differentiated here",
    summed_by_numpy: r"numpy\.add\.outer cannot be differentiated here",
    into_a_buffer: r"numpy\.sin into an array of floats cannot be differentiated here",
}


@pytest.mark.parametrize("function", REASONS, ids=lambda f: f.__name__)
def test_what_is_not_recorded_is_called_and_the_note_says_why(function):
    model = model_from_function("m", function, states="x", parameters={"a": 2.0}, guess=[0.25])
    assert model.external is not None
    assert re.search(REASONS[function], model.notes[0]), model.notes[0]
    wanted = function(np.array([0.25]), type("P", (), {"a": 2.0}))
    got = compile_model(model).core(np.array([0.25]), np.array([2.0]))
    np.testing.assert_allclose(got, wanted, rtol=1e-15)


def test_a_parameter_may_have_the_name_of_a_term():
    def long(x, p):
        y = x[0]
        for _ in range(12):
            y = np.tanh(p.term_1 * y * (1.0 - 0.1 * y)) + 0.01 * x[0]
        return [y]

    model = model_from_function("m", long, states="x", parameters={"term_1": 1.2})
    assert model.terms
    assert all(name.startswith("_term_") for name in model.terms)
    got = compile_model(model).core(np.array([0.6]), np.array([1.2]))
    wanted = long(np.array([0.6]), type("P", (), {"term_1": 1.2}))
    np.testing.assert_allclose(got, wanted, rtol=1e-13)


def test_paths_that_are_told_apart_only_once_are_refused():
    calls = []

    def forgets(given):
        calls.append(given)
        return [1 if len(calls) > 1 or given["x"] > 0.0 else 2]

    with pytest.raises(NotTraceable, match="does not branch in the same way when it is called"):
        record(forgets, ["x"], "term_")


def test_paths_of_different_lengths_are_refused():
    with pytest.raises(NotTraceable, match="lists of different lengths"):
        record(lambda given: [1, 2] if given["x"] > 0.0 else [1], ["x"], "term_")


def test_a_condition_asked_again_makes_no_further_path():
    found = record(lambda given: asked_twice([given["x"], 0.0], type("P", (), given)), "xa", "t")
    assert found.paths == 2
    assert found.results[0].has(sp.Piecewise)


def test_one_comparison_is_a_rate_of_one_or_zero():
    model = model_from_function("m", lambda x, p: x > p.a, states="x", parameters={"a": 1.0})
    assert model.external is None
    core = compile_model(model).core
    found = [core(np.array([x]), np.array([1.0]))[0] for x in (0.5, 1.5)]
    assert found == [0.0, 1.0]


def test_an_integer_that_no_float_holds_is_infinite():
    model = model_from_function(
        "m", lambda x, p: [p.a if float(x[0]) < 5.0 else 10**400], states="x", parameters={"a": 1.0}
    )
    core = compile_model(model).core
    assert core(np.array([1.0]), np.array([2.0])) == [2.0]
    assert core(np.array([6.0]), np.array([2.0])) == [math.inf]


def test_one_helper_under_two_names_and_a_cell_that_is_filled_later():
    local = helper

    def inner(x, p):
        far = later if x[0] > 100.0 else 0.0
        return [local(x[0]) * helper(x[1]) * p.a + far, x[1]]

    copy = rebind(inner)
    later = 5.0
    cells = dict(zip(copy.__code__.co_freevars, copy.__closure__, strict=True))
    assert cells["local"].cell_contents is copy.__globals__["helper"]
    with pytest.raises(ValueError, match="empty"):
        cells["later"].cell_contents  # noqa: B018
    assert inner(np.array([101.0, 0.0]), type("P", (), {"a": 0.0})) == [later, 0.0]


def helper(x):
    return math.sqrt(1.0 + x * x)


@functools.cache
def cached(x, y, a):
    return [math.sin(x) * a, y]


def test_what_is_no_python_function_is_called_as_it_is():
    model = model_from_function("m", cached, states="x y", parameters={"a": 2.0})
    assert "'cached' is called at every evaluation" in model.notes[0]
    assert "Overloaded" not in model.notes[0]
    compiled = compile_model(model)
    x, p = np.array([0.3, 0.5]), np.array([2.0])
    np.testing.assert_array_equal(compiled.core(x, p), [2.0 * math.sin(0.3), 0.5])
    wanted = [[2.0 * math.cos(0.3), 0.0], [0.0, 1.0]]
    np.testing.assert_allclose(compiled.core_jacobian(x, p), wanted, rtol=1e-9, atol=1e-9)
