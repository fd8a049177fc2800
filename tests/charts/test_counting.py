"""Many determinants at once against one at a time."""

import numpy as np
import pytest

from racs_bif.charts.counting import UNKNOWN, count_right
from racs_bif.charts.damping import rightmost
from racs_bif.charts.plane import Plane
from racs_bif.charts.sheet import Sheet
from racs_bif.charts.sums import Sums, expand
from racs_bif.errors import ConvergenceError
from racs_bif.fractional.argument import count_unstable
from racs_bif.fractional.characteristic import Characteristic
from racs_bif.fractional.roots import roots_right

PLANES = {
    "orders held": (("c", "m_c"), ((0.02, 0.6), (5.0, 400.0))),
    "orders moving": (("alpha", "gamma"), ((0.15, 0.6), (0.3, 0.8))),
    "derived": (("u", "C_s"), ((8.0, 40.0), (8e3, 8e4))),
}


@pytest.fixture(scope="module", params=PLANES)
def batch(request, vehicle):
    """Return model, equilibria, parameters and determinants at 60 places of a plane."""
    plane = Plane(vehicle, *PLANES[request.param])
    sheet = Sheet(plane)
    places = np.random.default_rng(1).random((2, 60))
    start = plane.nominal
    X0 = vehicle.exact_point(vehicle.equilibrium(), vehicle.values)
    wide = np.ones((1, 60))
    X, reached = sheet.follow(X0[:, None] * wide, start[:, None] * wide, places)
    assert np.all(reached == 1.0)
    P = plane.vectors(places)
    return vehicle.exact, X, P, expand(sheet.core(X, P), sheet.laws(P)), plane, places


def test_places_give_the_parameters_that_a_path_gives(batch):
    *_, P, _, plane, places = batch
    for k in range(5):
        assert P[:, k] == pytest.approx(plane.path.vector(plane.values(places[:, k])), rel=1e-13)


def test_equilibria_are_those_of_newtons_method_one_by_one(batch):
    exact, X, P, *_ = batch
    for k in range(10):
        assert np.abs(exact.residual(X[:, k], P[:, k])).max() < 1e-6
        assert X[:, k] == pytest.approx(exact.equilibrium(X[:, k], P[:, k]), rel=1e-9, abs=1e-10)


def test_sums_are_the_determinant_and_its_derivative(batch):
    exact, X, P, sums, *_ = batch
    t = np.array([0.3 + 1.2j, -2.0 + 0.5j, 3.0 + 3.0j])
    for k in range(10):
        log, rate = Characteristic.of_model(exact, X[:, k], P[:, k]).log_det(t)
        value, slope, scale = sums.take(np.full(3, k)).evaluate(t)
        assert np.abs(np.exp(np.log(value) + scale - log) - 1.0).max() < 1e-9
        assert slope / value == pytest.approx(rate, rel=1e-8)


@pytest.mark.parametrize("above", [0.0, -0.5, -3.0, 1.0, 40.0])
def test_counts_are_those_of_the_argument_principle_one_by_one(batch, above):
    exact, X, P, sums, *_ = batch
    counts = count_right(sums, above)
    lines = count_right(sums, np.full(60, above) * (1.0 + 1e-9 * np.arange(60)))
    for k in range(0, 60, 3):
        assert counts.unstable[k] == count_unstable(exact, X[:, k], P[:, k], above).unstable
    assert np.array_equal(counts.unstable, lines.unstable)  # lines of their own, no shared sweep
    assert counts.evaluations.min() > 3


def test_rightmost_roots_are_those_found_one_by_one(batch):
    exact, X, P, sums, *_ = batch
    found = rightmost(exact, sums, X, P)
    for k in range(0, 60, 4):
        try:
            roots = roots_right(Characteristic.of_model(exact, X[:, k], P[:, k]), -3.0).roots
        except ConvergenceError:
            continue
        if len(roots):
            assert found.root[k] == pytest.approx(roots[0], rel=1e-8)
    assert np.isfinite(found.root).sum() >= 55


def polynomials(*roots):
    """Return sums with these roots: powers 0, 1, 2, ... of s."""
    rows = np.array([np.poly(one).real[::-1] for one in roots]).T
    return Sums(rows, np.arange(len(rows), dtype=float)[:, None])


def test_counts_of_polynomials_with_roots_anywhere():
    sums = polynomials([1.0, -2.0, -3.0], [-1.0, 2j, -2j], [0.5, 1 + 1j, 1 - 1j], [-1, -2, -4])
    assert count_right(sums).unstable.tolist() == [1, UNKNOWN, 3, 0]
    assert count_right(sums, -1.5).unstable.tolist() == [1, 3, 3, 1]
    assert count_right(sums, 0.75).unstable.tolist() == [1, 0, 2, 0]


def test_a_root_at_zero_is_left_out():
    sums = polynomials([0.0, 1.0, -3.0], [0.0, 0.0, -3.0])
    assert count_right(sums).unstable.tolist() == [1, 0]
    assert count_right(sums, -1.0).unstable.tolist() == [1, 0]


def test_counts_of_lightly_damped_pairs_close_together():
    pairs = [s * r for r in (1.0, 1.001, 1.002) for s in (-1e-6 + 1j, -1e-6 - 1j)]
    mirrored = [-s for s in pairs]
    assert count_right(polynomials(pairs, mirrored)).unstable.tolist() == [0, 6]


def test_numbers_that_are_not_finite_are_unknown():
    rows = np.array([[1.0, np.nan, 0.0], [1.0, 1.0, 0.0]])
    assert count_right(Sums(rows, np.array([[0.0], [1.0]]))).unstable.tolist() == [
        0,
        UNKNOWN,
        UNKNOWN,
    ]
