"""Orbits around a centre all have one value of the parameter."""

import pytest

import racs_bif as rb


@pytest.fixture(scope="module")
def van_der_pol():
    return rb.load_model("van_der_pol", parameters={"g": 1})


def test_the_cycle_leaves_the_circles_where_their_radius_is_2(van_der_pol):
    hopf = rb.continue_equilibria(van_der_pol, "mu", (-1, 3))["H1"]
    assert hopf.criticality == "degenerate"
    circles = rb.continue_orbits(hopf, span=(-1, 3), method="collocation")
    assert [point.label for point in circles.special] == ["BPC", "EP"]
    branching = circles["BPC1"]
    assert branching.state["x"] == pytest.approx(2.0, abs=1e-8)
    assert branching.parameters["mu"] == pytest.approx(0.0, abs=1e-8)
    cycle = rb.continue_orbits(branching, span=(-1, 1))
    assert sorted(cycle.values[[0, -1], 0]) == [-1.0, 1.0]
    end = cycle.values[:, 0] == 1.0
    assert cycle.measures["period"][end] == pytest.approx(6.6632868593231, rel=1e-9)
    assert cycle.measures["max x"][end] == pytest.approx(2.00861986, rel=1e-7)
    assert cycle.stable[end].all()


def test_a_hopf_point_of_a_cubic_that_is_small_is_not_degenerate():
    small = rb.model_from_strings(
        "small",
        {"x": "mu*x - y - 1e-9*x*(x**2 + y**2)", "y": "x + mu*y - 1e-9*y*(x**2 + y**2)"},
        parameters={"mu": -1.0},
    )
    hopf = rb.continue_equilibria(small, "mu", (-1, 1))["H1"]
    assert hopf.criticality == "supercritical"
    assert hopf.l1 == pytest.approx(-2e-9, rel=1e-6)
