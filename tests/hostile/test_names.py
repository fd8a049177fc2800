"""Names of states and parameters that mean something to Python, sympy, or the generated code."""

import keyword
import unicodedata

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.errors import ModelError, ParameterError

PYTHON = [w for w in keyword.kwlist if w not in {"and", "else", "for", "if", "in", "is", "not"}]
PYTHON = [w for w in PYTHON if w not in {"or", "True", "False", "None"}]
OTHERS = [
    *("E", "I", "S", "N", "O", "Q", "x0", "np", "f", "p", "c", "i3", "t1", "c0", "m", "_", "META"),
    *("make", "core", "where", "exp", "sin", "log", "max", "Symbol", "Integer", "beta", "gamma"),
    *("zeta", "print", "self", "value", "period", "index", "time", "label", "stable", "branch"),
    *("λ", "µ", "Δt", "ψ_1", "ϕ", "名", "match", "type", "call_", "exp_", "inf", "nan", "e1"),
]


@pytest.mark.parametrize("name", [*PYTHON, *OTHERS])
def test_as_a_parameter_and_as_a_state(name):
    model = rb.model_from_strings("names", {"q1": f"{name}*q1 - q1^3"}, parameters={name: -0.5})
    plain = unicodedata.normalize("NFKC", name)  # as Python spells names
    if plain != name:
        with pytest.raises(ParameterError, match=f"write its letters as in '{plain}'"):
            rb.continue_equilibria(model, name, (-1.0, 1.0))
    branch = rb.continue_equilibria(model, plain, (-1.0, 1.0))
    assert branch["BP1"].parameters[branch.parameters[0]] == pytest.approx(0.0, abs=1e-10)
    other = rb.model_from_strings("names", {name: f"k - {name}"}, parameters={"k": 0.5})
    branch = rb.continue_equilibria(other, "k", (-1.0, 1.0))
    np.testing.assert_allclose(branch.states[:, 0], branch.parameter, atol=1e-9)


@pytest.mark.parametrize("name", ["lambda", "λ", "period", "index", "stable", "E", "class"])
def test_results_with_such_names_are_saved_and_shown(name, tmp_path):
    state = "x" if name != "x" else "y"
    model = rb.model_from_strings(
        "names",
        {state: f"{name}*{state} - v - {state}^3", "v": f"{state} + {name}*v"},
        parameters={name: -0.5},
    )
    branch = rb.continue_equilibria(model, name, (-1.0, 1.0))
    rb.save(branch, tmp_path / "b.nc")
    again = rb.load(tmp_path / "b.nc")
    assert again["H1"].parameters == branch["H1"].parameters
    assert name in branch.to_dataframe().columns


def test_both_spellings_of_lambda():
    model = rb.model_from_strings(
        "names", {"x": "λ*x + lambda - x^3"}, parameters={"λ": -1.0, "lambda": 0.25}
    )
    branch = rb.continue_equilibria(model, "λ", (-1.0, -0.5))
    x, other = branch.states[:, 0], branch.parameter
    np.testing.assert_allclose(other * x + 0.25 - x**3, 0.0, atol=1e-9)


def test_two_spellings_of_one_name_are_refused():
    with pytest.raises(ModelError, match="given twice, in two spellings"):
        rb.model_from_strings("names", {"ϕ": "1", "φ": "2"}, parameters={})
    with pytest.raises(ModelError, match="used twice"):
        rb.model_from_strings("names", {"x": "-x"}, parameters={"ϕ": 1.0, "φ": 2.0})


@pytest.mark.parametrize(
    "name",
    ["if", "else", "None", "x y", "", "1x", "x-y", "x.y", "pi", "a·keyword\n", "__import__()"],
)
def test_names_that_cannot_be(name):
    with pytest.raises(ModelError, match=r"cannot be a name|is a constant"):
        rb.model_from_strings("names", {"x": "-x"}, parameters={name: 1.0})


def test_through_the_command_line(command, capsys):
    text = '[equations]\nclass = "lambda*class - class^3"\n[parameters]\nlambda = -0.5\n'
    assert command(text, "h.toml", parameter="lambda") == (0, "")
    from racs_bif.cli.main import main

    assert main(["models", "h.toml"]) == 0
    assert "class^3" in capsys.readouterr().out.replace("**", "^")
    assert main(["continue", "class", "0", "1", "--model", "h.toml"]) == 2
    assert "class" in capsys.readouterr().err


def test_names_of_python_functions():
    model = rb.model_from_function(
        "names", lambda state, p: [p["lambda"] - state[0]], states="x", parameters={"lambda": 1.0}
    )
    assert str(model.equations["x"]) == "lambda - x"
    model = rb.model_from_function("names", lambda S, E: E - S, states="S", parameters={"E": 1.0})
    assert str(model.equations["S"]) == "E - S"
