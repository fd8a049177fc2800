"""``racs-bif chart`` on a model that is known in closed form."""

import json
import math
import signal
import subprocess
import sys
import time
from contextlib import suppress

import pytest

from racs_bif import load
from racs_bif.cli.chart import FILES
from racs_bif.results import files

ISLAND = '''"""x'' + (a**2 + b**2 - r**2) x' + x = 0: unstable within a circle of radius r."""

import sympy as sp

from racs_bif import Model, Parameter


def model():
    x, v, a, b, r = sp.symbols("x v a b r")
    return Model(
        name="island",
        title="an oscillator with an island of instability",
        equations={"x": v, "v": -x - (a**2 + b**2 - r**2) * v},
        parameters=(
            Parameter("a", 0.5, unit="m", description="one"),
            Parameter("b", 0.0, unit="kg", description="other", valid=(-5.0, 5.0)),
            Parameter("r", 1.0, unit="1", description="radius"),
        ),
        guess={"x": 0.0, "v": 0.0},
        notes=("this is no vehicle",),
    )
'''
BOX = ("--span", "a", "-2", "2", "--span", "b", "-2", "2.1", "--depth", "4")


@pytest.fixture
def model(tmp_path):
    path = tmp_path / "island.py"
    path.write_text(ISLAND)
    return path


@pytest.fixture
def chart(cli, model, tmp_path):
    def run(*arguments, names=("a", "b"), out="out"):
        return cli("chart", *names, *arguments, "--model", model, "--out", tmp_path / out)

    return run


def test_the_files_and_what_the_summary_says(chart, tmp_path):
    told = chart(*BOX, "--mark", "a=0.6", "--l1", "--json")
    assert (told.status, told.err.count("racs-bif:")) == (0, 0)
    out = tmp_path / "out"
    assert sorted(p.name for p in out.iterdir()) == sorted(FILES)
    summary = json.loads(told.out)
    assert summary == json.loads((out / "summary.json").read_text(encoding="utf-8"))
    assert (summary["schema"], summary["model"], summary["plane"]) == (1, "island", ["a", "b"])
    (boundary,) = summary["boundaries"]
    assert (boundary["kind"], boundary["closed"]) == ("hopf", True)
    for point in boundary["points"]:
        assert math.hypot(*point["parameters"].values()) == pytest.approx(1.0, abs=1e-12)
        assert point["omega"] == pytest.approx(1.0, abs=1e-12)
    marked = sorted(p["parameters"]["b"] for p in boundary["special_points"])
    assert marked == pytest.approx([-0.8, 0.8], abs=1e-10)
    assert [region["unstable"] for region in summary["regions"]] == [0, 2]
    area = sum(region["area"] for region in summary["regions"])
    assert area == pytest.approx(1.0)
    cost = summary["cost"]
    assert cost["grid"]["evaluations"] > 50 * cost["evaluations"] > 0
    assert load(out / "chart.nc").boundaries[0].closed
    assert (out / "chart.png").read_bytes().startswith(b"\x89PNG")
    assert b"<svg" in (out / "chart.svg").read_bytes()


def test_what_is_told_fits_80_columns(chart):
    text = chart(*BOX).out
    lines = [line for line in text.splitlines() if not line.startswith("Wrote")]
    assert max(map(len, lines)) <= 80
    for words in ("1 hopf", "closed", "2 unstable", "stable", "characteristic evaluations"):
        assert words in text
    assert "Note: this is no vehicle" in text


def test_slices(chart, tmp_path):
    told = chart(*BOX, "--slices", "r=0.5,1.5", "--json", "--quiet")
    summary = json.loads(told.out)
    radii = [one["parameters"]["r"] for one in summary["slices"]]
    assert radii == [0.5, 1.5]
    for radius, one in zip(radii, summary["slices"], strict=True):
        point = one["boundaries"][0]["points"][0]["parameters"]
        assert math.hypot(*point.values()) == pytest.approx(radius, abs=1e-12)
    assert len(load(tmp_path / "out" / "chart.nc")) == 2


def test_a_map_leaves_no_tiles(chart, tmp_path):
    told = chart(*BOX, "--map", "damping", "--cells", "20", "10", "--json")
    assert told.status == 0
    assert json.loads(told.out)["map"]["cells"] == [20, 10]
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == sorted(FILES)


def test_a_run_that_was_killed_goes_on_and_gives_the_same_file(chart, model, tmp_path):
    options = (*BOX, "--map", "damping", "--cells", "256", "256")
    tiles = tmp_path / "killed" / "tiles"

    def finished():
        with suppress(FileNotFoundError):  # the folder may come or go while it is looked into
            return list(tiles.glob("tile_*.npz"))
        return []

    command = [sys.executable, "-m", "racs_bif", "chart", "a", "b", *options]
    command += ["--model", str(model), "--out", str(tmp_path / "killed"), "--quiet"]
    with subprocess.Popen(command) as running:
        while len(finished()) < 2:
            assert running.poll() is None, "it ended before it could be killed"
            time.sleep(0.002)
        running.send_signal(signal.SIGKILL)
    assert 2 <= len(finished()) < 16
    assert not (tmp_path / "killed" / "chart.nc").exists()

    assert chart(*options, "--resume", out="killed").status == 0
    assert chart(*options, out="whole").status == 0
    again, whole = (load(tmp_path / name / "chart.nc") for name in ("killed", "whole"))
    assert again == whole  # every bit of its data
    nodes = [files.encode_charts(one) for one in (again, whole)]
    assert files.fingerprint(nodes[0]) == files.fingerprint(nodes[1])
    assert not tiles.exists()


def test_ctrl_c_says_how_to_go_on(chart, monkeypatch, tmp_path):
    from racs_bif.charts import backends

    compute, done = backends.compute, []

    def interrupted(job, index):
        if done:
            raise KeyboardInterrupt
        done.append(index)
        return compute(job, index)

    monkeypatch.setattr(backends, "compute", interrupted)
    told = chart(*BOX, "--map", "count", "--cells", "70", "20")
    assert told.status == 1
    assert "--resume goes on" in told.err
    monkeypatch.undo()
    assert chart(*BOX, "--map", "count", "--cells", "70", "20", "--resume").status == 0


def test_a_map_by_simulation_says_what_is_known(chart, tmp_path):
    options = (*BOX, "--map", "amplitude", "--cells", "4", "3", "--duration", "30")
    told = chart(*options, "--start", "x=0.1", "--start", "v=0", "--watch", "v", "--json")
    assert told.status == 0
    found = json.loads(told.out)["map"]
    assert found["quantity"] == "amplitude"
    assert (found["watch"], found["duration"]) == ("v", 30.0)
    assert found["start"] == {"x": 0.1, "v": 0.0}
    assert sum(found["status"].values()) == 12
    assert found["unknown"] == 12 - found["status"]["certain"]
    assert found["status"]["failed"] + found["status"]["not settled"] > 0
    assert load(tmp_path / "out" / "chart.nc").map.sweep.status.shape == (4, 3)
    assert "Map of amplitude of x, 4 x 3 cells, 30 s each" in chart(*options).out


def test_the_realised_operator_and_a_curve_over_it(cli, model, chart, tmp_path):
    span = ("--span", "a", "0.1", "2", "--span", "b", "-0.6", "0.6")
    curve = ("curve", "hopf", "a", "b", "--model", model, "--out", tmp_path / "curve")
    assert cli(*curve, *span).status == 0
    saved = tmp_path / "curve" / "branches.nc"
    told = chart(*BOX, "--operator", "realised", "--curve", saved, "--json")
    assert told.status == 0
    summary = json.loads(told.out)
    assert summary["operator"] == "realised"
    assert summary["search"]["depth"] == 4
    assert summary["search"]["smallest_island"] == pytest.approx(0.5, abs=1e-3)
    (over,) = summary["curves"]
    for point in over["points"]:
        assert math.hypot(*point["parameters"].values()) == pytest.approx(1.0, abs=1e-6)
    wrong = chart(*BOX, "--curve", tmp_path / "out" / "chart.nc", out="other")
    assert wrong.status == 2
    assert "holds no curve in a and b" in wrong.err


@pytest.mark.parametrize(
    ("names", "arguments", "message"),
    [
        (("a", "a"), (), "two different parameters, not 'a' twice"),
        (("a", "b"), ("--span", "a", "2", "1"), "LOW must be below HIGH"),
        (("a", "b"), ("--span", "c", "1", "2"), "the plane is that of a and b"),
        (("a", "b"), BOX[:4], "'b' is 0"),
        (("a", "b"), (*BOX[:4], "--span", "b", "0", "9"), "leaves the model's validity"),
        (("a", "bb"), BOX[:4], "unknown parameter 'bb'"),
        (("a", "b"), (*BOX, "--resume"), "give --map"),
        (("a", "b"), (*BOX, "--workers", "2"), "give --map or --slices"),
        (("a", "b"), (*BOX, "--map", "colour"), "unknown 'colour'"),
        (("a", "b"), (*BOX, "--map", "damping", "--duration", "3"), "--duration is for simul"),
        (("a", "b"), (*BOX, "--map", "damping", "--start", "x=1"), "--start is for simulations"),
        (("a", "b"), (*BOX, "--cells", "3", "3"), "--cells is for a map"),
        (("a", "b"), (*BOX, "--map", "periods", "--watch", "q"), "unknown state 'q'"),
        (("a", "b"), (*BOX, "--curve", "none.nc"), "there is no file 'none.nc'"),
        (("a", "b"), (*BOX, "--slices", "r"), "is not NAME=V1,V2"),
        (("a", "b"), (*BOX, "--slices", "a=1,2"), "slice along another parameter"),
        (("a", "b"), (*BOX, "--mark", "r=1"), "at values of a or b"),
    ],
)
def test_wrong_usage_is_told_in_one_line(chart, tmp_path, names, arguments, message):
    told = chart(*arguments, names=names)
    assert told.status == 2
    assert message in told.err
    assert len(told.err.splitlines()) == 1
    assert not (tmp_path / "out").exists()


def test_an_incomplete_chart_is_saved_and_the_exit_status_says_so(chart, monkeypatch, tmp_path):
    from racs_bif.charts import search

    def refuse(*_a, **_k):
        raise search.ConvergenceError("no seed is good enough")

    monkeypatch.setattr(search, "trace_boundary", refuse)
    told = chart(*BOX)
    assert told.status == 1
    assert "it may lack something" in told.err
    assert "no seed is good enough" in told.err
    assert (tmp_path / "out" / "chart.nc").exists()
