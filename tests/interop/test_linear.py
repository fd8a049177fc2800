"""Linearisations as control.StateSpace."""

import control
import numpy as np
import pytest

import racs_bif as rb
from racs_bif.errors import ParameterError, UsageError
from racs_bif.shelf.load import system_of


def test_the_poles_are_the_eigenvalues_of_the_branch(equilibria):
    point = equilibria.at(u=12)
    plant = rb.to_control(point)
    found, known = np.sort_complex(plant.poles()), np.sort_complex(point.eigenvalues)
    np.testing.assert_allclose(found, known, rtol=1e-6, atol=1e-9)
    assert isinstance(plant, control.StateSpace)


def test_signals_have_names(equilibria):
    plant = rb.to_control(equilibria.at(u=12), forces=["v", "w"])
    assert plant.input_labels == ["delta_f", "force_v", "force_w"]
    assert plant.output_labels[:5] == ["v", "w", "delta_c", "ddelta_c", "alpha_f"]
    assert plant.state_labels[3:5] == ["ddelta_c", "memory_of_delta_z_1"]
    assert plant.name == "racs"


def test_a_model_without_inputs_of_its_own_has_all_its_parameters(two_elements):
    assert rb.to_control(two_elements).input_labels == ["k", "a", "f"]
    assert rb.to_control(two_elements, forces=["y"]).input_labels == ["force_y"]


def test_all_four_matrices_are_derivatives(two_elements):
    system = system_of(two_elements)
    names = ["x", "w", "z", "power", "load"]
    plant = rb.to_control(system, inputs=["f", "a"], outputs=names)
    x0, p0 = system.equilibrium(), system.values

    def outputs(x, p):
        frame = system.field.frame(p)
        X = system.field.core_point(x, p)
        e = system.compiled.core(X, frame.P)[2:]
        w = X[2:] + frame.P[len(p) :] * e
        values = system.compiled.output_values(X, frame.P)
        return np.array([x[0], *w, values["power"], values["load"]])

    def both(x, p):
        return np.concatenate([system.field.f(x, p), outputs(x, p)])

    h = 1e-6
    by_x = [(both(x0 + h * e, p0) - both(x0 - h * e, p0)) / (2 * h) for e in np.eye(len(x0))]
    by_u = [
        (both(x0, p0 + h * e) - both(x0, p0 - h * e)) / (2 * h)
        for e in (np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0]))
    ]
    n = len(x0)
    stacked = np.block([[plant.A, plant.B], [plant.C, plant.D]])
    differences = np.column_stack([*by_x, *by_u])
    np.testing.assert_allclose(stacked, differences, rtol=1e-6, atol=1e-6 * np.abs(plant.A).max())
    assert plant.D[names.index("load"), 0] == pytest.approx(1.0)
    assert n == plant.nstates


def test_a_force_goes_through_the_mass_matrix(vehicle):
    """Against a parameter that is added to the same equation."""
    pushed = rb.with_feedback(vehicle, forces={"w": "T"}, parameters={"T": 0.0})
    at = {"u": 14.0}
    wanted = rb.to_control(system_of(pushed, parameters=at), inputs=["T"], outputs=["w", "a_y"])
    found = rb.to_control(
        vehicle.with_parameters(at), inputs=[], outputs=["w", "a_y"], forces=["w"]
    )
    np.testing.assert_allclose(found.B, wanted.B, rtol=1e-12, atol=1e-16)
    np.testing.assert_allclose(found.A, wanted.A, rtol=1e-10, atol=1e-9)


def test_a_derived_parameter_acts_through_what_it_sets(vehicle):
    at = vehicle.with_parameters({"u": 12.0})
    by_stiffness = rb.to_control(at, inputs=["C_s"], outputs=["v"])
    by_area = rb.to_control(at, inputs=["A_h"], outputs=["v"])
    ratio = at.parameters["C_s"] / at.parameters["A_h"]
    np.testing.assert_allclose(by_stiffness.B * ratio, by_area.B, rtol=1e-10)


def test_the_step_response_is_the_simulated_one(vehicle):
    at, size = vehicle.with_parameters({"u": 8.0}), 1e-5
    plant = rb.to_control(at, inputs=["delta_f"], outputs=["w", "delta_c"])
    start = at.equilibrium()
    base = at.parameters["delta_f"]
    done = rb.simulate(
        at,
        2.0,
        operator="realised",
        initial=dict(zip(at.states, start, strict=False)),
        history="equilibrium",
        inputs={"delta_f": {0.0: base + size}},
        tolerance=1e-11,
    )
    answer = control.forced_response(
        plant, timepts=np.linspace(0.0, 2.0, 801), inputs=np.full((1, 801), size)
    )
    for k, name in enumerate(("w", "delta_c")):
        moved = done.column(name) - start[at.states.index(name)]
        linear = np.interp(done.times, answer.time, answer.outputs[k])
        assert np.abs(moved).max() > 0.0
        np.testing.assert_allclose(moved, linear, atol=2e-3 * np.abs(moved).max())


def test_points_from_files_and_from_their_branches(equilibria, tmp_path):
    rb.save(equilibria, tmp_path / "eq.nc")
    loaded = rb.load(tmp_path / "eq.nc")
    with pytest.raises(UsageError, match=r"branch\.at\(u="):
        rb.to_control(loaded["H1"])
    again = rb.to_control(loaded.at(u=loaded["H1"].parameters["u"]))
    np.testing.assert_array_equal(again.A, rb.to_control(equilibria["H1"]).A)


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"inputs": ["delta"]}, ParameterError, "did you mean 'delta_f'"),
        ({"inputs": ["alpha"]}, ParameterError, "a law of the model depends on 'alpha'"),
        ({"inputs": ["u", "u"]}, UsageError, "'u' is twice"),
        ({"outputs": ["vv"]}, UsageError, "unknown output 'vv'"),
        ({"forces": ["vv"]}, UsageError, "unknown state 'vv'"),
        ({"inputs": []}, UsageError, "needs an input"),
    ],
)
def test_what_cannot_be_linearised_is_said(vehicle, options, error, message):
    with pytest.raises(error, match=message):
        rb.to_control(vehicle, **options)


def test_an_orbit_is_no_operating_point(equilibria):
    orbits = rb.continue_orbits(equilibria["H1"], span=(10, 10.6))
    with pytest.raises(UsageError, match="is no equilibrium"):
        rb.to_control(orbits.special[-1])
