"""Points of a branch of equilibria at any value of its parameter."""

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.errors import UsageError


@pytest.fixture(scope="module")
def fold():
    model = rb.model_from_strings(
        "fold", {"x": "a + x**2"}, parameters={"a": -4.0}, guess={"x": -2.0}
    )
    return rb.continue_equilibria(model, "a", (-5.0, 1.0))


def test_the_point_is_solved_for_not_interpolated():
    model = rb.model_from_strings(
        "cubic", {"x": "a - x - x**3"}, parameters={"a": 1.0}, guess={"x": 0.5}
    )
    branch = rb.continue_equilibria(model, "a", (0.0, 5.0))
    for value in (0.123, 1.0 / 3.0, 4.7):
        point = branch.at(a=value)
        x = point.state["x"]
        assert value - x - x**3 == pytest.approx(0.0, abs=1e-13)
        assert point.parameters == {"a": value}
        assert point.eigenvalues[0] == pytest.approx(-1.0 - 3.0 * x**2)
        assert (point.label, point.unstable, point.branch) == ("UZ", 0, "EQ1")


def test_another_branch_starts_there():
    branch = rb.continue_equilibria(rb.load_model("racs"), "u", (5, 15))
    point = branch.at(u=12)
    assert point.origin.span == (5.0, 15.0)
    assert np.linalg.norm(point.origin.raw.tangent) > 0.0
    x, p = point.origin.equilibrium, point.origin.parameters
    assert np.abs(point.origin.system.field.f(x, p)).max() < 1e-12


def test_a_branch_that_turns_back_has_two_points(fold):
    assert any(point.label == "LP" for point in fold.special)
    with pytest.raises(UsageError, match="more than once"):
        fold.at(a=-1.0)


def test_beyond_the_ends_there_is_nothing(fold):
    with pytest.raises(UsageError, match=r"does not reach a = 0\.5"):
        fold.at(a=0.5)


def test_a_loaded_branch_solves_too(tmp_path):
    branch = rb.continue_equilibria(rb.load_model("racs"), "u", (5, 15))
    rb.save(branch, tmp_path / "eq.nc")
    loaded = rb.load(tmp_path / "eq.nc")
    assert loaded.at(u=12.0) == branch.at(u=12.0)
    start = loaded.at(u=loaded["H1"].parameters["u"])
    assert start.name == "H1"
    assert start.origin is not None
