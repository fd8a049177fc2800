import numpy as np
import pytest

from racs_bif.errors import UsageError
from racs_bif.orbits.return_map import last_turn

T = np.linspace(0.0, 60.0, 6001)


def test_the_period_of_a_simple_oscillation():
    turn = last_turn(T, np.column_stack([np.cos(3.0 * T), np.sin(3.0 * T)]), ("x", "y"))
    assert turn.crossings == 1
    assert turn.times[-1] == pytest.approx(2.0 * np.pi / 3.0, rel=1e-8)
    assert turn.mismatch < 1e-6
    np.testing.assert_allclose(turn.states[:, 0], turn.states[:, -1], atol=1e-6)


def test_a_turn_that_crosses_several_times_is_whole():
    wave = np.cos(3.0 * T) + 0.4 * np.cos(1.5 * T + 0.3)
    turn = last_turn(T, np.column_stack([wave, np.sin(3.0 * T)]), ("x", "y"))
    assert turn.crossings == 2
    assert turn.times[-1] == pytest.approx(4.0 * np.pi / 3.0, rel=1e-6)


def test_a_transient_before_the_tail_does_not_matter():
    wave = np.cos(3.0 * T) * (1.0 + 20.0 * np.exp(-T))
    turn = last_turn(T, np.column_stack([wave, np.sin(3.0 * T)]), ("x", "y"))
    assert turn.times[-1] == pytest.approx(2.0 * np.pi / 3.0, rel=1e-6)


@pytest.mark.parametrize(
    ("states", "message"),
    [
        (np.column_stack([np.exp(-T), np.exp(-2.0 * T)]), "at rest in the end"),
        (np.column_stack([T, T**2]), "passes the middle of its range twice"),
        (np.column_stack([np.cos(T), np.sin(T)]) * np.exp(0.1 * T)[:, None], "does not repeat"),
    ],
)
def test_what_has_no_period_is_refused(states, message):
    with pytest.raises(UsageError, match=message):
        last_turn(T, states, ("x", "y"))
