"""The standard problems of periodic orbits, to the digits known of them.

The numbers come from Taylor-series shooting in long arithmetic, checked against what MatCont, AUTO
and BifurcationKit publish.
"""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.continuation import StepSettings, Stopped, trace
from racs_bif.orbits import (
    BranchPointOfCycles,
    FoldOfCycles,
    NeimarkSacker,
    PeriodDoubling,
    collocated_from_hopf,
    collocated_from_samples,
    doubled,
    from_hopf,
    from_samples,
    switched,
)
from racs_bif.shelf.load import system_of

RTOL = 1e-6
STEPS = StepSettings(maximum=0.05, tolerance=1e-8)
FROM_HOPF = {"collocation": collocated_from_hopf, "shooting": from_hopf}
FROM_SAMPLES = {"collocation": collocated_from_samples, "shooting": from_samples}

both = pytest.mark.parametrize("method", ["collocation", "shooting"])


def build(name, equations, parameters, guess):
    return system_of(rb.model_from_strings(name, equations, parameters=parameters, guess=guess))


def traced(start, span, **options):
    """Follow a branch with all detectors; the problem goes along with it."""
    detectors = [FoldOfCycles(), BranchPointOfCycles(), PeriodDoubling(), NeimarkSacker()]
    options = {"tangent": start.tangent, "direction": 1, "settings": STEPS, **options}
    found = trace(start.problem, start.z, span, detectors, **options)
    return SimpleNamespace(
        problem=start.problem,
        points=found.points,
        special=found.special,
        stopped=found.stopped,
        labels=[special.label for special in found.special],
        named=found.__getitem__,
        period=lambda special: start.problem.period(special.z),
    )


def hopf_points(system, parameter, span):
    branch = rb.continue_equilibria(system, parameter, span)
    return [point for point in branch.special if point.label == "H"]


def born(hopf, span, method="collocation", **options):
    """Follow the orbits born at a Hopf point of the verb."""
    origin, form = hopf.origin, hopf.origin.raw.data["form"]
    path, z = origin.problem.path, origin.raw.z
    start = FROM_HOPF[method](origin.system.field, path, z, form.omega, form.q, form=form)
    return traced(start, span, **options)


def assert_at(branch, name, parameter, period=None, rtol=RTOL):
    special = branch.named(name)
    assert special.parameter == pytest.approx(parameter, rel=rtol)
    if period is not None:
        assert branch.period(special) == pytest.approx(period, rel=rtol)


# ------------------------------------------------------------------------- 1. adaptive control


@pytest.fixture(scope="module")
def adaptive():
    equations = {"x": "y", "y": "z", "z": "-al*z-be*y-x+x**2"}
    guess = {"x": 0.0, "y": 0.0, "z": 0.0}
    (hopf,) = hopf_points(
        build("adaptive", equations, {"al": 1.2, "be": 1.0}, guess), "al", (0.5, 1.5)
    )
    return hopf


@both
def test_adaptive_control_doubles_its_period_and_is_no_torus_at_zero(adaptive, method):
    branch = born(adaptive, (0.0, 1.2), method, targets=[0.0])
    assert sorted(branch.labels) == ["PD", "UZ"]  # no LPC or BPC at the Hopf point, and no NS
    assert_at(branch, "PD1", 0.63030200616, 6.36407133944)
    assert branch.period(branch.named("UZ1")) == pytest.approx(6.43381794597, rel=RTOL)
    np.testing.assert_allclose(
        branch.named("UZ1").spectrum, [1.0, -16.790652, -0.059557], rtol=1.2e-5
    )


def test_adaptive_control_on_its_doubled_branch(adaptive):
    first = born(adaptive, (0.5, 1.2))
    branch = traced(doubled(first.problem, first.named("PD1").z), (-0.2, 1.2))
    assert branch.labels.count("LPC") == 2
    assert "BPC" not in branch.labels  # the first point is on two branches, but is no event here
    assert_at(branch, "PD1", 0.579629840896, 12.7343655422)
    assert_at(branch, "LPC1", -0.0449491238579)
    assert_at(branch, "LPC2", 0.0449491238579)


# ------------------------------------------------------------------------------ 2. neural mass


@pytest.fixture(scope="module")
def neural():
    equations = {
        "E": "(-E+a*log(1+exp((J*u*x*E+E0)/a)))/tE",
        "x": "(1-x)/tD-u*x*E",
        "u": "(U0-u)/tF+U0*(1-u)*E",
    }
    parameters = {"E0": -2.0, "tE": 0.013, "J": 3.07, "tD": 0.2, "U0": 0.3, "tF": 1.5, "a": 1.5}
    guess = {"E": 0.5, "x": 0.9, "u": 0.4}
    return hopf_points(build("neural", equations, parameters, guess), "E0", (-2.2, -0.9))


def test_neural_mass_folds(neural):
    branch = born(neural[1], (-1.77, -0.9), targets=[-1.2])
    assert_at(branch, "LPC1", -1.14585313623, 0.332533059919)
    assert_at(branch, "UZ1", -1.2, 0.361811719008)
    assert_at(branch, "LPC2", -1.7690340404, 0.8053578, rtol=2e-8)
    assert {"H", "BPC"}.isdisjoint(branch.labels)
    # a fold and a doubling, less than 1e-7 apart, on the way to the homoclinic orbit
    assert branch.labels.count("LPC") == 3
    assert abs(branch.named("LPC3").parameter - branch.named("PD1").parameter) < 1e-6


# -------------------------------------------------------------------------- 3. Freire's circuit


def test_freire_circuit_and_its_secondary_branch():
    equations = {
        "x": "(-(be+nu)*x+be*y-a3*x**3+b3*(y-x)**3)/r",
        "y": "be*x-(be+ga)*y-z-b3*(y-x)**3",
        "z": "y",
    }
    parameters = {"nu": -0.7, "be": 0.5, "ga": -0.6, "r": 0.6, "a3": 0.328578, "b3": 0.933578}
    system = build("freire", equations, parameters, {"x": 0.0, "y": 0.0, "z": 0.0})
    (hopf,) = hopf_points(system, "nu", (-0.75, -0.5))
    assert hopf.parameters["nu"] == pytest.approx(-0.589336477991794, rel=1e-8)
    branch = born(hopf, (-0.7, -0.5))
    assert branch.labels[:2] == ["LPC", "BPC"]
    assert_at(branch, "LPC1", -0.584334771866, 8.42647292)
    assert_at(branch, "BPC1", -0.587028974365, 8.68966962)
    crossing = branch.named("BPC1")
    other = traced(switched(branch.problem, crossing.z, crossing.tangent), (-0.62, -0.5))
    assert other.labels == ["NS", "PD"]
    assert_at(other, "NS1", -0.591650195032, 8.7941517464)
    pair = other.named("NS1").spectrum[1]
    assert pair.real == pytest.approx(0.82017809, abs=1e-6)
    assert abs(pair.imag) == pytest.approx(0.5721083, abs=1e-6)
    assert_at(other, "PD1", -0.614955221138)


# -------------------------------------------------------------------------------- 4. Lorenz


def test_lorenz_breaks_its_symmetry_and_doubles_its_period():
    from scipy.integrate import solve_ivp

    equations = {"x": "sg*(y-x)", "y": "r*x-y-x*z", "z": "x*y-b*z"}
    parameters = {"r": 350.0, "sg": 10.0, "b": 8 / 3}
    system = build("lorenz", equations, parameters, {"x": 30.0, "y": 30.0, "z": 349.0})

    def upwards(_t, x):
        return x[2] - 349.0

    upwards.direction = 1.0
    found = solve_ivp(
        lambda _t, x: system.field.f(x, system.values),
        (0.0, 30.0),
        [1.0, 2.0, 300.0],
        rtol=1e-8,
        atol=1e-8,
        dense_output=True,
        events=upwards,
    )
    begin, end = found.t_events[0][[-3, -1]]  # the symmetric orbit rises twice in a period
    times = np.linspace(begin, end, 401)
    start = collocated_from_samples(system.field, system.path("r"), times, found.sol(times), 350.0)
    branch = traced(start, (300.0, 350.0), direction=-1)
    assert branch.labels == ["BPC"]
    assert_at(branch, "BPC1", 312.973532984)
    crossing = branch.named("BPC1")
    span = (215.7, 350.0)
    other = traced(switched(branch.problem, crossing.z, crossing.tangent), span)
    expected = [229.406708561, 218.210127778, 215.965930632]
    for level, value in enumerate(expected):
        assert_at(other, "PD1", value)
        if level < 2:
            other = traced(doubled(other.problem, other.named("PD1").z), span)


# ----------------------------------------------------------------- 5. to 7. textbook oscillators


@both
def test_van_der_pol_periods(method):
    equations = {"x": "y", "y": "mu*(1-x**2)*y-x"}
    system = build("van_der_pol", equations, {"mu": 0.1}, {"x": 0.0, "y": 0.0})
    angle = np.linspace(0.0, 2.0 * np.pi, 65)
    ring = np.array([2.0 * np.cos(angle), -2.0 * np.sin(angle)])
    start = FROM_SAMPLES[method](system.field, system.path("mu"), angle, ring, 0.1)
    branch = traced(start, (0.1, 10.0), targets=[1.0, 5.0])
    periods = [
        branch.points[0].measures["period"],
        branch.period(branch.named("UZ1")),
        branch.period(branch.named("UZ2")),
        branch.points[-1].measures["period"],
    ]
    expected = [6.2871112722887, 6.6632868593231, 11.61223066772, 19.078369566939]
    np.testing.assert_allclose(periods, expected, rtol=RTOL)
    highest = branch.problem.extrema(branch.named("UZ1").z)[0][0]
    assert highest == pytest.approx(2.00861986, rel=RTOL)


@both
def test_brusselator_periods_and_multiplier(method):
    equations = {"x": "A-(B+1)*x+x**2*y", "y": "B*x-x**2*y"}
    system = build("brusselator", equations, {"A": 1.0, "B": 1.5}, {"x": 1.0, "y": 1.5})
    (hopf,) = hopf_points(system, "B", (1.0, 4.0))
    branch = born(hopf, (1.0, 3.0), method, targets=[2.5])
    assert branch.labels == ["UZ"]
    assert_at(branch, "UZ1", 2.5, 6.577284341906)
    end = branch.points[-1]
    assert end.measures["period"] == pytest.approx(7.15691992118, rel=RTOL)
    assert end.spectrum[1].real == pytest.approx(2.516e-4, rel=2e-4)


@both
def test_langford_torus(method):
    equations = {
        "x": "(z-0.7)*x-om*y",
        "y": "om*x+(z-0.7)*y",
        "z": "0.6+al*z-z**3/3-(x**2+y**2)*(1+rho*z)",
    }
    parameters = {"rho": 0.5, "om": 3.5, "al": 0.95}
    system = build("langford", equations, parameters, {"x": 0.0, "y": 0.0, "z": 1.5})
    radius = np.sqrt((0.6 + 0.95 * 0.7 - 0.343 / 3) / 1.35)
    times = np.linspace(0.0, 2.0 * np.pi / 3.5, 65)
    angle = 3.5 * times
    ring = np.array([radius * np.cos(angle), radius * np.sin(angle), np.full(65, 0.7)])
    start = FROM_SAMPLES[method](system.field, system.path("rho"), times, ring, 0.5)
    branch = traced(start, (0.5, 0.6))
    assert branch.labels == ["NS"]
    assert_at(branch, "NS1", 0.55510860820595, 2.0 * np.pi / 3.5)


# ---------------------------------------------------------------------------------- the vehicle


def test_shooting_and_collocation_agree_on_the_vehicle():
    hopf = rb.continue_equilibria(rb.load_model("racs"), "u", (5, 30))["H1"]
    speeds = (12.0, 16.0, 18.0)
    branches = [
        rb.continue_orbits(hopf, (5, 20), method=method, at=speeds)
        for method in ("shooting", "collocation")
    ]
    assert [branch.method for branch in branches] == ["shooting", "collocation"]
    for u in speeds:
        one, other = (branch.at(u=u) for branch in branches)
        assert one.period == pytest.approx(other.period, rel=RTOL)
        for name in ("max delta_c", "min delta_c"):
            first, second = (
                b.measures[name][p.index] for b, p in zip(branches, (one, other), strict=True)
            )
            assert first == pytest.approx(second, rel=RTOL)


def test_a_branch_that_runs_out_of_accuracy_says_so(neural):
    branch = born(neural[0], (-2.2, -0.9))
    assert branch.stopped in {Stopped.ACCURACY, Stopped.PERIOD}
    assert "PD" not in branch.labels  # multipliers that overflow fake none
