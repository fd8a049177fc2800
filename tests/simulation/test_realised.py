import numpy as np
import pytest

from racs_bif.errors import ConvergenceError
from racs_bif.fractional.diffusive import Diffusive
from racs_bif.shelf.load import load_model, system_of
from racs_bif.simulation.exact import INTERRUPTED
from racs_bif.simulation.inputs import Inputs
from racs_bif.simulation.realised import RealisedStepper
from racs_bif.simulation.start import begin
from racs_bif.symbolic.strings import model_from_strings


@pytest.fixture(scope="module")
def oscillator():
    model = model_from_strings("spring", {"x": "v", "v": "-x + f"}, parameters={"f": 0.0})
    return system_of(model)


@pytest.mark.parametrize("method", ["lsoda", "radau"])
def test_an_ordinary_model_with_a_force_that_jumps(march, oscillator, method):
    done = march(oscillator, 4.0, 80, method, signals={"f": {1.0: 2.0}}, tolerance=1e-9)
    t = done.times
    exact = np.where(t > 1.0, 2.0 - 2.0 * np.cos(t - 1.0), 0.0)
    assert done.X[0] == pytest.approx(exact, abs=1e-6)


def test_a_smooth_input(march, oscillator):
    done = march(oscillator, 6.0, 60, "lsoda", signals={"f": lambda t: np.sin(2.0 * t)})
    exact = (2.0 * np.sin(done.times) - np.sin(2.0 * done.times)) / 3.0
    assert done.X[0] == pytest.approx(exact, abs=1e-6)


@pytest.mark.parametrize("history", ["rest", "constant", "equilibrium"])
def test_realised_and_exact_agree_within_the_band(march, history):
    vehicle = load_model(
        "racs", parameters={"u": 12.0}, realisation=Diffusive(band=(1e-4, 1e5), order=45)
    )
    settings = {"initial": {"ddelta_c": 0.05}, "history": history}
    realised = march(vehicle, 2.0, 100, "lsoda", **settings).X
    exact = march(vehicle, 2.0, 4000, **settings).X[:, ::40]
    size = np.abs(exact).max(axis=1, keepdims=True)
    assert np.abs(realised - exact)[:, 5:].max() < 2e-3 * size.max()
    assert np.all(np.abs(realised - exact)[:, 5:] < 2e-3 * size)


def test_outputs_of_elements_hold_their_feedthrough(march):
    model = model_from_strings(
        "through", {"x": "-x"}, parameters={}, elements=[("w", "x", "(1 + 2*s)/(1 + s)")]
    )
    done = march(system_of(model), 1.0, 20, "lsoda", initial={"x": 1.0}, history="constant")
    # Z of exp(-t) - 1, by partial fractions; the realisation is good to 1e-4 here
    t = done.times
    assert done.X[1] == pytest.approx((1.0 - t) * np.exp(-t), abs=1e-4)


@pytest.mark.parametrize("method", ["lsoda", "radau"])
def test_what_blows_up_ends_with_what_there_is(method):
    system = system_of(model_from_strings("blow", {"x": "1 + x**2"}, parameters={}))
    inputs = Inputs(system=system, duration=2.0)
    stepper = RealisedStepper(system, begin(system, {}, "rest"), inputs, 200, method)
    done = stepper.run()
    assert "gave up" in done.stopped
    assert 1.4 < done.times[-1] < 1.6
    with pytest.raises(ConvergenceError, match=r"nothing was integrated.*gave up"):
        RealisedStepper(system, begin(system, {"x": 1e200}, "rest"), inputs, 9, method).run()


def test_an_interruption_keeps_what_there_is(oscillator):
    def exact(t):
        return np.cos(t) + np.where(t > 50.0, 1.0 - np.cos(t - 50.0), 0.0)

    def stop(time):
        if time > 60.0:
            raise KeyboardInterrupt

    inputs = Inputs(system=oscillator, duration=100.0, signals={"f": {50.0: 1.0}})
    start = begin(oscillator, {"x": 1.0}, "rest")
    done = RealisedStepper(oscillator, start, inputs, 1000, tolerance=1e-10).run(stop)
    assert done.stopped == INTERRUPTED
    assert done.times[-1] == pytest.approx(60.0, abs=6.0)
    assert done.X[0] == pytest.approx(exact(done.times), abs=1e-6)
