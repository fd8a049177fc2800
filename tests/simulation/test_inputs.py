import math

import numpy as np
import pytest

from racs_bif.errors import ParameterError, UsageError
from racs_bif.simulation.inputs import Inputs


@pytest.fixture
def inputs(torvik):
    def build(duration=10.0, jumps=(), **signals):
        return Inputs(system=torvik, duration=duration, signals=signals, jumps=jumps)

    return build


def test_steps_take_their_values_from_their_times_on(inputs):
    force = inputs(f={1.0: 8.0, 4.0: -1.0})
    assert [force.values(t)[0] for t in (0.0, 0.99, 1.0, 4.0, 9.0)] == [0.0, 0.0, 8.0, -1.0, -1.0]
    assert force.values(1.0, before=True)[0] == 0.0
    assert force.values(4.0, before=True)[0] == 8.0
    assert force.constant
    assert force.jump_times == (1.0, 4.0)


def test_before_the_beginning_parameters_are_the_models_own(inputs):
    assert inputs(f={0.0: 8.0}).values(0.0, before=True)[0] == 0.0
    assert inputs(f=math.cos).values(0.0, before=True)[0] == 0.0
    assert inputs(f=math.cos).values(0.0)[0] == 1.0


def test_a_function_jumps_where_it_is_said_to(inputs):
    force = inputs(f=lambda t: float(t >= 2.0), jumps=(2.0,))
    assert force.values(2.0)[0] == 1.0
    assert force.values(2.0, before=True)[0] == 0.0
    assert not force.constant


def test_jumps_fall_between_steps(inputs):
    force = inputs(f={0.1: 1.0, 2.5: 0.0, 20.0: 1.0})
    assert force.divisor == 100
    times = force.times(300)
    assert {0.1, 2.5} <= set(times)
    assert np.diff(times) == pytest.approx(10.0 / 300)
    assert force.column("f", times)[[0, 3, 4, 75, 76]] == pytest.approx([0, 0, 1, 1, 0])
    with pytest.raises(UsageError, match=r"no step divides .* choose round numbers"):
        _ = inputs(f={math.pi: 1.0}).divisor


def test_derived_parameters_move_too(vehicle):
    moving = Inputs(system=vehicle, duration=1.0, signals={"C_s": {0.0: 4e4}})
    names = [p.name for p in vehicle.compiled.parameters]
    assert moving.values(0.5)[names.index("A_h")] == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("signals", "error", "text"),
    [
        ({"g": {0.0: 1.0}}, ParameterError, "unknown parameter 'g'"),
        ({"f": {0.0: float("nan")}}, ParameterError, "finite"),
        ({"f": {-1.0: 1.0}}, UsageError, "t = -1 s; give times from 0 on"),
        ({"f": {math.inf: 1.0}}, UsageError, "from 0 on"),
    ],
)
def test_what_is_refused(inputs, signals, error, text):
    with pytest.raises(error, match=text):
        inputs(**signals)


def test_a_parameter_of_a_law_cannot_move(relaxation):
    with pytest.raises(ParameterError, match="depends on 'q', which therefore cannot change"):
        Inputs(system=relaxation(0.5), duration=1.0, signals={"q": {0.5: 0.6}})
