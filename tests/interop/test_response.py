"""Frequency responses of the exact operator."""

import control
import numpy as np
import pytest

import racs_bif as rb
from racs_bif.errors import UsageError
from racs_bif.shelf.load import system_of

OMEGA = np.geomspace(0.2, 40.0, 25)


def straight_running(p, omega):
    """Return (v, w, delta_c) over delta_f by the equations of model.md, section 2, linear."""
    answer = []
    M = np.array(
        [
            [p["m"] + p["m_c"], -(p["b"] - p["e"]) * p["m_c"], p["e"] * p["m_c"]],
            [
                (p["b"] - p["c"]) * p["m_c"],
                -((p["b"] - p["e"]) * (p["b"] - p["c"]) * p["m_c"] + p["I_z"]),
                p["e"] * (p["b"] - p["c"]) * p["m_c"],
            ],
            [
                (p["c"] - p["e"]) * p["m_c"],
                -((p["c"] - p["e"]) * (p["b"] - p["e"]) * p["m_c"] + p["I_cs"]),
                p["e"] * (p["c"] - p["e"]) * p["m_c"] - p["I_cs"],
            ],
        ]
    )
    F = np.array(
        [
            [1.0, 1.0, 0.0],
            [-p["a"], p["b"] - p["c"], p["d"] - p["c"]],
            [0.0, p["c"], -(p["d"] - p["c"])],
        ]
    )
    front, rear = (p[f"B_{k}"] * p[f"C_{k}"] * p[f"D_{k}"] for k in "fr")
    for w in omega:
        s = 1j * w
        Z = (1 + (p["tau_sig"] * s) ** p["gamma"]) / (1 + (p["tau_eps"] * s) ** p["alpha"])
        forces = np.array(
            [
                [front / p["u"], front * p["a"] / p["u"], 0.0],
                [rear / p["u"], -rear * p["b"] / p["u"], rear],
                [0.0, 0.0, -p["C_s"] * Z],
            ]
        )
        drift = np.zeros((3, 3))
        drift[0, 1] = -p["m"] * p["u"]
        left = M @ np.diag([s, s, s**2]) - drift - F @ forces
        answer.append(np.linalg.solve(left, F @ np.array([-front, 0.0, 0.0])))
    return np.array(answer).T


def test_the_vehicle_follows_the_equations_of_the_paper(vehicle):
    straight = vehicle.with_parameters({"delta_f": 0.0, "u": 14.0})
    names = ["v", "w", "delta_c"]
    exact = rb.frequency_response(straight, OMEGA, inputs=["delta_f"], outputs=names)
    known = straight_running(straight.parameters, OMEGA)
    np.testing.assert_allclose(exact.frdata[:, 0, :], known, rtol=1e-11)
    assert isinstance(exact, control.FrequencyResponseData)
    assert (exact.input_labels, exact.output_labels) == (["delta_f"], names)


def test_the_realisation_is_as_good_as_it_says(equilibria, vehicle):
    point = equilibria.at(u=8)
    signals = {"inputs": ["delta_f", "u"], "outputs": ["w", "F_d"], "forces": ["ddelta_c"]}
    exact = rb.frequency_response(point, OMEGA, **signals)
    realised = rb.to_control(point, **signals)(1j * OMEGA)
    error = np.abs(realised / exact.frdata - 1.0).max()
    assert 0.0 < error < 3 * vehicle.realisation.error


def test_two_elements_are_related_by_their_laws(two_elements):
    names = ["x", "y", "w", "z"]
    exact = rb.frequency_response(two_elements, OMEGA, inputs=["f"], outputs=names)
    x, y, w, z = exact.frdata[:, 0, :]
    s = 1j * OMEGA
    np.testing.assert_allclose(w, s**0.5 * (x + 0.1 * y), rtol=1e-12)
    np.testing.assert_allclose(z, (x + 0.2 * w) / (1 + s**0.6), rtol=1e-12)


def test_zero_frequency_is_the_static_gain(vehicle):
    at = vehicle.with_parameters({"u": 8.0})
    static = rb.frequency_response(at, [0.0], inputs=["delta_f"], outputs=["delta_c"])
    h = 1e-6
    ends = [at.with_parameters({"delta_f": 0.01 + k * h}).equilibrium()[2] for k in (1, -1)]
    assert static.frdata[0, 0, 0] == pytest.approx((ends[0] - ends[1]) / (2 * h), rel=1e-7)


def test_the_element_exactly_and_as_it_is_realised(vehicle):
    s = 1j * OMEGA
    exact = rb.element_response(vehicle, "delta_z", OMEGA)
    np.testing.assert_allclose(exact.frdata[0, 0], (1 + s**0.7) / (1 + s**0.3), rtol=1e-13)
    realised = rb.element_transfer(vehicle)
    assert isinstance(realised, control.TransferFunction)
    filter_ = vehicle.field.frame(vehicle.values).filters[0]
    np.testing.assert_allclose(realised(s), filter_(s), rtol=1e-8)
    assert np.abs(realised(s) / exact.frdata[0, 0] - 1.0).max() < 2 * vehicle.realisation.error


def test_an_element_that_integrates():
    system = system_of(
        rb.model_from_strings("i", {"x": "-w"}, parameters={}, elements=[("w", "x", "s**(-0.5)")])
    )
    realised = rb.element_transfer(system, "w")
    s = 1j * np.array([1.0, 10.0])
    np.testing.assert_allclose(realised(s), s**-0.5, rtol=1e-2)
    for call in (rb.element_response, rb.loop_response):
        with pytest.raises(UsageError, match="integrates"):
            call(system, "w", [0.0, 1.0])


def test_without_frequencies_the_band_and_its_surroundings_are_taken(vehicle):
    omega = rb.element_response(vehicle).omega
    low, high = vehicle.settings.band
    assert omega[0] == pytest.approx(low / 100)
    assert omega[-1] == pytest.approx(high * 100)


@pytest.mark.parametrize(
    "call",
    [
        lambda v: rb.frequency_response(v, [2.0, 1.0]),
        lambda v: rb.frequency_response(v, [-1.0, 1.0]),
        lambda v: rb.frequency_response(v, []),
    ],
)
def test_frequencies_ascend(vehicle, call):
    with pytest.raises(UsageError, match="finite and ascend"):
        call(vehicle)


def test_elements_that_are_not_there(vehicle, two_elements):
    with pytest.raises(UsageError, match="did you mean 'delta_z'"):
        rb.element_response(vehicle, "delta_zz")
    with pytest.raises(UsageError, match="name one of w, z"):
        rb.element_transfer(two_elements)
    plain = rb.model_from_strings("plain", {"x": "-x"}, parameters={})
    with pytest.raises(UsageError, match="no fractional element"):
        rb.loop_response(plain)
