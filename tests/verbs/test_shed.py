"""Equilibria with the orbits they shed, on a model whose orbits are circles."""

from __future__ import annotations

import pytest

import racs_bif as rb
from racs_bif.verbs.shed import shed_diagram, through


@pytest.fixture(scope="module")
def bubble():
    """Orbits of radius sqrt(r) where r = 1 - mu**2 > 0: born at mu = -1, gone at mu = 1."""
    return rb.model_from_strings(
        "bubble",
        {
            "x": "(1-mu**2)*x-k*y-x*(x**2+y**2)",
            "y": "k*x+(1-mu**2)*y-y*(x**2+y**2)",
        },
        parameters={"mu": -1.5, "k": 2.0},
    )


def test_orbits_between_two_hopf_points_are_followed_once(bubble):
    diagram, troubles = shed_diagram(bubble, "mu", (-1.5, 1.5), at=(0.5,))
    assert troubles == ()
    assert [p.parameters["mu"] for p in diagram.branches[0].special if p.label == "H"] == (
        pytest.approx([-1.0, 1.0])
    )
    (orbits,) = (branch for branch in diagram if branch.kind == "orbit")
    at = orbits.at(mu=0.5)
    assert orbits.column("max x")[at.index] == pytest.approx(0.75**0.5, rel=1e-6)


def test_an_orbit_is_followed_in_another_parameter(bubble):
    diagram, _ = shed_diagram(bubble, "mu", (-1.5, 0.2), at=(0.0,))
    (orbits,) = (branch for branch in diagram if branch.kind == "orbit")
    found = through(orbits.at(mu=0.0), "k", (1.9, 3.0))
    assert found.parameter[-1] == pytest.approx(3.0)
    assert found.measures["period"][-1] == pytest.approx(2.0943951, rel=1e-5)
