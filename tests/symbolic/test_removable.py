"""A removable singularity, through the compiled kernels, against long arithmetic."""

import numpy as np
import pytest
import sympy as sp

from racs_bif.symbolic.compiled import compile_model
from racs_bif.symbolic.jets import total_degree
from racs_bif.symbolic.model import Model, Parameter
from racs_bif.symbolic.removable import over_expm1

mpmath = pytest.importorskip("mpmath")


@pytest.fixture(scope="module")
def compiled():
    x, p = sp.symbols("x p")
    return compile_model(Model("gate", {"x": over_expm1(p - x)}, (Parameter("p", 0.0),)))


def exact(z, order):
    """Return a derivative of z/(exp(z) - 1) from 60 digits."""
    with mpmath.workdps(60):
        quotient = mpmath.diff(lambda t: t / mpmath.expm1(t), mpmath.mpf(z), order)
        return float(quotient)


POINTS = [-40.0, -3.0, -1.0, -0.9999999, -0.3, -1e-5, 1e-9, 0.5, 1.0, 1.0000001, 4.0, 30.0]


@pytest.mark.parametrize("z", POINTS)
def test_value_and_three_derivatives(compiled, z):
    x, p, one = np.array([-z]), np.array([0.0]), np.array([1.0])
    found = [
        compiled.core(x, p)[0],
        -compiled.core_jacobian(x, p)[0, 0],
        compiled.core_xx(x, p, one, one)[0],
        -compiled.core_xxx(x, p, one, one, one)[0],
    ]
    expected = [exact(z, order) for order in range(4)]
    np.testing.assert_allclose(found, expected, rtol=2e-13, atol=2e-15)


def test_at_the_singularity_itself_the_coefficients_are_bernoullis(compiled):
    algebra = total_degree(1, 6)
    x = np.zeros((1, len(algebra)))
    x[0, 1] = -1.0
    found = compiled.expand("core", algebra, np.zeros(1), x)[0]
    expected = [float(sp.bernoulli(k) / sp.factorial(k)) for k in range(7)]
    expected[1] = -0.5
    np.testing.assert_allclose(found, expected, rtol=1e-15, atol=1e-18)
    assert compiled.core(np.zeros(1), np.zeros(1))[0] == 1.0
    assert compiled.core_jacobian(np.zeros(1), np.zeros(1))[0, 0] == 0.5


def test_arrays_meet_no_quotient_of_zeros(compiled):
    x = np.linspace(-2.0, 2.0, 401)[None, :]
    values = compiled.core(x, np.zeros(1))[0]
    scalar = [compiled.core(column, np.zeros(1))[0] for column in x.T]
    np.testing.assert_allclose(values, scalar, rtol=1e-15)
    assert np.isfinite(compiled.core_xxx(x, np.zeros(1), x, x, x)).all()
