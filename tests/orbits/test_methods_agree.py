"""Three discretisations of the same equations have the same orbits."""

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.errors import UsageError
from racs_bif.orbits.balance_settings import BalanceSettings


def test_the_vehicles_orbits_agree_on_the_same_realisation():
    start = rb.continue_equilibria(rb.load_model("racs"), "u", (9, 11))["H1"]
    settings = {"harmonic-balance": BalanceSettings(operator="realised")}
    periods, highest = {}, {}
    for method in ("collocation", "shooting", "harmonic-balance"):
        branch = rb.continue_orbits(
            start, span=(9, 12), method=method, orbit_settings=settings.get(method)
        )
        assert branch.values[-1] == 12.0
        periods[method] = branch.measures["period"][-1]
        highest[method] = branch.measures["max delta_c"][-1]
    assert periods["shooting"] == pytest.approx(periods["collocation"], rel=1e-8)
    assert periods["harmonic-balance"] == pytest.approx(periods["collocation"], rel=1e-11)
    assert highest["harmonic-balance"] == pytest.approx(highest["collocation"], rel=1e-8)
    # the exact operator's orbits are others: that is the error of the realisation
    exact = rb.continue_orbits(start, span=(9, 12), method="harmonic-balance")
    shift = exact.measures["period"][-1] / periods["collocation"] - 1.0
    assert 1e-6 < abs(shift) < 1e-4
    assert np.all(exact.measures["trivial error"][1:] < 1e-2)


def test_operators_that_are_none_are_named():
    with pytest.raises(UsageError, match=r"'operator'.*'exact' or 'realised', not 'oustaloup'"):
        BalanceSettings(operator="oustaloup")


def test_any_realisation_can_be_balanced():
    system = rb.load_model("racs", realisation="oustaloup", order=9, band=(1e-2, 1e3))
    start = rb.continue_equilibria(system, "u", (9, 11))["H1"]
    balanced = BalanceSettings(operator="realised")
    periods = [
        rb.continue_orbits(start, span=(9, 10.8), method=method, orbit_settings=settings).measures[
            "period"
        ][-1]
        for method, settings in (("collocation", None), ("harmonic-balance", balanced))
    ]
    assert periods[0] == pytest.approx(periods[1], rel=1e-10)
