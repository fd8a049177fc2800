"""Every figure of the paper at a low resolution, by the numbers that are in its caption."""

from __future__ import annotations

import json

import pytest

from racs_bif.cli.main import main
from racs_bif.shelf import find, load_module

CALIBRATED = 29661.065
SHORT = {"duration": 3.0, "step": 0.02, "points": 3}
COARSE = {"members": 3, "duration": 6.0, "points": 3}


@pytest.fixture
def numbers(tmp_path):
    """Run an analysis and return the numbers that it wrote."""

    def run(name, **options):
        told = []
        path = load_module(find("analyses", name)).run(tmp_path, **options, progress=told.append)
        assert path == tmp_path / f"{name}.png"
        assert path.stat().st_size > 10_000
        assert all(0.0 <= share <= 1.0 for share in told)
        assert sorted(told) == told
        for ending in ("svg", "md"):
            assert (tmp_path / f"{name}.{ending}").is_file()
        about = json.loads((tmp_path / f"{name}.json").read_text(encoding="utf-8"))
        assert all(paragraph.strip() and "nan" not in paragraph for paragraph in about["caption"])
        return about["numbers"]

    return run


def near(value, relative=1e-6):
    return pytest.approx(value, rel=relative)


def test_tyres(numbers):
    found = numbers("fig02_tyres", speed=11.0)
    assert found["front"]["stiffness"] == near(6.64 * 1.352 * 5822)
    assert found["rear"]["peak_force"] == near(5920, 1e-5)
    assert -0.2 < found["rear"]["orbit_low"] < -0.03 < 0.02 < found["rear"]["orbit_high"] < 0.2


def test_speed(numbers):
    found = numbers("fig03_speed", members=6, duration=12.0, points=12)
    assert found["hopf_u"] == near(10.2)
    assert found["hopf_omega"] == near(9.5200832)
    assert found["l1"] < 0.0
    assert found["oscillating"]


def test_below_and_above(numbers):
    below = numbers("fig04_below", **SHORT)
    assert below["stable"]
    assert below["rate"] == near(-0.0609, 1e-2)
    assert below["settling"]["delta_c"] is None  # not within three seconds
    above = numbers("fig05_above", duration=6.0, step=0.02, points=120)
    assert above["roots"][0] == [near(1.80501519), near(7.66054698)]
    assert above["period"] == near(1.5602, 1e-3)
    assert above["multipliers"]


@pytest.mark.parametrize(
    ("name", "stable"),
    [
        ("fig06_phase_speed", [True, False]),
        ("fig11_phase_arm", [True, False, False, False]),
        ("fig12_phase_mass", [True, False]),
        ("fig14_phase_delta_f", [False, False, False, True]),
    ],
)
def test_phase_portraits(name, stable, numbers):
    assert [found["stable"] for found in numbers(name, **SHORT).values()] == stable


@pytest.mark.parametrize(
    ("name", "hopf"), [("fig07_order", []), ("fig08_modulus", [near(0.45969876, 1e-5)])]
)
def test_orders(name, hopf, numbers):
    found = numbers(name, **COARSE)
    assert found["hopf_alpha"] == hopf
    assert found["alpha = 0.3"]["stable"] is bool(hopf)


def test_arm(numbers):
    found = numbers("fig09_arm", **COARSE)
    assert found["C_s"] == [near(CALIBRATED), near(13128, 1e-4)]
    assert found["hopf_c"] == [[near(0.295587, 1e-5)], [near(0.15)]]


def test_steering(numbers):
    found = numbers("fig13_steering", **COARSE)
    assert found["C_s"][1] == near(37376, 1e-4)
    assert found["hopf_delta_f"][1] == [near(0.08)]


def test_mass(numbers):
    found = numbers("fig10_mass", **COARSE)
    assert found["hopf_m_c"][:2] == [[], []]
    assert found["hopf_m_c"][3] == [near(160)]


def test_a_figure_runs_from_the_command_line(tmp_path, capsys):
    arguments = ["run", "fig02_tyres", "--set", "speed=11", "--out", str(tmp_path)]
    assert main(arguments) == 0
    assert "fig02_tyres.png" in capsys.readouterr().out
