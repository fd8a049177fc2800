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
