"""The verdict on chaos, and its parts."""

from __future__ import annotations

import json

import numpy as np
import pytest

from racs_bif.shelf import find, load_module


@pytest.fixture(scope="module")
def chaos():
    return load_module(find("analyses", "chaos"))


def test_a_few_vehicles(chaos, tmp_path):
    chaos.run(tmp_path, members=3, duration=8.0, points=3)
    about = json.loads((tmp_path / "chaos.json").read_text(encoding="utf-8"))
    claimed, orders = about["numbers"]["claimed"], about["numbers"]["orders"]
    assert "chaos" not in claimed["kinds"]
    assert claimed["kinds"][0] == "rest"  # spun out
    assert claimed["exponent"][0] < 0.0
    assert len(orders["exponent"]) == 3
    assert "not chaos" in about["caption"][1]


def test_both_the_exponent_and_the_section_have_a_say(chaos):
    kind = chaos.family.__globals__["_kind"]
    assert kind(1.0, 0.1, np.inf, failed=False) == "chaos"
    assert kind(0.2, 0.1, np.inf, failed=False) == "undecided"
    assert kind(1.0, 0.1, 2.0, failed=False) == "undecided"
    assert kind(0.0, 0.1, 2.0, failed=False) == "periodic"
    assert kind(-0.1, 0.01, 0.0, failed=False) == "rest"
    assert kind(-0.1, 0.01, np.nan, failed=False) == "undecided"
    assert kind(1.0, 0.1, np.inf, failed=True) == "undecided"


def test_the_verdict_follows_from_the_numbers(chaos):
    family = chaos.family.__globals__["Family"]
    three = np.array([1.0, 2.0, 3.0])
    common = {"parameter": "C_s", "values": three, "error": 0.01 * three, "repeats": 0.0 * three}
    rest = family(**common, exponent=-three, side=np.array([1.0, -1.0, 1.0]), kinds=("rest",) * 3)
    assert "It is not chaos" in chaos.verdict(rest)
    assert "changes 2 times among the 3" in chaos.verdict(rest)
    doubt = family(**common, exponent=three, side=0.0 * three, kinds=("rest", "undecided", "rest"))
    assert "Not decided: 1 have a positive exponent" in chaos.verdict(doubt)
    some = family(**common, exponent=three, side=0.0 * three, kinds=("rest", "chaos", "chaos"))
    assert "Chaos it is from C_s = 2 to 3" in chaos.verdict(some)
