"""What many simulations settle on, against models whose attractors are known."""

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.shelf.load import system_of
from racs_bif.simulation.attractors import FAILED, SETTLED, UNSETTLED, amplitudes, periods
from racs_bif.simulation.batch import members
from racs_bif.simulation.batch_field import BatchField
from racs_bif.simulation.batch_lyapunov import largest_exponents


@pytest.fixture(scope="module")
def batch():
    """Return equations of members and where they begin."""

    def build(equations, values, start, **more):
        defaults = {name: float(v[0]) for name, v in values.items()}
        system = system_of(rb.model_from_strings("some", equations, parameters=defaults, **more))
        field = BatchField(system, members(system, {k: np.array(v) for k, v in values.items()}))
        y = np.repeat(np.array(start)[:, None], field.P.shape[1], axis=1)
        return field, field.at_rest(y)

    return build


NORMAL = {"x": "m*x - w*y - x*(x**2 + y**2)", "y": "w*x + m*y - y*(x**2 + y**2)"}


def test_amplitudes_of_hopfs_normal_form(batch):
    field, x = batch(NORMAL, {"m": [0.04, 0.25, 1.0, -0.5, 0.0], "w": [1.0] * 5}, [0.3, 0.0])
    found = amplitudes(field, x, 160.0, 0, 1e-6)
    assert found.status.tolist() == [SETTLED] * 4 + [UNSETTLED]
    assert found.value[:4] == pytest.approx([0.2, 0.5, 1.0, 0.0], abs=2e-5)
    assert np.isnan(found.value[4])
    assert found.error[:4].max() < 1e-4


def test_amplitude_of_a_fractional_oscillator(batch):
    # Acceptance: max .8601611934 at mu = .4, 1.6432206301 at mu = 1.
    equations = {"x": "y", "y": "mu*(1 - x**2)*y - x - c*w"}
    values = {"mu": [0.4, 1.0], "c": [0.5, 0.5], "a": [0.5, 0.5]}
    field, x = batch(equations, values, [0.7, 0.0], elements=[("w", "x", "s**a")])
    found = amplitudes(field, x, 100.0, 0, 1e-5)
    assert found.value == pytest.approx([0.86016, 1.64322], rel=5e-3)


def test_one_without_bound_is_no_amplitude(batch):
    field, x = batch({"x": "k*x"}, {"k": [1.0, -1.0]}, [1.0])
    found = amplitudes(field, x, 100.0, 0, 1e-5)
    assert found.status.tolist() == [FAILED, SETTLED]
    assert np.isnan(found.value[0])
    assert found.value[1] == 0.0


ROESSLER = {"x": "-y - z", "y": "x + a*y", "z": "b + z*(x - c)"}


def test_period_doubling_of_roesslers_equations(batch):
    values = {"c": [2.5, 3.5, 4.0, 5.7], "a": [0.2] * 4, "b": [0.2] * 4}
    field, x = batch(ROESSLER, values, [1.0, 1.0, 1.0])
    found = periods(field, x, 360.0, 0, 1e-5)
    assert found.value.tolist() == [1.0, 2.0, 4.0, np.inf]
    assert found.error[:3].max() < 0.01 < found.error[3]


def test_at_rest_and_with_too_few_crossings_there_is_no_period(batch):
    field, x = batch(NORMAL, {"m": [-1.0, 0.04], "w": [1.0, 1.0]}, [0.3, 0.0])
    assert periods(field, x, 60.0, 0, 1e-6).value[0] == 0.0
    few = periods(field, x, 8.0, 0, 1e-6)
    assert few.status[1] == UNSETTLED
    assert np.isnan(few.value[1])


def test_exponents_of_a_linear_equation_are_its_rates(batch):
    field, x = batch({"x": "-k*x + y", "y": "-3*y"}, {"k": [0.2, 1.0, -0.05]}, [1.0, 1.0])
    found = largest_exponents(field, x, 200.0, 1e-7)
    assert found.value == pytest.approx([-0.2, -1.0, 0.05], abs=1e-5)


def test_exponents_of_a_cycle_and_of_chaos(batch):
    values = {"c": [2.5, 5.7], "a": [0.2, 0.2], "b": [0.2, 0.2]}
    field, x = batch(ROESSLER, values, [1.0, 1.0, 1.0])
    found = largest_exponents(field, x, 500.0, 1e-5)
    assert abs(found.value[0]) < 0.01
    # .0714, J. C. Sprott, Chaos and Time-Series Analysis (2003), table A.4
    assert found.value[1] == pytest.approx(0.0714, abs=0.02)
    assert 0.0 < found.error[1] < 0.02


def test_exponents_of_a_fractional_model_are_roots_of_its_realisation(batch):
    equations = {"x": "y", "y": "-x - 0.3*y - 0.5*w"}
    field, x = batch(equations, {"a": [0.5]}, [1.0, 0.0], elements=[("w", "x", "s**a")])
    found = largest_exponents(field, x, 400.0, 1e-6)
    system = field.system
    roots = np.linalg.eigvals(system.field.f_x(np.zeros(field.size), system.values))
    assert found.value[0] == pytest.approx(roots.real.max(), rel=0.02)
