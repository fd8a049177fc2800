"""Models of nerves against their known results."""

import numpy as np
import pytest

import racs_bif as rb

POINT = 1e-8
FORM = 1e-4
CYCLE = 1e-6


def test_fitzhugh_nagumo(places):
    branch = rb.continue_equilibria(rb.load_model("fitzhugh_nagumo"), "I", (0.0, 2.0))
    known = [0.331281337454746, 1.41871866254525]
    np.testing.assert_allclose(places(branch, "H", "I"), known, rtol=POINT)
    assert sum(known) == pytest.approx(2.0 * 0.7 / 0.8, rel=1e-12)
    for hopf in branch.special:
        assert hopf.omega == pytest.approx(0.275506805723561, rel=POINT)
        assert hopf.omega**2 == pytest.approx(0.08 - 0.064**2, rel=POINT)
        assert hopf.state["v"] ** 2 == pytest.approx(1.0 - 0.064, rel=POINT)
        assert hopf.c1 == pytest.approx(0.267784648, rel=FORM)


def test_neural_mass(places):
    branch = rb.continue_equilibria(rb.load_model("neural_mass"), "E_0", (-2.2, -0.9))
    folds, hopf = [-1.86522391033905, -1.46302732554269], [-1.85012459476756, -1.15105939691867]
    np.testing.assert_allclose(places(branch, "LP", "E_0"), folds, rtol=POINT)
    np.testing.assert_allclose(places(branch, "H", "E_0"), hopf, rtol=POINT)
    last = max((p for p in branch.special if p.label == "H"), key=lambda p: p.parameters["E_0"])
    assert last.omega == pytest.approx(19.3650354034982, rel=POINT)
    assert last.c1 == pytest.approx(0.02605640481, rel=FORM)
    orbits = rb.continue_orbits(last, (-1.77, -0.9), method="collocation")
    for name, level, period in (
        ("LPC1", -1.14585313623, 0.332533059919),
        ("LPC2", -1.7690340404, 0.8053578),
    ):
        assert orbits[name].parameters["E_0"] == pytest.approx(level, rel=CYCLE)
        assert orbits[name].period == pytest.approx(period, rel=CYCLE)


@pytest.fixture(scope="module")
def axon():
    return rb.load_model("hodgkin_huxley")


@pytest.fixture(scope="module")
def firing(axon):
    return rb.continue_equilibria(axon, "I", (0.0, 200.0))


def test_the_axon_rests_at_zero_and_fires_between_two_hopf_points(axon, firing):
    assert axon.equilibrium()[0] == pytest.approx(2.0329993e-5, rel=1e-6)
    first, last = firing.special
    assert first.label == last.label == "H"
    assert first.parameters["I"] == pytest.approx(9.779637995393126, rel=POINT)
    assert first.omega == pytest.approx(0.5862338131302925, rel=POINT)
    assert first.criticality == "subcritical"
    assert last.parameters["I"] == pytest.approx(154.526633665808, rel=POINT)
    assert last.omega == pytest.approx(1.062921806760336, rel=POINT)
    assert last.criticality == "supercritical"


def test_the_cycles_of_the_axon_fold_three_times(firing):
    branch = rb.continue_orbits(firing.special[0], (6.2, 9.8), method="collocation")
    known = [
        (7.84654712003, 16.7137967202),
        (7.9219854929, 20.7072946),
        (6.26452127451, 19.8952407126),
    ]
    folds = [p for p in branch.special if p.label == "LPC"]
    assert len(folds) == len(known)
    for fold, (current, period) in zip(folds, known, strict=True):
        assert fold.parameters["I"] == pytest.approx(current, rel=CYCLE)
        assert fold.period == pytest.approx(period, rel=CYCLE)


@pytest.mark.parametrize("V", [10.0, 25.0, 10.0 + 1e-9, 25.0 - 1e-5, 20.0, 0.0, 15.0, 35.0])
def test_the_rates_of_the_axon_are_finite_and_smooth_where_they_are_0_over_0(axon, V):
    p, field = axon.values, axon.field
    gates = np.array([0.4, 0.3, 0.5])

    def at(voltage):
        return np.array([voltage, *gates])

    step = 1e-4
    value, slope = field.f(at(V), p), field.f_x(at(V), p)[:, 0]
    ahead, behind = field.f(at(V + step), p), field.f(at(V - step), p)
    assert np.isfinite(value).all()
    np.testing.assert_allclose((ahead - behind) / (2 * step), slope, rtol=1e-7, atol=1e-8)
    assert value[3] == pytest.approx(rate_of_n(V, 0.5), rel=1e-12)


def rate_of_n(V, n):
    alpha = 0.1 if V == 10.0 else 0.01 * (10.0 - V) / np.expm1((10.0 - V) / 10.0)
    return alpha * (1.0 - n) - 0.125 * np.exp(-V / 80.0) * n
