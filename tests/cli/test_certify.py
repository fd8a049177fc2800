"""``racs-bif certify`` on files that were really computed."""

import json
import subprocess
import sys
from dataclasses import replace

import pytest

import racs_bif as rb


@pytest.fixture
def saved(normal_form, tmp_path):
    """The file of a diagram of the normal form, kept by its path."""
    branch = rb.continue_equilibria(rb.load_model(str(normal_form)), "mu", (-1, 1))
    return rb.save(rb.Diagram(branch), tmp_path / "branches.nc")


def test_a_diagram_of_continue_is_certified_to_a_proof(cli, normal_form, tmp_path):
    cli("continue", "mu", "-0.1", "0.1", "--model", normal_form, "--out", tmp_path, "--quiet")
    saved = tmp_path / "branches.nc"
    told = cli("certify", saved, "--proof", "--json")
    assert told.status == 0, told.err
    found = json.loads(told.out)
    assert (found["model"], found["strength"], found["holds"]) == ("hopf", "proof", True)
    (proof,) = [c for c in found["checks"] if c["strength"] == "proof"]
    assert proof["subject"] == "H1"
    assert proof["box"]["mu"]["lower"] <= 0.0 <= proof["box"]["mu"]["upper"]
    assert proof["box"]["omega"]["lower"] <= 1.0 <= proof["box"]["omega"]["upper"]
    assert "PO1" in found["notes"][0]
    assert "All 4 checks hold" in told.err


def test_the_table_fits_the_terminal(cli, saved):
    told = cli("certify", saved)
    assert told.status == 0
    assert "complete  holds" in told.out
    assert "proof" not in told.out
    assert "All 3 checks hold." in told.out
    assert max(map(len, told.out.splitlines())) <= 80
    assert cli("certify", saved, "--quiet").out == ""


def test_a_failure_is_named_and_the_status_is_1(cli, saved):
    branch = rb.load(saved)["EQ1"]
    missing = replace(branch, special=(), labels=("",) * len(branch))
    rb.save(missing, saved)
    told = cli("certify", saved)
    assert told.status == 1
    assert "FAILS" in told.out
    assert "not certified, EQ1 (complete): " in told.err
    assert "where no special point is reported" in told.err


def test_a_narrow_tolerance_is_kept(cli, tmp_path):
    branch = rb.continue_equilibria(rb.load_model("racs"), "u", (9, 12))
    path = rb.save(branch, tmp_path / "eq.nc")
    told = cli("certify", path, "--tolerance", "1e-6")
    assert told.status == 1
    assert "not certified, H1 (newton): " in told.err


def test_a_model_that_has_moved_may_be_given(cli, saved, normal_form, tmp_path):
    moved = tmp_path / "moved.py"
    normal_form.rename(moved)
    told = cli("certify", saved)
    assert told.status == 2
    assert "there is no file" in told.err
    assert cli("certify", saved, "--model", moved).status == 0


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("nowhere.nc",), "there is no file 'nowhere.nc'"),
        ((), "FILE"),
        (("a.nc", "--prof"), "did you mean '--proof'"),
        (("a.nc", "--tolerance", "x"), "'x' is not a number"),
    ],
)
def test_wrong_usage_is_one_line_and_status_2(cli, arguments, words):
    told = cli("certify", *arguments)
    assert told.status == 2
    assert words in told.err
    assert len(told.err.splitlines()) == 1


def test_without_python_flint_one_line_names_the_extra(cli, saved, monkeypatch):
    monkeypatch.setitem(sys.modules, "flint", None)
    assert cli("certify", saved).status == 0
    told = cli("certify", saved, "--proof")
    assert told.status == 2
    assert told.err == (
        "racs-bif: proofs need the package python-flint: pip install 'racs-bif[proof]'\n"
    )


def test_another_process_certifies_what_this_one_saved(tmp_path):
    path = rb.save(rb.continue_equilibria(rb.load_model("racs"), "u", (9, 12)), tmp_path / "eq.nc")
    command = [sys.executable, "-m", "racs_bif", "certify", str(path), "--proof", "--json"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    (proof,) = [c for c in json.loads(done.stdout)["checks"] if c["strength"] == "proof"]
    assert proof["interval"][0] < 10.2 < proof["interval"][1]
