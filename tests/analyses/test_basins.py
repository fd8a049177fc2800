"""Shares of initial conditions, and their confidence."""

from __future__ import annotations

import json

import numpy as np
import pytest

from racs_bif.shelf import find, load_module


@pytest.fixture(scope="module")
def basins():
    return load_module(find("analyses", "basins"))


def test_all_vehicles_are_accounted_for(basins, tmp_path):
    basins.run(tmp_path, speeds=2, samples=6, resolution=3, duration=8.0)
    numbers = json.loads((tmp_path / "basins.json").read_text(encoding="utf-8"))["numbers"]
    assert np.sum(list(numbers["counts"].values()), axis=0).tolist() == [6, 6]
    assert {speed: sum(row) for speed, row in numbers["maps"].items()} == {"20": 9, "25": 9}
    assert numbers["counts"]["straight"][0] + numbers["counts"]["unsettled"][0] > 0  # at 8 m/s
    at_20, at_25 = numbers["stable"][2:]
    assert at_20 == {"straight": 0, "right": 1, "left": 1}
    assert at_25 == {"straight": 0, "right": 1, "left": 0}
    table = (tmp_path / "basins.csv").read_text(encoding="utf-8").splitlines()
    assert len(table) == 1 + 2 * 5


def test_a_speed_that_is_asked_twice_has_its_equilibria_twice(basins):
    first, second = basins.places(np.array([20.0, 20.0]))
    assert first.stable == second.stable == {"straight": 0, "right": 1, "left": 1}
    assert first.spun == pytest.approx(0.1439, rel=1e-3)


@pytest.mark.parametrize(("count", "total"), [(0, 10), (5, 10), (10, 10), (3, 40)])
def test_confidence_solves_its_equation(basins, count, total):
    low, high = basins.wilson(count, total)
    z = 1.959963984540054
    for p in {low, high} - {0.0, 1.0}:
        assert (count / total - p) ** 2 == pytest.approx(z**2 * p * (1.0 - p) / total)
    assert low <= count / total <= high
