"""Curves of special cycles: exact derivatives, block solver, and problems with known answers."""

import math

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.continuation.settings import StepSettings
from racs_bif.continuation.trace import trace
from racs_bif.errors import UsageError
from racs_bif.orbits.collocation_settings import CollocationSettings
from racs_bif.orbits.curves.detectors import detectors
from racs_bif.orbits.curves.kinds import KINDS
from racs_bif.orbits.curves.start import as_collocated, cycle_curve

COARSE = CollocationSettings(intervals=20)
STEPS = StepSettings(maximum=0.05, angle=0.3, tolerance=1e-8)


@pytest.fixture(scope="module")
def feedback():
    """PD of the adaptive control system (MatCont's manual)."""
    model = rb.load_model("adaptive_control")
    hopf = rb.continue_equilibria(model, "alpha", (0.4, 2.0))["H1"]
    return rb.continue_orbits(hopf, span=(0.5, 2.0), method="collocation", orbit_settings=COARSE)


@pytest.fixture(scope="module")
def langford():
    """NS of Langford's system, which is a line in (alpha, rho)."""
    model = rb.load_model("langford")
    hopf = rb.continue_equilibria(model, "alpha", (-1.0, 1.0))["H1"]
    return rb.continue_orbits(hopf, span=(-1.0, 1.0), method="collocation", orbit_settings=COARSE)


@pytest.fixture(scope="module")
def folds():
    """LPC of the neural mass model."""
    model = rb.load_model("neural_mass")
    hopf = rb.continue_equilibria(model, "E_0", (-3.0, 2.0))["H2"]
    return rb.continue_orbits(hopf, span=(-1.3, -1.0), method="collocation", orbit_settings=COARSE)


def curve_of(point, names, spans):
    origin = point.origin
    path = origin.system.path(*names)
    active = np.array([point.parameters.get(n, origin.system.parameters[n]) for n in names])
    orbit = as_collocated(origin.problem, origin.raw.z)
    angle = point.data.get("angle", 0.0)
    return cycle_curve(KINDS[point.label], orbit, path, spans, active, angle=angle)


@pytest.fixture(scope="module", params=["PD", "NS", "LPC"])
def start(request, feedback, langford, folds):
    if request.param == "PD":
        return curve_of(feedback["PD1"], ("alpha", "beta"), ((-0.5, 2.0), (0.5, 2.0)))
    if request.param == "NS":
        return curve_of(langford["NS1"], ("alpha", "rho"), ((0.0, 2.0), (0.0, 2.0)))
    return curve_of(folds["LPC1"], ("E_0", "J"), ((-3.0, 2.0), (2.0, 4.0)))


def test_the_start_is_a_solution(start):
    problem, z = start
    assert np.abs(problem.residual(z)).max() < 1e-6


def test_products_are_derivatives(start):
    problem, z = start
    direction = 0.1 * np.random.default_rng(3).standard_normal(len(z)) * problem.magnitudes(z)
    direction[-3] = 0.0
    step = 1e-6
    difference = problem.residual(z + step * direction) - problem.residual(z - step * direction)
    exact = problem.product(z, direction)
    assert exact == pytest.approx(difference / (2.0 * step), abs=1e-7 * np.abs(exact).max())


def test_blocks_solve_what_the_products_make(start):
    problem, z = start
    random = np.random.default_rng(4)
    row = random.standard_normal(len(z)) / problem.magnitudes(z) / len(z)
    rhs = random.standard_normal((len(z), 2))
    found = problem.bordered(z, row)(rhs)
    back = np.stack([np.append(problem.product(z, x), row @ x) for x in found.T], axis=1)
    assert back == pytest.approx(rhs, abs=1e-7 * np.abs(found).max())


def test_jacobian_and_product_agree(feedback):
    problem, z = curve_of(feedback["PD1"], ("alpha", "beta"), ((-0.5, 2.0), (0.5, 2.0)))
    step = np.random.default_rng(5).standard_normal(len(z))
    assert problem.jacobian(z) @ step == pytest.approx(problem.product(z, step), abs=1e-9)


def test_both_strong_resonances_of_the_feedback_system(feedback):
    """Acceptance, orbits 1: R2 at alpha = 0."""
    spans = {"alpha": (-0.2, 2.0), "beta": (0.5, 2.0)}
    curve = rb.continue_curve(feedback["PD1"], ("alpha", "beta"), spans, settings=STEPS)
    assert [point.label for point in curve.special if point.label != "EP"] == ["R2", "R2"]
    first, second = (point for point in curve.special if point.label == "R2")
    assert first.parameters == pytest.approx({"alpha": 0.0, "beta": 0.678278315057}, abs=1e-6)
    assert second.parameters == pytest.approx({"alpha": 0.0, "beta": 1.69871069234}, abs=1e-6)
    assert first.period == pytest.approx(9.05831822058, rel=1e-6)
    assert second.period == pytest.approx(4.84183511632, rel=1e-6)
    assert np.abs(curve.spectrum[:, 1] + 1.0).max() < 1e-4
    start = int(np.argmin(np.abs(curve.values[:, 1] - 1.0)))
    assert curve.values[start] == pytest.approx([0.63030200616, 1.0], rel=1e-6)
    assert curve.measures["c"][start] == pytest.approx(feedback["PD1"].data["c"], rel=1e-3)


def test_langfords_tori_lie_on_a_line_with_known_resonances(langford):
    spans = {"alpha": (0.4, 5.0), "rho": (0.0, 6.0)}
    curve = rb.continue_curve(langford["NS1"], ("alpha", "rho"), spans, settings=STEPS)
    alpha, rho = curve.values.T
    assert rho == pytest.approx((alpha - 0.49) / (0.6 + 0.343 * 2.0 / 3.0), rel=1e-6, abs=1e-8)
    found = {point.label: point.parameters["alpha"] for point in curve.special}
    for label, share in (("R3", 2.0 / 3.0), ("R4", 3.0 / 4.0)):
        square = (3.5 * share) ** 2
        assert found[label] == pytest.approx((0.5 * square - 0.6 + 0.343 / 3.0) / 0.7, rel=1e-7)


def test_folds_of_cycles_arrive_at_the_generalised_hopf_point(folds):
    spans = {"E_0": (-1.3, 0.0), "J": (2.5, 3.3)}
    curve = rb.continue_curve(folds["LPC1"], ("E_0", "J"), spans, settings=STEPS)
    assert "equilibrium" in curve.stopped
    nearest = np.abs(curve.values - [-1.068520928, 2.971711713]).max(axis=1).min()
    assert nearest < 1e-4
    assert not [point for point in curve.special if point.label == "CPC"]


def test_folds_of_cycles_leave_a_generalised_hopf_point_and_meet_in_cusps():
    model = rb.load_model("neural_mass")
    hopf = rb.continue_equilibria(model, "E_0", (-3.0, 2.0))["H2"]
    spans = {"E_0": (-1.75, 0.0), "J": (2.0, 4.0)}
    hopf_curve = rb.continue_curve(hopf, ("E_0", "J"), spans)
    bautin = min(
        (p for p in hopf_curve.special if p.label == "GH"),
        key=lambda p: abs(p.parameters["E_0"] + 1.44),
    )
    curve = rb.continue_curve(
        bautin, ("E_0", "J"), spans, kind="lpc", settings=STEPS, orbit_settings=COARSE
    )
    cusps = [point.parameters["E_0"] for point in curve.special if point.label == "CPC"]
    assert cusps == pytest.approx([-1.68408235, -1.67739549], abs=1e-4)


def test_no_point_of_codimension_two_is_found_twice(feedback):
    problem, z = curve_of(feedback["PD1"], ("alpha", "beta"), ((0.3, 2.0), (0.9, 1.1)))
    found = trace(problem, z, (0.9, 1.1), detectors("pd"), STEPS)
    assert not found.special
    assert problem.parameter == "beta"
    assert math.isclose(found.points[0].z[-1], 0.9, rel_tol=1e-12)


def test_a_curve_of_another_kind_is_refused(feedback):
    with pytest.raises(UsageError, match="ns curve cannot start at PD1"):
        rb.continue_curve(feedback["PD1"], ("alpha", "beta"), kind="ns")


def test_an_orbit_of_another_method_is_collocated(langford):
    point = langford["NS1"]
    span = (point.parameters["alpha"], point.parameters["alpha"] + 0.05)
    other = rb.continue_orbits(point, span, method="shooting").special[-1]
    problem, z = as_collocated(other.origin.problem, other.origin.raw.z, COARSE)
    assert np.abs(problem.residual(z)).max() < 1e-8
    assert problem.period(z) == pytest.approx(other.period, rel=1e-5)
    assert problem.path.names == ("alpha",)
    again = as_collocated(problem, z)
    assert again[0] is problem
    assert again[1] is z


def test_a_cycle_of_a_curve_is_an_orbit_in_its_first_parameter(start):
    curves, z = start
    problem, orbit = as_collocated(curves, z)
    assert np.abs(problem.residual(orbit)).max() < 1e-6
    assert problem.period(orbit) == curves.period(z)
    assert orbit[-1] == z[-1]
    assert len(problem.path.names) == 1
