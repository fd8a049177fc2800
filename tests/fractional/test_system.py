"""Systems: values, paths, outputs, and what they say of their realisation."""

import numpy as np
import pytest

from racs_bif.errors import ParameterError
from racs_bif.fractional.diffusive import Diffusive
from racs_bif.fractional.system import System


def test_parameters_hold_derived_ones_too(vehicle):
    known = vehicle.parameters
    assert known["C_s"] == pytest.approx(known["d"] * known["A_h"] * known["E_0"], rel=1e-14)
    assert [p.name for p in vehicle.parameter_table] == list(known)


def test_systems_do_not_change(vehicle):
    before = dict(vehicle.parameters)
    other = vehicle.with_parameters({"u": 17.0, "C_s": 2e4})
    assert vehicle.parameters == before
    assert other.parameters["u"] == 17.0
    assert other.parameters["C_s"] == pytest.approx(2e4, rel=1e-14)
    assert vehicle.with_parameters({}).parameters == before
    with pytest.raises(AttributeError):
        vehicle.values = other.values


def test_a_derived_parameter_follows_the_others_until_it_is_set(vehicle):
    thinner = vehicle.with_parameters({"E_0": 1e5})
    assert thinner.parameters["C_s"] == pytest.approx(2.0 * vehicle.parameters["C_s"], rel=1e-14)
    held = vehicle.with_parameters({"E_0": 1e5, "C_s": vehicle.parameters["C_s"]})
    assert held.parameters["A_h"] == pytest.approx(0.5 * vehicle.parameters["A_h"], rel=1e-14)


def test_values_outside_validity_are_refused(vehicle):
    for values in ({"u": 0.0}, {"alpha": 1.0}, {"C_s": -1.0}, {"D_f": 5.0}):
        with pytest.raises(ParameterError, match="outside the model's validity"):
            vehicle.with_parameters(values)


def test_error_of_the_realisation_falls_with_its_order(vehicle):
    errors = [
        System(vehicle.compiled, vehicle.values, Diffusive(band=(1.0, 60.0), order=n)).realisation
        for n in (4, 8, 16)
    ]
    assert [info.states for info in errors] == [4, 8, 16]
    assert errors[0].error > 2.0 * errors[1].error > 4.0 * errors[2].error


def test_outputs(vehicle):
    """Forces and angles of the vehicle at rest balance: m u w = F_f + F_r, a_y = u w."""
    system = vehicle.with_parameters({"u": 15.0})
    x = system.equilibrium()
    X = system.exact_point(x, system.values)
    out = system.compiled.output_values(X, system.compiled.padded(system.values))
    assert tuple(out) == system.outputs
    v, w = x[:2]
    assert out["a_y"] == pytest.approx(15.0 * w, rel=1e-9)
    assert out["F_f"] + out["F_r"] == pytest.approx(1740.0 * 15.0 * w, rel=1e-9)
    assert out["alpha_f"] == pytest.approx((v + 1.46 * w) / 15.0 - 0.01, rel=1e-12)
    assert out["beta"] == pytest.approx(v / 15.0, rel=1e-14)
    assert out["F_d"] == pytest.approx(-system.parameters["C_s"] * x[2], rel=1e-9)


def test_the_realised_steady_state_is_the_exact_one(vehicle):
    """Whatever the realisation: its static gain is exact."""
    states = [
        System(vehicle.compiled, vehicle.values, Diffusive(band=band)).equilibrium()[:4]
        for band in ((1.0, 60.0), (0.3, 10.0), (1e-3, 1e3))
    ]
    for other in states[1:]:
        np.testing.assert_allclose(other, states[0], rtol=1e-12, atol=1e-15)
