import numpy as np
import pytest

from racs_bif.errors import UsageError
from racs_bif.simulation.signals import crossings, extremes, period

TIMES = np.linspace(0.0, 10.0, 801)
WAVE = 2.0 * np.sin(3.0 * TIMES) + 0.5


def test_extremes_lie_between_samples():
    assert extremes(TIMES, WAVE) == pytest.approx((-1.5, 2.5), abs=1e-6)
    assert extremes(TIMES, TIMES) == pytest.approx((0.0, 10.0))
    assert extremes(TIMES, np.ones(801)) == (1.0, 1.0)


def test_crossings_know_their_direction():
    up = crossings(TIMES, WAVE, 0.5)
    down = crossings(TIMES, WAVE, 0.5, -1)
    turn = np.pi / 3.0
    assert down == pytest.approx(turn * np.arange(1, 10, 2), abs=1e-7)
    assert up[-4:] == pytest.approx(turn * np.arange(2, 10, 2), abs=1e-7)
    assert len(crossings(TIMES, WAVE, 0.5, 0)) == len(up) + len(down)


def test_the_period():
    assert period(TIMES, WAVE) == pytest.approx(2.0 * np.pi / 3.0, rel=1e-7)
    assert np.isnan(period(TIMES, TIMES))


def test_too_few_samples_are_refused():
    with pytest.raises(UsageError, match="3 samples are too few"):
        extremes(TIMES[:3], WAVE[:3])
