from types import SimpleNamespace

import numpy as np
import pytest

from racs_bif.errors import UsageError
from racs_bif.orbits import from_hopf, hopf_orbit


def test_a_frequency_must_be_positive(hopf):
    with pytest.raises(UsageError, match="positive frequency"):
        from_hopf(*hopf, [0.0, 0.0, 0.0], 0.0, np.array([1.0, -1j]))


def test_sizes_must_agree(hopf):
    with pytest.raises(UsageError, match="2 states"):
        from_hopf(*hopf, [0.0, 0.0, 0.0], 1.7, np.array([1.0, -1j, 0.0]))


def test_normal_form_predicts_the_bent_circle_to_third_order(bent_hopf):
    # a = x, b = y + x^2/2, and c' = -3 c + a b follows at second order
    w = 1.7
    q = np.array([1.0, -1.0j, 0.0]) / np.sqrt(2.0)
    # x = 2 Re(w q)_1, so x^2/2 = Re(w^2)/2 + |w|^2/2; a b = x y = 2 Re(-i w^2 / 2) at second order
    form = SimpleNamespace(
        q=q,
        h20=np.array([0.0, 0.5, -1j / (3.0 + 2j * w)]),
        h11=np.array([0.0, 0.5, 0.0]),
        parameter_curvature=2.0,
        frequency_curvature=0.0,
        drift=np.zeros(3),
    )
    start = from_hopf(*bent_hopf, [0.0, 0.0, 0.0, 0.0], w, q, form=form)
    residuals = [
        np.abs(start.problem.residual(hopf_orbit(start, size, w, form))).max()
        for size in (0.04, 0.02, 0.01)
    ]
    orders = np.log2(np.divide(residuals[:-1], residuals[1:]))
    assert np.all(orders > 2.8), (residuals, orders)


@pytest.mark.parametrize("k", [1, 2])
def test_orbits_that_break_a_symmetry_are_left_with_natural_steps(k):
    """The middle cell of an odd mode is at rest to first order: it moves by its square."""
    import racs_bif as rb

    system = rb.load_model("brusselator_chain", variant="5", parameters={"D_x": 0.5, "D_y": 0.5})
    points = rb.continue_equilibria(system, "B", (1.5, 3.5)).special
    hopf = [point for point in points if point.label == "H"][k]
    low, high = 1.5, hopf.parameters["B"] + 0.1
    branch = rb.continue_orbits(hopf, span=(low, high), method="collocation")
    assert branch.parameter[-1] == pytest.approx(high)
    assert len(branch) < 40
