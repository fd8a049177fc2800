"""The realisation fitted to the bifurcation, on the vehicle and on forty like it."""

import sys
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from racs_bif.equilibria.hopf_form import hopf_form
from racs_bif.errors import ConvergenceError, UsageError
from racs_bif.fractional import fitted as fitted_module
from racs_bif.fractional.diffusive import Diffusive
from racs_bif.fractional.exact_hopf import solve_hopf
from racs_bif.fractional.fitted import Fitted, fit_to_hopf
from racs_bif.fractional.laws import Law, PowerSum
from racs_bif.fractional.realised_hopf import solve_realised_hopf
from racs_bif.shelf.load import load_model

BAND = (1.0, 60.0)
OWN = 4
FINE = Diffusive(band=(1e-2, 1e4), order=40)
RANGES = {
    "c": (0.2, 0.5),
    "m_c": (50.0, 200.0),
    "alpha": (0.15, 0.45),
    "gamma": (0.55, 0.85),
    "C_s": (2e4, 4.5e4),
    "delta_f": (0.0, 0.03),
}
SPEEDS = np.arange(3.0, 40.5, 0.75)
VEHICLES = 40


@pytest.fixture(scope="module")
def racs():
    return load_model("racs", band=BAND)


def critical(system, path, value, X):
    """Return the rightmost oscillating eigenvalue and the exact equilibrium."""
    p = path.vector(value)
    X = system.exact.equilibrium(X, p)
    x = system.field.rest(X[:OWN], X[OWN:], p)
    mu = np.linalg.eigvals(system.field.f_x(x, p))
    mu = mu[mu.imag > 0.3]
    return mu[np.argmax(mu.real)], X


def first_hopf(system):
    """Return the exact Hopf point first met from 3 m/s on the branch of straight running."""
    path, X, before = system.path("u"), np.zeros(OWN + 1), None
    for u in SPEEDS:
        try:
            mu, X = critical(system, path, u, X)
        except ConvergenceError:
            return None
        if before is not None and before * mu.real < 0.0:
            return solve_hopf(system.exact, path, X, u, mu.imag)
        before = mu.real
    return None


def form(system, exact):
    """Return the realised Hopf point and its normal form."""
    path = system.path("u")
    found = solve_realised_hopf(system, path, exact.X, exact.value, exact.omega)
    p, dp = path.vector(found.value), path.direction(found.value)
    return found, hopf_form(system.field, found.x, p, dp, found.omega, OWN)


def test_forty_random_vehicles(racs):
    rng = np.random.default_rng(2024)
    scout = replace(racs, settings=Diffusive(band=(0.1, 300.0)))
    worst = dict.fromkeys(("speed", "speed by Newton", "omega", "crossing", "l1", "band"), 0.0)
    kept = drawn = 0
    while kept < VEHICLES:
        drawn += 1
        vehicle = scout.with_parameters({k: rng.uniform(*v) for k, v in RANGES.items()})
        exact = first_hopf(vehicle)
        if exact is None or not SPEEDS[0] <= exact.value <= 40.0:
            continue
        kept += 1
        coarse = replace(vehicle, settings=Diffusive(band=BAND))
        fitted = fit_to_hopf(coarse, "u", exact.value * 1.01, exact.omega * 0.98, X=exact.X)
        assert fitted.realisation.states == 8
        path = fitted.path("u")
        near = (exact.value * 0.98, exact.value * 1.02)
        alone = brentq(
            lambda u, s=fitted, w=path, X=exact.X: critical(s, w, u, X)[0].real,
            *near,
            xtol=1e-13,
            rtol=1e-13,
        )
        found, mine = form(fitted, exact)
        _, fine = form(replace(fitted, settings=FINE), exact)
        errors = {
            "speed": alone / exact.value - 1.0,
            "speed by Newton": found.value / exact.value - 1.0,
            "omega": found.omega / exact.omega - 1.0,
            "crossing": mine.mu_slope / fine.mu_slope - 1.0,
            "l1": mine.l1 / fine.l1 - 1.0,
            "band": fitted.realisation.error,
        }
        worst = {k: max(v, abs(errors[k])) for k, v in worst.items()}
    shown = ", ".join(f"{k} {v:.1e}" for k, v in worst.items())
    sys.stdout.write(f"\n{kept} of {drawn} vehicles, worst errors: {shown}\n")  # seen with -s
    assert worst["speed"] < 1e-9
    assert worst["speed by Newton"] < 1e-11
    assert worst["omega"] < 1e-11
    assert worst["crossing"] < 1e-5  # what the fine realisation leaves
    assert worst["l1"] < 1e-5
    assert worst["band"] < 0.03


def test_paper_vehicle(racs):
    fitted = fit_to_hopf(racs, "u", 10.0, 9.0)
    assert isinstance(fitted.settings, Fitted)
    assert fitted.settings.band == BAND
    assert fitted.settings.omega == pytest.approx(9.5200832, abs=1e-7)
    path = fitted.path("u")
    X = fitted.exact_point(fitted.equilibrium(path.vector(10.2)), path.vector(10.2))
    found = solve_realised_hopf(fitted, path, X, 10.0, 9.0)  # from afar
    assert found.value == pytest.approx(10.2, rel=1e-10)
    assert found.omega == pytest.approx(9.5200832, abs=1e-7)


@pytest.mark.parametrize("order", [7, 8, 12])
def test_any_order_from_seven_is_exact(racs, order):
    fitted = fit_to_hopf(racs, "u", 10.0, 9.0, order=order)
    assert fitted.realisation.states == order
    again = fit_to_hopf(fitted, "u", 10.2, 9.5)
    assert again.realisation.states == order
    assert again.settings.omega == pytest.approx(fitted.settings.omega, rel=1e-12)


def test_refitted_where_the_hopf_point_moves(racs):
    # model.md, section 4: exact Hopf points with one parameter changed
    fitted = fit_to_hopf(racs, "u", 10.2, 9.5)
    moved = fit_to_hopf(fitted.with_parameters({"m_c": 200.0}), "u", 11.5, 8.7)
    assert moved.settings.omega == pytest.approx(8.6582576, abs=1e-7)


def test_exact_along_an_order_too(racs):
    # Z_r(i omega) = Z(i omega) holds for every alpha, so its derivative is exact as well
    fitted = fit_to_hopf(racs, "alpha", 0.3, 9.5)  # at the default u = 10
    path = fitted.path("alpha")
    X = fitted.exact_point(fitted.equilibrium(), fitted.values)
    exact = solve_hopf(fitted.exact, path, X, 0.3, 9.5)
    fine = replace(fitted, settings=FINE)
    mine = solve_realised_hopf(fitted, path, exact.X, exact.value, exact.omega)
    other = solve_realised_hopf(fine, path, exact.X, exact.value, exact.omega)
    assert mine.value == pytest.approx(exact.value, rel=1e-11)
    assert mine.slope == pytest.approx(other.slope, rel=1e-5)


def test_no_hopf_point_is_an_error(racs):
    # model.md, section 4: none between 1 and 60 m/s
    with pytest.raises(ConvergenceError, match="no exact Hopf point"):
        fit_to_hopf(racs.with_parameters({"alpha": 0.6}), "u", 10.0, 9.5)


def test_band_without_the_critical_frequency_refused(racs):
    narrow = replace(racs, settings=Diffusive(band=(20.0, 60.0)))
    with pytest.raises(UsageError, match="outside the band 20"):
        fit_to_hopf(narrow, "u", 10.0, 9.5)


LAWS = [
    Law(
        PowerSum(np.array([1.0, 1.0]), np.array([0.0, 0.7])),
        PowerSum(np.array([1.0, 1.0]), np.array([0.0, 0.3])),
    ),
    Law(PowerSum(np.array([2.0]), np.array([0.5])), PowerSum(np.array([1.0]), np.array([0.0]))),
    Law(
        PowerSum(np.array([1.0]), np.array([0.0])),
        PowerSum(np.array([1.0, 1.0]), np.array([0.0, 0.6])),
        feedthrough=False,
    ),
    Law(
        PowerSum(np.array([1.0]), np.array([0.0])),
        PowerSum(np.array([1.0]), np.array([0.6])),
        feedthrough=False,
    ),
]


@pytest.mark.parametrize("law", LAWS)
def test_conditions_hold(law):
    omega, h = 9.5, 1e-3
    realised = Fitted(band=BAND, omega=omega).realise(law)
    s = 1j * np.array([omega, 2.0 * omega])
    np.testing.assert_allclose(realised(s), law(s), rtol=1e-12)
    around = 1j * (omega + h * np.array([-2.0, -1.0, 1.0, 2.0]))
    weights = np.array([1.0, -8.0, 8.0, -1.0]) / 12.0 / h
    assert weights @ realised(around) == pytest.approx(weights @ law(around), rel=1e-8)


def test_settings():
    assert Fitted(band=(1.0, 100.0)).omega == pytest.approx(10.0)
    assert Fitted(band=BAND).order == 8
    with pytest.raises(UsageError, match="at least 7"):
        Fitted(band=BAND, order=6)
    with pytest.raises(UsageError, match="outside the band"):
        Fitted(band=BAND, omega=0.5)
    with pytest.raises(UsageError, match="spread"):
        Fitted(band=BAND, spread=0.0)


@pytest.mark.parametrize(("parameter", "omega"), [("C_s", 9.52), ("alpha", 9.5)])
def test_agreement_is_relative_to_the_parameter(racs, monkeypatch, parameter, omega):
    """Some 3e4 N/rad and some 0.3."""
    system = racs.with_parameters({"u": 10.2})
    shift = 2e-12

    def off(*given):
        found = solve_realised_hopf(*given)
        return replace(found, value=found.value * (1.0 + shift))

    monkeypatch.setattr(fitted_module, "solve_realised_hopf", off)
    near = system.parameters[parameter], omega
    assert isinstance(fit_to_hopf(system, parameter, *near).settings, Fitted)
    shift = 2e-11
    with pytest.raises(ConvergenceError, match=rf"off by 2\.0e-11 in {parameter};"):
        fit_to_hopf(system, parameter, *near)
