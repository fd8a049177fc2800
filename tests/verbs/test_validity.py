"""Branches end where the model stops to hold, and say at which limit of which parameter."""

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.errors import ParameterError, ValidityError

SPANS = ((-5.0, 5.0), (-3.0, 3.0))


@pytest.fixture(scope="module")
def hopf():
    """The Hopf point of an oscillator with a springpot; nothing is said of where a is valid."""
    model = rb.model_from_strings(
        "springpot",
        {"x": "v", "v": "mu*v - x - c*Z - x**2*v"},
        parameters={"mu": 0.2, "c": 0.5, "a": 0.5},
        elements=[("Z", "x", "s**a")],
    )
    return rb.continue_equilibria(model, "mu", (0.1, 1.0))["H1"]


@pytest.mark.parametrize("operator", ["exact", "realised"])
@pytest.mark.parametrize("names", [("mu", "a"), ("a", "mu")])
def test_a_curve_ends_where_the_order_leaves_its_range(hopf, operator, names):
    spans = SPANS if names == ("mu", "a") else SPANS[::-1]
    curve = rb.continue_curve(hopf, names, spans, operator=operator)
    assert curve.early
    assert "left the range in which the model is valid" in curve.stopped
    assert "law of 'Z' grows like s**1" in curve.stopped
    order = np.sort(curve.values[:, names.index("a")])
    assert 0.0 < order[0] < 1e-3
    assert 1.0 - 1e-3 < order[-1] < 1.0
    if operator == "exact":  # i omega solves s**2 - mu s + 1 + c s**a = 0
        s = 1j * curve.measures["omega"]
        mu, a = (curve.values[:, names.index(name)] for name in ("mu", "a"))
        np.testing.assert_allclose(s**2 - mu * s + 1.0 + 0.5 * s**a, 0.0, atol=1e-8)


def test_a_branch_of_equilibria_ends_there_too(hopf):
    system = hopf.origin.system
    branch = rb.continue_equilibria(system, "a", (0.2, 3.0))
    assert branch.early
    assert "law of 'Z' grows like s**1" in branch.stopped
    assert branch.parameter[0] == 0.2
    assert 1.0 - 1e-6 < branch.parameter[-1] < 1.0


def test_a_start_outside_is_refused_as_before():
    with pytest.raises(ParameterError, match=r"'alpha' = 1\.2 is outside") as told:
        rb.load_model("racs", parameters={"alpha": 1.2})
    assert isinstance(told.value, ValidityError)
