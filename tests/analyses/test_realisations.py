"""The table of realisations over random vehicles, few of them."""

from __future__ import annotations

import json

import pytest

from racs_bif.cli.main import main
from racs_bif.shelf import find, load_module


def test_the_fitted_realisation_is_exact_and_the_others_are_not(tmp_path):
    analysis = load_module(find("analyses", "realisations"))
    rows = {row.name: row for row in analysis.table(3, seed=2)}
    assert rows["fitted"].states == 8
    assert rows["fitted"].worst < 1e-9
    assert 1e-6 < rows["diffusive"].worst < 1e-2
    assert rows["oustaloup"].worst > rows["diffusive"].worst
    assert rows["nonnegative"].refused > 0


def test_it_runs_from_the_command_line(tmp_path, capsys):
    arguments = ["run", "realisations", "--set", "vehicles=1", "--out", str(tmp_path)]
    assert main(arguments) == 0
    assert "Wrote" in capsys.readouterr().out
    assert "| fitted | 8 |" in (tmp_path / "realisations.md").read_text(encoding="utf-8")


def test_analyses_are_listed(capsys):
    assert main(["analyses", "--json"]) == 0
    assert "realisations" in json.loads(capsys.readouterr().out)["analyses"]


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (["run", "realisation"], "did you mean 'realisations'"),
        (["run", "realisations", "--set", "vehicle=2"], "did you mean 'vehicles'"),
        (["run", "realisations", "--set", "vehicles=2.5"], "whole number"),
    ],
)
def test_what_cannot_be_run(arguments, text, tmp_path, capsys):
    assert main([*arguments, "--out", str(tmp_path / "out")]) == 2
    assert text in capsys.readouterr().err
