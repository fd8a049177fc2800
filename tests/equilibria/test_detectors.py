"""Points of codimension two: unfoldings by their coefficients, and what is none of them."""

from types import SimpleNamespace

import numpy as np
import pytest

from racs_bif.equilibria.bogdanov_takens import BogdanovTakensOnFold
from racs_bif.equilibria.cusp import Cusp
from racs_bif.equilibria.double_hopf import DoubleHopf, _unfolding
from racs_bif.equilibria.manifold import NormalForm


def form(p11, p12, p21, p22):
    g = {
        (2, 1, 0, 0): np.array([p11, 0, 0, 0], dtype=complex),
        (1, 0, 1, 1): np.array([p12, 0, 0, 0], dtype=complex),
        (1, 1, 1, 0): np.array([0, 0, p21, 0], dtype=complex),
        (0, 0, 2, 1): np.array([0, 0, p22, 0], dtype=complex),
    }
    return NormalForm(g, {})


# Kuznetsov, section 8.6: theta = p12 / p22 and delta = p21 / p11, the larger one first.
@pytest.mark.parametrize(
    ("theta", "delta", "sign", "case"),
    [
        (2.0, 3.0, 1, "simple case I"),
        (0.5, 0.4, 1, "simple case II"),
        (0.5, -0.4, 1, "simple case III"),
        (-0.4, -0.5, 1, "simple case IV"),
        (-2.0, -3.0, 1, "simple case V"),
        (2.0, 3.0, -1, "difficult case I"),
        (2.0, 0.6, -1, "difficult case II"),
        (0.5, 0.4, -1, "difficult case III"),
        (0.5, -0.4, -1, "difficult case IV"),
        (-0.4, -0.5, -1, "difficult case V"),
        (-2.0, -3.0, -1, "difficult case VI"),
    ],
)
@pytest.mark.parametrize("exchanged", [False, True])
def test_unfoldings_of_a_double_hopf_point(theta, delta, sign, case, exchanged):
    if exchanged:
        theta, delta = delta, theta
    p11, p22 = -1.0, -2.0 * sign
    found = _unfolding(form(p11, theta * p22, delta * p11, p22))
    assert found["unfolding"] == case
    assert (found["theta"], found["delta"]) == (pytest.approx(theta), pytest.approx(delta))
    assert (found["p11"], found["p22"]) == (p11, p22)


def test_a_neutral_saddle_is_no_double_hopf_point():
    values = np.array([1.0, -1.0, -3.0], dtype=complex)
    problem = SimpleNamespace(noncritical=lambda _spectrum: values, frequency=lambda _z: 2.0)
    point = SimpleNamespace(spectrum=values, z=np.zeros(3))
    assert DoubleHopf().data(problem, point) is None


def test_a_coefficient_that_jumps_is_no_cusp():
    problem = SimpleNamespace(quadratic=lambda _z: (0.5, 1.0), typical=1.0)
    assert Cusp().data(problem, SimpleNamespace(z=np.zeros(3))) is None


def test_two_zero_eigenvalues_with_two_vectors_are_no_bogdanov_takens_point():
    field = SimpleNamespace(f_x=lambda _x, _p: np.diag([0.0, 0.0, -1.0]))
    problem = SimpleNamespace(realised=lambda _z: (field, np.zeros(3), np.zeros(1)))
    assert BogdanovTakensOnFold().data(problem, SimpleNamespace(z=np.zeros(5))) is None
