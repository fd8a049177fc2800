"""Models from plain Python functions: recorded, called, refused."""

import functools
import math
import pickle
from math import sin

import numpy as np
import pytest
from scipy.special import erf, expit

from racs_bif.errors import ModelError, UsageError
from racs_bif.symbolic import functions
from racs_bif.symbolic.compiled import compile_model
from racs_bif.symbolic.functions import model_from_function
from racs_bif.symbolic.model import FractionalElement, Parameter
from racs_bif.symbolic.strings import model_from_strings

PARAMETERS = {"a": 0.7, "b": 1.3}
COUPLING = np.array([[0.5, -1.0], [2.0, 0.25]])


def helper(x):
    return math.sqrt(1.0 + x * x) + math.atan2(x, 2.0)


def plain(x, p):
    return [x[1] * p.a, -p["b"] * x[0] + x[1] ** 3]


def by_name(x, y, a, b):
    return {"y": a * x - b, "x": y / (1 + x**2)}


def with_time(t, state, p):
    del t
    x, y = state
    a, b = p
    return (a * x + b * y, x * y)


def scipy_order(time, state, a, b):
    return np.array([a * state[0] + b, state[1] - state[0] * time * 0])


def everything_by_name(**values):
    return [values["x"] * values["a"], values["y"] - values["b"]]


def unpacked(x, p):
    return by_name(*x, **p)["x"], len(p) * x[1] + ("a" in p)


def arrays(x, p):
    rates = np.zeros(2)
    rates[0] = np.sum(COUPLING @ x)
    rates[1:] = p.a * np.exp(-(x[:1] ** 2)) + np.dot([1.0, 2.0], x)
    return rates


def numpy_functions(x, p):
    u, v = x
    first = np.arctan2(u, 2 + v**2) + np.tanh(u) * np.log1p(v**2) + np.hypot(u, 1.5)
    second = np.cbrt(u + 3) + np.expm1(v) + np.log2(4 + u**2) + np.square(v) + np.exp2(u)
    return first * p.a + np.heaviside(u, 0.5), second + erf(u) + expit(v) + np.reciprocal(3 + u)


def math_functions(x, p):
    u, v = x
    return helper(u) + math.pow(abs(v) + 0.1, 1.5) + sin(u), math.log(3 + u, 2) + math.cosh(p.b * v)


def loops(x, p):
    total = 0.0
    for k in range(1, 6):
        total += math.cos(k * x[0]) / k**p.a
    return [sum(c * x[0] ** k for k, c in enumerate([1, -2, 0.5])), total]


def branches(x, p):
    if x[0] > 0.1:
        first = p.a * x[0]
    elif x[1] <= 0.0 and x[0] > -1.0:
        first = math.sin(x[1])
    else:
        first = -1.0
    return [first, max(x[0], x[1], p.b) - min(x) + (x[1] > 0.2) * x[0]]


def choices(x, p):
    u, v = x
    return [
        np.where(u > v, u**2, p.a * v) + np.maximum(u, 0.0) * np.sign(v),
        np.clip(v, -0.2, 0.3) + np.abs(u - v),
    ]


def long(x, p):
    y = x[0]
    for _ in range(40):
        y = np.tanh(p.a * y * (1.0 - 0.1 * y)) + 0.01 * x[1]
    return [y, -y]


def reversed_operations(x, p):
    u, v = x
    return [2 - u + np.float64(3.0) * v - 1 / (2 + u**2), 2.0**u - p.a**v + (+u) - (-v)]


class Callable:
    gain = 2.0

    def __call__(self, x, p):
        return [self.gain * math.sin(x[0]) * p.a, self.rate(x, p)]

    def rate(self, x, p):
        return x[1] * p.b


def shifted(offset, x, p):
    return [math.sin(x[0]) + offset, x[1] * p.a]


def closure():
    scale = 1.5
    root = math.sqrt

    def inner(x, p):
        return [scale * root(x[0] ** 2 + 1), p.b * x[1]]

    return inner


RECORDED = {
    f.__name__: f
    for f in (
        *(plain, by_name, with_time, scipy_order, everything_by_name, unpacked, arrays),
        *(numpy_functions, math_functions, loops, branches, choices, long, reversed_operations),
    )
} | {
    "callable": Callable(),
    "method": Callable().__call__,
    "partial": functools.partial(shifted, 0.25),
    "closure": closure(),
    "lambda": lambda x, p: [x[0] * p.a, x[1]],
}


@pytest.mark.parametrize("name", RECORDED)
def test_what_is_recorded_has_the_values_of_the_function(name):
    function = RECORDED[name]
    model = model_from_function("m", function, states=["x", "y"], parameters=PARAMETERS)
    assert model.external is None
    assert model.notes == ()
    compiled = compile_model(model)
    rng = np.random.default_rng(3)
    arguments = functions.read_arguments("m", function, ("x", "y"), ("a", "b"), ())
    for _ in range(25):
        x, p = rng.uniform(-1.5, 1.5, 2), rng.uniform(0.3, 1.5, 2)
        given = {"x": float(x[0]), "y": float(x[1]), "a": float(p[0]), "b": float(p[1]), "t": 0.0}
        wanted = arguments.floats(arguments.call(function, given))
        np.testing.assert_allclose(compiled.core(x, p), wanted, rtol=2e-14, atol=2e-14)


def test_a_long_recording_is_told_in_terms():
    model = model_from_function("m", long, states="x y", parameters=PARAMETERS)
    assert model.terms
    assert sum(len(str(e)) for e in model.terms.values()) < 10_000
    compiled = compile_model(model)
    assert list(compiled.meta["terms"]) == list(model.terms)


def test_a_recording_compiles_to_the_program_that_strings_give():
    texts = {"x": "A-(B+1)*x+x**2*y", "y": "B*x-x**2*y"}
    numbers = {"A": 1.0, "B": 1.5}

    def brusselator(x, p):
        return p.A - (p.B + 1) * x[0] + x[0] ** 2 * x[1], p.B * x[0] - x[0] ** 2 * x[1]

    one = compile_model(model_from_strings("b", texts, parameters=numbers))
    other = compile_model(model_from_function("b", brusselator, states="x, y", parameters=numbers))
    assert one.sources == other.sources


def converging(x, p):
    y = 1.0
    for _ in range(100):
        step = (y * y - 2.0 - x[0] ** 2) / (2.0 * y)
        y = y - step
        if abs(step) < 1e-15:
            break
    return [p.a * y - x[1], x[0] * math.cos(y)]


def solved(x, p):
    matrix = np.array([[2.0, x[0]], [0.0, p.a + x[1] ** 2]])
    return np.linalg.solve(matrix, x)


def rounded(x, p):
    return [math.exp(float(x[0])) - p.a * x[1], float(x[0]) ** 2 * float(x[1])]


def exact_root(x, a):
    """Return values, Jacobian and a second form along (1, 2) of `converging`."""
    u, v = x
    y = math.sqrt(2 + u * u)
    y1, y2 = u / y, 2 / y**3
    value = [a * y - v, u * math.cos(y)]
    jacobian = [[a * y1, -1.0], [math.cos(y) - u * math.sin(y) * y1, 0.0]]
    bend = -2 * math.sin(y) * y1 - u * (math.cos(y) * y1**2 + math.sin(y) * y2)
    return value, jacobian, [a * y2, bend]


def test_what_branches_too_often_is_called_with_exact_derivatives():
    model = model_from_function("m", converging, states="x y", parameters={"a": 0.7})
    assert "power series" in model.notes[0]
    assert "more than" in model.notes[0]
    compiled = compile_model(model)
    assert compiled.meta["external"]["derivatives"] == "series"
    x, p = np.array([0.4, -0.3]), np.array([0.7])
    value, jacobian, bend = exact_root(x, 0.7)
    np.testing.assert_allclose(compiled.core(x, p), value, rtol=1e-14)
    np.testing.assert_allclose(compiled.core_jacobian(x, p), jacobian, rtol=1e-13, atol=1e-14)
    u = np.array([1.0, 2.0])
    np.testing.assert_allclose(compiled.core_xx(x, p, u, u), bend, rtol=1e-12)
    complex_u = u * (1 + 2j)
    np.testing.assert_allclose(
        compiled.core_xx(x, p, complex_u, u), np.array(bend) * (1 + 2j), rtol=1e-12
    )
    slope = compiled.core_p(x, p, np.array([1.0]))
    np.testing.assert_allclose(slope, [math.sqrt(2.16), 0.0], rtol=1e-13)
    many = np.column_stack([x, x + 0.1, x - 0.2])
    jacobians = compiled.core_jacobian(many, p)
    for column, found in zip(many.T, jacobians, strict=True):
        np.testing.assert_allclose(found, exact_root(column, 0.7)[1], rtol=1e-13, atol=1e-14)


def test_third_derivatives_of_what_is_called():
    def cubic(x, p):
        k = 0
        while abs(x[0]) > k:  # no bound that is known beforehand
            k += 1
        return [p.a * x[0] ** 3 * x[1], x[1] ** 3]

    model = model_from_function("m", cubic, states="x y", parameters={"a": 2.0})
    assert model.external is not None
    compiled = compile_model(model)
    u, v, w = np.array([1.0, 0.0]), np.array([1.0, 1.0]), np.array([0.5, 2.0])
    x, p = np.array([0.5, 1.5]), np.array([2.0])
    # f = 2 x^3 y: f_xxx = 12 y, f_xxy = 12 x
    first = 12 * 1.5 * 0.5 + 12 * 0.5 * (1.0 * 0.5 + 2.0)
    second = 0.0
    np.testing.assert_allclose(compiled.core_xxx(x, p, u, v, w), [first, second], rtol=1e-12)
    mixed = compiled.core_xp(x, p, u, np.array([1.0]))
    np.testing.assert_allclose(mixed, [3 * 0.25 * 1.5, 0.0], rtol=1e-12)


def test_a_complex_step_where_series_do_not_pass():
    model = model_from_function("m", solved, states="x y", parameters={"a": 1.0})
    assert "complex step" in model.notes[0]
    compiled = compile_model(model)
    x, p = np.array([0.3, 0.4]), np.array([1.0])
    below = x[1] / (1 + x[1] ** 2)
    slope = (1 - x[1] ** 2) / (1 + x[1] ** 2) ** 2
    jacobian = [[(1 - below) / 2, -x[0] * slope / 2], [0.0, slope]]
    np.testing.assert_allclose(compiled.core_jacobian(x, p), jacobian, rtol=1e-13, atol=1e-14)


def test_differences_are_said():
    model = model_from_function("m", rounded, states="x y", parameters={"a": 1.0})
    assert "differences" in model.notes[0]
    assert "estimated relative error" in model.notes[0]
    compiled = compile_model(model)
    x, p = np.array([0.3, -0.4]), np.array([1.0])
    jacobian = [[math.exp(0.3), -1.0], [2 * 0.3 * -0.4, 0.09]]
    np.testing.assert_allclose(compiled.core_jacobian(x, p), jacobian, rtol=1e-9, atol=1e-10)
    u, v, w = np.array([1.0, 0.5j]), np.array([1.0, -1.0]), np.array([0.2, 0.3])
    form = [math.exp(0.3), 2 * -0.4 + 2 * 0.3 * (0.5j - 1.0)]
    np.testing.assert_allclose(compiled.core_xx(x, p, u, v), form, rtol=1e-8, atol=1e-8)
    third = compiled.core_xxx(x, p, v, v, w)
    np.testing.assert_allclose(third, [math.exp(0.3) * 0.2, 2 * (0.3 - 0.4)], atol=1e-6)


def test_what_is_asked_for_is_done_or_refused():
    model = model_from_function(
        "m", plain, states="x y", parameters=PARAMETERS, derivatives="series"
    )
    assert model.external is not None
    text = model_from_function(
        "m", plain, states="x y", parameters=PARAMETERS, derivatives="differences"
    ).notes[0]
    assert "complex step" in text
    with pytest.raises(ModelError, match=r"'converging' cannot be recorded \(it branches"):
        model_from_function(
            "m", converging, states="x y", parameters={"a": 1.0}, derivatives="recorded"
        )
    with pytest.raises(ModelError, match="'rounded' has no series"):
        model_from_function("m", rounded, states="x y", parameters={"a": 1.0}, derivatives="series")
    with pytest.raises(UsageError, match="did you mean 'series'"):
        model_from_function("m", plain, states="x y", derivatives="serie")


def test_one_state_as_a_number_or_an_array():
    number = model_from_function("m", lambda x, p: p.a - x**3, states="x", parameters={"a": 1})
    array = model_from_function(
        "m", lambda x, p: [p.a - x[0] ** 3], states="x", parameters={"a": 1}
    )
    assert number.equations == array.equations


def test_fractional_elements_parameters_guesses_and_outputs():
    model = model_from_function(
        "m",
        lambda x, v, w, c: [v, -x - c * w],
        states="x v",
        parameters=[Parameter("c", 0.5, unit="N"), Parameter("q", 0.5)],
        guess=[0.1, 0.2],
        elements=[("w", "x", "s**q")],
        outputs={"energy": "x**2 + v**2"},
    )
    assert model.parameters[0].unit == "N"
    assert model.guess == {"x": 0.1, "v": 0.2}
    assert isinstance(model.elements[0], FractionalElement)
    compiled = compile_model(model)
    # X = (x, v, w's memory), P = (c, q, D): w = memory + D x
    core = compiled.core(np.array([0.3, 0.4, 2.0]), np.array([0.5, 0.5, 10.0]))
    np.testing.assert_allclose(core, [0.4, -0.3 - 0.5 * 5.0, 0.3], rtol=1e-14)


def test_a_called_function_takes_outputs_of_elements():
    def rates(x, p, w):
        k = 0
        while abs(x[0]) > k:
            k += 1
        return [x[1], -x[0] - p.c * w * x[0]]

    model = model_from_function(
        "m", rates, states="x v", parameters={"c": 0.5}, elements=[("w", "x*v", "s**0.5")]
    )
    assert model.external is not None
    compiled = compile_model(model)
    X, P = np.array([0.3, 0.4, 2.0]), np.array([0.5, 10.0])
    w = 2.0 + 10.0 * 0.12
    np.testing.assert_allclose(compiled.core(X, P), [0.4, -0.3 - 0.5 * w * 0.3, 0.12], rtol=1e-14)
    # w_x = D v, w_v = D x, w_memory = 1
    row = [-1 - 0.5 * (w + 0.3 * 10 * 0.4), -0.5 * 0.3 * 10 * 0.3, -0.15]
    jacobian = compiled.core_jacobian(X, P)
    np.testing.assert_allclose(jacobian, [[0, 1, 0], row, [0.4, 0.3, 0]], rtol=1e-13, atol=1e-14)
    u, v = np.array([1.0, 2.0, 3.0]), np.array([0.5, 1.0, -1.0])
    forms = compiled.core_xx(X, P, u, v)
    step = 1e-5
    moved = [compiled.core_jacobian(X + s * step * v, P) @ u for s in (1, -1)]
    np.testing.assert_allclose(forms, (moved[0] - moved[1]) / (2 * step), rtol=1e-8, atol=1e-8)


def test_called_models_are_pickled_by_the_name_of_their_function():
    model = model_from_function("m", converging, states="x y", parameters={"a": 0.7})
    compiled = compile_model(model)
    local = model_from_function(
        "m", lambda x, p: converging(2 * x, p), states="x y", parameters={"a": 0.7}
    )
    again = pickle.loads(pickle.dumps(compiled))
    x, p = np.array([0.4, -0.3]), np.array([0.7])
    np.testing.assert_array_equal(again.core(x, p), compiled.core(x, p))
    with pytest.raises(ModelError, match="top level of a file"):
        pickle.dumps(compile_model(local))


def test_the_function_and_its_module_stay_as_they_were():
    before = dict(globals())
    model_from_function("m", math_functions, states="x y", parameters=PARAMETERS)
    assert globals() == before
    assert math_functions.__globals__["math"] is math
    assert math.sin(1.0) == pytest.approx(0.8414709848)


counter = {"calls": 0}


def remembers(x, p):
    counter["calls"] += 1
    return [p.a * counter["calls"] - x[0]]


REFUSED = {
    "no return": (lambda x, p: None, "returns nothing; end it with 'return"),
    "too few": (lambda x, p: [x[0]], "returns 1 number; return 2, one for each of x, y"),
    "too many": (lambda x, p: [1, 2, 3], "returns 3 numbers"),
    "a matrix": (lambda x, p: np.eye(2), r"an array of shape \(2, 2\); return \(2,\)"),
    "text": (lambda x, p: "xy", "returns str; return a list of 2 numbers"),
    "text inside": (lambda x, p: ["1", 2], "returns str for 'x'; return a number"),
    "a list inside": (lambda x, p: [[1, 2], 2], "returns list for 'x'"),
    "complex": (lambda x, p: [1j, 2], "returns a complex number for 'x', 0\\+1j; return real"),
    "no state": (
        lambda x, p: {"x": 1, "z": 2},
        "a rate of 'z', which is no state; there are: x, y",
    ),
    "a state missing": (lambda x, p: {"x": 1}, "no rate of 'y'; add it"),
    "unknown parameter": (lambda x, p: [p.aa, 1], "no parameter 'aa'; did you mean 'a'"),
    "unknown key": (lambda x, p: [p["aa"], 1], "no parameter 'aa'; did you mean 'a'"),
    "raises": (lambda x, p: [x[0], {}["k"]], "raises KeyError at x = 0, y = 0, a = 1: 'k'"),
    "unknown argument": (lambda x, q, r: [x[0], 1], "'r' of the function '<lambda>' is neither"),
    "no states": (lambda a: [1, 2], "takes no states; write it as <lambda>"),
    "the time": (lambda t, x, p: [math.cos(t), 1], "depends on the time; make it autonomous"),
    "an index": (lambda x, p: [x[2], 1], "raises IndexError"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refused(case):
    function, words = REFUSED[case]
    with pytest.raises(ModelError, match=words) as caught:
        model_from_function("toy", function, states="x y", parameters={"a": 1.0})
    message = str(caught.value)
    assert message.startswith("model 'toy'")
    assert "\n" not in message


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"function": 3}, "int is no function"),
        ({"function": print}, "cannot be read|neither a state|takes no states|returns nothing"),
        ({"states": 3}, "give the names of the states as a list"),
        ({"states": "x 1y"}, "'1y' cannot be a name"),
        ({"states": "pi y"}, "'pi' is a constant"),
        ({"states": "x x"}, "used twice"),
        ({"parameters": ["a"]}, "give parameters as a dict, not as list"),
        ({"parameters": {"a": "one"}}, "'a' is 'one', which is no number"),
        ({"parameters": {"a": float("inf")}}, "default of 'a' is inf"),
        ({"guess": [1.0]}, "the guess has 1 numbers; give 2"),
        ({"guess": {"z": 1.0}}, "guess for unknown state 'z'"),
        ({"elements": [("w", "x")]}, "an element must be"),
    ],
)
def test_what_is_around_the_function_is_checked(options, words):
    given = {"function": plain, "states": "x y", "parameters": PARAMETERS} | options
    with pytest.raises(ModelError, match=words):
        model_from_function("toy", given.pop("function"), **given)


def test_a_function_that_remembers_is_refused():
    with pytest.raises(ModelError, match="returns other numbers when it is called again"):
        model_from_function("toy", remembers, states="x", parameters={"a": 1.0})


def test_integers_booleans_and_complex_zeros_are_numbers():
    model = model_from_function(
        "m", lambda x, p: [np.int64(1) - True * x[0], 2 + 0j], states="x y", parameters={"a": 1}
    )
    core = compile_model(model).core(np.array([3.0, 0.0]), np.array([1.0]))
    np.testing.assert_array_equal(core, [-2.0, 2.0])


def test_where_the_function_is_undefined_it_is_no_number():
    model = model_from_function(
        "m",
        lambda x, p: [math.log(float(x[0])) - p.a],
        states="x",
        parameters={"a": 1.0},
        guess=[2.0],
    )
    compiled = compile_model(model)
    assert np.isnan(compiled.core(np.array([-1.0]), np.array([1.0])))[0]
    assert np.isfinite(compiled.core(np.array([1.0]), np.array([1.0])))[0]


def test_an_error_of_the_function_is_told_where_it_happens():
    def breaks(x, p):
        if float(x[0]) > 5.0:
            raise LookupError("out of the table")
        return [p.a - x[0]]

    compiled = compile_model(model_from_function("m", breaks, states="x", parameters={"a": 1.0}))
    words = r"'breaks', line \d+ of test_functions.py, raises LookupError at x = 6, a = 1: out of"
    with pytest.raises(ModelError, match=words):
        compiled.core(np.array([6.0]), np.array([1.0]))
