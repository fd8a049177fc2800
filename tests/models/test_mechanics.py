"""The towed wheel and the car against their known results."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar

import racs_bif as rb

POINT = 1e-8
CYCLE = 1e-6


@pytest.mark.parametrize(
    "changed", [{}, {"b": 0.3, "l": 0.2, "J": 0.1, "d": 40.0}, {"b": 0.15, "J": 0.3, "d": 100.0}]
)
def test_a_towed_wheel_begins_to_shimmy_where_routh_says(changed):
    system = rb.load_model("towed_wheel", parameters=changed)
    m, J, b, length, k, d = (system.parameters[name] for name in "mJblkd")
    inertia, ahead = J + m * (length - b) ** 2, m * (length - b)
    # (ahead v + d l^2) (k l + d v) = inertia k v
    terms = [ahead * d, ahead * k * length + d**2 * length**2 - inertia * k, d * k * length**3]
    speed = min(v.real for v in np.roots(np.trim_zeros(terms, "f")) if v.real > 0.0)
    branch = rb.continue_equilibria(
        system.with_parameters({"v": 0.9 * speed}), "v", (0.8 * speed, 1.2 * speed)
    )
    hopf = branch["H1"]
    assert hopf.parameters["v"] == pytest.approx(speed, rel=POINT)
    omega = math.sqrt(k * length * speed / (ahead * speed + d * length**2))
    assert hopf.omega == pytest.approx(omega, rel=POINT)


def test_shimmy_is_there_below_the_critical_speed():
    branch = rb.continue_equilibria(rb.load_model("towed_wheel"), "v", (1.0, 8.0))
    hopf = branch["H1"]
    assert hopf.parameters["v"] == pytest.approx(40.0 / 9.0, rel=POINT)
    assert hopf.omega == pytest.approx(200.0 / 3.0, rel=POINT)
    assert hopf.criticality == "subcritical"
    orbits = rb.continue_orbits(hopf, (1.0, 8.0), method="collocation")
    fold = orbits["LPC1"]
    assert fold.parameters["v"] == pytest.approx(3.5428321910, rel=CYCLE)
    assert fold.period == pytest.approx(0.138006224464, rel=CYCLE)
    assert not orbits.stable[1 : fold.index].any()
    assert orbits.stable[fold.index + 1 :].all()


def test_the_wheel_does_not_slip_and_its_energy_is_accounted_for():
    """Without damping and towing the energy of wheel and spring does not change."""
    system = rb.load_model("towed_wheel", parameters={"v": 1e-12, "d": 0.0, "b": 0.15})
    m, J, b, length, k = (system.parameters[name] for name in "mJblk")

    def energy(state):
        psi, omega, y = state
        rate = length * omega / math.cos(psi)
        lateral = rate - b * omega * math.cos(psi)
        forward = b * omega * math.sin(psi)
        return 0.5 * (m * (lateral**2 + forward**2) + J * omega**2 + k * y**2)

    for state in ([0.3, 2.0, 0.01], [0.9, -5.0, 0.02], [-0.5, 1.0, -0.03]):
        x = np.array(state)
        rate = system.field.f(x, system.values)
        slope = [(energy(x + 1e-5 * e) - energy(x - 1e-5 * e)) / 2e-5 for e in np.eye(3)]
        power = np.dot(slope, rate)
        assert abs(power) < 1e-7 * np.linalg.norm(slope) * np.linalg.norm(rate)


def tyre(slip, B, C, D, E):
    return D * np.sin(C * np.arctan(B * (1 - E) * slip + E * np.arctan(B * slip)))


def test_the_critical_speed_of_an_oversteering_car():
    system = rb.load_model("bicycle_car")
    p = system.parameters
    front, rear = (abs(p[f"B_{i}"] * p[f"C_{i}"] * p[f"D_{i}"]) for i in "fr")
    a, b, m = p["a"], p["b"], p["m"]
    critical = (a + b) * math.sqrt(front * rear / (m * (a * front - b * rear)))
    point = rb.continue_equilibria(system, "u", (20.0, 60.0))["BP1"]
    assert point.kind == "pitchfork"
    assert point.parameters["u"] == pytest.approx(critical, rel=POINT)
    assert critical == pytest.approx(43.66373, rel=1e-7)


def test_with_the_centre_of_gravity_of_the_paper_the_car_understeers():
    system = rb.load_model("bicycle_car", parameters={"a": 1.46, "b": 1.54})
    assert not rb.continue_equilibria(system, "u", (5.0, 100.0)).special


def test_steady_cornering_ends_in_a_fold():
    system = rb.load_model("bicycle_car", parameters={"u": 30.0})
    p = system.parameters
    a, b, m, u = p["a"], p["b"], p["m"], p["u"]

    def slip(axle, force):
        B, C, D, E = (p[f"{name}_{axle}"] for name in "BCDE")
        return brentq(lambda x: tyre(x, B, C, D, E) - force, -0.15, 0.15, xtol=1e-15)

    def steering(w):
        share = m * u * w / (a + b)
        return (a + b) * w / u - (slip("f", b * share) - slip("r", a * share))

    best = minimize_scalar(lambda w: -steering(w), bounds=(0.0, 0.15), method="bounded")
    branch = rb.continue_equilibria(system, "delta_f", (-0.05, 0.05))
    assert sorted(point.label for point in branch.special) == ["LP", "LP"]
    folds = sorted(point.parameters["delta_f"] for point in branch.special)
    assert folds[1] == pytest.approx(-best.fun, rel=POINT)
    assert folds[0] == pytest.approx(-folds[1], rel=POINT)
    assert folds[1] == pytest.approx(0.004039293, rel=1e-6)
