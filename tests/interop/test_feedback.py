"""Feedback put around models."""

import math
from dataclasses import replace

import control
import numpy as np
import pytest

import racs_bif as rb
from racs_bif.errors import ModelError
from racs_bif.shelf.load import system_of


@pytest.fixture(scope="module")
def pendulum():
    return rb.model_from_strings(
        "pendulum",
        {"x": "y", "y": "sin(x) + T*(1 + x**2)"},
        parameters={"T": 0.0, "r": 0.1},
        outputs={"arm": "sin(x)", "load": "T + r"},
    )


def test_gains_of_lqr_place_the_poles_that_lqr_promises(pendulum):
    plant = rb.to_control(pendulum, inputs=["T"])
    gain, _, poles = control.lqr(plant.A, plant.B, np.eye(2), [[1.0]])
    held = rb.with_feedback(pendulum, {"T": dict(zip(plant.state_labels, gain[0], strict=True))})
    found = rb.to_control(held).poles()
    np.testing.assert_allclose(np.sort_complex(found), np.sort_complex(poles), rtol=1e-10)
    assert held.name == "pendulum_feedback"
    assert [p.name for p in held.parameters] == ["T", "r", "k_T_x", "k_T_y"]


def test_the_reference_stays_where_the_law_names_it(pendulum):
    gone = rb.with_feedback(pendulum, {"T": "-2*arm"})
    kept = rb.with_feedback(pendulum, {"T": "T - 2*arm"})
    assert "T" not in [p.name for p in gone.parameters]
    assert "T" in [p.name for p in kept.parameters]
    assert str(gone.equations["y"]) == "-2*(x**2 + 1)*sin(x) + sin(x)"
    assert str(gone.outputs["load"]) == "r - 2*sin(x)"


def test_forces_are_added_before_the_mass_matrix(vehicle):
    damped = rb.with_feedback(vehicle, forces={"ddelta_c": "k*ddelta_c"}, parameters={"k": 0.0})
    assert damped.mass == rb.with_feedback(vehicle).mass
    before = rb.continue_equilibria(damped, "u", (5, 15))["H1"].exact
    assert before.parameters["u"] == pytest.approx(10.2, rel=1e-9)
    more = system_of(damped, parameters={"k": 60.0})
    after = rb.continue_equilibria(more, "u", (5, 30))["H1"].exact
    assert after.parameters["u"] > 10.5


def test_the_feedback_may_measure_a_fractional_element(vehicle):
    """T = -k delta_z in parallel with the unit is as much stiffness more."""
    p = vehicle.parameters
    stiffer = rb.with_feedback(
        vehicle,
        forces={"w": "-k*delta_z", "ddelta_c": "k*delta_z"},
        parameters={"k": 0.1 * p["C_s"] * (p["d"] - p["c"])},
    )
    found = rb.spectrum(stiffer, above=-5.0).roots.roots
    known = rb.spectrum(vehicle.with_parameters({"C_s": 1.1 * p["C_s"]}), above=-5.0).roots.roots
    np.testing.assert_allclose(np.sort_complex(found), np.sort_complex(known), rtol=1e-8)


def test_inputs_follow(vehicle):
    model = rb.with_feedback(
        vehicle, forces={"w": "T"}, parameters={"T": 0.0}, inputs=["T"], name="pushed"
    )
    assert model.inputs == ("delta_f", "T")
    assert rb.with_feedback(model, {"T": "-w"}).inputs == ("delta_f",)
    values = {q.name: q.default for q in model.parameters}
    assert values["A_h"] == vehicle.parameters["A_h"]


@pytest.mark.parametrize(
    ("laws", "options", "message"),
    [
        ({"TT": "x"}, {}, "unknown parameter 'TT'; did you mean 'T'"),
        ({"T": {"z": 1.0}}, {}, "'z' cannot be fed back"),
        ({"T": "-load"}, {}, "algebraic loop"),
        ({"T": "-q*x"}, {}, "unknown symbol 'q'"),
        ({}, {"forces": {"z": "x"}}, "unknown state 'z'"),
        ({}, {"inputs": ["q"]}, "input 'q' is no parameter"),
    ],
)
def test_what_cannot_be_fed_back_is_said(pendulum, laws, options, message):
    with pytest.raises(ModelError, match=message):
        rb.with_feedback(pendulum, laws, **options)


def test_what_is_constant_in_time_is_not_fed_back_to(vehicle):
    for name, where in (("alpha", "the law of 'delta_z'"), ("A_h", "derived parameter 'C_s'")):
        with pytest.raises(ModelError, match=where):
            rb.with_feedback(vehicle, {name: "w"})


def test_where_equations_are_not_to_be_had(pendulum):
    with pytest.raises(ModelError, match="give the Model"):
        rb.with_feedback(system_of(pendulum))
    from racs_bif.shelf import find, load_module

    with pytest.raises(ModelError, match="is to be calibrated"):
        rb.with_feedback(load_module(find("models", "racs")).model())


def test_terms_are_looked_into_for_what_closes_a_loop():
    def rates(x, p):
        pull = sum(math.cos(k * x[0]) for k in range(1, 18))
        push = sum(math.sin(k * p.T) for k in range(1, 18))
        return [x[1] + 2 * pull, push - x[0]]

    recorded = rb.model_from_function("long", rates, states="x y", parameters={"T": 0.0})
    assert len(recorded.terms) > 1
    direct = replace(recorded, outputs={"push": recorded.equations["y"]})
    with pytest.raises(ModelError, match="output 'push' depends on 'T' without delay"):
        rb.with_feedback(direct, {"T": "2*push"})
    delayed = replace(recorded, outputs={"pull": recorded.equations["x"]})
    held = rb.with_feedback(delayed, {"T": "2*pull"})
    used = {str(symbol) for e in held.terms.values() for symbol in e.free_symbols}
    assert {"x", "y"} <= used
    assert "T" not in used


def test_terms_are_put_in_an_order_in_which_each_is_known():
    """The output fed back uses a later term than the one that the law goes into."""

    def rates(x, p):
        push = sum(math.sin(k * p.T) for k in range(1, 30))
        pull = sum(math.cos(k * x[0]) for k in range(1, 30))
        return [x[1] + 2 * pull, push * x[1] - x[0]]

    model = rb.model_from_function("long", rates, states="x y", parameters={"T": 0.0})
    pull = model.equations["x"]
    fed = system_of(rb.with_feedback(replace(model, outputs={"pull": pull}), {"T": "pull"}))
    x = np.array([0.3, 0.7])
    rate = x[1] + 2 * sum(math.cos(k * x[0]) for k in range(1, 30))
    push = sum(math.sin(k * rate) for k in range(1, 30))
    np.testing.assert_allclose(fed.field.f(x, fed.values), [rate, push * x[1] - x[0]], rtol=1e-9)
