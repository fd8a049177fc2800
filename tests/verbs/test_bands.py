"""Realisations whose band does not hold what decides stability."""

import pytest

import racs_bif as rb
from racs_bif.shelf.load import system_of
from racs_bif.verbs import bands, contradictions

SLOW = {
    # the relaxation of a soft solid in minutes: its Hopf point is far below the model's own band
    "x": "y",
    "y": "-0.0001*x + mu*y - y**3 + 0.0005*w",
}


@pytest.fixture(scope="module")
def slow():
    return rb.model_from_strings(
        "slow",
        SLOW,
        parameters={"mu": -0.01, "alpha": 0.5},
        elements=[("w", "y", "s**alpha")],
    )


@pytest.fixture(scope="module")
def vehicle(benchmark_module):
    def load(index):
        variant, values = benchmark_module("random_vehicles").draw(index)
        return rb.load_model("racs", parameters=values, variant=variant)

    return load


def test_a_band_is_widened_until_the_exact_equations_agree(slow):
    branch = rb.continue_equilibria(slow, "mu", (-0.01, 0.01))
    low, high = branch.system.realisation.band
    assert low < 1e-2
    assert "band was widened" in branch.stopped
    (hopf,) = (point for point in branch.special if point.label == "H")
    assert 2.0 * low < hopf.omega < high
    assert abs(hopf.exact.shift["omega"]) < 1e-2
    assert rb.certify(branch, "complete").holds


def test_a_band_that_the_user_chose_is_kept(slow):
    system = system_of(slow, band=(0.2, 50.0))
    branch = rb.continue_equilibria(system, "mu", (-0.01, 0.01))
    assert branch.system.realisation.band == (0.2, 50.0)
    assert "widened" not in branch.stopped


def test_every_branch_of_a_diagram_has_the_same_band(slow):
    diagram = rb.all_equilibria(slow, "mu", (-0.01, 0.01), probes=0)
    assert len({branch.system.realisation.band for branch in diagram}) == 1
    assert diagram["EQ1"].system.realisation.band[0] < 1e-2


def test_where_no_band_settles_it_that_is_said(slow, monkeypatch):
    monkeypatch.setattr(bands, "_LIMITS", (0.5, 2.0))
    branch = rb.continue_equilibria(slow, "mu", (-0.01, 0.01))
    assert branch.system.realisation.band == (0.1, 100.0)
    assert "No wider band settles it" in branch.stopped
    assert branch.early


def test_where_no_band_settles_it_stability_is_not_told(vehicle, monkeypatch):
    """Of this vehicle two roots slower than 1e-6 rad/s cross where no realisation has them."""
    system = vehicle(149)
    monkeypatch.setattr(bands, "_LIMITS", (0.5, 2.0))
    branch = rb.continue_equilibria(system, "u", (9.5, 11.0))
    unknown = branch.unstable == -1
    assert "No wider band settles it" in branch.stopped
    assert f"Stability is left out at {unknown.sum()} points" in branch.stopped
    assert 0 < unknown.sum() < 0.5 * len(branch)
    assert not branch.stable[unknown].any()
    assert branch.early
    # all that is told is true
    failures = rb.certify(branch, "complete").failures
    assert not any("unstable roots, the exact model has" in check.finding for check in failures)


def test_where_no_band_settles_it_refused_hopf_points_are_left_out(vehicle):
    """Beside a fold of this vehicle the realisation has a Hopf point, the exact equations none."""
    branch = rb.continue_equilibria(vehicle(1715), "u", (9.6, 9.8))
    assert [point.label for point in branch.special] == ["LP"]
    assert "Left out, as the exact equations have no such Hopf point: H1 at u = 9.728" in (
        branch.stopped
    )
    assert branch.early
    assert "H" not in branch.labels
    # what is told beside it is known
    findings = [check.finding for check in rb.certify(branch, "complete").failures]
    assert findings
    assert all("no stability" in text or "-1 reported" in text for text in findings)


def test_roots_that_cross_twice_between_special_points_are_seen(vehicle):
    """Two roots of this vehicle, slower than any band, are unstable in a short piece of it."""
    branch = rb.continue_equilibria(vehicle(1046), "u", (3.0, 5.0))
    unknown = branch.parameter[branch.unstable == -1]
    assert len(unknown)
    assert ((unknown > 3.98) & (unknown < 4.3)).all()  # above the Hopf point at 3.983
    assert branch.early
    findings = [check.finding for check in rb.certify(branch, "complete").failures]
    assert findings
    assert all("no stability" in text or "-1 reported" in text for text in findings)


def test_where_no_band_settles_it_stability_is_not_told_beside_a_fold(vehicle):
    """Two roots of this vehicle cross between a fold and the point before it, slower than 1e-8."""
    branch = rb.continue_equilibria(vehicle(1838), "u", (15.5, 16.3))
    fold = branch["LP1"].index
    assert branch.early
    assert -1 in branch.unstable[[fold - 1, fold + 1]]
    findings = [check.finding for check in rb.certify(branch, "complete").failures]
    assert findings
    assert all("no stability" in text or "-1 reported" in text for text in findings)


@pytest.mark.parametrize(
    ("index", "span", "u", "omega"),
    [
        (204, (16.0, 19.0), 18.4324191983, 0.0601894726),  # slow roots meet beside the fold
        (348, (14.0, 15.0), 14.6075654901, 0.000400327),  # within the step that has the fold
        (168, (14.0, 18.0), 15.0513714326, 0.000293267),  # no fold: a root is slow
    ],
)
def test_slow_hopf_points_of_vehicles_are_found(vehicle, index, span, u, omega):
    branch = rb.continue_equilibria(vehicle(index), "u", span)
    assert "band was widened" in branch.stopped
    exact = [point.exact for point in branch.special if point.label == "H"]
    nearest = min(exact, key=lambda point: abs(point.parameters["u"] - u))
    assert nearest.parameters["u"] == pytest.approx(u, rel=1e-10)
    assert nearest.omega == pytest.approx(omega, rel=1e-5)
    assert rb.certify(branch, "complete").holds


def test_what_rounding_hides_at_a_fold_is_no_reason_to_widen_for_ever(vehicle):
    """Of this vehicle a Hopf point of 6e-4 rad/s is 3e-10 beside a fold.

    The realisation that finds it has two more unstable eigenvalues within 1e-11 of the fold, where
    an equilibrium is known to half its digits.
    """
    branch = rb.continue_equilibria(vehicle(640), "u", (9.7, 10.0))
    low, _ = branch.system.realisation.band
    hopf = next(p for p in branch.special if p.label == "H" and p.omega < 0.1)
    assert not branch.early
    assert 1e-9 < low < 1e-5
    assert hopf.exact.parameters["u"] == pytest.approx(9.920403966938846, rel=1e-12)
    assert hopf.omega == pytest.approx(hopf.exact.omega, rel=1e-2)
    assert rb.certify(branch, "complete").holds


def test_the_order_is_raised_for_a_hopf_point_far_from_the_exact_one(vehicle):
    """Two Hopf points of this vehicle nearly meet, and the default order is 1.4 % off."""
    branch = rb.continue_equilibria(vehicle(959), "u", (18.0, 23.0))
    hopf = min((p for p in branch.special if p.label == "H"), key=lambda p: p.exact.parameters["u"])
    assert "order was raised to 1.5 times its default" in branch.stopped
    assert hopf.exact.parameters["u"] == pytest.approx(19.9055032487, rel=1e-10)
    assert abs(hopf.exact.shift["omega"]) < 1e-3
    assert rb.certify(branch, "complete").holds


def test_the_order_stays_where_no_exact_hopf_point_is_near(slow, monkeypatch):
    monkeypatch.setattr(contradictions, "exact_hopf_near", lambda *_: None)
    branch = rb.continue_equilibria(slow, "mu", (-0.01, 0.01))
    assert "order was raised to 3.38 times its default" in branch.stopped
    assert not branch.early


def test_the_vehicles_own_band_will_do():
    branch = rb.continue_equilibria(rb.load_model("racs"), "u", (5, 30))
    assert branch.system.realisation.band == (0.1, 50.0)
    assert "widened" not in branch.stopped
