"""Events in the step that has a fold, where the number of unstable eigenvalues tells nothing."""

import pytest

import racs_bif as rb


@pytest.mark.parametrize("b", [1e-1, 1e-2, 1e-3, 1e-4])
def test_a_hopf_point_right_beside_a_fold(b):
    """Near a Bogdanov-Takens point a pair crosses, meets on the real axis and parts at the fold.

    In all one eigenvalue has crossed, which the fold explains.
    """
    model = rb.model_from_strings(
        "beside",
        {"x": "y", "y": "x**2 - mu + y*(x + b)"},
        parameters={"mu": 0.5, "b": b},
        guess={"x": -0.7},
    )
    branch = rb.continue_equilibria(model, "mu", (-1.0, 1.0))
    inner = {point.label: point for point in branch.special if point.label in {"H", "LP"}}
    assert inner.keys() == {"H", "LP"}
    assert inner["H"].state["x"] == pytest.approx(-b, rel=1e-6)
    assert inner["H"].omega == pytest.approx((2.0 * b) ** 0.5, rel=1e-6)
    assert "unexplained" not in branch.stopped
