import json

import numpy as np
import pytest

from racs_bif import load
from racs_bif.cli import simulate as verb
from racs_bif.simulation.memory import METHODS
from racs_bif.simulation.realised import SOLVERS
from racs_bif.simulation.start import HISTORIES
from racs_bif.verbs.simulate import OPERATORS

RELAXATION = '''"""D^0.5 x = b - x."""

import sympy as sp

from racs_bif import FractionalElement, Model, Parameter


def model():
    x, b, s = sp.symbols("x b s")
    return Model(
        name="relax",
        equations={},
        parameters=(Parameter("b", 0.0),),
        elements=(FractionalElement("x", b - x, s ** -sp.Rational(1, 2)),),
        units={"x": "m"},
    )
'''


@pytest.fixture
def run(cli, tmp_path):
    path = tmp_path / "relax.py"
    path.write_text(RELAXATION)

    def run(*arguments):
        return cli("simulate", "--model", path, "--out", tmp_path / "out", *arguments)

    return run


def test_names_are_those_that_the_verb_knows():
    assert verb.OPERATORS == OPERATORS
    assert (*METHODS, *SOLVERS) == verb.METHODS
    assert verb.HISTORIES == HISTORIES


def test_the_exact_operator_and_its_files(run, tmp_path):
    told = run("--time", "1", "--initial", "x=1", "--step", "0.005", "--extrapolate", "--json")
    assert told.status == 0, told.err
    out = tmp_path / "out"
    assert sorted(p.name for p in out.iterdir()) == sorted(verb.FILES)
    history = load(out / "history.nc")
    assert history.column("x")[-1] == pytest.approx(0.4275835762, abs=1e-6)
    summary = json.loads(told.out)
    assert summary == json.loads((out / "summary.json").read_text(encoding="utf-8"))
    assert summary["simulation"]["step"] == 0.005
    assert summary["columns"]["x"]["last"] == history.column("x")[-1]
    assert (out / "history.png").read_bytes().startswith(b"\x89PNG")
    assert b"<svg" in (out / "history.svg").read_bytes()


def test_a_parameter_changes(run, tmp_path):
    told = run("--time", "2", "--change", "1", "b=1", "--change", "0", "b=0.5", "--step", "0.01")
    assert told.status == 0, told.err
    assert "exact operator by bdf2, step 0.01 s, history 'rest', 2 s" in told.out
    assert max(map(len, told.out.splitlines()[:-1])) <= 80
    history = load(tmp_path / "out" / "history.nc")
    assert np.unique(history.inputs["b"]).tolist() == [0.5, 1.0]


def test_the_vehicle_on_its_realisation(cli, tmp_path):
    told = cli(
        *("simulate", "--set", "u=12", "--time", "1", "--operator", "realised"),
        *("--initial", "delta_c=0.01", "--out", tmp_path, "--state", "delta_c", "F_d"),
    )
    assert told.status == 0, told.err
    assert "realised operator by lsoda, history 'rest', 1 s" in told.out
    assert "delta_c [rad]" in told.out


def test_what_ends_early_is_saved_with_status_one(run, tmp_path, monkeypatch):
    monkeypatch.setattr("racs_bif.simulation.runs._MOST", 512)
    told = run("--time", "1", "--initial", "x=1", "--tolerance", "1e-9")
    assert told.status == 1
    assert "ended early, saved what there is" in told.err
    assert load(tmp_path / "out" / "history.nc").early


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ((), "--time"),
        (("--time", "-1"), "the duration is -1 s"),
        (("--time", "1", "--step", "-0.1"), "the step is -0.1 s"),
        (("--time", "1", "--initial", "y=1"), "unknown state 'y'"),
        (("--time", "1", "--state", "y"), "unknown state 'y'"),
        (("--time", "1", "--operator", "exakt"), "did you mean 'exact'"),
        (("--time", "1", "--change", "x", "b=1"), "--change: 'x' is not a number"),
        (("--time", "1", "--change", "0.5", "b"), "--change: 'b' is not NAME=VALUE"),
        (("--time", "1", "--change", "0.5", "c=1"), "unknown parameter 'c'"),
    ],
)
def test_what_is_refused_in_one_line(run, tmp_path, arguments, text):
    told = run(*arguments)
    assert told.status == 2
    assert text in told.err
    assert told.err.count("\n") == 1
    assert not (tmp_path / "out").exists()
