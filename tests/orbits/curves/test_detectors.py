"""What is reported where a test function of a curve of cycles changes sign: a point, or nothing."""

from types import SimpleNamespace

import numpy as np
import pytest

from racs_bif.continuation.points import Point
from racs_bif.orbits.curves import doubling_points, fold_points
from racs_bif.orbits.curves.doubling_points import DoublingResonance, GeneralisedPeriodDoubling
from racs_bif.orbits.curves.fold_points import CuspOfCycles, FoldResonance
from racs_bif.orbits.curves.interactions import DoublingBeside, FoldBeside, TorusBeside
from racs_bif.orbits.curves.torus_points import Chenciner, TorusResonance


def at(*others):
    """Return a point whose multipliers are the trivial one and others."""
    spectrum = np.array([1.0, *others], dtype=complex)
    return SimpleNamespace(z=np.zeros(3), spectrum=spectrum)


def curve(**more):
    """Return a curve of cycles of period 3, none of whose further multipliers is critical."""
    return SimpleNamespace(noncritical=lambda spectrum: spectrum[1:], period=lambda _z: 3.0, **more)


def with_coefficient(value, size, kappa=0.3):
    layout = SimpleNamespace(further_of=lambda _z: np.array([kappa]))
    found = SimpleNamespace(value=value, size=size)
    return curve(coefficient=lambda _z: found, layout=layout)


def test_a_further_multiplier_is_one():
    detector = FoldBeside("LPNS", "lpc, ns")
    found = detector.data(curve(), at(1.0 + 1e-5, 0.3))
    assert found["period"] == 3.0
    assert found["starts"] == "lpc, ns"
    assert found["trivial_error"] == 0.0
    np.testing.assert_array_equal(found["multipliers"], [1.0, 1.0 + 1e-5, 0.3])
    # The sign changes where a real multiplier jumps over 1 between two points, too.
    assert detector.data(curve(), at(1.2, 0.3)) is None
    assert np.isnan(detector.value(curve(), at()))
    assert detector.value(curve(), at(1.2)) < 0.0 < detector.value(curve(), at(0.8))


@pytest.fixture
def point():
    def make(*others):
        spectrum = np.array([1.0, *others], dtype=complex)
        return Point(
            z=np.zeros(3),
            tangent=np.zeros(3),
            spectrum=spectrum,
            stable=None,
            unstable=-1,
            measures={},
            arclength=0.0,
            iterations=0,
        )

    return make


def test_a_further_multiplier_is_minus_one(point):
    detector = DoublingBeside("PDNS", "pd, ns")
    found = detector.data(curve(), point(-1.0 + 1e-6, 0.3))
    assert (found["period"], found["starts"]) == (3.0, "pd, ns")
    assert detector.data(curve(), point(-0.8, 0.3)) is None


def test_a_further_pair_is_on_the_unit_circle():
    detector = TorusBeside("NSNS", "ns")
    pair = np.exp(0.7j)
    found = detector.data(curve(), at(0.4 * pair, 0.4 / pair, pair, 1.0 / pair, 0.3))
    assert found["angle"] == pytest.approx(0.7)
    assert (found["period"], found["starts"]) == (3.0, "ns")
    # Neutral saddles: two real multipliers whose product is 1.
    assert detector.data(curve(), at(2.0, 0.5)) is None
    assert detector.data(curve(), at(1.1 * pair, 1.1 / pair)) is None


@pytest.mark.parametrize(
    ("module", "detector", "starts"),
    [(fold_points, FoldResonance(), "lpc, ns"), (doubling_points, DoublingResonance(), "pd, ns")],
)
def test_the_pairing_vanishes_or_jumps(module, detector, starts, monkeypatch):
    for value, there in ((1e-7, True), (0.3, False), (-0.3, False)):
        monkeypatch.setattr(module, "pairing", lambda _problem, _z, value=value: value)
        found = detector.data(curve(), at(0.3))
        assert (found is not None) == there
        assert not there or found["starts"] == starts
        assert detector.value(curve(), at(0.3)) == value


def test_a_cusp_of_cycles_is_no_pole_of_its_coefficient(monkeypatch):
    monkeypatch.setattr(fold_points, "pairing", lambda _problem, _z: 1e-6)
    assert CuspOfCycles().data(curve(), at(0.3)) is None
    monkeypatch.setattr(fold_points, "pairing", lambda _problem, _z: 0.5)
    assert CuspOfCycles().data(curve(), at(0.3))["starts"] == "lpc"


def test_coefficients_vanish_relative_to_what_they_are_made_of():
    for detector, starts in ((GeneralisedPeriodDoubling(), "pd"), (Chenciner(), "ns")):
        found = detector.data(with_coefficient(1e-6 + 0j, 1.0), at(0.3))
        assert (found["period"], found["starts"]) == (3.0, starts)
        assert detector.data(with_coefficient(1e-6 + 0j, 1e-6), at(0.3)) is None
        assert detector.data(with_coefficient(5.0 + 0j, 1.0), at(0.3)) is None
    found = Chenciner().data(with_coefficient(1e-6 + 2j, 1.0), at(0.3))
    assert found["angle"] == pytest.approx(np.arccos(0.3))


@pytest.mark.parametrize("kappa", [1.0, -1.0, -0.5, 0.0, 1.3, -2.0])
def test_the_torus_coefficient_is_unknown_at_resonances_and_neutral_saddles(kappa):
    assert np.isnan(Chenciner().value(with_coefficient(0.25 + 1j, 1.0, kappa), at()))
    assert Chenciner().value(with_coefficient(0.25 + 1j, 1.0, 0.3), at()) == 0.25


def test_strong_resonances_are_told_by_their_angle():
    problem = with_coefficient(0.0, 1.0, -0.4)
    third = TorusResonance("R3", -0.5)
    assert third.value(problem, at()) == pytest.approx(0.1)
    assert third.data(problem, at())["starts"] == "ns"
