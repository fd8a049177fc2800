import numpy as np
import pytest

from racs_bif.errors import ConvergenceError
from racs_bif.fractional.mittag_leffler import mittag_leffler
from racs_bif.shelf.load import system_of
from racs_bif.simulation.exact import INTERRUPTED, ExactStepper
from racs_bif.simulation.inputs import Inputs
from racs_bif.simulation.memory import order_of
from racs_bif.simulation.start import begin
from racs_bif.symbolic.strings import model_from_strings

COUNTS = (64, 128, 256, 512)


def orders(errors):
    errors = np.abs(errors)
    return np.log2(errors[:-1] / errors[1:])


@pytest.mark.parametrize("method", ["bdf2", "l1", "fast"])
@pytest.mark.parametrize("q", [0.3, 0.5, 0.8, 1.5])
def test_second_order_on_mittag_leffler_although_it_is_not_smooth(march, relaxation, q, method):
    system = relaxation(q)
    exact = mittag_leffler(q, 1.0, -(2.0**q))
    runs = [march(system, 2.0, n, method, initial={"x": 1.0}).X[0, -1] for n in COUNTS]
    assert orders(runs - exact)[1:] == pytest.approx(2.0, abs=0.1)
    assert abs(runs[-1] - exact) < 4e-6


def test_second_order_at_the_steps_near_the_beginning_is_not_claimed(march, relaxation):
    # The first step's error falls like h**q: that is why errors are judged later.
    first = [march(relaxation(0.5), 2.0, n, initial={"x": 1.0}).X[0, 1] for n in COUNTS]
    exact = mittag_leffler(0.5, 1.0, -np.sqrt(2.0 / np.array(COUNTS)))
    assert orders(first - exact) == pytest.approx(0.5, abs=0.2)


@pytest.mark.parametrize(("method", "order"), [("bdf2", 2.0), ("l1", 1.5), ("fast", 2.0)])
def test_order_with_a_differentiating_element_and_a_jump(march, torvik, method, order):
    # Bagley and Torvik, f = 8 on [0, 1]: acceptance.md
    counts = (320, 640, 1280, 2560)
    force = {"f": {0.0: 8.0, 1.0: 0.0}}
    runs = [march(torvik, 5.0, n, method, signals=force).X[0, -1] for n in counts]
    error = np.array(runs) - 2.943935664
    # L1's next term is of order 2 and not small yet.
    assert orders(error)[-1] == pytest.approx(order, abs=0.05 if order == 2.0 else 0.4)
    assert order_of(method, torvik.exact.laws(torvik.values)) == order


@pytest.mark.parametrize(("method", "order"), [("bdf2", 2.0), ("l1", 1.5), ("fast", 2.0)])
def test_order_with_a_growing_element_on_mittag_leffler(march, method, order):
    # y' = -D^0.5 y from y(0) = 1 after zero: s Y - 1 = -s^0.5 Y, y = E_0.5(-sqrt(t))
    system = system_of(
        model_from_strings("l1", {"y": "-w"}, parameters={}, elements=[("w", "y", "s**0.5")])
    )
    runs = [march(system, 1.0, n, method, initial={"y": 1.0}).X[0, -1] for n in (512, 1024, 2048)]
    assert orders(np.array(runs) - 0.4275835762)[-1] == pytest.approx(order, abs=0.1)


@pytest.mark.parametrize("method", ["bdf2", "l1", "fast"])
def test_all_methods_solve_the_same_equations(march, two_orders, method):
    settings = {"initial": {"x": 1.0, "v": -0.5}, "signals": {"f": {0.0: 0.0, 2.0: 1.0}}}
    fine = march(two_orders, 6.0, 2400, **settings)
    other = march(two_orders, 6.0, 1200, method, **settings)
    late = slice(60, None)
    assert other.X[:, late] == pytest.approx(fine.X[:, ::2][:, late], abs=4e-3)


def test_order_with_several_operators_a_jump_and_a_moving_input(march, two_orders):
    settings = {
        "initial": {"x": 1.0},
        "signals": {"f": lambda t: np.sin(3.0 * t) + (t >= 1.5)},
        "jumps": (1.5,),
    }
    runs = np.array([march(two_orders, 3.0, n, **settings).X[:2, -1] for n in (150, 300, 600)])
    ratio = (runs[1] - runs[0]) / (runs[2] - runs[1])
    assert np.log2(ratio) == pytest.approx(2.0, abs=0.15)


def test_a_model_without_elements_is_integrated_too(march):
    system = system_of(model_from_strings("decay", {"x": "-x**2"}, parameters={}))
    for method in ("bdf2", "l1", "fast"):
        assert march(system, 1.0, 400, method, initial={"x": 1.0}).X[0, -1] == pytest.approx(
            0.5, abs=2e-6
        )


def test_outputs_just_after_the_beginning(march, two_orders):
    jumping = march(two_orders, 0.1, 10, initial={"x": 1.0}).X[2:, 0]
    assert jumping[0] == pytest.approx(2.0)  # Z at high frequency, times the jump of x
    assert np.isnan(jumping[1])  # s**0.3 of a jump
    held = march(two_orders, 0.1, 10, initial={"x": 1.0}, history="constant").X[2:, 0]
    assert held == pytest.approx([1.0, 0.0])


def test_what_blows_up_ends_with_what_there_is():
    system = system_of(model_from_strings("blow", {"x": "1 + x**2"}, parameters={}))
    inputs = Inputs(system=system, duration=2.0)
    done = ExactStepper(system, begin(system, {}, "rest"), inputs, 400).run()
    assert "did not converge" in done.stopped
    assert 1.4 < done.times[-1] < 1.7
    assert done.X.shape == (1, len(done.times))
    start = begin(system, {"x": 1e30}, "rest")
    with pytest.raises(ConvergenceError, match="smaller step"):
        ExactStepper(system, start, inputs, 2).run()


def test_an_interruption_keeps_what_there_is(relaxation):
    system = relaxation(0.5)

    def stop(time):
        if time > 0.5:
            raise KeyboardInterrupt

    inputs = Inputs(system=system, duration=1.0)
    done = ExactStepper(system, begin(system, {"x": 1.0}, "rest"), inputs, 400).run(stop)
    assert done.stopped == INTERRUPTED
    assert 0.4 < done.times[-1] < 0.6
