"""Normal-form coefficients of cycles: exact ones, published ones, and what they must not depend on.

The exact systems are suspensions: an angle phi that runs once a period, and transverse coordinates
whose equation is the normal form itself.
"""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
import sympy as sp

import racs_bif as rb
from racs_bif.equilibria.hopf_form import hopf_form
from racs_bif.orbits import (
    collocated_from_samples,
    doubled,
    from_samples,
)
from racs_bif.orbits.critical_orbit import DEGREE, GaussOrbits
from racs_bif.orbits.mesh import Mesh
from racs_bif.orbits.normal_forms import cycle_normal_form
from racs_bif.orbits.piecewise import Piecewise, equidistant
from racs_bif.orbits.polishing import polished
from racs_bif.shelf.load import system_of

OMEGA = 1.3
T = 2.0 * np.pi / OMEGA


def suspension(transverse, extra=(), speed=1, **parameters):
    """Return equations of (x, y, z, *extra): r - 1 and z transverse to the circle r = 1.

    `transverse` gives (rho', z') from (rho, z, cos phi, sin phi), `speed` multiplies phi' = omega.
    """
    x, y, z = sp.symbols("x y z")
    r = sp.sqrt(x**2 + y**2)
    c, s = x / r, y / r
    rho_rate, z_rate = transverse(r - 1, z, c, s)
    turn = OMEGA * speed
    equations = {"x": c * rho_rate - y * turn, "y": s * rho_rate + x * turn, "z": z_rate}
    equations |= dict(extra)
    return {name: str(sp.sympify(value)) for name, value in equations.items()}, parameters


def mixed(equations, matrix):
    """Return the equations of Y = M X, with Y named as X is, M a matrix of sympy."""
    names = sp.symbols(list(equations))
    back = dict(zip(names, matrix.inv() * sp.Matrix(names), strict=True))
    rates = sp.Matrix([sp.sympify(e).subs(back, simultaneous=True) for e in equations.values()])
    turned = matrix * rates
    return {str(n): str(e) for n, e in zip(names, turned, strict=True)}


def circle(size, matrix=None, shift=0.0):
    """Sample the orbit."""
    phases = np.linspace(0.0, 2.0 * np.pi, 401) + shift
    profile = np.zeros((size, len(phases)))
    profile[0], profile[1] = np.cos(phases), np.sin(phases)
    return profile if matrix is None else np.asarray(matrix, dtype=float) @ profile


def rotation(size):
    """Return an orthogonal matrix of fractions that mixes all coordinates."""
    turned = sp.eye(size)
    for k in range(size - 1):
        plane = sp.eye(size)
        plane[k : k + 2, k : k + 2] = sp.Matrix([[3, -4], [4, 3]]) / 5
        turned = plane * turned
    return turned


@pytest.fixture
def found():
    """Return the normal form of the unit circle of a system."""

    def find(equations, parameters, label, *, angle=0.0, matrix=None, shift=0.0, start=None):
        model = rb.model_from_strings("suspension", equations, parameters=parameters)
        system = system_of(model)
        field, path = system.field, system.path(next(iter(parameters)))
        profile = circle(len(equations), matrix, shift)
        times = np.linspace(0.0, T, profile.shape[1])
        value = next(iter(parameters.values()))
        begun = (start or collocated_from_samples)(field, path, times, profile, value)
        return cycle_normal_form(begun.problem, SimpleNamespace(z=begun.z), label, angle)

    return find


# ---------------------------------------------------------------- period doubling


def moebius(c="c", quadratic=True):
    """A direction s that comes back as -s: s' = sg s + c s^3, phi' = omega (1 + a s^2).

    The third state w follows s^2 and acts back on s, so that the cubic coefficient is c + g b / k.
    """
    c, sg, a, b, g, k = sp.symbols(f"{c} sg a b g k")
    w, x, y, z = sp.symbols("w x y z")

    def squared(rho, z, cos, sin):
        return (1 + cos) / 2 * rho**2 + sin * rho * z + (1 - cos) / 2 * z**2

    r = sp.sqrt(x**2 + y**2)
    s2 = squared(r - 1, z, x / r, y / r)
    rate = sg + c * s2 + g * w

    def transverse(rho, z, cos, sin):
        along = ((1 + cos) / 2 * rho + sin / 2 * z, sin / 2 * rho + (1 - cos) / 2 * z)
        turn = OMEGA * (1 + a * s2) / 2
        return tuple(
            rate * p - 2 * (q - p) + turn * j
            for p, q, j in zip(along, (rho, z), (-z, rho), strict=True)
        )

    return suspension(transverse, {"w": -k * w + b * s2 * int(quadratic)}, 1 + a * s2)[0]


PD = {"sg": 0.0, "c": -0.7, "a": 0.4, "b": 1.1, "g": 0.5, "k": 2.0}
EXACT_C = (-0.7 + 0.5 * 1.1 / 2.0) / T


def test_exact_period_doubling(found):
    form = found(moebius(), PD, "PD")
    assert form["c"] == pytest.approx(EXACT_C, rel=1e-9)
    assert abs(form["c"] - EXACT_C) <= form["c_error"] < 1e-7
    assert form["criticality"] == "supercritical"


def test_a_doubling_found_a_little_off_is_found_again(found):
    assert found(moebius(), PD | {"sg": 2e-4}, "PD")["c"] == pytest.approx(EXACT_C, rel=1e-9)


def test_a_doubling_that_is_far_is_no_doubling(found):
    form = found(moebius(), PD | {"sg": 0.9}, "PD")
    assert set(form) == {"normal_form"}
    assert "close by" in form["normal_form"]


def test_subcritical_and_degenerate_doublings(found):
    assert found(moebius(), PD | {"c": 0.7}, "PD")["criticality"] == "subcritical"
    form = found(moebius(), PD | {"c": -0.275}, "PD")  # = -g b / k
    assert form["criticality"] == "degenerate"
    assert abs(form["c"]) < 1e-8


@pytest.mark.parametrize("start", [collocated_from_samples, from_samples], ids=["Gauss", "Radau"])
def test_neither_coordinates_nor_phase_nor_discretisation_matter(found, start):
    matrix = rotation(4)
    equations = mixed(moebius(), matrix)
    form = found(equations, PD, "PD", matrix=matrix, shift=1.1, start=start)
    assert form["c"] == pytest.approx(EXACT_C, rel=1e-8)


def test_other_units_change_c_by_the_square_of_a_length(found):
    units = sp.diag(1, 1, 100, sp.Rational(1, 100))
    phases = np.linspace(0.0, 2.0 * np.pi, 1001)[:-1]
    mean = np.mean(np.cos(phases / 2) ** 2 + (100.0 * np.sin(phases / 2)) ** 2)
    form = found(mixed(moebius(), units), PD, "PD", matrix=units)
    assert form["c"] == pytest.approx(EXACT_C / mean, rel=1e-8)


# ---------------------------------------------------------------- Neimark-Sacker


def rotating():
    """zeta = rho + i z: zeta' = (sg + i W + (d1 + i d2) |zeta|^2 + g w + h v conj(zeta)/zeta) zeta.

    w' = -k w + b |zeta|^2 and v' = -l v + Re zeta^2 act back, phi' = omega (1 + a |zeta|^2).
    """
    sg, W, d1, d2, a, b, g, k, h, m = sp.symbols("sg W d1 d2 a b g k h l")
    w, v, x, y, z = sp.symbols("w v x y z")
    rho = sp.sqrt(x**2 + y**2) - 1
    s2 = rho**2 + z**2

    def transverse(rho, z, cos, sin):
        del cos, sin
        growth, turn = sg + d1 * s2 + g * w, W + d2 * s2
        return growth * rho - turn * z + h * v * rho, growth * z + turn * rho - h * v * z

    extra = {"w": -k * w + b * s2, "v": -m * v + rho**2 - z**2}
    return suspension(transverse, extra, 1 + a * s2)[0]


NS = {"sg": 0.0, "W": 0.47, "d1": -0.6, "d2": 0.3, "a": 0.35, "b": 0.8, "g": 0.5, "k": 1.5}
NS |= {"h": 0.7, "l": 2.1}
EXACT_D = (-0.6 + 0.3j + 0.5 * 0.8 / 1.5 + 0.5 * 0.7 / (2.1 + 0.94j)) * 2.0 / T


def test_exact_neimark_sacker(found):
    form = found(rotating(), NS, "NS", angle=0.47 * T)
    assert form["d"] == pytest.approx(EXACT_D, rel=1e-9)
    assert abs(form["d"] - EXACT_D) <= form["d_error"] < 1e-7
    assert form["criticality"] == "supercritical"


def test_a_torus_found_a_little_off_is_found_again(found):
    form = found(rotating(), NS | {"sg": -1e-4}, "NS", angle=0.47 * T + 1e-3)
    assert form["d"] == pytest.approx(EXACT_D, rel=1e-8)


def test_coordinates_do_not_matter_to_a_torus(found):
    matrix = rotation(5)
    form = found(mixed(rotating(), matrix), NS, "NS", angle=0.47 * T, matrix=matrix, shift=2.0)
    assert form["d"] == pytest.approx(EXACT_D, rel=1e-8)


def test_strong_resonance_has_another_normal_form(found):
    form = found(rotating(), NS | {"W": OMEGA / 3.0}, "NS", angle=2.0 * np.pi / 3.0)
    assert set(form) == {"normal_form"}
    assert "1:3" in form["normal_form"]


def test_langford_agrees_with_the_hopf_form_of_its_reduced_system(written, langford):
    """Its orbits are circles: in (r, z) they are equilibria, and the torus is born at a Hopf point.

    The critical function there is that of the plane, in the directions of r and z.
    """
    rho, al = 0.55510860820595, 0.95
    field, path = langford
    z = 0.7
    r = np.sqrt((0.6 + al * z - z**3 / 3) / (1 + rho * z))
    phases = np.linspace(0.0, 2.0 * np.pi, 401)
    profile = np.stack((r * np.cos(phases), r * np.sin(phases), np.full(401, z)))
    period = 2.0 * np.pi / 3.5
    start = collocated_from_samples(field, path, phases / 3.5, profile, rho)
    flat, along = written(
        {"r": "(z - 0.7)*r", "z": "0.6 + al*z - z**3/3 - r**2*(1 + rho*z)"}, rho=rho, al=al
    )
    p, dp = along.vector(rho), along.direction(rho)
    x = np.array([r, z])
    omega = float(np.abs(np.linalg.eigvals(flat.f_x(x, p)).imag).max())
    plane = hopf_form(flat, x, p, dp, omega, 2)
    angle = omega * period
    assert angle < np.pi
    form = cycle_normal_form(start.problem, SimpleNamespace(z=start.z), "NS", angle)
    assert form["d"] == pytest.approx(plane.c1 / period, rel=1e-7)


# ---------------------------------------------------------------- folds


def folded():
    """s = r - 1: s' = la + b s^2 + g s w, w' = -k w + h s, phi' = omega (1 - e s)."""
    la, b, g, k, h, e = sp.symbols("la b g k h e")
    w, x, y = sp.symbols("w x y")
    s = sp.sqrt(x**2 + y**2) - 1

    def transverse(rho, z, cos, sin):
        del cos, sin
        return la + b * rho**2 + g * rho * w, -z + rho

    return suspension(transverse, {"w": -k * w + h * s}, 1 - e * s)[0]


LPC = {"la": 0.0, "b": 0.8, "g": 0.6, "k": 1.5, "h": 0.5, "e": 0.45}
EXACT_B = (0.8 + 0.6 * 0.5 / 1.5) / 0.45


@pytest.mark.parametrize("start", [collocated_from_samples, from_samples], ids=["Gauss", "Radau"])
def test_exact_fold(found, start):
    form = found(folded(), LPC, "LPC", start=start)
    assert form["b"] == pytest.approx(EXACT_B, rel=1e-8)
    assert form["b_error"] < 1e-7
    assert "criticality" not in form


def test_neither_coordinates_nor_units_matter_to_a_fold(found):
    matrix = sp.diag(1, 3, sp.Rational(1, 10), 50) * rotation(4)
    form = found(mixed(folded(), matrix), LPC, "LPC", matrix=matrix, shift=0.7)
    assert form["b"] == pytest.approx(EXACT_B, rel=1e-7)


def test_a_fold_at_which_the_period_stands_still_has_no_b(found):
    form = found(folded(), LPC | {"e": 0.0}, "LPC")
    assert set(form) == {"normal_form"}
    assert "period does not change" in form["normal_form"]


# ---------------------------------------------------------------- published systems


@pytest.fixture(scope="module")
def morris_lecar():
    """The fast Morris-Lecar equations of MatCont's manual and their Hopf point at y = 0.0757."""
    model = rb.model_from_strings(
        "fast_morris_lecar",
        {
            "v": "y - 0.5*(v + 0.5) - 2*w*(v + 0.7) - 0.5*(1 + tanh((v + 0.01)/0.15))*(v - 1)",
            "w": "1.15*(0.5*(1 + tanh((v - z)/0.145)) - w)*cosh((v - 0.1)/0.29)",
        },
        parameters={"y": 0.110472, "z": 0.1},
        guess={"v": 0.04722, "w": 0.32564},
    )
    branch = rb.continue_equilibria(model, "y", (0.05, 0.111))
    return branch["H1"]


@pytest.mark.parametrize("method", ["collocation", "shooting", "harmonic-balance"])
def test_matconts_limit_point_of_cycles(morris_lecar, method):
    """MatCont's manual: period 4.222011, y = 8.456948e-02, coefficient -2.334576e-01."""
    branch = rb.continue_orbits(morris_lecar, (0.07, 0.09), method=method)
    fold = branch["LPC1"]
    assert fold.period == pytest.approx(4.222011, rel=1e-6)
    assert fold.b == pytest.approx(-0.2334576, abs=6e-8)
    assert fold.b_error < 1e-8
    assert fold.b == pytest.approx(-0.23345762158, rel=1e-9)  # whatever the method


@pytest.fixture(scope="module")
def lure():
    """The adaptive control system of MatCont's manual, and its doubling by two methods."""
    model = rb.model_from_strings(
        "adaptive_control",
        {"x": "y", "y": "z", "z": "-al*z - be*y - x + x**2"},
        parameters={"al": 1.2, "be": 1.0},
        guess={"x": 0.0, "y": 0.0, "z": 0.0},
    )
    hopf = rb.continue_equilibria(model, "al", (0.5, 1.2))["H1"]
    return {
        method: rb.continue_orbits(hopf, (0.6, 1.2), method=method)["PD1"]
        for method in ("collocation", "harmonic-balance")
    }


def test_methods_agree_at_a_doubling(lure):
    """Their orbits differ by 1e-6, the bifurcations found from them by 1e-10."""
    gauss, series = lure.values()
    assert gauss.c == pytest.approx(series.c, rel=1e-8)
    assert gauss.criticality == series.criticality == "supercritical"


def test_doubled_orbits_are_as_wide_as_the_normal_form_says(lure):
    """xi^2 = -sigma / c, with sigma of the single orbit: c by a way that needs no third derivative.

    xi^2 = (1/2) integral over 2T of |odd part|^2 / 2, for the critical function has length 1 on T.
    """
    point = lure["collocation"]
    problem, z = point.origin.problem, point.origin.raw.z
    held = np.zeros(len(z))
    held[-1] = 1.0
    estimates = []
    for offset in (4e-4, 2e-4):
        single = np.array(z)
        single[-1] -= offset
        single = polished(problem, single, held)
        multipliers = problem.floquet(single).multipliers
        nearest = multipliers[np.argmin(np.abs(multipliers + 1.0))].real
        sigma = np.log(-nearest) / problem.period(single)
        start = doubled(problem, z)
        step = start.tangent / np.abs(start.tangent / start.problem.magnitudes(start.z)).max()
        wide = np.array(start.z) + 3.0 * np.sqrt(offset) * step
        wide[-1] = single[-1]
        hold = np.zeros(len(wide))
        hold[-1] = 1.0
        wide = polished(start.problem, wide, hold)
        times = np.linspace(0.0, 1.0, 2001)[:-1]
        profile = start.problem.sample(wide, times)
        odd = 0.5 * (profile - np.roll(profile, 1000, axis=1))
        squared = np.mean(np.sum(odd**2, axis=0)) * start.problem.period(wide) / 2.0
        estimates.append(-sigma / squared)
    # the next term of the normal form is proportional to the offset
    extrapolated = 2.0 * estimates[1] - estimates[0]
    assert extrapolated == pytest.approx(point.c, rel=2e-4)


# ---------------------------------------------------------------- what cannot be known


def test_a_third_derivative_that_is_not_finite_is_a_reason(found, monkeypatch):
    from racs_bif.orbits.variational import Variational

    def broken(self, u, v, w):
        return np.full_like(u, np.nan)

    monkeypatch.setattr(Variational, "third", broken)
    form = found(moebius(), PD, "PD")
    assert set(form) == {"normal_form"}


def test_meshes_may_be_finer_than_a_branch_would_have_them():
    """Normal forms halve the intervals of an orbit that may have as many as are allowed."""
    r = "(x**2 + y**2)"
    equations = {"x": f"mu*x - y - x*{r}", "y": f"x + mu*y - y*{r}"}
    system = system_of(rb.model_from_strings("circle", equations, parameters={"mu": 1.0}))
    mesh = Mesh.uniform(404, 1)
    angles = 2.0 * np.pi * equidistant(mesh, DEGREE)
    circle = Piecewise(mesh, np.stack([np.cos(angles), np.sin(angles)], axis=-1))
    orbits = GaussOrbits(system.field, system.path("mu"), circle, 2.0 * np.pi, 1.0)
    assert np.abs(orbits.problem.residual(orbits.guess)).max() < 1e-8
