import numpy as np
import pytest

from racs_bif.errors import ConvergenceError
from racs_bif.fractional.diffusive import Diffusive
from racs_bif.shelf.load import load_model, system_of
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
    # W - 1 = Z (X - 1) / s ...: w = exp(-t) (1 + t) + ... checked by its differential equation
    t, (x, w) = done.times, done.X
    assert w == pytest.approx(1.0 + (2.0 * (x - 1.0)) - (1.0 - np.exp(-t) - t * np.exp(-t)) * -1.0)


def test_what_blows_up_ends_with_what_there_is():
    system = system_of(model_from_strings("blow", {"x": "1 + x**2"}, parameters={}))
    inputs = Inputs(system=system, duration=2.0)
    stepper = RealisedStepper(system, begin(system, {}, "rest"), inputs, 200, "radau")
    done = stepper.run()
    assert "gave up" in done.stopped
    assert 1.4 < done.times[-1] < 1.6

    def stop(_time):
        raise KeyboardInterrupt

    stepper = RealisedStepper(
        system, begin(system, {"x": 1.0}, "rest"), Inputs(system=system, duration=0.7), 9
    )
    stepper.field = None  # nothing can be evaluated: the first call fails before any sample
    with pytest.raises(AttributeError):
        stepper.run(stop)
    assert ConvergenceError is not None
