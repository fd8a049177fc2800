"""The vehicle's stability charts against independent numbers and independent counts."""

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.charts.plane import Plane
from racs_bif.fractional.argument import count_unstable
from racs_bif.fractional.roots import characteristic_roots

SPANS = ((0.02, 0.6), (5.0, 400.0))
GRID = 12


@pytest.fixture(scope="module")
def vehicle():
    return rb.load_model("racs", parameters={"u": 20.0})


@pytest.fixture(scope="module")
def chart(vehicle):
    return rb.stability_chart(vehicle, "c", "m_c", SPANS, marks={"m_c": (100.0,)})


def test_one_boundary_through_the_points_known(chart):
    (boundary,) = chart.boundaries
    assert (boundary.kind, boundary.closed, boundary.complete) == ("hopf", False, True)
    (marked,) = boundary.points
    found = [boundary.values[0], list(marked.parameters.values()), boundary.values[-1]]
    expected = [(0.281572, 5.0), (0.295587, 100.0), (0.332436, 400.0)]
    assert np.array(found) == pytest.approx(np.array(expected), abs=5e-7)
    assert chart.unexplained == 0
    assert not chart.early
    assert [(region.unstable, region.disagreeing) for region in chart.regions] == [(2, 0), (0, 0)]


def test_the_cells_of_an_independent_grid_agree_and_cost_far_more(vehicle, chart):
    """A reduced grid; benchmarks/charts.py has the one of 200 x 200."""
    plane = Plane(vehicle, ("c", "m_c"), SPANS)
    steps = (np.arange(GRID) + 0.5) / GRID
    places = np.array([a.ravel() for a in np.meshgrid(steps, steps, indexing="ij")])
    counts, evaluations = [], 0
    for p in plane.vectors(places).T:
        X = vehicle.exact_point(vehicle.equilibrium(p), p)
        counted = count_unstable(vehicle.exact, X, p)
        counts.append(counted.unstable)
        evaluations += counted.evaluations
    line = plane.places(chart.boundaries[0].line.T)
    cut = np.zeros((GRID, GRID), dtype=bool)
    cut[tuple(np.clip((line * GRID).astype(int), 0, GRID - 1))] = True
    told = chart.unstable_on(plane.values(places).T)
    assert np.array_equal(told[~cut.ravel()], np.array(counts)[~cut.ravel()])
    assert {0, 2} == set(counts)
    per_cell = evaluations / GRID**2
    assert 200**2 * per_cell > 50 * chart.evaluations


def test_every_point_of_the_boundary_has_a_root_on_the_axis(vehicle, chart):
    boundary = chart.boundaries[0]
    for k in range(0, len(boundary), 9):
        values = dict(zip(("c", "m_c"), boundary.values[k], strict=True))
        roots = characteristic_roots(vehicle.with_parameters(values), above=-0.5).roots
        assert roots[0] == pytest.approx(1j * boundary.omega[k], abs=1e-7)


def test_the_plane_of_speed_and_stiffness_with_l1():
    known = {20000.0: (4.5672697, 10.414023), 35000.0: (15.81316, 8.3598728)}
    known |= {40000.0: (22.318792, 7.4845221)}
    chart = rb.stability_chart(
        rb.load_model("racs"),
        "u",
        "C_s",
        ((4.0, 40.0), (5e3, 8e4)),
        marks={"C_s": known, "u": (10.2,)},
        lyapunov=True,
    )
    (boundary,) = chart.boundaries
    marked = {round(p.parameters["C_s"], 3): p for p in boundary.points}
    for stiffness, (speed, omega) in known.items():
        assert marked[stiffness].parameters["u"] == pytest.approx(speed, rel=2e-7)
        assert marked[stiffness].data["omega"] == pytest.approx(omega, rel=2e-7)
    assert 29661.065 in marked  # at 10.2 m/s, by which it was calibrated
    assert np.all(boundary.l1 < 0.0)  # supercritical, as the paper has it
    # kappa of model.md is of another amplitude; the sign and the size are those of a branch's point
    hopf = rb.continue_equilibria(rb.load_model("racs"), "u", (5, 15))["H1"]
    k = int(np.argmin(np.abs(boundary.values[:, 0] - 10.2)))
    assert boundary.values[k, 0] == pytest.approx(10.2, abs=1e-12)
    assert boundary.l1[k] == pytest.approx(hopf.exact.l1, rel=1e-6)


def test_the_plane_of_order_and_modulus(vehicle):
    chart = rb.stability_chart(vehicle, "alpha", "E_0", ((0.05, 0.95), (1e4, 2e5)))
    (boundary,) = chart.boundaries
    assert boundary.complete
    for k in range(0, len(boundary), 12):
        values = dict(zip(("alpha", "E_0"), boundary.values[k], strict=True))
        roots = characteristic_roots(vehicle.with_parameters(values), above=-0.2).roots
        assert roots[0] == pytest.approx(1j * boundary.omega[k], abs=1e-7)
    assert [region.unstable for region in chart.regions] == [2, 0]
    assert chart.unstable_at(alpha=0.3, E_0=5e4) == 2
