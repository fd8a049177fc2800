"""The exact normal form: the vehicle's coefficient, and ordinary systems."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.equilibria.hopf_form import hopf_form
from racs_bif.fractional.diffusive import Diffusive
from racs_bif.fractional.exact_form import exact_form
from racs_bif.fractional.exact_hopf import solve_hopf
from racs_bif.fractional.roots import characteristic_roots
from racs_bif.shelf.load import system_of


def form_of(system, parameter, value, omega):
    path = system.path(parameter)
    p = path.vector(value)
    X = system.exact_point(system.equilibrium(p), p)
    return exact_form(system.exact, path, solve_hopf(system.exact, path, X, value, omega))


def test_the_vehicle_shimmies_as_computed_by_harmonic_balance():
    form = form_of(rb.load_model("racs"), "u", 10.2, 9.52)
    assert form.curvature(2) == pytest.approx(50.3487, abs=5e-5)  # model.md, section 4: kappa
    assert form.l1 < 0.0


@pytest.mark.parametrize("name", ["u", "C_s", "alpha", "gamma", "tau_eps"])
def test_the_speed_of_the_root_is_that_of_the_exact_roots(name):
    """Also by parameters that stand in the law."""
    system = rb.load_model("racs")
    path, X = system.path("u"), np.zeros(5)
    hopf = solve_hopf(system.exact, path, X, 10.2, 9.52)
    system = system.with_parameters({"u": hopf.value})
    value = system.parameters[name]
    form = exact_form(system.exact, system.path(name), replace(hopf, value=value))
    step = 1e-4 * value
    ahead, behind = (
        characteristic_roots(system.with_parameters({name: value + h})).roots[0]
        for h in (step, -step)
    )
    assert form.mu_slope == pytest.approx((ahead - behind) / (2.0 * step), rel=1e-5)


def test_a_nonlinear_input_of_an_element_counts_by_its_law(system_of):
    """An element of integer order is an ordinary equation: w = 2 e - z, z' = e - z."""
    states = {"x": "mu*x - y - x**3 + 0.2*w", "y": "x + y**2"}
    whole = system_of(
        states, elements=[("w", "y + x**2 - x**3", "(1 + 2*s)/(1 + s)")], parameters={"mu": 0.0}
    )
    plain = {k: v.replace("w", "(2*(y + x**2 - x**3) - z)") for k, v in states.items()}
    plain = system_of(plain | {"z": "y + x**2 - x**3 - z"}, parameters={"mu": 0.0})
    forms = []
    for system in (whole, plain):
        path = system.path("mu")
        hopf = solve_hopf(system.exact, path, np.zeros(3), 0.0, 0.8)
        forms.append(exact_form(system.exact, path, hopf))
    one, other = forms
    assert one.omega == pytest.approx(other.omega, rel=1e-10)
    assert one.mu_slope == pytest.approx(other.mu_slope, rel=1e-9)
    assert one.curvature(0) == pytest.approx(other.curvature(0), rel=1e-9)
    assert one.curvature(1) == pytest.approx(other.curvature(1), rel=1e-9)


def test_the_brusselator_has_the_textbook_coefficient():
    model = rb.model_from_strings(
        "brusselator",
        {"x": "A-(B+1)*x+x**2*y", "y": "B*x-x**2*y"},
        parameters={"A": 1.0, "B": 2.0},
        guess={"x": 1.0, "y": 2.0},
    )
    form = form_of(system_of(model), "B", 2.0, 1.0)
    assert form.c1.real == pytest.approx(-0.5, rel=1e-12)
    assert form.mu_slope == pytest.approx(0.5, rel=1e-12)


def test_fine_realisations_converge_to_it():
    system = rb.load_model("racs")
    exact = form_of(system, "u", 10.2, 9.52)
    fine = rb.load_model("racs", realisation=Diffusive(band=(1e-3, 1e4), order=45))
    hopf = rb.continue_equilibria(fine, "u", (9.0, 11.0))["H1"]
    raw = hopf.origin.raw
    path = fine.path("u")
    form = hopf_form(
        fine.field, raw.z[:-1], path.vector(raw.z[-1]), path.direction(raw.z[-1]), hopf.omega, 4
    )
    assert form.l1 == pytest.approx(exact.l1, rel=1e-5)
    assert form.mu_slope == pytest.approx(exact.mu_slope, rel=1e-5)
    assert form.frequency_curvature == pytest.approx(exact.frequency_curvature, rel=1e-4)
    assert np.allclose(form.h11[:4], exact.h11[:4], rtol=1e-4, atol=1e-6)


def test_fractional_van_der_pol_with_integrating_laws():
    """D^q x = y, D^q y = -x - ep (x^2 - 1) y: averaging gives the sign and size of c1."""
    model = rb.model_from_strings(
        "fvdp",
        {},
        parameters={"q": 1.0 - 1e-9, "ep": 0.0},
        elements=[("x", "y", "s**(-q)"), ("y", "-x-ep*(x**2-1)*y", "s**(-q)")],
    )
    system = system_of(model, parameters={"ep": 1e-3})
    path = system.path("ep")
    X = np.zeros(2)
    hopf = solve_hopf(system.exact, path, X, 0.0, 1.0)
    assert hopf.omega == pytest.approx(1.0, abs=1e-8)
    form = exact_form(system.exact, path, hopf)
    # near q = 1 the growth rate is ep/2
    assert form.mu_slope.real == pytest.approx(0.5, rel=1e-6)
