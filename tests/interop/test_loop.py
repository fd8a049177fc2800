"""The loop cut at a fractional element, its margins, and what control makes of it."""

import control
import matplotlib.pyplot as plt
import numpy as np
import pytest

import racs_bif as rb
from racs_bif.fractional.characteristic import Characteristic
from racs_bif.shelf.load import system_of

OMEGA = np.geomspace(0.05, 200.0, 40)


def test_the_nyquist_curve_passes_through_the_critical_point_at_the_hopf_point(equilibria):
    exact = equilibria["H1"].exact
    there = equilibria.at(u=exact.parameters["u"])
    loop = rb.loop_response(there, "delta_z", [exact.omega])
    assert complex(loop.frdata[0, 0, 0]) == pytest.approx(-1.0, abs=1e-9)
    found = rb.margins(there)
    assert found.gm == pytest.approx(1.0, abs=1e-9)
    assert found.pm == pytest.approx(0.0, abs=1e-6)
    assert found.sm < 1e-6
    assert found.wpc == pytest.approx(9.5200832, rel=1e-8)


@pytest.mark.parametrize("element", ["w", "z"])
def test_the_return_difference_is_a_quotient_of_characteristic_determinants(two_elements, element):
    """1 + L = det Delta / (D_k det Delta without row and column k)."""
    system = system_of(two_elements)
    k = 2 + system.compiled.elements.index(element)
    X = system.exact_point(system.equilibrium(), system.values)
    known = []
    for w in OMEGA:
        delta = system.exact.delta(1j * w, X, system.values)
        others = np.delete(np.arange(4), k)
        left = system.exact.weights(1j * w, system.values).left[k]
        known.append(np.linalg.det(delta) / left / np.linalg.det(delta[np.ix_(others, others)]))
    loop = rb.loop_response(system, element, OMEGA)
    np.testing.assert_allclose(1.0 + loop.frdata[0, 0], known, rtol=1e-9)
    assert Characteristic.of_model(system.exact, X, system.values).size == 4


@pytest.mark.parametrize("element", ["w", "z"])
def test_closing_the_realised_loop_gives_the_linearised_model(two_elements, element):
    loop = rb.loop_transfer(two_elements, element)
    closed = np.sort_complex(control.feedback(loop).poles())
    model = np.sort_complex(rb.to_control(two_elements).poles())
    np.testing.assert_allclose(closed, model, rtol=1e-6, atol=1e-8)
    exact = rb.loop_response(two_elements, element, OMEGA[10:30]).frdata[0, 0]
    np.testing.assert_allclose(loop(1j * OMEGA[10:30]), exact, rtol=0.05)


def test_the_gain_margin_is_how_far_the_stiffness_may_be_changed(vehicle):
    """On straight running, where the equilibrium does not depend on the stiffness."""
    straight = vehicle.with_parameters({"delta_f": 0.0, "u": 8.0})
    found = rb.margins(straight)
    calibrated = rb.calibrate(straight, "C_s", {"u": 8.0})
    assert found.gm == pytest.approx(calibrated.value / straight.parameters["C_s"], rel=1e-9)
    assert found.wpc == pytest.approx(calibrated.omega, rel=1e-9)


def test_margins_are_those_that_control_finds_by_interpolation(vehicle):
    at = vehicle.with_parameters({"u": 8.0})
    found, loop = rb.margins(at), rb.loop_response(at)
    gm, pm, sm, wpc, wgc, wms = control.stability_margins(loop)
    ours = [found.gm, found.pm, found.sm, found.wpc, found.wgc, found.wms]
    np.testing.assert_allclose(ours, [gm, pm, sm, wpc, wgc, wms], rtol=1e-6)
    gm, pm, wpc, wgc = control.margin(loop)
    np.testing.assert_allclose([found.gm, found.pm], [gm, pm], rtol=1e-6)
    realised = control.margin(rb.loop_transfer(at))
    np.testing.assert_allclose(realised[:2], [found.gm, found.pm], rtol=1e-3)


def test_a_range_without_crossings_has_no_margins(vehicle):
    found = rb.margins(vehicle, "delta_z", [1e-3, 2e-3])
    assert np.isinf(found.gm)
    assert np.isinf(found.pm)
    assert np.isnan(found.wgc)
    assert len(found.gains) == 0


def test_control_takes_the_loops_as_they_are(vehicle):
    unstable = vehicle.with_parameters({"u": 12.0})
    for loop in (rb.loop_response(unstable), rb.loop_transfer(unstable)):
        control.nyquist_plot(loop)
        control.bode_plot(loop)
        plt.close("all")


def test_the_nyquist_criterion_counts_the_unstable_roots(vehicle):
    for u, unstable in ((8.0, 0), (12.0, 2)):
        loop = rb.loop_transfer(vehicle.with_parameters({"u": u}))
        encirclements = control.nyquist_response(loop).count
        assert encirclements + np.count_nonzero(loop.poles().real > 0.0) == unstable
