"""Branches of orbits traced by the engine, with their special points."""

import math

import numpy as np
import pytest

from racs_bif.continuation import StepSettings, Stopped, trace
from racs_bif.orbits import (
    BranchPointOfCycles,
    FoldOfCycles,
    NeimarkSacker,
    OrbitSettings,
    PeriodDoubling,
    from_hopf,
    from_samples,
)

W = 1.7
Q = np.array([1.0, -1.0j]) / np.sqrt(2.0)


def detectors():
    return [FoldOfCycles(), BranchPointOfCycles(), PeriodDoubling(), NeimarkSacker()]


def run(start, span, **options):
    return trace(
        start.problem,
        start.z,
        span,
        detectors(),
        **{"tangent": start.tangent, "direction": 1, **options},
    )


def labels(found):
    return [special.label for special in found.special]


def test_hopf_normal_form_from_its_hopf_point(hopf):
    start = from_hopf(*hopf, [0.0, 0.0, 0.0], W, Q)
    found = run(start, (-1.0, 1.0), targets=[0.5])
    assert found.stopped is Stopped.SPAN
    assert labels(found) == ["UZ"]  # above all no LPC and no BPC at the Hopf point
    assert len(found.points) < 40
    first, *others = found.points
    assert first.measures["period"] == pytest.approx(2 * np.pi / W)
    assert len(first.spectrum) == 0
    assert first.stable is None
    for point in others:
        lam = point.parameter
        assert point.measures["max x"] == pytest.approx(math.sqrt(lam), rel=1e-6)
        assert point.measures["period"] == pytest.approx(2 * np.pi / W, rel=1e-8)
        contraction = np.exp(-4 * np.pi * lam / W)
        np.testing.assert_allclose(point.spectrum, [1.0, contraction], rtol=1e-6)
        assert point.stable


def test_first_step_predicts_amplitude(hopf):
    start = from_hopf(*hopf, [0.0, 0.0, 0.0], W, Q)
    assert np.abs(start.problem.residual(start.z)).max() < 1e-14
    found = run(start, (-1.0, 1.0), settings=StepSettings(points=1))
    assert found.stopped is Stopped.POINTS
    second = found.points[1]
    assert second.iterations <= 4
    assert second.measures["max x"] == pytest.approx(math.sqrt(second.parameter), rel=1e-5)


def test_fold_of_cycles_and_its_stability(written):
    # r' = r (lam + 2 r^2 - r^4): fold at lam = -1, r = 1, where T = 2 pi / (w + r^2)
    r2 = "(x**2 + y**2)"
    growth, turn = f"(lam + 2*{r2} - {r2}**2)", f"(w + {r2})"
    field, path = written(
        {"x": f"{growth}*x - {turn}*y", "y": f"{turn}*x + {growth}*y"}, lam=0.0, w=W
    )
    found = run(from_hopf(field, path, [0.0, 0.0, 0.0], W, Q), (-1.5, 1.0))
    assert found.stopped is Stopped.SPAN
    assert labels(found) == ["LPC"]
    fold = found["LPC1"]
    assert fold.parameter == pytest.approx(-1.0, abs=1e-7)
    assert fold.data["period"] == pytest.approx(2 * np.pi / (W + 1), rel=1e-5)
    assert abs(fold.spectrum[1] - 1.0) < 1e-4
    before, after = found.points[fold.index - 1], found.points[fold.index + 1]
    assert (before.stable, after.stable) == (False, True)
    assert after.unstable == 0


def test_branch_that_ends_at_another_hopf_point(written):
    # r' = r (lam (1 - lam) - r^2): the orbits live between lam = 0 and lam = 1
    r2, growth = "(x**2 + y**2)", "(lam*(1 - lam)"
    field, path = written(
        {"x": f"{growth} - {r2})*x - w*y", "y": f"w*x + {growth} - {r2})*y"}, lam=0.0, w=W
    )
    found = run(from_hopf(field, path, [0.0, 0.0, 0.0], W, Q), (-1.0, 2.0))
    assert found.stopped is Stopped.VANISHED
    assert labels(found) == []
    largest = max(point.measures["max x"] for point in found.points)
    assert largest == pytest.approx(0.5, abs=1e-3)
    assert found.points[-1].parameter == pytest.approx(1.0, abs=5e-3)


def test_period_doubling_of_adaptive_control(adaptive_control):
    field, path = adaptive_control
    values, vectors = np.linalg.eig(field.f_x(np.zeros(3), np.array([1.0, 1.0])))
    k = int(np.argmax(values.imag))
    start = from_hopf(field, path, [0.0, 0.0, 0.0, 1.0], values[k].imag, vectors[:, k])
    found = run(start, (0.0, 1.2), targets=[0.0])
    assert "PD" in labels(found)
    assert set(labels(found)) <= {"PD", "UZ"}  # the real multipliers at al = 0 are no NS
    doubling = found["PD1"]
    assert doubling.parameter == pytest.approx(0.63030200616, abs=1e-7)
    assert doubling.data["period"] == pytest.approx(6.36407133944, abs=1e-6)
    end = found.points[-1]
    assert end.parameter == 0.0
    assert end.measures["period"] == pytest.approx(6.43381794597, rel=1e-7)
    np.testing.assert_allclose(end.spectrum[1:], [-16.790652, -0.059557], rtol=2e-5)


def test_neimark_sacker_of_langford(langford):
    om, rho = 3.5, 0.5
    radius = math.sqrt((0.6 + 0.95 * 0.7 - 0.343 / 3) / (1 + 0.7 * rho))
    times = np.linspace(0.0, 2 * np.pi / om, 65)
    ring = [radius * np.cos(om * times), radius * np.sin(om * times), np.full(65, 0.7)]
    found = run(from_samples(*langford, times, np.array(ring), rho), (rho, 0.6))
    assert labels(found) == ["NS"]
    torus = found["NS1"]
    assert torus.parameter == pytest.approx(0.55510860820595, abs=1e-7)
    assert torus.data["period"] == pytest.approx(2 * np.pi / om, rel=1e-8)
    pair = torus.spectrum[1]
    assert abs(pair) == pytest.approx(1.0, abs=1e-8)
    assert torus.data["angle"] == pytest.approx(abs(np.angle(pair)), abs=1e-12)


def test_symmetry_breaking_branch_point(written):
    # a circle in x, y with a pitchfork in z: z' = (lam - 1) z - z^3 beside r = 1
    r2 = "(x**2 + y**2)"
    field, path = written(
        {"x": f"(1 - {r2})*x - w*y", "y": f"w*x + (1 - {r2})*y", "z": "(lam - 1)*z - z**3"},
        lam=0.5,
        w=W,
    )
    times = np.linspace(0.0, 2 * np.pi / W, 65)
    ring = np.array([np.cos(W * times), np.sin(W * times), 0.0 * times])
    found = run(from_samples(field, path, times, ring, 0.5), (0.5, 1.5))
    assert labels(found) == ["BPC"]
    assert found["BPC1"].parameter == pytest.approx(1.0, abs=1e-8)


def test_bound_on_the_period(van_der_pol):
    times = np.linspace(0.0, 6.66, 65)
    angle = 2 * np.pi * times / 6.66
    guess = np.array([2 * np.cos(angle), -2 * np.sin(angle)])
    start = from_samples(*van_der_pol, times, guess, 0.3, settings=OrbitSettings(longest=1.5))
    found = run(start, (0.3, 10.0))
    assert found.stopped is Stopped.PERIOD
    assert found.points[-1].measures["period"] > 1.5 * found.points[0].measures["period"]


def test_both_directions_from_the_middle_after_meshes_have_moved(van_der_pol):
    times = np.linspace(0.0, 6.66, 65)
    angle = 2 * np.pi * times / 6.66
    guess = np.array([2 * np.cos(angle), -2 * np.sin(angle)])
    found = run(
        from_samples(*van_der_pol, times, guess, 0.5), (0.1, 5.0), direction=None, targets=[1.0]
    )
    assert (found.stopped, found.stopped_backward) == (Stopped.SPAN, Stopped.SPAN)
    periods = [point.measures["period"] for point in found.points]
    assert np.all(np.diff(periods) > 0.0)
    assert periods[0] == pytest.approx(6.2871112722887, rel=1e-7)
    assert periods[-1] == pytest.approx(11.61223066772, rel=1e-6)
    assert found["UZ1"].z[-3] == pytest.approx(6.6632868593231, rel=1e-7)


def test_two_runs_agree_bit_for_bit(hopf):
    first, second = (
        run(from_hopf(*hopf, [0.0, 0.0, 0.0], W, Q), (-1.0, 0.5)).points for _ in range(2)
    )
    assert len(first) == len(second)
    assert all(np.array_equal(a.z, b.z) for a, b in zip(first, second, strict=True))
