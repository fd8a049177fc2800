from dataclasses import replace

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.results.diagram import Diagram


@pytest.fixture(scope="module")
def orbits():
    r = "(x**2 + y**2)"
    model = rb.model_from_strings(
        "hopf",
        {"x": f"mu*x - y - x*{r}", "y": f"x + mu*y - y*{r}"},
        parameters={"mu": -0.5},
        guess={"x": 0.0, "y": 0.0},
    )
    equilibria = rb.continue_equilibria(model, "mu", (-0.5, 1.0))
    return rb.continue_orbits(equilibria["H1"], span=(-0.5, 1.0), method="collocation")


def test_orbits_are_kept_along_the_branch(orbits):
    places = list(orbits.samples)
    assert 4 < len(places) <= (len(orbits) + 1) // 2
    assert places[0] == 0
    assert places[-1] == len(orbits) - 1
    assert max(np.diff(places)) <= 3
    for k, profile in orbits.samples.items():
        radius = np.hypot(*profile.states.T)
        assert radius == pytest.approx(np.sqrt(max(orbits.parameter[k], 0.0)), abs=1e-6)
        assert profile.names == ("x", "y")
        assert profile.times[0] == 0.0
        assert profile.times[-1] == pytest.approx(orbits.measures["period"][k])
        assert np.all(np.diff(profile.times) > 0.0)


def test_they_are_saved_and_loaded_bit_for_bit(orbits, tmp_path):
    rb.save(Diagram(orbits), tmp_path / "po.nc")
    loaded = rb.load(tmp_path / "po.nc").branches[0]
    assert loaded == orbits
    assert list(loaded.samples) == list(orbits.samples)
    assert loaded != replace(orbits, samples={})


@pytest.mark.parametrize(("method", "error"), [("collocation", 0.01), ("shooting", 1e-3)])
def test_what_is_kept_of_an_orbit_is_dense_where_it_is_fast(method, error):
    """Van der Pol's oscillator in Lienard's form; its derivative is taken from what is kept.

    The polynomials of collocation have an error of .006 in it at the ends of their intervals.
    """
    from scipy.interpolate import CubicSpline

    model = rb.model_from_strings(
        "relaxation",
        {"x": "mu*(y + x*a - x**3/3)", "y": "-x/mu"},
        parameters={"mu": 8.0, "a": -0.5},
    )
    equilibria = rb.continue_equilibria(model, "a", (-0.5, 1.0))
    orbits = rb.continue_orbits(equilibria["H1"], span=(-0.5, 1.0), method=method)
    end = orbits.special[-1]
    kept = orbits.profiles[end.name]
    x, y = kept.states.T
    steps = np.diff(kept.times)
    assert steps.min() < 0.5 * steps.mean()
    slope = CubicSpline(kept.times, np.append(x[:-1], x[0]), bc_type="periodic")(kept.times, 1)
    rate = 8.0 * (y + x * orbits.parameter[-1] - x**3 / 3.0)
    assert np.abs(slope - rate).max() < error * np.abs(rate).max()
