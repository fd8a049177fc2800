"""What verbs tell on the terminal when no JSON is asked for, and on one that is watched."""

import io
import os
import re
import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.cli.main import main

SPIRAL = '''"""A spiral, whose roots are a +- i w, and Hopf points where a = (k - 1)(k - 3)."""

import racs_bif as rb


def model():
    rates = {"x": "(a + (k - 1)*(k - 3))*x - w*y", "y": "w*x + (a + (k - 1)*(k - 3))*y"}
    numbers = {"a": -0.25, "w": 3.0, "k": 3.0, "zero": 0.0}
    return rb.model_from_strings("spiral", rates, parameters=numbers)
'''


@pytest.fixture
def spiral(tmp_path):
    path = tmp_path / "spiral.py"
    path.write_text(SPIRAL, encoding="utf-8")
    return path


@pytest.fixture
def watch(monkeypatch):
    """Make stderr a terminal, from the test itself: capsys puts its own back after fixtures."""

    class Screen(io.StringIO):
        def isatty(self):
            return True

    def begin():
        screen = Screen()
        monkeypatch.setattr(sys, "stderr", screen)
        monkeypatch.setenv("TERM", "xterm")
        return screen

    return begin


@pytest.fixture
def unpainted(monkeypatch):
    """Leave pictures empty: to draw them would take most of the time."""
    monkeypatch.setattr("racs_bif.plots.style.save_picture", lambda _, path: path.write_bytes(b""))


@pytest.mark.usefixtures("unpainted")
def test_roots_in_a_table(cli, spiral, tmp_path):
    told = cli("spectrum", "--model", spiral, "--out", tmp_path / "out")
    assert (told.status, told.err) == (0, "")
    assert not told.out.startswith("{")
    assert "Exact roots with Re s > -1" in told.out
    assert re.search(r"-0\.25 +3 +0\.47746", told.out)
    assert "The equilibrium is stable. The argument principle counts 2" in told.out


@pytest.mark.usefixtures("unpainted")
def test_no_root_right_of_the_line(cli, spiral, tmp_path):
    told = cli("spectrum", "--model", spiral, "--above", "0", "--out", tmp_path / "out")
    assert told.status == 0
    assert "No root with Re s > 0." in told.out
    assert "Exact roots" not in told.out


@pytest.mark.usefixtures("unpainted")
def test_roots_on_the_branch_cut_and_at_zero_are_told(cli, spiral, tmp_path, monkeypatch):
    from racs_bif.verbs import spectrum

    plain = spectrum.spectrum

    def with_cut(system, **options):
        found = plain(system, **options)
        cut = replace(found.roots, on_cut=np.array([-0.5, -0.75]), zero_order=0.5)
        return replace(found, roots=cut)

    monkeypatch.setattr(spectrum, "spectrum", with_cut)
    told = cli("spectrum", "--model", spiral, "--out", tmp_path / "out")
    assert "On both lips of the branch cut, so on no sheet: -0.5, -0.75" in told.out
    assert "s = 0 is a root: det Delta vanishes like s**0.5." in told.out


def test_a_calibrated_value_in_words(cli, spiral):
    told = cli("calibrate", "k", "--hopf", "a=0", "--model", spiral, "--span", "2", "5")
    assert told.status == 0, told.err
    value = float(re.match(r"k = (\S+)", told.out)[1])
    assert value == pytest.approx(3.0, abs=1e-9)


def test_several_values_are_told_and_none_is_taken(cli, spiral):
    told = cli("calibrate", "k", "--hopf", "a=0", "--model", spiral, "--span", "0.5", "5")
    assert told.status == 2
    assert re.search("'k' has 2 such values, (1, 3|3, 1); narrow --span to one", told.err)


def test_a_parameter_that_is_zero_needs_a_span(cli, spiral):
    told = cli("calibrate", "zero", "--hopf", "a=0", "--model", spiral)
    assert told.status == 2
    assert "'zero' is 0, which gives no interval to search; give --span LOW HIGH" in told.err


def test_a_watched_calibration_shows_that_it_goes_on(spiral, watch, capsys):
    watched = watch()
    words = ["calibrate", "k", "--hopf", "a=0", "--model", str(spiral), "--span", "2", "5"]
    assert main(words) == 0
    assert "calibrating k" in watched.getvalue()
    assert capsys.readouterr().out.startswith("k = ")


@pytest.mark.usefixtures("unpainted")
def test_realisations_without_a_hopf_point(cli, tmp_path, monkeypatch):
    from racs_bif.fractional.realisations import REALISATIONS

    for name in set(REALISATIONS) - {"diffusive", "matsuda"}:
        monkeypatch.delitem(REALISATIONS, name)
    out = tmp_path / "out"
    told = cli("realisations", "--model", "bagley_torvik", "--out", out)
    assert told.status == 0, told.err
    assert told.out.startswith("Realisations of bagley_torvik\n")
    assert "exact Hopf point" not in told.out
    assert re.findall(r"^(\w+) +\d+ ", told.out, re.MULTILINE) == ["diffusive", "matsuda"]
    assert {"realisations.png", "summary.json"} <= {path.name for path in out.iterdir()}


def test_analyses_are_listed_with_their_titles(cli):
    told = cli("analyses")
    assert told.status == 0
    assert not told.out.startswith("{")
    assert "claims" in told.out


def test_a_watched_analysis_shows_its_progress(tmp_path, watch, capsys):
    watched = watch()
    path = tmp_path / "counting.py"
    path.write_text(
        "def run(out, progress, steps=4):\n"
        "    for k in range(steps):\n"
        "        progress((k + 1) / steps)\n"
        "    return f'{steps} steps'\n",
        encoding="utf-8",
    )
    assert main(["run", str(path), "--out", str(tmp_path / "out")]) == 0
    assert "counting" in watched.getvalue()
    assert "100%" in watched.getvalue()
    assert capsys.readouterr().out == "Wrote 4 steps\n"


def test_what_an_analysis_refuses_is_told_as_it_says(cli, tmp_path):
    path = tmp_path / "refusing.py"
    path.write_text(
        "from racs_bif.errors import ConvergenceError\n\n\n"
        "def run(out):\n    raise ConvergenceError('no branch today')\n",
        encoding="utf-8",
    )
    told = cli("run", path, "--out", tmp_path / "out")
    assert told.status == 1
    assert told.err.strip().endswith("no branch today")
    assert "refusing.py" not in told.err


def test_a_traceback_of_what_is_refused_where_more_is_wanted(cli, spiral):
    words = ("calibrate", "zero", "--hopf", "a=0", "--model", spiral)
    assert "Traceback" not in cli(*words).err
    told = cli(*words, "--verbose")
    assert told.status == 2
    assert "Traceback" in told.err
    assert "UsageError" in told.err


def test_a_reader_that_went_away_ends_it_quietly(monkeypatch, tmp_path):
    kept = os.open(tmp_path / "pipe", os.O_WRONLY | os.O_CREAT)

    class Gone(io.StringIO):
        def write(self, text):
            raise BrokenPipeError

        def fileno(self):
            return kept

    monkeypatch.setattr(sys, "stdout", Gone())
    try:
        assert main(["models", "--json"]) == 1
        os.write(kept, b"lost")
    finally:
        os.close(kept)
    assert (tmp_path / "pipe").read_bytes() == b""


def test_a_named_branch_of_orbits_is_drawn(cli, known, tmp_path):
    first = known.orbits()
    points = [replace(point, branch="PO2") for point in first.special]
    second = replace(first, name="PO2", special=points)
    file = rb.save(rb.Diagram(known.equilibria(), first, second), tmp_path / "branches.nc")
    told = cli("plot", file, "--branch", "PO2", "--to", tmp_path / "two.png")
    assert told.status == 0, told.err
    assert (tmp_path / "two.png").read_bytes().startswith(b"\x89PNG")
    told = cli("plot", file, "--branch", "PO3", "--to", tmp_path / "three.png")
    assert told.status == 2
    assert "has no branch of orbits 'PO3'" in told.err


ISLAND = '''"""x'' + (a**2 + b**2 - 1) x' + x = 0: unstable within a circle."""

import racs_bif as rb


def model():
    rates = {"x": "v", "v": "-x - (a**2 + b**2 - 1)*v"}
    return rb.model_from_strings("island", rates, parameters={"a": 0.5, "b": 0.0})
'''
BOX = ("--span", "a", "-2", "2", "--span", "b", "-2", "2.1", "--depth", "2")


@pytest.fixture
def island(tmp_path):
    path = tmp_path / "island.py"
    path.write_text(ISLAND, encoding="utf-8")
    return path


@pytest.mark.usefixtures("unpainted")
def test_a_watched_chart_shows_what_it_does(island, tmp_path, watch, capsys):
    out = tmp_path / "out"
    watched = watch()
    words = ["chart", "a", "b", "--model", str(island), *BOX, "--out", str(out)]
    assert main([*words, "--map", "damping", "--cells", "4", "3"]) == 0
    shown = watched.getvalue()
    assert "searching" in shown
    assert re.search(r"\w+: \d+ of \d+", shown)
    assert (out / "chart.nc").stat().st_size > 0


def test_an_interrupted_chart_without_tiles_has_nothing_to_go_on_from(
    cli, island, tmp_path, monkeypatch
):
    from racs_bif.verbs import chart

    def interrupted(*_args, **_options):
        raise KeyboardInterrupt

    monkeypatch.setattr(chart, "stability_chart", interrupted)
    words = ("chart", "a", "b", "--model", island, *BOX, "--out", tmp_path / "out")
    told = cli(*words)
    assert told.status == 1
    assert "interrupted before there was anything to save" in told.err
    assert "--resume" not in told.err


def test_tiles_are_forgotten_and_what_is_not_theirs_is_kept(tmp_path):
    from racs_bif.cli.chart import _forget

    tiles = tmp_path / "tiles"
    (tiles / "w_1").mkdir(parents=True)
    (tiles / "w_2").mkdir()
    for name in ("map.json", "w_1/tile_0.npz", "w_1/.tile_1.npz.part", "w_2/notes.txt"):
        (tiles / name).write_text("", encoding="utf-8")
    _forget(tiles)
    left = sorted(path.relative_to(tiles).as_posix() for path in tiles.rglob("*"))
    assert left == ["w_2", "w_2/notes.txt"]
    (tiles / "w_2" / "notes.txt").unlink()
    _forget(tiles)
    assert not tiles.exists()


@pytest.mark.usefixtures("unpainted")
def test_a_watched_simulation_shows_each_run(spiral, tmp_path, watch, capsys):
    watched = watch()
    words = ["simulate", "--model", str(spiral), "--initial", "x=0.1", "--time", "2"]
    assert main([*words, "--out", str(tmp_path / "out")]) == 0, watched.getvalue()
    assert "run 1" in watched.getvalue()


def test_an_orbit_in_words(known, tmp_path, capsys):
    from racs_bif.cli.orbit import _tell

    orbit = known.orbits()
    count = len(orbit)
    slow = np.linspace(0.99, 0.5, 30)
    spectrum = np.column_stack([np.ones(count), *np.tile(slow, (count, 1)).T])
    point = replace(orbit.special[-1], data={"period": 0.75})
    profile = replace(orbit.profiles["NS1"], names=("delta_c",), states=np.ones((7, 1)))
    orbit = replace(orbit, spectrum=spectrum, special=(point,), profiles={point.name: profile})
    arguments = SimpleNamespace(json=False, quiet=False, out=tmp_path)
    _tell(orbit, arguments, "{}")
    told = " ".join(capsys.readouterr().out.split())
    assert "Orbit at u = 21 by shooting: period 0.75 s" in told
    assert "Note: the sign in print is inconsistent" in told
    assert "smaller ones" in told
    assert "belong to the realisation's memory, not to the model." in told
    ordinary = replace(orbit, system=replace(orbit.system, realisation=None, notes=()))
    _tell(ordinary, arguments, "{}")
    told = capsys.readouterr().out
    assert "memory" not in told
    assert "Note" not in told


def test_a_quantity_that_a_branch_does_not_hold_is_left_open(known):
    from rich.console import Console

    from racs_bif.cli.tables import operating_table

    branch = known.equilibria()
    system = replace(branch.system, shown="F_d")

    def told(branch):
        screen = Console(file=io.StringIO(), width=120)
        screen.print(operating_table(rb.Diagram(branch)))
        return screen.file.getvalue()

    assert re.search(r"UZ1 +EQ1 +12 +-0\.012", told(branch))
    row = told(replace(branch, system=system)).splitlines()[-1]
    assert re.search(r"UZ1 +EQ1 +12 ", row)
    assert "-0.012" not in row
