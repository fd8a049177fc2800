import json
import math
from dataclasses import replace

import numpy as np
import pytest

from racs_bif.errors import FileError
from racs_bif.results.diagram import Diagram
from racs_bif.results.summary import summarise, to_json, to_text, write_summary

COMMAND = ["continue", "u", "5", "30"]


@pytest.fixture
def summary(diagram):
    return json.loads(to_text(summarise(diagram, COMMAND, "1.2.3")))


def test_the_promised_keys(summary):
    assert summary["schema"] == 1
    assert summary["version"] == "1.2.3"
    assert summary["command"] == COMMAND
    assert (summary["model"], summary["variant"]) == ("synthetic", "paper")
    assert summary["parameters"]["m"] == 1740.0
    how = summary["realisation"]
    assert (how["name"], how["states"], how["band"]) == ("oustaloup", 1, [0.1, 1000.0])


def test_branches(summary):
    one, two = summary["branches"]
    assert one["name"] == "EQ1"
    assert one["kind"] == "equilibrium"
    assert one["parameters"] == ["u"]
    assert one["points"] == 29
    assert one["stopped"] == "reached the end of the span"
    assert [part["unstable"] for part in one["stability"]] == [0, 2]
    assert two["early"] is True


def test_special_points(summary):
    hopf = next(p for p in summary["special_points"] if p["label"] == "H")
    assert (hopf["name"], hopf["branch"]) == ("H1", "EQ1")
    assert hopf["parameters"] == {"u": 10.0}
    assert hopf["state"] == {"v": 1.0, "delta_c": -0.01}
    assert (hopf["omega"], hopf["l1"], hopf["criticality"]) == (9.5, -1.25, "supercritical")
    assert hopf["exact"] == {
        "parameters": {"u": 10.001},
        "omega": 9.51,
        "shift": {"u": -1e-4, "omega": -1e-3},
        "l1": None,
    }
    assert hopf["eigenvector"] == [[1.0, 0.0], [0.0, -1.0], [None, 0.0]]
    assert [p["label"] for p in summary["special_points"]] == ["H", "UZ", "UZ", "NS"]


def test_orbits_at_ends_user_and_special_points(summary, diagram):
    assert [o["label"] for o in summary["orbits"]] == ["EP", "UZ", "NS", "MX"]
    at = next(o for o in summary["orbits"] if o["label"] == "UZ")
    amplitude = math.sqrt(2 / 50)
    assert at["branch"] == "PO1"
    assert at["parameters"] == {"u": 12.0}
    assert at["period"] == pytest.approx(2 * math.pi / 9.5)
    assert at["stable"] is True
    assert at["max"]["delta_c"] == pytest.approx(-0.012 + amplitude)
    assert at["min"]["delta_c"] == pytest.approx(-0.012 - amplitude)
    assert at["multipliers"][0] == [1.0, 0.0]
    assert len(at["multipliers"]) == 2  # the padding is not a multiplier
    assert diagram["PO1"].spectrum.shape[1] == 3


def test_equilibria_at_ends_user_and_special_points(summary):
    assert [e["label"] for e in summary["equilibria"]] == ["EP", "H", "UZ", "EP"]
    first = summary["equilibria"][0]
    assert first["state"] == {"v": 0.5, "delta_c": -0.005}  # memory states are left out
    assert first["parameters"] == {"u": 5.0}
    assert len(first["eigenvalues"]) == 3


def test_what_is_not_a_number_is_null(branch):
    point = replace(branch["H1"], data={"l1": math.nan, "omega": math.inf})
    broken = replace(branch, special=(point,), unstable=np.full(len(branch), -1))
    text = to_text(summarise(Diagram(broken), [], ""))
    assert "NaN" not in text
    assert "Infinity" not in text
    found = json.loads(text)
    assert found["special_points"][0]["l1"] is None
    assert found["special_points"][0]["omega"] is None
    assert found["equilibria"][0]["stable"] is None


def test_numbers_survive_json(diagram):
    found = json.loads(to_text(summarise(diagram, [], "")))
    assert found["parameters"]["C_s"] == 1 / 3


def test_json_refuses_what_it_cannot_hold():
    with pytest.raises(TypeError, match="JSON has no object"):
        to_json([object()])


def test_written_whole_or_not_at_all(diagram, tmp_path):
    summary = summarise(diagram, [], "")
    write_summary(summary, tmp_path / "summary.json")
    assert json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))["schema"] == 1
    with pytest.raises(FileError, match="no such file"):
        write_summary(summary, tmp_path / "no" / "summary.json")
    assert [p.name for p in tmp_path.iterdir()] == ["summary.json"]
