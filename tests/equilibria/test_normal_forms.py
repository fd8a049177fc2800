"""Coefficients of normal forms through nonlinear changes of coordinates."""

from __future__ import annotations

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.verbs.curves import continue_curve

DISGUISES = [(1.0, 0.0), (2.0, 0.3), (0.5, -0.4)]
BAUTIN = {
    "x": "b1*x - y*(1 + e*r2) + x*(b2*r2 + l*r2**2)",
    "y": "x*(1 + e*r2) + b1*y + y*(b2*r2 + l*r2**2)",
}


def radial(text, r2="(x**2+y**2)"):
    return text.replace("r2", r2)


@pytest.mark.parametrize(("scale", "bend"), DISGUISES)
def test_hopf_coefficient(disguise, scale, bend):
    equations = {k: radial(v) for k, v in BAUTIN.items()}
    values = {"b1": -0.5, "b2": 0.3, "l": -1.0, "e": 0.4}
    model = disguise("bautin", equations, values, scale=scale, bend=bend)
    hopf = rb.continue_equilibria(model, "b1", (-0.6, 0.6))["H1"]
    # w = (x + i y) / sqrt(2) / scale has unit eigenvector: r2 = 2 |w|^2 / scale^2.
    assert hopf.c1 == pytest.approx(2.0 * 0.3 / scale**2, rel=1e-8)
    assert hopf.criticality == "subcritical"


@pytest.mark.parametrize(("scale", "bend"), DISGUISES)
def test_second_lyapunov_coefficient(disguise, curve_through, scale, bend):
    equations = {k: radial(v) for k, v in BAUTIN.items()}
    values = {"b1": -0.5, "b2": 0.3, "l": -1.0, "e": 0.4}
    model = disguise("bautin", equations, values, scale=scale, bend=bend)
    curve = curve_through(model, ("b1", "b2"), ((-0.6, 0.6), (-1.0, 1.0)), "H1")
    point = curve["GH1"]
    assert len(curve.special) == 1
    assert abs(point.parameters["b1"]) < 1e-9
    assert abs(point.parameters["b2"]) < 1e-9
    assert point.l2 == pytest.approx(-4.0 / scale**4, rel=1e-7)


@pytest.mark.parametrize(("scale", "bend"), DISGUISES)
def test_cusp_coefficient(disguise, curve_through, scale, bend):
    equations = {"x": "h + m*x + c*x**3", "y": "-2*y + 0.3*x**2*s"}
    values = {"h": -0.5, "m": 0.4, "c": -1.5, "s": 0.0}
    model = disguise("cusp", equations, values, scale=scale, bend=bend)
    curve = curve_through(model, ("h", "m"), ((-0.6, 0.6), (-1.0, 1.0)), "LP1")
    point = curve["CP1"]
    assert abs(point.parameters["h"]) < 1e-10
    assert abs(point.parameters["m"]) < 1e-8
    assert point.c == pytest.approx(-1.5 / scale**2, rel=1e-6)


@pytest.mark.parametrize("start", ["LP1", "H1"])
@pytest.mark.parametrize(("scale", "bend"), DISGUISES)
def test_bogdanov_takens_coefficients(disguise, curve_through, scale, bend, start):
    equations = {"x": "y", "y": "b1 + b2*y + a*x**2 + b*x*y"}
    values = {"b1": -0.5, "b2": 0.4, "a": 1.3, "b": -0.7}
    model = disguise("takens", equations, values, scale=scale, bend=bend)
    if start == "H1":
        # The Hopf point is on the other side of the fold: follow the fold back from there.
        folds = curve_through(model, ("b1", "b2"), ((-0.6, 0.6), (-1.0, 1.0)), "LP1")
        curve = continue_curve(folds["BT1"], ("b1", "b2"), ((-0.6, 0.6), (-1.0, 1.0)))
        assert curve.method == "Hopf curve"
    else:
        curve = curve_through(model, ("b1", "b2"), ((-0.6, 0.6), (-1.0, 1.0)), start)
    point = curve["BT1"]
    assert abs(point.parameters["b1"]) < 1e-9
    assert abs(point.parameters["b2"]) < 1e-9
    assert abs(point.a) == pytest.approx(1.3 / scale, rel=1e-7)
    assert abs(point.b) == pytest.approx(0.7 / scale, rel=1e-7)
    assert point.a * point.b < 0.0


ZERO_HOPF = {
    "z": "m1 + z**2 + s*(x**2+y**2) + k*z**3",
    "x": "(m2 + t*z + z**2)*x - 2*y",
    "y": "(m2 + t*z + z**2)*y + 2*x",
}


@pytest.mark.parametrize(("s", "t"), [(1.0, 0.8), (-1.0, 0.8), (1.0, -1.2), (-1.0, -0.6)])
@pytest.mark.parametrize(("scale", "bend"), DISGUISES[1:2])
def test_zero_hopf(disguise, curve_through, scale, bend, s, t):
    values = {"m1": -0.5, "m2": 0.2, "s": s, "t": t, "k": 0.1}
    model = disguise("zero-Hopf", ZERO_HOPF, values, scale=scale, bend=bend)
    curve = curve_through(model, ("m1", "m2"), ((-0.6, 0.3), (-1.0, 1.0)), "LP1")
    point = curve["ZH1"]
    assert abs(point.parameters["m2"]) < 1e-9
    assert point.omega == pytest.approx(2.0, rel=1e-9)
    assert point.s == s
    assert point.theta == pytest.approx(t / 2.0, rel=1e-7)
    assert ("ns" in point.starts) == (s * t < 0.0)
    hopf = continue_curve(point, ("m1", "m2"), ((-0.6, 0.3), (-1.0, 1.0)))
    assert hopf.method == "Hopf curve"
    other = hopf["ZH1"]
    for key in ("theta", "E", "s"):
        assert getattr(other, key) == pytest.approx(getattr(point, key), rel=1e-6)


DOUBLE_HOPF = {
    "x": "(m1 + p11*(x**2+y**2) + p12*(z**2+w**2))*x - y",
    "y": "(m1 + p11*(x**2+y**2) + p12*(z**2+w**2))*y + x",
    "z": "(m2 + p21*(x**2+y**2) + p22*(z**2+w**2))*z - g*w",
    "w": "(m2 + p21*(x**2+y**2) + p22*(z**2+w**2))*w + g*z",
}


@pytest.mark.parametrize(
    ("p", "scale", "bend", "case"),
    [
        ((-1.0, -2.0, -3.0, -1.5), 2.0, 0.0, "simple case I"),
        ((-1.0, -0.5, -0.4, -1.5), 1.0, 0.0, "simple case II"),
        ((-1.0, 0.5, 0.4, -1.5), 0.5, 0.0, "simple case IV"),
        ((-1.0, -2.0, 3.0, 1.5), 1.0, 0.2, "difficult case VI"),
    ],
)
def test_double_hopf(disguise, curve_through, scale, bend, p, case):
    names = ("p11", "p12", "p21", "p22")
    values = {"m1": -0.5, "m2": -0.3, "g": 2.0**0.5} | dict(zip(names, p, strict=True))
    model = disguise("double Hopf", DOUBLE_HOPF, values, scale=scale, bend=bend)
    curve = curve_through(model, ("m1", "m2"), ((-0.6, 0.6), (-1.0, 1.0)), "H1")
    point = curve["HH1"]
    assert len(curve.special) == 1
    assert np.abs(list(point.parameters.values())).max() < 1e-9
    found = np.array([getattr(point, name) for name in names])
    np.testing.assert_allclose(found, 2.0 * np.array(p) / scale**2, rtol=1e-7)
    assert point.unfolding == case
    other = continue_curve(point, ("m1", "m2"), ((-0.6, 0.6), (-1.0, 1.0)))
    np.testing.assert_allclose(other.column("omega"), 2.0**0.5, rtol=1e-9)
    same = continue_curve(point, ("m1", "m2"), ((-0.6, 0.6), (-1.0, 1.0)), kind="hopf")
    np.testing.assert_allclose(same.column("omega"), 1.0, rtol=1e-9)


def test_strong_resonance_is_named(disguise, curve_through):
    values = {"m1": -0.5, "m2": -0.3, "g": 2.0, "p11": -1.0, "p12": 0.0, "p21": 0.0, "p22": -1.0}
    model = disguise("resonant", DOUBLE_HOPF, values, bend=0.0)
    curve = curve_through(model, ("m1", "m2"), ((-0.6, 0.6), (-1.0, 1.0)), "H1")
    assert curve["HH1"].resonance == "1:2"
    assert "unfolding" not in curve["HH1"].data


def test_a_conservative_centre_has_no_generalised_hopf_points(curve_through):
    # l1 is zero but for rounding all along the curve: nothing is reported.
    model = rb.model_from_strings(
        "centre",
        {"x": "y + m*x*(1 + k)", "y": "-x - x**3*k"},
        parameters={"m": -0.5, "k": 1.0},
        guess={"x": 0.0, "y": 0.0},
    )
    curve = curve_through(model, ("m", "k"), ((-0.6, 0.6), (0.5, 2.0)), "H1")
    assert not curve.special
    assert np.abs(curve.column("l1")).max() < 1e-12
