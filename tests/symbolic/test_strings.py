"""Models from strings: arithmetic is understood, all else refused and nothing executed."""

import math

import numpy as np
import pytest
import sympy as sp

from racs_bif.errors import ModelError
from racs_bif.symbolic.compiled import compile_model
from racs_bif.symbolic.strings import model_from_strings, parse

x, y, t = sp.symbols("x y t")

READ = {
    "2*x^2 + 3": 2 * x**2 + 3,
    "2*x**2": 2 * x**2,
    "2^3^2": sp.Integer(512),
    "-x^2": -(x**2),
    "x^-1": 1 / x,
    "1/3*x": x / 3,
    "+x - -y": x + y,
    "  x\t+ 1 ": x + 1,
    "1e-3*x": sp.Float("1e-3") * x,
    "1_000*x": 1000 * x,
    "pi*x": sp.pi * x,
    "ln(x) + log(x)": 2 * sp.log(x),
    "log(x, 2)": sp.log(x) / sp.log(2),
    "abs(x)*sign(y)": sp.Abs(x) * sp.sign(y),
    "max(x, y, 1) - min(x, y)": sp.Max(x, y, 1) - sp.Min(x, y),
    "heaviside(x)": sp.Heaviside(x),
    "heaviside(x, 1)": sp.Heaviside(x, 1),
    "x if x > 0 else -x": sp.Piecewise((x, x > 0), (-x, True)),
    "1 if x <= y else 2 if x >= 2*y else 3": sp.Piecewise(
        (1, x <= y), (sp.Piecewise((2, x >= 2 * y), (3, True), evaluate=False), True)
    ),
    "sqrt(x) + exp(x)": sp.sqrt(x) + sp.exp(x),
    "asinh(x) + acosh(x) + atanh(x)": sp.asinh(x) + sp.acosh(x) + sp.atanh(x),
    "erf(tanh(sinh(cosh(x))))": sp.erf(sp.tanh(sp.sinh(sp.cosh(x)))),
    "asin(x) + acos(x) + atan(x)": sp.asin(x) + sp.acos(x) + sp.atan(x),
    "sin(x)*cos(x)/tan(x)": sp.sin(x) * sp.cos(x) / sp.tan(x),
    "exp": sp.Symbol("exp"),  # a name like any other where it is not called
    "lambda_": sp.Symbol("lambda_"),
}


@pytest.mark.parametrize("text", READ)
def test_what_is_read(text):
    assert parse(text) == READ[text]


REFUSED = [
    "__import__('os').system('x')",
    "__import__(os)",
    "().__class__",
    "().__class__.__bases__[0].__subclasses__()",
    "x.real",
    "x.__class__",
    "lambda: 0",
    "(lambda y: y)(x)",
    "f'{x}'",
    "'x'",
    "b'x'",
    "[x for x in y]",
    "{x: y for x in y}",
    "(x for x in y)",
    "[x, y]",
    "(x, y)",
    "{x}",
    "x[0]",
    "x if",
    "x if y",
    "x if y else x",
    "x if 1 else y",
    "x if (y if 1 < 2 else x) else y",
    "(x := 1)",
    "x = 1",
    "x; y",
    "x\ny",
    "import os",
    "print(x)",
    "eval('1')",
    "exec(x)",
    "open(x)",
    "getattr(x, y)",
    "sin.func(x)",
    "sin(x)(y)",
    "2(x)",
    "2x",
    "x y",
    "sin(x=1)",
    "sin(*x)",
    "sin(**x)",
    "sin()",
    "sin(x, y)",
    "sqrt(x, y)",
    "log(x, y, 2)",
    "max(x)",
    "max()",
    "max(x < 1, y)",
    "sin(x < 1)",
    "x < 1",
    "(x < 1) + 1",
    "-(x < 1)",
    "x**(y < 1)",
    "0 < x < 1",
    "x if 0 < y < 1 else y",
    "x if x == 1 else y",
    "x and y",
    "not x",
    "~x",
    "x % y",
    "x // y",
    "x @ y",
    "x & y",
    "x << 2",
    "True",
    "None",
    "...",
    "1j*x",
    "1e999",
    "await x",
    "yield x",
    "9**9**9",
    "9^9^9",
    "(10**1000)**1000",
    "((10**100)**9)**9",
    "2**(2**20)",
    "(1/10**300)**300",
    "x**100000",
    "x**(1/0)",
    "x**(0/0)",
    "x**(-1)**0.5",
    "9" * 5000,
    "(" * 5000 + "x" + ")" * 5000,
    "-" * 5000 + "x",
    "+".join("x" * 5000),
    "sin(" * 2000 + "x" + ")" * 2000,
    "x**" * 3000 + "x",
    "x" * 30_000,
    "",
    "   ",
    "#",
    "x \\",
    "x\0y",
    "\ud800",
    "\u202ex",
    "x\u200b",
    "x − y",  # noqa: RUF001 - a typeset minus sign
    "x × y",  # noqa: RUF001 - a typeset product
    "x²",
    "½*x",
    "θ.ω",
    "ｌａｍｂｄａ: 0",  # noqa: RUF001 - full width letters
    "ｅｖａｌ(x)",  # noqa: RUF001
    "$x",
    "x?",
    "`x`",
    "!x",
    "%x",
]


@pytest.mark.parametrize("text", REFUSED, ids=range(len(REFUSED)))
def test_what_is_refused(text):
    with pytest.raises(ModelError) as caught:
        parse(text)
    message = str(caught.value)
    assert len(message) < 300
    assert message.isprintable()
    message.encode()


@pytest.mark.parametrize("thing", [None, 1, 1.0, b"x", x, ["x"], {"x": 1}, object()])
def test_only_strings_are_read(thing):
    with pytest.raises(ModelError, match=f"not {type(thing).__name__}"):
        parse(thing)


def test_unknown_functions_are_named_with_the_nearest():
    with pytest.raises(ModelError, match=r"unknown function 'Sin'.*did you mean 'sin'"):
        parse("Sin(x)")
    with pytest.raises(ModelError, match=r"unknown function 'arctan'.*did you mean 'atan'"):
        parse("arctan(x)")
    with pytest.raises(ModelError, match=r"unknown function 'x'.*2\*x\(y\)"):
        parse("2*x(y)")


def test_names_are_case_sensitive():
    words = "unknown symbol 'X' in the equation of 'x'; did you mean 'x'"
    with pytest.raises(ModelError, match=words):
        model_from_strings("case", {"x": "-X"}, parameters={})
    model = model_from_strings("case", {"x": "-X"}, parameters={"X": 2.0})
    value = compile_model(model).core(np.array([1.0]), np.array([2.0]))
    assert value == -2.0


def test_names_of_functions_are_free():
    model = model_from_strings("names", {"sin": "exp*sin(sin)"}, parameters={"exp": 2.0})
    value = compile_model(model).core(np.array([0.5]), np.array([2.0]))
    assert value[0] == 2.0 * math.sin(0.5)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"parameters": {"k": "abc"}}, "'k' is 'abc', which is no number"),
        ({"parameters": {"k": None}}, "'k' is None, which is no number"),
        ({"parameters": {"k": float("nan")}}, "default of 'k' is nan"),
        ({"parameters": {"pi": 3.0}}, "'pi' is a constant"),
        ({"parameters": {1: 3.0}}, "1 cannot be a name"),
        ({"parameters": ["k"]}, "as a dict, not as list"),
        ({"equations": "x"}, "as a dict, not as str"),
        ({"equations": {"pi": "1"}}, "'pi' is a constant"),
        ({"equations": {}}, "no equations"),
        ({"guess": {"x": "here"}}, "'x' is 'here', which is no number"),
        ({"guess": {"y": 0.0}}, "guess for unknown state 'y'"),
        ({"elements": [("w", "x")]}, r"an element must be \(output, input, law\)"),
        ({"elements": ["wxs"]}, r"an element must be \(output, input, law\)"),
        ({"elements": [("pi", "x", "s")]}, "'pi' is a constant"),
        ({"elements": [("w", "x", "s**")]}, r"'s\*\*' is not an arithmetic expression"),
        ({"outputs": {"y": "x.real"}}, "x.real.*not allowed"),
    ],
)
def test_tables_are_checked(arguments, words):
    whole = {"equations": {"x": "-x"}, "parameters": {}} | arguments
    with pytest.raises(ModelError, match=words):
        model_from_strings("toy", whole.pop("equations"), **whole)


def test_brusselator_of_the_documentation():
    model = model_from_strings(
        "brusselator",
        {"x": "A-(B+1)*x+x**2*y", "y": "B*x-x**2*y"},
        parameters={"A": 1, "B": 1.5},
        guess={"x": 1, "y": 1.5},
        outputs={"product": "x*y"},
    )
    compiled = compile_model(model)
    p = np.array([1.0, 1.5])
    np.testing.assert_array_equal(compiled.core(np.array([1.0, 1.5]), p), 0.0)
    np.testing.assert_array_equal(
        compiled.core_jacobian(np.array([1.0, 1.5]), p), [[0.5, 1.0], [-1.5, -1.0]]
    )
    assert compiled.output_values(np.array([2.0, 3.0]), p) == {"product": 6.0}
