"""What a model refuses, and in which words."""

import math

import numpy as np
import pytest
import sympy as sp

from racs_bif.errors import ModelError
from racs_bif.symbolic.compiled import compile_model
from racs_bif.symbolic.model import DerivedParameter, FractionalElement, Model, Parameter
from racs_bif.symbolic.strings import model_from_strings

x, y, a, b, s, w = sp.symbols("x y a b s w")
A = Parameter("a", 1.0)
ROOT = sp.sqrt(s)


def build(**changes):
    parts = {"name": "toy", "equations": {"x": -a * x}, "parameters": (A,)}
    return Model(**(parts | changes))


def element(law=ROOT, source=x, output="w"):
    return FractionalElement(output, source, law)


REFUSED = {
    "unknown symbol, nearest name": (
        {"equations": {"speed": -a * sp.Symbol("sped")}},
        ["'sped'", "equation of 'speed'", "did you mean 'speed'?"],
    ),
    "unknown symbol in an output": ({"outputs": {"out": b * x}}, ["'b'", "output 'out'"]),
    "unknown symbol in a law": ({"elements": (element(b * s),)}, ["'b'", "law of 'w'"]),
    "a state in a law": ({"elements": (element(x * s),)}, ["'x'", "law of 'w'"]),
    "unknown symbol in an input": ({"elements": (element(source=b),)}, ["'b'", "input of 'w'"]),
    "unknown symbol in the mass": ({"mass": sp.Matrix([[b]])}, ["'b'", "mass matrix"]),
    "an output of an element in the mass": (
        {"mass": sp.Matrix([[2 + w]]), "elements": (element(),)},
        ["'w'", "mass matrix"],
    ),
    "unknown symbol in a derived parameter": (
        {"derived": (DerivedParameter("k", a * b, sets="a"),)},
        ["'b'", "derived 'k'"],
    ),
    "a state in a derived parameter": (
        {"derived": (DerivedParameter("k", a * x, sets="a"),)},
        ["'x'", "derived 'k'"],
    ),
    "state and parameter of one name": ({"parameters": (A, Parameter("x", 1.0))}, ["'x'", "twice"]),
    "two parameters of one name": ({"parameters": (A, A)}, ["'a'", "twice"]),
    "element and state of one name": ({"elements": (element(output="x"),)}, ["'x'", "twice"]),
    "output and state of one name": ({"outputs": {"x": a}}, ["'x'", "twice"]),
    "derived and base of one name": (
        {"derived": (DerivedParameter("a", 2 * a, sets="a"),)},
        ["'a'", "twice"],
    ),
    "a word of the grammar": ({"equations": {"if": sp.Integer(1)}}, ["'if'", "cannot be a name"]),
    "no identifier": ({"equations": {"x 1": sp.Integer(1)}}, ["'x 1'", "cannot be a name"]),
    "no string": ({"equations": {1: sp.Integer(1)}}, ["'1'", "cannot be a name"]),
    "the Laplace variable as a state": (
        {"equations": {"s": s, "x": -x}, "elements": (element(),)},
        ["'s'", "Laplace", "rename"],
    ),
    "a mass of the wrong shape": ({"mass": sp.eye(2)}, ["(2, 2)", "(1, 1)", "1 states"]),
    "derived that sets nothing": (
        {
            "parameters": (Parameter("alpha", 1.0), A),
            "derived": (DerivedParameter("k", a, sets="alpa"),),
        },
        ["'k'", "'alpa'", "did you mean 'alpha'?"],
    ),
    "guess for nothing": ({"guess": {"z": 1.0}}, ["guess", "'z'", "there are: x"]),
    "a guess that is infinite": ({"guess": {"x": math.inf}}, ["guess of 'x'", "inf"]),
    "a default that is no number": (
        {"parameters": (Parameter("a", math.nan),)},
        ["default of 'a'", "nan"],
    ),
    "a default that is text": ({"parameters": (Parameter("a", "1"),)}, ["default of 'a'", "'1'"]),
    "a band that falls": ({"band": (10.0, 1.0)}, ["band 10 .. 1", "LOW < HIGH"]),
    "nothing at all": ({"equations": {}}, ["no equations"]),
    "an equation that is text": ({"equations": {"x": "-a*x"}}, ["'x'", "str"]),
    "an equation that is a comparison": ({"equations": {"x": x < 1}}, ["'x'", "sympy expression"]),
    "a matrix for an equation": ({"equations": {"x": sp.eye(2)}}, ["'x'", "sympy expression"]),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refused(case):
    changes, words = REFUSED[case]
    with pytest.raises(ModelError) as caught:
        build(**changes)
    message = str(caught.value)
    assert "\n" not in message
    for word in ["toy", *words]:
        assert word in message


NOT_COMPILED = {
    "no quotient of powers": ({"elements": (element(sp.exp(-s)),)}, ["law of 'w'", "quotient"]),
    "a logarithm": ({"elements": (element(sp.log(s)),)}, ["law of 'w'", "quotient"]),
    "a root of a sum": ({"elements": (element(sp.sqrt(1 + s)),)}, ["law of 'w'", "quotient"]),
    "a pole of broken order": (
        {"elements": (element(1 / (1 + s) ** sp.Rational(3, 10)),)},
        ["law of 'w'", "quotient"],
    ),
    "elements in a loop": (
        {"elements": (element(source=sp.Symbol("r")), element(source=w, output="r"))},
        ["w, r", "feed each other"],
    ),
    "an element that feeds itself": ({"elements": (element(source=x - w),)}, ["w", "feed"]),
    "a singular mass": (
        {"equations": {"x": -x, "y": y}, "mass": sp.Matrix([[a, 1], [1, 1]])},
        ["singular"],
    ),
    "an algebraic equation": (
        {"equations": {"x": -x, "y": y}, "mass": sp.diag(1, 0)},
        ["singular", "algebraic"],
    ),
    "an infinite mass": ({"mass": sp.Matrix([[1 / (a - 1)]])}, ["mass", "not finite"]),
    "a derived parameter with two inverses": (
        {"derived": (DerivedParameter("k", a**2, sets="a"),)},
        ["'k'", "'a'", "uniquely"],
    ),
    "a derived parameter that its target does not move": (
        {
            "parameters": (A, Parameter("b", 1.0)),
            "derived": (DerivedParameter("k", 2 * a, sets="b"),),
        },
        ["'k'", "'b'"],
    ),
    "an unknown function": ({"equations": {"x": sp.gamma(x)}}, ["gamma", "elementary"]),
    "an imaginary number": ({"equations": {"x": sp.I * x}}, ["'I'", "real"]),
    "a complex constant": ({"equations": {"x": x * sp.log(-2)}}, ["log(2)", "real"]),
    "a number too large": ({"equations": {"x": x * sp.Integer(10) ** 400}}, ["finite"]),
    "infinity": ({"equations": {"x": x * sp.oo}}, ["'oo'", "finite"]),
    "a gap in a piecewise": ({"equations": {"x": sp.Piecewise((x, x > 0))}}, ["undefined", "True"]),
}


@pytest.mark.parametrize("case", NOT_COMPILED)
def test_not_compiled(case):
    changes, words = NOT_COMPILED[case]
    model = build(**changes)
    with pytest.raises(ModelError) as caught:
        compile_model(model)
    message = str(caught.value)
    assert "\n" not in message
    for word in words:
        assert word in message


def test_nested_too_deeply():
    nest = x
    for _ in range(400):
        nest = sp.sin(nest, evaluate=False)
    with pytest.raises(ModelError, match=r"model 'toy': .* nested too deeply"):
        compile_model(build(equations={"x": nest}))


def test_elements_in_series_are_no_loop():
    """An element may feed another, in any order of writing."""
    elements = (
        FractionalElement("late", sp.Symbol("early"), s ** sp.Rational(1, 2)),
        FractionalElement("early", x, s ** sp.Rational(1, 3)),
    )
    compiled = compile_model(build(elements=elements, equations={"x": -sp.Symbol("late")}))
    # X = (x, zeta of late, zeta of early), P = (a, D of late, D of early)
    X, P = np.array([2.0, 3.0, 5.0]), np.array([1.0, 7.0, 11.0])
    early = 5.0 + 11.0 * 2.0
    late = 3.0 + 7.0 * early
    np.testing.assert_allclose(compiled.core(X, P), [-late, early, 2.0], rtol=1e-15)


def test_a_strictly_proper_element_closes_a_loop():
    loop = FractionalElement("w", x - w, 1 / (1 + s ** sp.Rational(1, 2)))
    compiled = compile_model(build(elements=(loop,), equations={"x": -w}))
    assert compiled.feedthrough == (False,)
    np.testing.assert_array_equal(
        compiled.core(np.array([2.0, 3.0]), np.array([1.0, 0.0])), [-3.0, -1.0]
    )


def test_elements_alone_are_a_model():
    model = build(equations={}, elements=(element(1 / s, source=-a * w),))
    assert model.states == ()
    compiled = compile_model(model)
    np.testing.assert_array_equal(compiled.core(np.array([3.0]), np.array([2.0, 0.0])), [-6.0])


def test_greek_names():
    model = model_from_strings(
        "αβγ",
        {"θ": "ω", "ω": "-2*ζ*ω - sin(θ) + µ"},
        parameters={"ζ": 0.1, "µ": 0.2},  # the micro sign of the keyboard
        guess={"θ": 0.1},
        outputs={"ε": "θ**2"},
    )
    compiled = compile_model(model)
    assert compiled.states == ("θ", "ω")
    value = compiled.core(np.array([0.5, 0.25]), np.array([0.1, 0.2]))
    np.testing.assert_allclose(value, [0.25, -0.05 - math.sin(0.5) + 0.2], rtol=1e-15)
    outputs = compiled.output_values(np.array([0.5, 0.25]), np.array([0.1, 0.2]))
    assert outputs == {"ε": 0.25}


def test_assumptions_of_symbols_do_not_matter():
    positive = sp.Symbol("x", positive=True)
    model = build(equations={"x": -a * positive + x**2}, elements=(element(),))
    compiled = compile_model(model)
    assert compiled.core(np.array([3.0, 0.0]), np.array([2.0, 0.0]))[0] == 3.0


def test_a_model_keeps_its_own_tables():
    equations = {"x": -a * x}
    model = build(equations=equations)
    equations["x"] = sp.Integer(0)
    equations["y"] = sp.Integer(0)
    assert model.equations == {"x": -a * x}
    with pytest.raises(AttributeError):
        model.name = "other"


def test_what_a_compiled_model_tells_of_itself():
    positive = (0.0, math.inf)
    model = build(
        parameters=(Parameter("a", 2, "m", "length", "a book", positive), Parameter("b", 3.0)),
        derived=(DerivedParameter("k", a * b, sets="b", unit="N", valid=positive),),
        units={"x": "m"},
        notes=["mind this"],
        title="a toy",
        band=(2, 30),
    )
    compiled = compile_model(model)
    assert compiled.parameters == (
        Parameter("a", 2.0, "m", "length", "a book", positive),
        Parameter("b", 3.0),
    )
    (info,) = compiled.derived
    assert (info.name, info.sets, info.unit, info.valid) == ("k", "b", "N", positive)
    assert compiled.meta["notes"] == ["mind this"]
    assert compiled.meta["band"] == [2.0, 30.0]
    p = np.array([2.0, 3.0])
    assert compiled.derived_values(p) == 6.0
    assert compiled.inverse(0, p, 10.0) == 5.0
    # b = k/a: db = (dk - b da)/a
    slope = compiled.inverse_slope(0, np.array([2.0, 5.0]), 10.0, np.array([0.5, 0.0]), 3.0)
    assert slope == pytest.approx((3.0 - 5.0 * 0.5) / 2.0, rel=1e-15)


def test_inputs_are_parameters():
    equations, parameters = {"x": sp.Symbol("f") - sp.Symbol("x")}, (Parameter("f", 0.0),)
    model = Model(name="m", equations=equations, parameters=parameters, inputs=["f"])
    assert model.inputs == ("f",)
    with pytest.raises(ModelError, match="input 'ff' is no parameter; did you mean 'f'"):
        Model(name="m", equations=equations, parameters=parameters, inputs=("ff",))


def test_powers_that_sympy_leaves_unevaluated():
    rates = {
        "x": sp.Pow(sp.E, a * x, evaluate=False),
        "y": sp.Pow(x, 0, evaluate=False) + sp.Pow(1, y, evaluate=False) + y,
    }
    compiled = compile_model(build(equations=rates))
    found = compiled.core(np.array([0.5, 0.25]), np.array([2.0]))
    np.testing.assert_allclose(found, [math.e, 2.25], rtol=1e-15)
    jacobian = compiled.core_jacobian(np.array([0.5, 0.25]), np.array([2.0]))
    np.testing.assert_allclose(jacobian, [[2.0 * math.e, 0.0], [0.0, 1.0]], rtol=1e-15)


def test_a_term_may_hold_the_output_of_an_element():
    v = sp.Symbol("v")
    model = build(equations={"x": -a * v}, terms={"v": w**2 + 1}, elements=(element(),))
    compiled = compile_model(model)
    # X = (x, memory of w), P = (a, D): w = memory + D x
    found = compiled.core(np.array([3.0, 0.5]), np.array([2.0, 10.0]))
    np.testing.assert_array_equal(found, [-2.0 * (30.5**2 + 1.0), 3.0])
