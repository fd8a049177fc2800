"""The vehicle against the independent numbers of model.md."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.errors import ParameterError, UsageError

if TYPE_CHECKING:
    from racs_bif.results.branch import Branch

HOPF_SPEEDS = {
    "C_s 20000": ({"C_s": 2e4}, 4.5672697, 10.414023),
    "C_s 35000": ({"C_s": 3.5e4}, 15.81316, 8.3598728),
    "C_s 40000": ({"C_s": 4e4}, 22.318792, 7.4845221),
    "alpha .2": ({"alpha": 0.2}, 14.23821, 7.7314068),
    "alpha .4": ({"alpha": 0.4}, 4.7922914, 12.550348),
    "gamma .6": ({"gamma": 0.6}, 3.9916341, 12.99678),
    "gamma .8": ({"gamma": 0.8}, 15.266725, 7.2073304),
    "m_c 30": ({"m_c": 30.0}, 9.3015361, 10.198924),
    "m_c 200": ({"m_c": 200.0}, 11.576326, 8.6582576),
    "c .30": ({"c": 0.3}, 18.934671, 7.693726),
    "c .40": ({"c": 0.4}, 5.831142, 11.027693),
    "delta_f .08": ({"delta_f": 0.08}, 10.308432, 9.4531972),
}


@pytest.fixture(scope="module")
def equilibria() -> Branch:
    return rb.continue_equilibria(rb.load_model("racs"), "u", (5, 30))


@pytest.fixture(scope="module")
def orbits(equilibria: Branch) -> Branch:
    return rb.continue_orbits(equilibria["H1"], (5, 21), at=(12, 18))


def test_equilibria_are_those_of_the_exact_model(equilibria: Branch) -> None:
    u, delta_c = equilibria.column("u"), equilibria.column("delta_c")
    assert (u[0], u[-1]) == (5.0, 30.0)
    assert delta_c[0] == pytest.approx(-0.0015083144, abs=5e-11)
    assert delta_c[-1] == pytest.approx(-0.0072687, abs=5e-8)


def test_one_hopf_point_exactly_where_it_was_calibrated(equilibria: Branch) -> None:
    assert [p.name for p in equilibria.special] == ["H1"]
    hopf = equilibria["H1"]
    assert hopf.exact is not None
    assert hopf.exact.parameters["u"] == pytest.approx(10.2, rel=1e-9)
    assert hopf.exact.omega == pytest.approx(9.5200832, abs=1e-7)
    assert abs(hopf.exact.shift["u"]) < 1e-3
    assert hopf.l1 < 0.0
    assert hopf.exact.l1 == pytest.approx(hopf.l1, rel=0.02)
    assert hopf.criticality == "supercritical"


def test_stability_changes_at_the_hopf_point_only(equilibria: Branch) -> None:
    below = equilibria.column("u") < equilibria["H1"].parameters["u"]
    assert np.all(equilibria.unstable[below] == 0)
    assert np.all(equilibria.unstable[~below][1:] == 2)


@pytest.mark.parametrize(("values", "u", "omega"), HOPF_SPEEDS.values(), ids=HOPF_SPEEDS.keys())
def test_exact_hopf_speed_with_one_parameter_changed(
    values: dict[str, float], u: float, omega: float
) -> None:
    branch = rb.continue_equilibria(rb.load_model("racs", parameters=values), "u", (3, 30))
    hopf = [p for p in branch.special if p.label == "H"]
    assert len(hopf) == 1
    assert hopf[0].exact is not None
    assert hopf[0].exact.parameters["u"] == pytest.approx(u, rel=2e-7)
    assert hopf[0].exact.omega == pytest.approx(omega, rel=2e-7)


def test_no_hopf_point_with_a_large_order() -> None:
    branch = rb.continue_equilibria(rb.load_model("racs", parameters={"alpha": 0.6}), "u", (1, 60))
    assert not [p for p in branch.special if p.label == "H"]


@pytest.mark.parametrize(
    ("u", "period", "low", "high"),
    [(12, 0.7393668, -0.0839322, 0.0754349), (18, 1.1496047, -0.1095942, 0.1009184)],
)
def test_orbits_are_those_of_the_exact_operator(
    orbits: Branch, u: float, period: float, low: float, high: float
) -> None:
    point = orbits.at(u=u)
    k = point.index
    assert point.period == pytest.approx(period, rel=1e-3)
    assert orbits.measures["min delta_c"][k] == pytest.approx(low, rel=1e-3)
    assert orbits.measures["max delta_c"][k] == pytest.approx(high, rel=1e-3)
    assert orbits.stable[k]


def test_orbits_reach_the_end_of_the_span_with_healthy_multipliers(orbits: Branch) -> None:
    assert orbits.column("u")[-1] == 21.0
    assert not orbits.early
    assert orbits.measures["trivial error"].max() < 1e-4
    assert not [p for p in orbits.special if p.label in {"LPC", "PD", "NS", "BPC"}]


def test_amplitude_near_onset_follows_the_exact_coefficient(orbits: Branch) -> None:
    """u - u_H = kappa A^2, kappa = 50.3487, A the first harmonic of delta_c (model.md, 4)."""
    u = orbits.column("u")
    spread = 0.5 * (orbits.measures["max delta_c"] - orbits.measures["min delta_c"])
    small = int(np.flatnonzero(spread > 1e-3)[0])
    assert spread[small] < 0.01
    kappa = (u[small] - u[0]) / spread[small] ** 2
    assert kappa == pytest.approx(50.3487, rel=0.01)


def test_printed_signs_give_one_real_unstable_root_and_no_hopf_point() -> None:
    system = rb.load_model("racs", variant="printed")
    branch = rb.continue_equilibria(system, "u", (5, 30))
    assert not [p for p in branch.special if p.label == "H"]
    assert np.all(branch.unstable == 1)
    rightmost = branch.spectrum[:, 0]
    assert np.all(rightmost.imag == 0.0)
    assert any("pushes the axle away" in note for note in system.notes)


def test_calibration_is_a_computation() -> None:
    system = rb.load_model("racs")
    assert system.parameters["C_s"] == pytest.approx(29661.065, abs=5e-4)
    assert system.parameters["A_h"] == pytest.approx(0.741526625, abs=5e-10)
    other = rb.calibrate(system, "C_s", {"u": 15.81316})
    assert other.value == pytest.approx(35000.0, rel=1e-6)
    assert other.omega == pytest.approx(8.3598728, rel=1e-6)


def test_calibration_refuses_what_cannot_be() -> None:
    system = rb.load_model("racs")
    with pytest.raises(UsageError, match="cannot be both"):
        rb.calibrate(system, "u", {"u": 12.0})
    with pytest.raises(UsageError, match="no Hopf point"):
        rb.calibrate(system, "C_s", {"u": 10.2}, span=(1e5, 2e5))
    with pytest.raises(ParameterError, match="did you mean 'C_s'"):
        rb.calibrate(system, "Cs", {"u": 10.2})


@pytest.mark.parametrize(
    ("span", "error", "text"),
    [
        ((30, 5), UsageError, "empty"),
        ((5, float("nan")), UsageError, "finite"),
        ((-1, 30), ParameterError, "validity"),
    ],
)
def test_spans_that_cannot_be_followed(
    span: tuple[float, float], error: type[Exception], text: str
) -> None:
    with pytest.raises(error, match=text):
        rb.continue_equilibria(rb.load_model("racs"), "u", span)


def test_orbits_need_a_hopf_point_of_this_process(equilibria: Branch) -> None:
    with pytest.raises(UsageError, match="outside the span"):
        rb.continue_orbits(equilibria["H1"], (15, 30))
    with pytest.raises(UsageError, match="did you mean 'shooting'"):
        rb.continue_orbits(equilibria["H1"], method="shoting")


def test_a_band_that_excludes_the_critical_frequency_is_warned_of() -> None:
    system = rb.load_model("racs", band=(20.0, 500.0), order=14)
    branch = rb.continue_equilibria(system, "u", (5, 30))
    assert "is outside the realisation's band, 20 to 500 rad/s" in branch.stopped
    hopf = next(p for p in branch.special if p.label == "H")
    assert hopf.exact.parameters["u"] == pytest.approx(10.2, rel=1e-9)
    inside = rb.continue_equilibria(rb.load_model("racs"), "u", (5, 30))
    assert "band" not in inside.stopped
