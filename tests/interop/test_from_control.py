"""Models out of control's systems."""

import control
import numpy as np
import pytest

import racs_bif as rb
from racs_bif.errors import ModelError, UsageError
from racs_bif.shelf.load import system_of

S = 1j * np.geomspace(0.1, 100.0, 20)


def swing(t, x, u, params):
    return np.array([x[1], -params["g"] * np.sin(x[0]) - params["b"] * x[1] + u[0]])


@pytest.fixture
def pendulum():
    return control.nlsys(
        swing,
        lambda t, x, u, params: [x[0], np.cos(x[0]) * x[1] + 2 * u[0]],
        inputs=["torque"],
        outputs=["angle", "speed"],
        states=["phi", "rate"],
        params={"g": 9.81, "b": 0.2},
        name="pendulum",
    )


def test_a_state_space_comes_back_as_it_went(vehicle):
    signals = {"inputs": ["delta_f"], "outputs": ["w", "a_y"]}
    plant = rb.to_control(vehicle.with_parameters({"u": 8.0}), **signals)
    model = rb.from_control(plant)
    again = rb.to_control(model, outputs=["a_y"])
    assert model.inputs == ("delta_f",)
    assert again.state_labels == plant.state_labels
    np.testing.assert_allclose(again.A, plant.A, rtol=1e-14)
    np.testing.assert_allclose(again.B, plant.B, rtol=1e-14)
    np.testing.assert_allclose(again.C, plant.C[[1]], rtol=1e-14)
    np.testing.assert_allclose(again.D, plant.D[[1]], rtol=1e-14)


@pytest.mark.parametrize(
    ("numerators", "denominators"),
    [
        ([[[2.0, 1.0]]], [[[1.0, 0.5, 4.0]]]),
        ([[[3.0, 1.0, 2.0]]], [[[1.0, 2.0, 9.0]]]),
        (
            [[[1.0], [2.0, 1.0]], [[0.0], [4.0]], [[1.0, 0.0], [1.0]]],
            [[[1.0, 1.0], [1.0, 3.0, 7.0]], [[1.0], [2.0]], [[1.0, 5.0], [1.0, 0.3, 2.0]]],
        ),
    ],
)
def test_a_transfer_function_keeps_its_response(numerators, denominators):
    system = control.tf(numerators, denominators)
    model = rb.from_control(system, name="plant")
    again = rb.to_control(model, outputs=list(model.outputs))
    known = system(S, squeeze=False)
    np.testing.assert_allclose(again(S, squeeze=False), known, rtol=1e-9, atol=1e-12)
    assert model.name == "plant"


def test_an_oscillator_from_control_has_its_hopf_point():
    """A van der Pol oscillator out of a linear system: the loop is closed by with_feedback."""
    linear = rb.from_control(control.ss([[0, 1], [-4, 0]], [[0], [1]], np.eye(2), 0, name="lin"))
    closed = rb.with_feedback(
        linear, {"u_0": "(mu - x_0**2)*x_1"}, parameters={"mu": -0.5}, name="van_der_pol"
    )
    hopf = rb.continue_equilibria(closed, "mu", (-0.5, 0.5))["H1"]
    assert hopf.parameters["mu"] == pytest.approx(0.0, abs=1e-9)
    assert hopf.omega == pytest.approx(2.0)


def test_a_nonlinear_system_is_recorded(pendulum):
    model = rb.from_control(pendulum)
    assert (model.inputs, model.notes, model.external) == (("torque",), (), None)
    assert {p.name: p.default for p in model.parameters} == {"torque": 0.0, "g": 9.81, "b": 0.2}
    system = system_of(model, parameters={"torque": 0.4})
    x = np.array([0.3, -0.7])
    known = pendulum.dynamics(0.0, x, [0.4])
    np.testing.assert_allclose(system.field.f(x, system.values), known, rtol=1e-14)
    outputs = system.compiled.output_values(x, system.values)
    np.testing.assert_allclose(list(outputs.values()), pendulum.output(0.0, x, [0.4]), rtol=1e-14)
    linear, theirs = rb.to_control(system, outputs=["angle", "speed"]), pendulum.linearize
    theirs = theirs(*control.find_operating_point(pendulum, [0.0, 0.0], [0.4])[:2])
    np.testing.assert_allclose(linear.A, theirs.A, atol=1e-5)


def test_an_interconnection_is_taken_apart(pendulum):
    controller = control.ss(
        [[-1.0]], [[1.0]], [[2.0]], [[0.5]], inputs=["e"], outputs=["torque"], states=["z"]
    )
    loop = control.interconnect(
        [pendulum, controller, control.summing_junction(["r", "-angle"], "e")],
        inputs=["r"],
        outputs=["angle", "torque", "e", "speed"],
        name="loop",
    )
    model = rb.from_control(loop)
    assert not model.notes
    system = system_of(model, parameters={"r": 0.2})
    x = np.array([0.3, -0.7, 0.25])
    np.testing.assert_allclose(
        system.field.f(x, system.values), loop.dynamics(0.0, x, [0.2]), rtol=1e-13
    )
    outputs = system.compiled.output_values(x, system.values)
    np.testing.assert_allclose(list(outputs.values()), loop.output(0.0, x, [0.2]), rtol=1e-13)


def test_a_function_that_cannot_be_recorded_says_so_in_the_notes():
    def table(t, x, u, params):
        return [np.interp(float(x[0]), [-9.0, 0.0, 9.0], [9.0, 0.0, -9.0]) + u[0]]

    system = control.nlsys(table, None, inputs=["u"], outputs=["x"], states=["x"], name="table")
    model = rb.from_control(system)
    assert model.external is not None
    assert len(model.notes) == 1


def test_what_no_model_can_be_made_of(pendulum):
    with pytest.raises(UsageError, match="discrete time"):
        rb.from_control(control.ss([[0.5]], [[1]], [[1]], [[0]], dt=0.1))
    with pytest.raises(UsageError, match="has no equations"):
        rb.from_control(control.frd([1.0, 2.0], [1.0, 2.0]))
    with pytest.raises(UsageError, match="int is no system"):
        rb.from_control(3)
    with pytest.raises(ModelError, match="has no equations"):
        rb.from_control(control.tf([5], [2]))
    with pytest.raises(ModelError, match="is called 't'"):
        rb.from_control(control.nlsys(swing, inputs=["t"], states=["a", "b"], outputs=2))
    with pytest.raises(ModelError, match="differentiates"):
        rb.from_control(control.tf([1, 0, 0], [1, 1]))


def test_a_system_without_outputs_of_its_own_gives_its_states():
    def rates(t, x, u, params):
        return np.array([x[1], -x[0] + u[0]])

    plain = control.nlsys(rates, None, inputs=["f"], outputs=2, states=["x", "v"], name="bare")
    model = rb.from_control(plain)
    assert [str(e) for e in model.outputs.values()] == ["x", "v"]


def test_names_that_begin_with_a_digit():
    system = control.ss([[-1.0]], [[1.0]], [[1.0]], [[0.0]], inputs=["2nd"], states=["1st"])
    model = rb.from_control(system)
    assert list(model.equations) == ["_1st"]
    assert model.inputs == ("_2nd",)
