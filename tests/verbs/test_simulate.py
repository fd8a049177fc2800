import numpy as np
import pytest

import racs_bif as rb
from racs_bif.errors import ConvergenceError, ParameterError, UsageError
from racs_bif.fractional.mittag_leffler import mittag_leffler


def relaxation():
    return rb.model_from_strings(
        "relaxation", {}, parameters={"k": 1.0}, elements=[("x", "-k*x", "s**(-0.5)")]
    )


@pytest.fixture(scope="module")
def vehicle():
    return rb.load_model("racs", parameters={"u": 12})


def test_the_tolerance_is_reached_by_smaller_steps():
    done = rb.simulate(relaxation(), 2.0, initial={"x": 1.0}, tolerance=1e-6)
    exact = mittag_leffler(0.5, 1.0, -np.sqrt(done.times))
    late = done.times >= 0.2
    worst = np.abs(done.column("x") - exact)[late].max()
    assert worst < 1e-6 * np.ptp(exact)
    # The estimate is that error, not just a bound.
    assert done.errors["x"] == pytest.approx(worst, rel=0.2)
    assert not done.early
    assert done.stopped == "The duration is over."


def test_a_step_is_rounded_down_and_extrapolation_gains_an_order():
    model = relaxation()
    plain = rb.simulate(model, 1.0, initial={"x": 1.0}, step=0.01)
    assert (plain.step, len(plain)) == (pytest.approx(0.01), 101)
    assert len(rb.simulate(model, 1.0, initial={"x": 1.0}, step=0.013)) == 79
    better = rb.simulate(model, 1.0, initial={"x": 1.0}, step=0.01, extrapolate=True)
    exact = 0.4275835762
    assert better.extrapolated
    assert better.times == pytest.approx(plain.times[::2])
    assert abs(better.column("x")[-1] - exact) < 0.05 * abs(plain.column("x")[-1] - exact)
    assert better.errors == plain.errors


def test_what_is_returned_for_the_vehicle(vehicle):
    done = rb.simulate(vehicle, 1.0, initial={"delta_c": 0.01}, step=0.005)
    assert done.state_names == ("v", "w", "delta_c", "ddelta_c")
    assert done.states.shape == (201, 4)
    assert next(iter(done.outputs)) == "delta_z"
    assert set(vehicle.outputs) <= set(done.outputs)
    assert done.column("delta_c")[0] == 0.01
    assert np.isnan(done.column("delta_z")[0])  # s**0.4 of a jump
    assert done.units["ddelta_c"] == "rad/s"
    assert done.system.realisation is None
    assert (done.operator, done.method, done.history, done.order) == ("exact", "bdf2", "rest", 2.0)
    # The force of the element is what the model says of its output.
    F_d = -vehicle.parameters["C_s"] * done.column("delta_z")[1:]
    assert done.column("F_d")[1:] == pytest.approx(F_d)


def test_the_realised_operator(vehicle):
    done = rb.simulate(vehicle, 1.0, operator="realised", initial={"delta_c": 0.01})
    assert len(done) == 2001
    assert done.method == "lsoda"
    assert done.system.realisation.states == 14
    assert np.isnan(done.step)
    assert np.isnan(done.order)
    assert 0.0 < done.errors["delta_c"] < 1e-6
    exact = rb.simulate(vehicle, 1.0, initial={"delta_c": 0.01}, step=0.002)
    assert done.column("delta_c")[-1] == pytest.approx(exact.column("delta_c")[-1], abs=2e-4)


def test_an_input_that_jumps_is_told(vehicle):
    settings = {"history": "equilibrium", "inputs": {"delta_f": {0.5: 0.03}}, "step": 0.0025}
    for operator in ("exact", "realised"):
        done = rb.simulate(vehicle, 1.0, operator=operator, **settings)
        assert np.unique(done.inputs["delta_f"]).tolist() == [0.01, 0.03]
        v = done.column("v")
        assert np.ptp(v[done.times <= 0.5]) < 1e-8
        assert np.ptp(v) > 1e-3


def test_a_model_without_elements_has_one_operator():
    model = rb.model_from_strings("decay", {"x": "-x"}, parameters={})
    done = rb.simulate(model, 1.0, initial={"x": 1.0})
    assert (done.operator, done.method) == ("ordinary", "lsoda")
    assert done.column("x") == pytest.approx(np.exp(-done.times), abs=1e-7)
    other = rb.simulate(model, 1.0, initial={"x": 1.0}, method="bdf2", tolerance=1e-5)
    assert other.operator == "ordinary"
    assert other.column("x")[-1] == pytest.approx(np.exp(-1.0), abs=1e-5)


def test_a_tolerance_out_of_reach_is_said(monkeypatch):
    monkeypatch.setattr("racs_bif.simulation.runs._MOST", 512)
    done = rb.simulate(relaxation(), 2.0, initial={"x": 1.0}, tolerance=1e-9)
    assert done.early
    assert "1e-09 was not reached with 512 steps" in done.stopped
    assert 1e-8 < done.errors["x"] < 1e-4


def test_a_blow_up_is_kept_and_said():
    model = rb.model_from_strings(
        "blow", {}, parameters={}, elements=[("x", "1 + x**2", "s**(-0.8)")]
    )
    done = rb.simulate(model, 3.0, step=0.01)
    assert done.early
    assert "did not converge" in done.stopped
    assert 0.5 < done.times[-1] < 3.0


def test_progress_is_told(vehicle):
    seen = []
    rb.simulate(vehicle, 0.5, step=0.005, initial={"v": 0.1}, progress=seen.append)
    assert seen[-1] == pytest.approx(0.5)
    assert len(seen) > 20


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"duration": -1.0}, "duration is -1 s; give a positive"),
        ({"duration": float("inf")}, "give a positive, finite one"),
        ({"step": -0.1}, "step is -0.1 s; give one between 0 and the duration"),
        ({"step": 2.0}, "step is 2 s"),
        ({"step": 1e-9}, "over 4e\\+06 steps"),
        ({"tolerance": 0.0}, "tolerance is 0; give one between 0 and 1"),
        ({"operator": "exakt"}, "unknown operator 'exakt'; did you mean 'exact'"),
        ({"method": "lsoda"}, "unknown method 'lsoda' of the exact operator"),
        ({"operator": "realised", "method": "bdf2"}, "of the realised operator"),
        ({"operator": "realised", "extrapolate": True}, "leave it out"),
        ({"initial": {"delta": 0.1}}, "did you mean 'delta_c'"),
        ({"history": "zero"}, "there are: rest, constant, equilibrium"),
    ],
)
def test_what_is_refused_in_one_line(vehicle, options, text):
    with pytest.raises(UsageError, match=text) as told:
        rb.simulate(vehicle, options.pop("duration", 1.0), **options)
    assert "\n" not in str(told.value)


@pytest.mark.parametrize(
    ("law", "text"),
    [
        ("s**(-2.5)", r"has the order 2.5; fractional orders lie between -2 and 2"),
        ("1/(1 + s**0.5 + s**2.3)", r"has the order 2.3"),
        ("s**(-1.5)/(1 + s**0.9)", r"has the order 2.4"),
        ("s**1.5", r"grows like s\*\*1.5; feed it the derivative"),
        ("(1 + s**1.9)/(1 + s**0.3)", r"grows like s\*\*1.6"),
    ],
)
def test_orders_that_cannot_be_are_refused_in_one_line(law, text):
    model = rb.model_from_strings("m", {"y": "-w"}, parameters={}, elements=[("w", "y", law)])
    with pytest.raises(ParameterError, match=text) as told:
        rb.simulate(model, 1.0)
    assert "\n" not in str(told.value)


def test_no_equilibrium_to_start_from():
    model = rb.model_from_strings("none", {"x": "1 + x**2"}, parameters={})
    with pytest.raises(ConvergenceError, match="do not change with the states at the guess"):
        rb.simulate(model, 1.0, history="equilibrium")


def stopping(after):
    """Return a report of progress that interrupts when it has been called so often."""
    calls = []

    def report(time):
        calls.append(time)
        if len(calls) > after:
            raise KeyboardInterrupt

    return report


@pytest.mark.parametrize(
    "options",
    [{"step": 0.004}, {}, {"operator": "realised"}],
    ids=["step", "tolerance", "realised"],
)
def test_an_interruption_of_the_first_run_keeps_it_without_an_error(options):
    done = rb.simulate(relaxation(), 2.0, initial={"x": 1.0}, progress=stopping(1), **options)
    assert "nterrupted" in done.stopped
    assert done.early
    assert 0.0 <= done.times[-1] < 2.0
    assert np.isnan(done.errors["x"])
    exact = mittag_leffler(0.5, 1.0, -np.sqrt(done.times))
    late = done.times > 0.2
    np.testing.assert_allclose(done.column("x")[late], exact[late], atol=1e-3)


def test_the_finest_run_is_taken_without_a_word_where_it_is_good_enough(monkeypatch):
    from racs_bif.simulation import runs

    monkeypatch.setattr(runs, "_MOST", 300)
    done = rb.simulate(relaxation(), 2.0, initial={"x": 1.0}, tolerance=0.01)
    assert len(done) == 257
    assert done.stopped == "The duration is over."
    assert 0.0 < done.errors["x"] < 0.01


def test_an_input_is_a_function_or_a_table():
    model = rb.model_from_strings("m", {"x": "f - x"}, parameters={"f": 0.0})
    with pytest.raises(UsageError, match=r"'f' is 2\.0; give a function of time, or a dict of the"):
        rb.simulate(model, 1.0, inputs={"f": 2.0})
