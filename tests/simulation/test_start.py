import numpy as np
import pytest

from racs_bif.errors import UsageError
from racs_bif.simulation.start import begin


def test_rest_is_zero_before_and_where_nothing_is_said(two_orders):
    start = begin(two_orders, {"x": 2.0}, "rest")
    assert start.y.tolist() == [2.0, 0.0]
    assert start.w.tolist() == [0.0, 0.0]
    assert start.e.tolist() == [0.0, 0.0]


def test_a_constant_history_is_the_state_held_for_ever(two_orders):
    start = begin(two_orders, {"x": 2.0, "v": 1.0}, "constant")
    # w = Z(0) x; r = s**0.3 of a constant
    assert start.w == pytest.approx([2.0, 0.0], abs=1e-14)
    assert start.e == pytest.approx([2.0, 1.2])


def test_equilibrium_is_where_the_model_was(vehicle):
    X = vehicle.exact_point(vehicle.equilibrium(), vehicle.values)
    start = begin(vehicle, {"delta_c": 0.05}, "equilibrium")
    assert start.y[[0, 1, 3]] == pytest.approx(X[[0, 1, 3]], abs=1e-14)
    assert start.y[2] == 0.05
    assert start.w == pytest.approx(X[4:])
    assert start.e == pytest.approx(X[[2]])


def test_an_integrating_element_starts_where_it_is_told(relaxation):
    for history in ("rest", "constant", "equilibrium"):
        start = begin(relaxation(0.5), {"x": 3.0}, history)
        assert start.w.tolist() == [3.0]
        assert start.e.tolist() == [0.0]


@pytest.mark.parametrize("history", ["constant", "equilibrium"])
def test_an_undisturbed_equilibrium_stays(march, vehicle, history):
    for method in ("bdf2", "l1", "fast", "lsoda"):
        X = march(vehicle, 1.0, 50, method, history=history).X
        assert np.allclose(X, X[:, :1], rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize(
    ("initial", "history", "text"),
    [
        ({"delta": 0.1}, "rest", "unknown state 'delta'; did you mean 'delta_c'"),
        ({"delta_z": 0.1}, "rest", "'delta_z' follows from its law"),
        ({"v": float("inf")}, "rest", "initial value of 'v' is inf"),
        ({}, "rests", "unknown history 'rests'; did you mean 'rest'"),
    ],
)
def test_what_is_refused(vehicle, initial, history, text):
    with pytest.raises(UsageError, match=text):
        begin(vehicle, initial, history)
