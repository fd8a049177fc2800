"""The verb ``curve`` on the vehicle and on a textbook model."""

from __future__ import annotations

import json

import pytest

from racs_bif.cli.main import main

BAZYKIN = '''"""Bazykin's predator-prey model."""

from racs_bif.symbolic.strings import model_from_strings


def model():
    return model_from_strings(
        "bazykin",
        {"x": "x-x*y/(1+al*x)-0.01*x**2", "y": "-y+x*y/(1+al*x)-de*y**2"},
        parameters={"al": 0.3, "de": 0.1},
        guess={"x": 3.0, "y": 2.0},
    )
'''


def test_exact_hopf_curve_of_the_vehicle(capsys, tmp_path):
    arguments = ["--span", "u", "3", "30", "--span", "C_s", "1e4", "6e4", "--json"]
    status = main(["curve", "hopf", "u", "C_s", *arguments, "--out", str(tmp_path)])
    summary = json.loads(capsys.readouterr().out)
    assert status == 0
    assert summary["branches"][0]["parameters"] == ["u", "C_s"]
    assert summary["special_points"] == []
    u = [p["parameters"]["u"] for p in summary["points"]]
    assert (min(u), max(u)) == (3.0, 30.0)
    assert all(p["l1"] < 0 for p in summary["points"])
    nearest = min(summary["points"], key=lambda p: abs(p["parameters"]["C_s"] - 29661.065))
    assert nearest["omega"] == pytest.approx(9.52, abs=0.3)
    for name in ("branches.nc", "diagram.png", "diagram.svg", "summary.json"):
        assert (tmp_path / name).stat().st_size > 0


def test_hopf_curve_of_bazykins_model_ends_in_its_bogdanov_takens_point(capsys, tmp_path):
    file = tmp_path / "bazykin.py"
    file.write_text(BAZYKIN, encoding="utf-8")
    arguments = ["--model", str(file), "--span", "al", "0.1", "1.0", "--span", "de", "0.01", "0.5"]
    out = ["--json", "--out", str(tmp_path / "out")]
    assert main(["curve", "hopf", "al", "de", *arguments, *out]) == 0
    summary = json.loads(capsys.readouterr().out)
    found = [p for p in summary["special_points"] if p["label"] == "BT"]
    places = [(p["parameters"]["al"], p["parameters"]["de"]) for p in found]
    known = pytest.approx((0.453624327778, 0.175127592950), rel=1e-8)  # acceptance.md
    assert any(place == known for place in places)


def test_the_fold_curve_through_a_bogdanov_takens_point(capsys, tmp_path):
    file = tmp_path / "bazykin.py"
    file.write_text(BAZYKIN, encoding="utf-8")
    spans = ["--span", "al", "0.1", "1.0", "--span", "de", "0.01", "0.5"]
    out = ["--json", "--out", str(tmp_path / "out")]
    arguments = ["--model", str(file), *spans, "--through", "BT1", *out]
    assert main(["curve", "hopf", "al", "de", *arguments]) in {0, 1}
    summary = json.loads(capsys.readouterr().out)
    assert [b["name"][:2] for b in summary["branches"]] == ["HC", "LC"]
    assert {p["curve"] for p in summary["points"]} == {b["name"] for b in summary["branches"]}
    arguments = ["--model", str(file), *spans, "--through", "BT9", *out]
    assert main(["curve", "hopf", "al", "de", *arguments]) == 2
    assert "there are: BT1" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (["hopff", "u", "C_s"], "did you mean 'hopf'"),
        (["hopf", "u", "u"], "two different parameters"),
        (["hopf", "u", "Cs"], "did you mean 'C_s'"),
        (["fold", "u", "C_s", "--span", "u", "5", "6"], "no LP as u goes from 5 to 6"),
        (["hopf", "u", "C_s", "--span", "c", "0.1", "0.2"], "the plane is that of u and C_s"),
        (["hopf", "u", "C_s", "--span", "u", "9", "x"], "not a number"),
        (["hopf", "u", "C_s", "--span", "u", "8", "12", "--point", "H9"], "there are: H1"),
    ],
)
def test_what_cannot_be_followed(capsys, tmp_path, arguments, text):
    status = main(["curve", *arguments, "--out", str(tmp_path / "out")])
    told = capsys.readouterr().err
    assert status == 2
    assert text in told
    assert told.count("\n") == 1
    assert not (tmp_path / "out").exists()
