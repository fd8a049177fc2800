"""Charts that are known in closed form."""

import numpy as np
import pytest
import sympy as sp

from racs_bif.charts.edges import Edge
from racs_bif.charts.lattice import BEYOND, NOTHING
from racs_bif.charts.pieces import own_pieces
from racs_bif.charts.plane import Plane
from racs_bif.charts.regions import regions
from racs_bif.charts.search import search
from racs_bif.charts.settings import ChartSettings
from racs_bif.errors import ConvergenceError, UsageError
from racs_bif.shelf.load import system_of
from racs_bif.symbolic.model import FractionalElement, Model, Parameter
from racs_bif.symbolic.strings import model_from_strings

UNIT = ((0.0, 1.0), (0.0, 1.0))


def held(found):
    """Return counts and areas of the regions, and that nodes agree with them."""
    pieces = [piece for b in found.boundaries for piece in own_pieces(found.lattice, b)]
    parts = regions(found.lattice, pieces)
    assert sum(part.disagreeing for part in parts) == 0
    assert sum(part.face.area for part in parts) == pytest.approx(1.0)
    return {part.count: round(part.face.area, 6) for part in parts}


@pytest.mark.parametrize(("radius", "nodes"), [(0.3, 800), (0.03, 400), (0.01, 700)])
def test_islands_are_found_and_closed(searched, radius, nodes):
    found = searched("island", ("a", "b"), UNIT, r=radius)
    (boundary,) = found.boundaries
    assert (boundary.kind, boundary.closed, boundary.complete) == ("hopf", True, True)
    away = np.hypot(*(boundary.values - [0.371, 0.613]).T) - radius
    assert np.abs(away).max() < 1e-12  # every point is exact
    smooth = np.hypot(*(boundary.line - [0.371, 0.613]).T) - radius
    assert np.abs(smooth).max() < 1e-4 * radius
    assert boundary.omega == pytest.approx(1.0, abs=1e-12)
    assert found.unexplained == []
    # Far fewer than the 16641 of the finest lattice.
    assert len(found.lattice.nodes) < nodes
    areas = held(found)
    assert areas[2] == pytest.approx(np.pi * radius**2, rel=2e-3)
    assert set(areas) == {0, 2}


def test_an_island_below_the_stated_depth_may_be_missed_and_is_found_deeper(searched):
    assert searched("island", ("a", "b"), UNIT, r=0.003).boundaries == []
    assert len(searched("island", ("a", "b"), UNIT, r=0.003, depth=9).boundaries) == 1


def test_two_boundaries_that_cross(searched):
    found = searched("two", ("a", "b"), ((-0.5, 0.5), (-0.5, 0.5)))
    assert [b.kind for b in found.boundaries] == ["hopf", "hopf"]
    assert found.unexplained == []
    # Im: (a - 0.4) w + 0.5 w**0.5 sin(pi/4) = 0 and the like for the other, Re gives w.
    upright, oblique = sorted(found.boundaries, key=lambda b: np.ptp(b.values[:, 0]))
    w = upright.omega[0]
    assert 1.0 - w**2 + 0.5 * w**0.5 * np.cos(np.pi / 4) == pytest.approx(0.0, abs=1e-12)
    expected = 0.4 - 0.5 * w**-0.5 * np.sin(np.pi / 4)
    assert upright.values[:, 0] == pytest.approx(expected, abs=1e-12)
    w = oblique.omega[0]
    assert 4.0 - w**2 + 0.3 * w**0.7 * np.cos(0.35 * np.pi) == pytest.approx(0.0, abs=1e-12)
    total = 0.6 - 0.3 * w**-0.3 * np.sin(0.35 * np.pi)
    assert oblique.values.sum(axis=1) == pytest.approx(total, abs=1e-12)
    assert sorted(held(found)) == [0, 2, 4]
    pieces = regions(found.lattice, found.boundaries)
    assert sorted(part.count for part in pieces) == [0, 2, 2, 4]  # crossed, not merely met


def test_the_oscillator_with_two_springpots(searched):
    found = searched("springpots", ("a", "b"), ((-2.03, 2.0), (-2.0, 2.01)))
    (boundary,) = found.boundaries
    a, b = boundary.values.T
    w = boundary.omega
    # s**2 + a s**0.5 + b s**1.5 + 1 at s = i w: linear in a and b
    assert a == pytest.approx((w**2 - 1.0) / (np.sqrt(2.0 * w)), abs=1e-12)
    assert b == pytest.approx(-a / w, abs=1e-12)
    assert w.max() / w.min() > 5.0
    assert sorted(held(found)) == [0, 2]


def test_boundaries_that_run_along_the_lattice_and_meet(searched):
    found = searched("corner", ("k", "d"), ((-1.0, 1.0), (-0.5, 1.5)))
    assert sorted(b.kind for b in found.boundaries) == ["hopf", "static"]
    static, hopf = sorted(found.boundaries, key=lambda b: b.kind, reverse=True)
    assert np.abs(static.values[:, 0]).max() < 1e-12
    assert np.abs(hopf.values[:, 1]).max() < 1e-12
    assert hopf.omega == pytest.approx(np.sqrt(hopf.values[:, 0]), abs=1e-9)
    assert hopf.complete  # its frequency goes to zero where it meets the other
    areas = held(found)
    assert areas == pytest.approx({0: 0.375, 1: 0.5, 2: 0.125}, abs=1e-4)


def test_where_the_equilibrium_ends(searched):
    found = searched("fold", ("a", "b"), ((-1.0, 1.03), (-0.5, 1.5)))
    fold, hopf = sorted(found.boundaries, key=lambda boundary: boundary.kind)
    assert (fold.kind, hopf.kind) == ("fold", "hopf")
    assert fold.values[:, 0] == pytest.approx(-(fold.values[:, 1] ** 2) / 4.0, abs=1e-12)
    # Where x = -1/2, in a wedge that ends at the fold (BT) and is narrower than a cell.
    assert hopf.values[:, 0] == pytest.approx(0.25 - hopf.values[:, 1] / 2.0, abs=1e-12)
    assert hopf.values.min(axis=0) == pytest.approx([-0.5, 1.0], abs=1e-3)
    areas = held(found)
    b = np.linspace(-0.5, 1.5, 20001)
    there, wedge = np.mean((1.03 + b**2 / 4.0) / 2.03), 0.5**3 / 12.0 / 4.06
    assert areas == pytest.approx({0: there - wedge, 2: wedge, NOTHING: 1.0 - there}, abs=2e-5)


def test_where_the_mass_matrix_is_singular():
    """Behind a b = 1 the inertia is negative; Hopf where b = 0.6 - x, in front of it only."""
    x, y, a, b = sp.symbols("x y a b")
    equations = {"x": y, "y": -x - (b - 0.6) * y + a}
    parameters = (Parameter("a", 0.5), Parameter("b", 0.8))
    model = Model("inertia", equations, parameters, mass=sp.diag(1, 1 - a * b))
    found = search(Plane(system_of(model), ("a", "b"), ((0.0, 2.0), (0.1, 2.1))), ChartSettings())
    hopf, singular = sorted(found.boundaries, key=lambda boundary: boundary.kind)
    assert (hopf.kind, singular.kind) == ("hopf", "singular")
    assert found.unexplained == []
    assert found.troubles == []
    assert singular.values.prod(axis=1) == pytest.approx(1.0, abs=1e-12)
    assert singular.complete
    assert hopf.values[:, 1] == pytest.approx(0.6, abs=1e-12)
    # left of a = 1/2.1 all the height is in front of the line
    share = (1.0 / 2.1 * 2.0 + np.log(2.0 * 2.1) - 0.1 * (2.0 - 1.0 / 2.1)) / 4.0
    areas = held(found)
    assert areas.keys() == {0, 2, BEYOND}
    assert areas[BEYOND] == pytest.approx(1.0 - share, abs=1e-4)
    below = 0.5 * (1.0 / 0.6) + np.log(2.0 * 0.6) - 0.1 * (2.0 - 1.0 / 0.6)
    assert areas[2] == pytest.approx(below / 4.0, abs=1e-4)


def test_a_mass_matrix_that_states_make_singular():
    """x rests at a: the mass 1 - x b is zero on the same curve, and the forces are not."""
    x, y, z, a, b, s = sp.symbols("x y z a b s")
    equations = {"x": y, "y": a - x - y - z}
    model = Model(
        "inertia",
        equations,
        (Parameter("a", 0.5), Parameter("b", 0.5)),
        elements=(FractionalElement("z", y, s ** sp.Rational(1, 2)),),
        mass=sp.diag(1, 1 - x * b),
    )
    found = search(Plane(system_of(model), ("a", "b"), ((0.0, 2.0), (0.0, 2.0))), ChartSettings())
    (singular,) = found.boundaries
    assert singular.values.prod(axis=1) == pytest.approx(1.0, abs=1e-12)
    assert singular.states[:, 0] == pytest.approx(singular.values[:, 0], abs=1e-12)
    areas = held(found)
    assert areas[BEYOND] == pytest.approx((3.0 - np.log(4.0)) / 4.0, abs=1e-4)
    assert areas.keys() == {0, BEYOND}


def test_folds_between_several_equilibria(searched):
    found = searched("cusp", ("a", "b"), ((-1.0, 1.03), (-0.5, 1.5)))
    assert found.torn > 0
    (boundary,) = found.boundaries
    a, b = boundary.values.T
    assert 27.0 * a**2 == pytest.approx(4.0 * b**3, abs=1e-12)
    assert a.min() < -0.6 < 0.6 < a.max()  # through the cusp
    assert held(found).keys() == {0}


def test_generalised_hopf_points_and_l1_along_a_boundary(searched):
    found = searched("bautin", ("a", "b"), ((-0.5, 0.52), (-1.0, 1.1)), lyapunov=True)
    (boundary,) = found.boundaries
    (point,) = [p for p in boundary.special if p.label == "GH"]
    assert point.values == pytest.approx([0.0, 0.0], abs=1e-9)
    # x = 2 Re(w q) with |q| = 1, so that r**2 = 2 |w|**2 and c1 = 2 b.
    ratio = boundary.l1 / boundary.values[:, 1]
    kept = np.abs(boundary.values[:, 1]) > 1e-3
    assert ratio[kept] == pytest.approx(2.0, rel=1e-9)


def test_points_wanted_exactly(model_of):
    plane = Plane(model_of("island"), ("a", "b"), UNIT)
    found = search(plane, ChartSettings(), marks={"a": [0.4], "b": [0.5]})
    marked = {tuple(np.round(p.values, 9)) for p in found.boundaries[0].special}
    high = np.sqrt(0.04 - 0.029**2)
    wide = np.sqrt(0.04 - 0.113**2)
    expected = {(0.4, 0.613 + s * high) for s in (1, -1)} | {
        (0.371 + s * wide, 0.5) for s in (1, -1)
    }
    assert marked == {(round(a, 9), round(b, 9)) for a, b in expected}


def test_a_stable_plane_has_no_boundary(searched):
    found = searched("island", ("a", "b"), ((0.7, 1.0), (0.0, 0.3)))
    assert found.boundaries == []
    assert held(found) == {0: 1.0}


def test_a_plane_without_equilibria_says_so():
    nowhere = system_of(
        model_from_strings(
            "nowhere", {"x": "1 + a**2 + b**2 + x**2"}, parameters={"a": 0.1, "b": 0}
        )
    )
    with pytest.raises(ConvergenceError, match="'nowhere' found anywhere in a 0 to 1 and b 0 to 1"):
        search(Plane(nowhere, ("a", "b"), UNIT), ChartSettings())


def test_nodes_without_an_equilibrium_are_never_stable(searched):
    found = searched("fold", ("a", "b"), ((-1.0, 1.03), (-0.5, 1.5)))
    for node in found.lattice.nodes.values():
        a, b = found.lattice.plane.values(node.place)
        assert (node.count == NOTHING) == (a < -(b**2) / 4.0)


@pytest.mark.parametrize("wrong", [{"coarse": 0}, {"coarse": 6, "depth": 5}, {"depth": 20}])
def test_settings_out_of_range(wrong):
    with pytest.raises(UsageError, match="coarse"):
        ChartSettings(**wrong)


def test_steps_out_of_range():
    with pytest.raises(UsageError, match="'step'"):
        ChartSettings(step=0.0)


def test_an_imperfect_pitchfork_costs_little(monkeypatch):
    """Nearly a static boundary: the determinant changes its sign where equilibria are lost."""
    model = model_from_strings(
        "imperfect",
        {"x": "mu*x - x**3 + h", "y": "-k*y"},
        parameters={"mu": -1.0, "h": 1e-14, "k": 1.0},
    )
    plane = Plane(system_of(model), ("mu", "k"), ((-1.0, 1.1), (1.0, 2.0)))
    follow, asked = Edge.follow, []

    def counted(edge, shares):
        asked.append(len(shares))
        return follow(edge, shares)

    monkeypatch.setattr(Edge, "follow", counted)
    found = search(plane, ChartSettings(coarse=2, depth=3))
    assert found.unexplained
    assert len(asked) < 800  # 4,008 when each edge was halved twelve times, and asked again
