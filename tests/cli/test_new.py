"""A template that runs at once, by the command that is printed."""

import json
import shlex

import pytest

from racs_bif.cli.main import main

KINDS = {
    "python": ((), "mine.py", 0.0),
    "toml": (("--toml",), "mine.toml", 0.0),
    "fractional": (("--fractional",), "mine.py", 0.3259981216),
    "fractional-toml": (("--toml", "--fractional"), "mine.toml", 0.3259981216),
}


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("kind", KINDS)
def test_the_printed_command_runs_and_finds_what_the_file_says(kind, here, capsys):
    options, name, hopf = KINDS[kind]
    assert main(["new", "mine", *options]) == 0
    said = capsys.readouterr().out
    assert f"Wrote {name}" in said
    program, *words = shlex.split(said.partition("Run it: ")[2])
    assert program == "racs-bif"
    text = (here / name).read_text()
    assert shlex.join(["racs-bif", *words]) in text
    assert max(map(len, text.splitlines())) <= 100
    assert "elements" in text
    # Equilibria only: the orbits are another test's, and take seconds.
    assert main([*words, "--orbits", "none", "--quiet", "--json"]) == 0
    summary = json.loads(capsys.readouterr().out)
    (point,) = summary["special_points"]
    value = (point.get("exact") or point)["parameters"]["mu"]
    assert value == pytest.approx(hopf, abs=1e-9)


def test_nothing_is_overwritten(here, capsys):
    (here / "mine.py").write_text("precious")
    assert main(["new", "mine"]) == 2
    assert "mine.py is there already and is not overwritten" in capsys.readouterr().err
    assert (here / "mine.py").read_text() == "precious"
    assert main(["new", "mine", "--toml"]) == 0


def test_a_name_with_its_ending_and_a_folder(here, capsys):
    (here / "sub dir").mkdir()
    assert main(["new", "one.toml", "--out", "sub dir", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["file"].endswith("one.toml")
    assert (here / "sub dir" / "one.toml").is_file()
    assert main(["new", "sub dir/two.py"]) == 0
    assert "--model 'sub dir/two.py'" in capsys.readouterr().out


@pytest.mark.parametrize("name", ["1x", "a b", "a-b", "x.txt", "..", "", "__import__('os')"])
def test_names_that_cannot_be(name, here, capsys):
    assert main(["new", name]) == 2
    assert "cannot be a model's name" in capsys.readouterr().err
    assert list(here.iterdir()) == []


def test_a_folder_that_is_not_there(here, capsys):
    assert main(["new", "mine", "--out", "nowhere"]) == 2
    assert "cannot be written: No such file or directory" in capsys.readouterr().err
