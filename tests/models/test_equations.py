"""Textbook systems of chemistry, ecology, circulation and control against their known results."""

from dataclasses import replace

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.shelf import find
from racs_bif.shelf.modules import load_module

POINT = 1e-8
FORM = 1e-4
CYCLE = 1e-6


@pytest.mark.parametrize(
    ("mu", "period"),
    [
        (0.1, 6.2871112722887),
        (1.0, 6.6632868593231),
        (5.0, 11.61223066772),
        (10.0, 19.078369566939),
    ],
)
def test_van_der_pol(mu, period):
    system = rb.load_model("van_der_pol", parameters={"mu": mu})
    hopf = rb.continue_equilibria(system, "g", (-0.5, 1.0))["H1"]
    assert hopf.parameters["g"] == pytest.approx(0.0, abs=1e-12)
    assert hopf.omega == pytest.approx(1.0, rel=POINT)
    assert hopf.c1 == pytest.approx(-mu / 4.0, rel=FORM)
    branch = rb.continue_orbits(hopf, method="collocation")
    assert branch.special[-1].parameters["g"] == 1.0
    assert branch.special[-1].period == pytest.approx(period, rel=CYCLE)
    assert branch.stable[branch.parameter > 1e-3].all()
    if mu == 1.0:
        assert branch.column("max x")[-1] == pytest.approx(2.00861986, rel=CYCLE)


def test_brusselator():
    hopf = rb.continue_equilibria(rb.load_model("brusselator"), "B", (1.0, 4.0))["H1"]
    assert hopf.parameters["B"] == pytest.approx(2.0, rel=POINT)
    assert hopf.omega == pytest.approx(1.0, rel=POINT)
    assert hopf.c1 == pytest.approx(-0.5, rel=FORM)
    branch = rb.continue_orbits(hopf, (1.0, 3.0), method="collocation", at=(2.5, 3.0))
    assert branch.at(B=2.5).period == pytest.approx(6.577284341906, rel=CYCLE)
    assert branch.at(B=3.0).period == pytest.approx(7.15691992118, rel=CYCLE)


@pytest.mark.parametrize("A", [0.7, 2.0])
def test_brusselator_in_closed_form(A):
    system = rb.load_model("brusselator", parameters={"A": A})
    hopf = rb.continue_equilibria(system, "B", (0.5, 6.0))["H1"]
    assert hopf.parameters["B"] == pytest.approx(1.0 + A**2, rel=POINT)
    assert hopf.omega == pytest.approx(A, rel=POINT)
    assert hopf.criticality == "supercritical"


def test_a_chain_of_brusselators(places):
    branch = rb.continue_equilibria(rb.load_model("brusselator_chain"), "B", (1.5, 2.8))
    assert len(branch.state_names) == 30
    r = 4.0 * np.sin(np.pi * np.arange(15) / 30.0) ** 2
    expected = 2.0 + 10.0 * r
    np.testing.assert_allclose(places(branch, "H", "B"), expected[expected < 2.8], rtol=POINT)
    for point, r_k in zip((branch["H1"], branch["H2"]), r, strict=False):
        assert point.omega == pytest.approx(np.sqrt(1.0 - 25.0 * r_k**2), rel=POINT)
    orbits = rb.continue_orbits(branch["H1"], (1.5, 2.5), method="collocation")
    assert orbits.special[-1].period == pytest.approx(6.577284341906, rel=CYCLE)


def test_a_chain_of_brusselators_of_unequal_exchange(places):
    parameters = {"D_x": 0.1, "D_y": 0.8}
    system = rb.load_model("brusselator_chain", variant="4", parameters=parameters)
    assert len(system.states) == 8
    branch = rb.continue_equilibria(system, "B", (1.5, 2.2))
    r = 4.0 * np.sin(np.pi * np.arange(4) / 8.0) ** 2
    turing = 1.0 + 0.1 / 0.8 + 1.0 / (0.8 * r[1:]) + 0.1 * r[1:]
    np.testing.assert_allclose(
        places(branch, "BP", "B"), np.sort(turing[(turing > 1.5) & (turing < 2.2)]), rtol=POINT
    )


@pytest.mark.parametrize("variant", ["1", "many", "-3"])
def test_a_chain_needs_two_cells(variant):
    with pytest.raises(rb.errors.UsageError, match="give a number of cells from 2 on"):
        rb.load_model("brusselator_chain", variant=variant)


def test_lorenz():
    system = rb.load_model("lorenz")
    rest = rb.continue_equilibria(system, "r", (0.0, 30.0))
    assert rest["BP1"].parameters["r"] == pytest.approx(1.0, rel=POINT)
    assert rest["BP1"].kind == "pitchfork"


def test_lorenz_convection_and_its_homoclinic_orbit():
    model = load_module(find("models", "lorenz")).model()
    model = replace(model, guess={"x": 6.0, "y": 6.0, "z": 14.0})  # not at rest
    hopf = rb.continue_equilibria(model, "r", (10.0, 30.0))["H1"]
    assert hopf.parameters["r"] == pytest.approx(470.0 / 19.0, rel=POINT)
    assert hopf.omega == pytest.approx(np.sqrt(1760.0 / 19.0), rel=POINT)
    assert hopf.criticality == "subcritical"
    branch = rb.continue_orbits(hopf, method="collocation")
    assert branch.column("period")[-1] > 3.0 * branch.column("period")[0]
    assert branch.parameter[-1] == pytest.approx(13.926557407520, rel=CYCLE)


def test_lorenz_84(places):
    branch = rb.continue_equilibria(rb.load_model("lorenz_84"), "F", (1.0, 3.5))
    known = {
        1.61965782094258: (0.295286816712987, 0.864734632),
        2.46722212311275: (0.723205920022479, -0.134874605),
        2.85987541274829: (1.1715226466894, 0.303845582),
    }
    np.testing.assert_allclose(places(branch, "H", "F"), sorted(known), rtol=POINT)
    np.testing.assert_allclose(places(branch, "LP", "F"), 1.54664837259813, rtol=POINT)
    for F, (omega, c1) in known.items():
        point = min(branch.special, key=lambda p, F=F: abs(p.parameters["F"] - F))
        assert point.omega == pytest.approx(omega, rel=POINT)
        assert point.c1 == pytest.approx(c1, rel=FORM)
    curve = rb.continue_curve(branch["LP1"], ("F", "T"), ((0.5, 4.0), (-0.1, 0.1)))
    np.testing.assert_allclose(places(curve, "BT", "F"), 2 * [1.44671670111536], rtol=POINT)
    takens = np.array([-0.0209401696833226, 0.0209401696833226])
    np.testing.assert_allclose(places(curve, "BT", "T"), takens, rtol=POINT)
    np.testing.assert_allclose(places(curve, "ZH", "F"), 2 * [1.28341929613827], rtol=POINT)
    np.testing.assert_allclose(np.abs(places(curve, "ZH", "T")), 1.26540834e-4, rtol=1e-8)


def test_roessler():
    system = rb.load_model("roessler")
    hopf = rb.continue_equilibria(system, "a", (0.001, 0.2))["H1"]
    a, b, c = hopf.parameters["a"], 0.2, 5.7
    x = (c - np.sqrt(c**2 - 4.0 * a * b)) / 2.0
    trace, minors, det = a + x - c, 1.0 + a * (x - c) + x / a, a * x / a + x - c
    assert trace * minors == pytest.approx(det, rel=1e-12)  # Routh and Hurwitz
    assert a == pytest.approx(0.005978441849616639, rel=POINT)
    branch = rb.continue_orbits(hopf, method="collocation")
    assert branch["PD1"].parameters["a"] == pytest.approx(0.109638936518, rel=CYCLE)
    end = branch.special[-1]
    assert end.parameters["a"] == 0.2
    assert end.period == pytest.approx(5.88108845555, rel=CYCLE)
    assert end.multipliers[1] == pytest.approx(-2.40395353, rel=1e-5)


@pytest.mark.parametrize(("a", "h", "e", "m"), [(1.0, 1.0, 1.0, 0.5), (1.3, 0.4, 0.9, 0.7)])
def test_rosenzweig_macarthur(a, h, e, m):
    parameters = {"a": a, "h": h, "e": e, "m": m}
    branch = rb.continue_equilibria(
        rb.load_model("rosenzweig_macarthur", parameters=parameters), "K", (0.3, 9.0)
    )
    low = m / (a * (e - m * h))
    assert branch["BP1"].parameters["K"] == pytest.approx(low, rel=POINT)
    hopf = branch["H1"]
    assert hopf.parameters["K"] == pytest.approx(2.0 * low + 1.0 / (a * h), rel=POINT)
    assert hopf.criticality == "supercritical"
    if m == 0.5:
        assert hopf.omega == pytest.approx(1.0 / np.sqrt(6.0), rel=POINT)


def test_bazykin():
    branch = rb.continue_equilibria(rb.load_model("bazykin"), "alpha", (0.1, 0.6))
    curve = rb.continue_curve(branch["LP1"], ("alpha", "delta"), ((0.1, 0.8), (0.05, 0.5)))
    takens = curve["BT1"]
    assert takens.parameters["alpha"] == pytest.approx(0.453624327778129, rel=POINT)
    assert takens.parameters["delta"] == pytest.approx(0.175127592950217, rel=POINT)
    assert abs(takens.a) == pytest.approx(0.0394530911236764, rel=FORM)
    assert abs(takens.b) == pytest.approx(0.0525387764928562, rel=FORM)


def test_adaptive_control():
    hopf = rb.continue_equilibria(rb.load_model("adaptive_control"), "alpha", (0.0, 1.5))["H1"]
    assert hopf.parameters["alpha"] == pytest.approx(1.0, rel=POINT)
    assert hopf.omega == pytest.approx(1.0, rel=POINT)
    assert hopf.c1 == pytest.approx(-0.3, rel=FORM)
    branch = rb.continue_orbits(hopf, method="collocation")
    assert branch["PD1"].parameters["alpha"] == pytest.approx(0.63030200616, rel=CYCLE)
    assert branch["PD1"].period == pytest.approx(6.36407133944, rel=CYCLE)
    assert branch.special[-1].period == pytest.approx(6.43381794597, rel=CYCLE)
    assert not [p for p in branch.special if p.label == "NS"]


def test_co_oxidation(places):
    branch = rb.continue_equilibria(rb.load_model("co_oxidation"), "q_2", (0.8, 1.3))
    known = [1.04099156953262, 1.05155746245773]
    np.testing.assert_allclose(places(branch, "H", "q_2"), known, rtol=POINT)
    known = [1.04204850537853, 1.05220028786995]
    np.testing.assert_allclose(places(branch, "LP", "q_2"), known, rtol=POINT)
    omegas = sorted(p.omega for p in branch.special if p.label == "H")
    np.testing.assert_allclose(omegas, [0.0507403448967863, 0.0591061479357754], rtol=POINT)
    folds = rb.continue_curve(branch["LP1"], ("q_2", "k"), ((0.5, 2.0), (0.1, 1.5)))
    assert folds["CP1"].parameters["q_2"] == pytest.approx(1.00640832967832, rel=POINT)
    assert folds["CP1"].parameters["k"] == pytest.approx(0.355991273208677, rel=POINT)
    curve = rb.continue_curve(branch["H1"], ("q_2", "k"), ((0.5, 2.0), (0.1, 1.5)))
    known = {
        "GH": [0.891318980774319, 0.924255015218579],
        "BT": [1.16119870882174, 1.41762763760065],
    }
    for label, values in known.items():
        np.testing.assert_allclose(places(curve, label, "q_2"), values, rtol=POINT)


def test_langford():
    rho = 0.55510860820595
    system = rb.load_model("langford", parameters={"rho": rho})
    hopf = rb.continue_equilibria(system, "alpha", (-1.5, 1.2))["H1"]
    assert hopf.parameters["alpha"] == pytest.approx((0.343 / 3.0 - 0.6) / 0.7, rel=POINT)
    assert hopf.omega == pytest.approx(3.5, rel=POINT)
    torus = rb.continue_orbits(hopf, method="collocation")["NS1"]
    assert torus.parameters["alpha"] == pytest.approx(0.95, rel=CYCLE)
    assert torus.period == pytest.approx(2.0 * np.pi / 3.5, rel=CYCLE)
    assert 0.49 + (1.457 / 3.0 + 0.343) * rho == pytest.approx(0.95, rel=1e-12)


def test_freire():
    hopf = rb.continue_equilibria(rb.load_model("freire"), "nu", (-0.75, -0.5))["H1"]
    assert hopf.parameters["nu"] == pytest.approx(-0.589336477991794, rel=POINT)
    assert hopf.omega == pytest.approx(0.773448606134865, rel=POINT)
    assert hopf.c1 == pytest.approx(-0.456363001829, rel=FORM)
    branch = rb.continue_orbits(hopf, (-0.6, -0.5), method="collocation")
    assert branch["LPC1"].parameters["nu"] == pytest.approx(-0.584334771866, rel=CYCLE)
    assert branch["LPC1"].period == pytest.approx(8.42647292, rel=CYCLE)
    assert branch["BPC1"].parameters["nu"] == pytest.approx(-0.587028974365, rel=CYCLE)
    assert branch["BPC1"].period == pytest.approx(8.68966962, rel=CYCLE)
