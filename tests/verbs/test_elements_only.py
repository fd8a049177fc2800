"""Models that are made of elements only: their outputs stand for states."""

from __future__ import annotations

import numpy as np
import pytest

import racs_bif as rb

B_HOPF = 2.3128689301


@pytest.fixture(scope="module")
def hopf():
    return rb.continue_equilibria(rb.load_model("fractional_brusselator"), "B", (1.5, 3.5))["H1"]


def test_the_hopf_point(hopf):
    assert hopf.exact.parameters["B"] == pytest.approx(B_HOPF, abs=1e-9)
    assert hopf.exact.omega == pytest.approx(1.0, abs=1e-9)
    assert hopf.l1 == pytest.approx(hopf.exact.l1, rel=1e-4)
    assert hopf.state["x"] == pytest.approx(1.0, abs=1e-12)
    assert hopf.state["y"] == pytest.approx(B_HOPF, abs=1e-5)


@pytest.mark.parametrize("method", ["harmonic-balance", "collocation"])
def test_the_orbits(hopf, method):
    branch = rb.continue_orbits(hopf, span=(2.0, 2.4), method=method, at=[2.35])
    assert not branch.early
    assert 2.0 * np.pi / branch.measures["period"][0] == pytest.approx(1.0, abs=1e-6)
    point = branch["UZ1"]
    highest, lowest = (branch.measures[f"{end} x"][point.index] for end in ("max", "min"))
    assert lowest < point.state["x"] <= highest * (1.0 + 1e-6)
    profile = branch.profiles["UZ1"]
    assert profile.names == ("x", "y")
    assert profile.states[:, 0].max() == pytest.approx(highest, rel=1e-3)
    # both discretisations agree, one with the exact operator
    assert (lowest, highest) == pytest.approx((0.815120, 1.255680), abs=1e-5)
