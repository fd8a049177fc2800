import numpy as np
import pytest

import racs_bif as rb
from racs_bif.orbits.banded import BandedStages, band
from racs_bif.orbits.gauss import gauss
from racs_bif.orbits.stages import FactoredStages, interval_matrices


def jacobians(mask, degree, count=5):
    random = np.random.default_rng(3)
    return random.standard_normal((count, degree, *mask.shape)) * mask


@pytest.mark.parametrize("degree", [2, 4, 7])
@pytest.mark.parametrize(("below", "above"), [(0, 0), (1, 2), (3, 0)])
def test_a_band_eliminates_as_full_matrices_do(degree, below, above):
    n = 11
    offsets = np.subtract.outer(np.arange(n), np.arange(n))
    shuffled = np.random.default_rng(1).permutation(n)
    mask = ((offsets <= below) & (-offsets <= above))[np.ix_(shuffled, shuffled)]
    along, tau = jacobians(mask, degree), np.linspace(0.05, 0.3, 5)
    g = gauss(degree)
    ours = BandedStages(g, along, tau, band(mask))
    full = FactoredStages(g, interval_matrices(g, along, tau))
    rhs = np.random.default_rng(2).standard_normal((3, 5, degree, n))
    np.testing.assert_allclose(ours.transitions(), full.transitions(), rtol=1e-10, atol=1e-12)
    np.testing.assert_allclose(ours.solve(rhs), full.solve(rhs), rtol=1e-10, atol=1e-12)
    np.testing.assert_allclose(ours.adjoint(rhs), full.adjoint(rhs), rtol=1e-10, atol=1e-12)
    np.testing.assert_allclose(ours.at_ends(rhs), full.at_ends(rhs), rtol=1e-10, atol=1e-12)


def test_the_order_makes_a_shuffled_chain_narrow():
    n = 40
    offsets = np.abs(np.subtract.outer(np.arange(n), np.arange(n)))
    shuffled = np.random.default_rng(4).permutation(n)
    shape = band((offsets <= 1)[np.ix_(shuffled, shuffled)])
    assert (shape.below, shape.above) == (1, 1)
    assert shape.narrow
    assert not band(np.ones((n, n), dtype=bool)).narrow


def test_a_pattern_holds_what_lies_within_it():
    shape = band(np.eye(3, dtype=bool))
    assert shape.holds(np.zeros((3, 3), dtype=bool))
    assert not shape.holds(np.ones((3, 3), dtype=bool))
    assert not shape.holds(np.eye(4, dtype=bool))


def test_a_chain_takes_the_band_and_finds_the_orbit_of_one_cell(monkeypatch):
    taken = []

    def counted(*arguments):
        taken.append(arguments[-1])
        return BandedStages(*arguments)

    monkeypatch.setattr("racs_bif.orbits.equations.BandedStages", counted)
    system = rb.load_model("brusselator_chain", variant="8")
    start = rb.continue_equilibria(system, "B", (1.5, 2.3))["H1"]
    branch = rb.continue_orbits(start, span=(1.5, 2.5), method="collocation")
    assert branch.measures["period"][-1] == pytest.approx(6.577284341906, rel=1e-9)
    assert taken
    assert taken[0].below == 2
    # each point: one matrix to correct with, one for its tangent and multipliers, meshes apart
    assert len(taken) < 3.5 * len(branch)
