"""The verbs on a model that is known in closed form: nothing is faked here."""

import json
import math

import pytest

from racs_bif import load


@pytest.fixture
def run(cli, normal_form, tmp_path):
    def run(*arguments):
        return cli(*arguments, "--model", normal_form, "--out", tmp_path / "out")

    return run


def test_continue_finds_the_hopf_point_and_the_orbits_of_the_normal_form(run, tmp_path):
    told = run("continue", "mu", "-1", "1", "--at", "0.25", "--json")
    assert told.status == 0, told.err
    summary = json.loads(told.out)
    (hopf,) = [p for p in summary["special_points"] if p["label"] == "H"]
    assert hopf["parameters"]["mu"] == pytest.approx(0, abs=1e-9)
    assert hopf["omega"] == pytest.approx(1, rel=1e-9)
    assert hopf["criticality"] == "supercritical"
    (at,) = [o for o in summary["orbits"] if o["label"] == "UZ"]
    assert at["parameters"] == {"mu": 0.25}
    assert at["period"] == pytest.approx(2 * math.pi, rel=1e-6)
    assert at["max"]["x"] == pytest.approx(0.5, rel=1e-5)
    assert at["min"]["y"] == pytest.approx(-0.5, rel=1e-5)
    assert at["stable"] is True
    multipliers = sorted(math.hypot(*m) for m in at["multipliers"])
    assert multipliers == pytest.approx([math.exp(-4 * math.pi * 0.25), 1.0], rel=1e-4)
    diagram = load(tmp_path / "out" / "branches.nc")
    assert diagram["EQ1"].at(mu=0.25).state == pytest.approx({"x": 0, "y": 0}, abs=1e-12)


def test_the_variant_and_the_values_reach_the_model(run):
    told = run("continue", "mu", "-1", "1", "--variant", "sub", "--set", "k=4", "--json")
    summary = json.loads(told.out)
    assert summary["variant"] == "sub"
    assert summary["parameters"]["k"] == 4.0
    (hopf,) = [p for p in summary["special_points"] if p["label"] == "H"]
    assert hopf["criticality"] == "subcritical"


def test_a_span_without_special_points_says_so(run):
    told = run("continue", "mu", "-1", "-0.5")
    assert told.status == 0
    assert "No special point in this span" in told.out
    assert "stable -1 to -0.5" in told.out


def test_models_lists_them(cli):
    told = cli("models")
    assert told.status == 0
    assert "racs" in told.out
    listed = json.loads(cli("models", "--json", "--quiet").out)
    assert any(entry["name"] == "racs" and entry["title"] for entry in listed)


def test_models_shows_one(cli, normal_form):
    told = cli("models", normal_form, "--variant", "sub", "--set", "k=2")
    assert told.status == 0
    for words in ("Hopf's normal form", "x' = ", "mu", "1/s", "growth", "-10 < mu < 10"):
        assert words in told.out
    assert "* sub: subcritical" in told.out
    assert "Note: nothing here is a vehicle" in told.out
    shown = json.loads(cli("models", normal_form, "--json", "--quiet").out)
    assert shown["variant"] == "super"
    assert [p["name"] for p in shown["parameters"]] == ["mu", "k"]
    assert shown["parameters"][0]["valid"] == [-10.0, 10.0]
    assert set(shown["equations"]) == {"x", "y"}


def test_models_shows_the_vehicle_with_what_is_calibrated(cli):
    told = cli("models", "racs")
    text = " ".join(told.out.split())
    assert "F_f + F_r - m*u*w" in text  # forces are called by their names
    assert "calibrated: C_s puts the exact Hopf point at u = 10.2" in text
    assert "lagrange" in text
    assert "m/s" in text
    assert max(map(len, told.out.splitlines())) <= 80


def test_calibrate_puts_the_exact_hopf_point_where_it_is_wanted(cli):
    told = cli("calibrate", "C_s", "--hopf", "u=10.2", "--json")
    assert told.status == 0
    found = json.loads(told.out)
    # model.md: an independent computation
    assert found["value"] == pytest.approx(29661.065, rel=1e-7)
    assert found["sets"] == pytest.approx({"A_h": 0.741526625}, rel=1e-8)
    assert found["omega"] == pytest.approx(9.5200832, abs=1e-7)
    assert "which sets A_h = 0.7415266" in told.err


def test_calibrate_says_where_it_found_nothing(cli):
    told = cli("calibrate", "C_s", "--hopf", "u=10.2", "--span", "1e3", "2e3")
    assert told.status == 2
    assert "no Hopf point at u = 10.2" in told.err
