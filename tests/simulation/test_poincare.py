import numpy as np
import pytest

from racs_bif.simulation.poincare import poincare_section


def test_a_spiral_is_cut_once_a_turn():
    t = np.linspace(0.0, 30.0, 3001)
    spiral = np.exp(-0.1 * t)[:, None] * np.column_stack([np.cos(t), np.sin(t)])
    cut = poincare_section(t, spiral, spiral[:, 1], direction=-1)
    turns = np.pi * np.arange(1, 10, 2)
    assert cut.times == pytest.approx(turns, abs=1e-7)
    assert cut.points[:, 0] == pytest.approx(-np.exp(-0.1 * turns), rel=1e-6)
    assert np.abs(cut.points[:, 1]).max() < 1e-12


def test_nothing_crosses():
    t = np.linspace(0.0, 1.0, 50)
    assert poincare_section(t, np.ones((50, 3)), t, level=5.0).points.shape == (0, 3)
