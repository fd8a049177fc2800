"""Models from TOML files: every table, and a reason for everything that is refused."""

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.errors import ModelError, UsageError
from racs_bif.shelf.load import load_model
from racs_bif.shelf.tables import model_from_toml
from racs_bif.symbolic.compiled import compile_model

WHOLE = """
name = "oscillator"
title = "An oscillator"
source = "nowhere"
notes = ["one", "two"]
inputs = ["F"]
band = [0.01, 10]
mass = [["m", 0], ["0", 1.0]]

[equations]
v = "F - c*v - k*x - damping*w"
x = "v"

[parameters]
m = 2
c = 0.5
k = { default = 4.0, unit = "N/m", description = "stiffness", source = "p. 1", valid = [0, inf] }
F = 0.0
damping = 0.1
q = { default = 0.5, valid = [0, 1] }

[guess]
x = 0.25

[elements.w]
input = "x"
law = "s^q"

[terms]
kinetic = "m*v^2/2"

[outputs]
energy = "kinetic + k*x^2/2"

[derived.omega_squared]
expression = "k/m"
sets = "k"
unit = "1/s^2"

[units]
x = "m"

[descriptions]
x = "where it is"
"""


@pytest.fixture
def write(tmp_path):
    def put(text, name="model.toml"):
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return path

    return put


def test_every_table(write):
    model = model_from_toml(write(WHOLE))
    assert (model.name, model.title, model.source) == ("oscillator", "An oscillator", "nowhere")
    assert model.notes == ("one", "two")
    assert model.band == (0.01, 10.0)
    assert model.states == ("v", "x")
    k = next(p for p in model.parameters if p.name == "k")
    assert (k.default, k.unit, k.description, k.source) == (4.0, "N/m", "stiffness", "p. 1")
    assert k.valid == (0.0, float("inf"))
    assert model.guess == {"x": 0.25}
    assert model.inputs == ("F",)
    assert dict(model.units) == {"x": "m"}
    assert dict(model.descriptions) == {"x": "where it is"}
    compiled = compile_model(model)
    p = np.array([x.default for x in model.parameters])
    X, P = np.array([0.5, 0.25, 0.3]), np.append(p, 2.0)  # v, x, memory; feedthrough D = 2
    force = -0.5 * 0.5 - 4 * 0.25 - 0.1 * (0.3 + 2.0 * 0.25)
    np.testing.assert_allclose(compiled.core(X, P), [force / 2, 0.5, 0.25], rtol=1e-15)
    assert compiled.output_values(X, P)["energy"] == pytest.approx(0.25 + 0.125, rel=1e-15)
    assert compiled.derived_values(p) == [2.0]


def test_elements_may_be_a_list(write):
    text = WHOLE.replace("[elements.w]", '[[elements]]\noutput = "w"')
    assert model_from_toml(write(text)).elements == model_from_toml(write(WHOLE)).elements


def test_the_smallest_file_takes_its_name_from_the_file(write):
    path = write('[equations]\nx = "-x"\nn = 0\n', "decay.toml")
    model = rb.model_from_toml(path)
    assert (model.name, model.title) == ("decay", "decay")
    assert load_model(str(path)).name == "decay"
    again = write('[equations]\nx = "-x"\nn = 0\n', "other.toml")
    assert load_model(str(again)).name == "other"  # the cache tells the two apart


def test_load_model_reads_it_and_knows_it_again(write):
    path = write(WHOLE)
    system = load_model(str(path), parameters={"omega_squared": 3.0})
    assert system.parameters["k"] == 6.0
    assert system.loaded == str(path)
    path.write_text(WHOLE.replace("c = 0.5", "c = 0.75"), encoding="utf-8")
    assert load_model(str(path)).parameters["c"] == 0.75
    with pytest.raises(UsageError, match="has no variants"):
        load_model(str(path), variant="soft")


REFUSED = {
    "an unknown key": ("equation.x = '-x'", "unknown key 'equation'; did you mean 'equations'"),
    "no equations": ("[parameters]\na = 1", r"no table \[equations\]"),
    "equations that are none": ("equations = 3", "'equations' is a number; make it a table"),
    "no state": ("[equations]", "no equations"),
    "an unknown symbol": ("[equations]\nx = 'a*x'", "unknown symbol 'a'"),
    "an equation that is true": ("[equations]\nx = true", "'equations.x' is true or false"),
    "a date": ("[equations]\nx = 2020-01-01", "'equations.x' is a date; put it in quotes"),
    "a parameter without default": (
        "[equations]\nx = '-x'\n[parameters]\na = {unit = 'm'}",
        "'parameters.a' has no default",
    ),
    "an unknown key of a parameter": (
        "[equations]\nx = '-x'\n[parameters]\na = {default = 1, units = 'm'}",
        r"unknown key in \[parameters.a\]: 'units'; did you mean 'unit'",
    ),
    "a parameter that is text": (
        "[equations]\nx = '-x'\n[parameters]\na = '1'",
        "'parameters.a' is a text; give a number",
    ),
    "a parameter that is no number": (
        "[equations]\nx = '-x'\n[parameters]\na = nan",
        "default of 'a' is nan",
    ),
    "a parameter too large": (
        f"[equations]\nx = '-x'\n[parameters]\na = 1{'0' * 400}",
        "which is no number",
    ),
    "an interval the wrong way": (
        "[equations]\nx = '-x'\n[parameters]\na = {default = 1, valid = [2, 1]}",
        "'parameters.a.valid' is 2 to 1; give LOW below HIGH",
    ),
    "an element without law": (
        "[equations]\nx = '-w'\n[elements.w]\ninput = 'x'",
        r"\[elements.w\] has no 'law'",
    ),
    "an element with more": (
        "[equations]\nx = '-w'\n[elements.w]\ninput = 'x'\nlaw = 's'\norder = 1",
        r"unknown key in \[elements.w\]: 'order'",
    ),
    "a derived parameter that sets nothing": (
        "[equations]\nx = '-x'\n[derived.b]\nexpression = '1'",
        r"\[derived.b\] has no 'sets'",
    ),
    "a mass of another shape": (
        "mass = [[1, 0]]\n[equations]\nx = '-x'",
        "'mass' is no square matrix",
    ),
    "notes that are one": ("notes = 'x'\n[equations]\nx = '-x'", "make it a list of texts"),
    "a name that is none": ("name = ''\n[equations]\nx = '-x'", "the name is ''"),
    "a band of three": ("band = [1, 2, 3]\n[equations]\nx = '-x'", "give two numbers"),
    "a guess for nothing": ("[equations]\nx = '-x'\n[guess]\ny = 1", "guess for unknown state 'y'"),
    "a constant as a name": ("[equations]\npi = '-x'", "'pi' is a constant"),
    "the same name in two spellings": (
        "[equations]\n'\u00b5' = '1'\n'\u03bc' = '2'",
        "given twice",
    ),
    "no TOML": ("[equations\nx = 1", r"is no TOML .*line 1"),
    "a key twice": ("[equations]\nx = '1'\nx = '2'", "is no TOML .*overwrite"),
    "nested too deeply": ("a = " + "[" * 3000 + "]" * 3000, "nested too deeply|no TOML"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refused(case, write):
    text, words = REFUSED[case]
    with pytest.raises(ModelError, match=words) as caught:
        model_from_toml(write(text))
    message = str(caught.value)
    assert "model.toml" in message
    assert "\n" not in message


def test_files_that_cannot_be_read(tmp_path, write):
    with pytest.raises(ModelError, match=r"nothing\.toml cannot be read \(No such file"):
        model_from_toml(tmp_path / "nothing.toml")
    with pytest.raises(UsageError, match="there is no file"):
        load_model(str(tmp_path / "nothing.toml"))
    with pytest.raises(ModelError, match="cannot be read"):
        model_from_toml(tmp_path)
    (tmp_path / "latin.toml").write_bytes(b"name = '\xe4'")
    with pytest.raises(ModelError, match="no text in UTF-8"):
        model_from_toml(tmp_path / "latin.toml")
    path = write("#" * 6_000_000, "large.toml")
    with pytest.raises(ModelError, match="larger than 5 MB"):
        model_from_toml(path)
