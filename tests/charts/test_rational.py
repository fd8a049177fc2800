"""Charts of the realised operator: its own characteristic roots, without any of its states."""

from dataclasses import replace

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.charts.plane import Plane
from racs_bif.charts.search import search
from racs_bif.charts.settings import ChartSettings
from racs_bif.charts.sheet import Sheet
from racs_bif.charts.sums import expand
from racs_bif.errors import UsageError
from racs_bif.fractional.rational import RationalSystem, rational
from racs_bif.fractional.realisations import choose_realisation

QUICK = ChartSettings(coarse=3, depth=3)


@pytest.fixture(scope="module")
def springpots(model_of):
    return model_of("springpots")


@pytest.mark.parametrize("name", ["diffusive", "oustaloup", "fitted", "aaa"])
def test_a_filter_as_a_quotient_of_polynomials(springpots, name):
    system = replace(springpots, settings=choose_realisation(name, (0.1, 50.0)))
    frame = system.field.frame(system.values)
    made = rational(frame.laws[0], frame.filters[0])
    s = 1j * np.geomspace(0.01, 500.0, 30)
    assert made(s) == pytest.approx(frame.filters[0](s), rel=1e-8)
    assert made.integer


def test_derivatives_of_the_law(model_of):
    system = RationalSystem.of(model_of("two"))
    field = system.exact.field
    dp = np.zeros(len(system.values))
    dp[[p.name for p in system.compiled.parameters].index("q")] = 1.0
    moved = field.law_directions(system.values, dp)
    h, s = 1e-6, 0.4 + 1.3j
    around = [field.laws(system.values + side * h * dp)[1] for side in (1.0, -1.0)]
    for part in ("numerator", "denominator"):
        own = getattr(field.laws(system.values)[1], part)
        slope = own.along(getattr(moved[1], part), s)
        numbers = [getattr(law, part)(s) for law in around]
        difference = (numbers[0] - numbers[1]) / (2.0 * h)
        assert slope == pytest.approx(difference, rel=1e-5, abs=1e-5 * abs(own(s)))


def test_roots_are_those_of_the_realised_jacobian(model_of):
    system = RationalSystem.of(model_of("two"))
    plane = Plane(system, ("a", "b"), ((-0.5, 0.5), (-0.5, 0.5)))
    places = np.array([[0.1, 0.9], [0.2, 0.8]])
    P, X = plane.vectors(places), np.zeros((system.compiled.size, 2))
    sheet = Sheet(plane)
    sums = expand(sheet.core(X, P), sheet.laws(P))
    for k in range(2):
        jacobian = system.field.f_x(np.zeros(len(system.field.states)), P[:, k])
        roots = np.linalg.eigvals(jacobian)
        pair = roots[np.argmax(roots.real)]
        pair = complex(pair.real, abs(pair.imag))
        value = sums.evaluate(np.full(2, np.log(pair)))[0]
        assert abs(value[k]) < 1e-9


def test_boundaries_are_hopf_points_of_the_realisation(model_of):
    system = model_of("two")
    # A narrow band: the realised boundary is seen to differ.
    system = replace(system, settings=choose_realisation("oustaloup", (0.5, 8.0), order=2))
    chart = rb.stability_chart(
        system,
        "a",
        "b",
        ((-0.5, 0.5), (-0.5, 0.5)),
        operator="realised",
        settings=QUICK,
        lyapunov=False,
    )
    exact = rb.stability_chart(system, "a", "b", ((-0.5, 0.5), (-0.5, 0.5)), settings=QUICK)
    assert (chart.operator, exact.operator) == ("realised", "exact")
    assert len(chart.boundaries) == 2
    for boundary in chart.boundaries:
        for values, omega in zip(boundary.values[::9], boundary.omega[::9], strict=True):
            p = system.with_parameters(dict(zip(("a", "b"), values, strict=True))).values
            roots = np.linalg.eigvals(system.field.f_x(np.zeros(len(system.field.states)), p))
            assert np.abs(roots - 1j * omega).min() < 1e-7
    ends = [np.sort(c.boundaries[0].values[0]) for c in (chart, exact)]
    assert np.abs(ends[0] - ends[1]).max() > 1e-4
    assert {r.unstable for r in chart.regions} == {0, 2, 4}


def test_a_model_without_elements_has_one_operator(model_of):
    system = model_of("corner")
    chart = rb.stability_chart(
        system, "k", "d", ((-0.5, 0.6), (-0.5, 0.6)), operator="realised", settings=QUICK
    )
    assert {r.unstable for r in chart.regions} == {0, 1, 2}


def test_what_cannot_be_written_so(springpots):
    frame = springpots.field.frame(springpots.values)
    law, done = frame.laws[0], frame.filters[0]
    twins = replace(
        done, A=np.array([[-1.0, 1.0], [0.0, -1.0]]), B=np.array([0.0, 1.0]), C=np.ones(2)
    )
    with pytest.raises(UsageError, match="choose the realisation 'diffusive' or 'fitted'"):
        rational(law, twins)


def test_planes_in_which_the_law_moves(model_of):
    system = RationalSystem.of(model_of("two"))
    found = search(Plane(system, ("a", "q"), ((-0.5, 0.5), (0.5, 0.9))), QUICK)
    assert found.boundaries
    assert not found.unexplained
