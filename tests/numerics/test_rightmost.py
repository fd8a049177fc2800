"""Unstable eigenvalues of sparse matrices: none is missed, or the result says so."""

import math

import numpy as np
import pytest
from scipy import sparse as ss
from scipy.linalg import eigvals

from racs_bif.numerics.rightmost import rightmost


def brusselator(cells, length):
    h, B = 1.0 / (cells + 1), 5.45
    ones = np.ones(cells - 1)
    D = ss.diags_array([ones, np.full(cells, -2.0), ones], offsets=[-1, 0, 1]) / (h * length) ** 2
    eye = ss.eye_array(cells)
    blocks = [[0.008 * D + (B - 1) * eye, 4.0 * eye], [-B * eye, 0.004 * D - 4.0 * eye]]
    return ss.block_array(blocks, format="csc")


def random(seed):
    rng = np.random.default_rng(seed)
    return (ss.random_array((300, 300), density=0.01, rng=rng) - ss.eye_array(300)).tocsc()


def advection():
    n, h = 400, 1 / 401
    low, high = 0.01 / h**2 + 0.04 / h, 0.01 / h**2 - 0.04 / h
    bands = [np.full(n - 1, low), np.full(n, 8.0 - 0.02 / h**2), np.full(n - 1, high)]
    return ss.diags_array(bands, offsets=[-1, 0, 1], format="csc")


def with_pair(omega):
    pair = np.array([[0.01, 1e3 * omega], [-1e-3 * omega, 0.01]])
    return ss.block_diag([brusselator(150, 0.2), pair], format="csc")


EXAMPLES = {
    "stable": brusselator(150, 0.5),
    "two pairs": brusselator(150, 1.5),
    "many pairs": brusselator(150, 4.0),
    "random": random(1),
    "advection": advection(),
    "pair at 3": with_pair(3.0),
    "pair at 300": with_pair(300.0),
    "pair at 3000": with_pair(3000.0),
}


@pytest.mark.parametrize("matrix", EXAMPLES.values(), ids=EXAMPLES)
def test_every_unstable_eigenvalue_is_found(matrix):
    every = eigvals(matrix.toarray())
    found = rightmost(matrix)
    assert found.height == math.inf
    expected = np.sort_complex(every[every.real > 0.0])
    unstable = np.sort_complex(found.values[found.values.real > 0.0])
    assert len(unstable) == len(expected)
    np.testing.assert_allclose(unstable, expected, rtol=1e-8, atol=1e-10)
    assert np.all(np.diff(found.values.real) <= 0.0)
    # All are eigenvalues, once each, and conjugates are both there.
    distance = np.abs(found.values[:, None] - every[None, :]).min(axis=1)
    assert np.all(distance <= 1e-8 * (1.0 + np.abs(found.values)))
    assert len(np.unique(np.round(found.values, 6))) == len(found.values)
    np.testing.assert_array_equal(
        np.sort_complex(found.values), np.sort_complex(found.values.conj())
    )


def test_the_same_matrix_gives_the_same_numbers():
    matrix = brusselator(200, 1.5)
    np.testing.assert_array_equal(rightmost(matrix).values, rightmost(matrix.copy()).values)


def test_a_spectrum_too_crowded_to_be_searched_is_said_to_be():
    """Four hundred oscillators that are hardly damped, between 1 and 500 rad/s."""
    n = 400
    k = np.linspace(1.0, 500.0, n)
    matrix = ss.block_array(
        [[None, ss.eye_array(n)], [-ss.diags_array(k**2), -0.1 * ss.eye_array(n)]], format="csc"
    )
    found = rightmost(matrix)
    assert 10.0 < found.height < 500.0
    seen = found.values[(found.values.imag > 0.0) & (found.values.imag < found.height)]
    assert len(seen) == np.count_nonzero(np.sqrt(k**2 - 0.05**2) < found.height)


@pytest.mark.parametrize("at", [0.0, 1e-13, -1e-9])
def test_eigenvalues_at_the_shift_do_not_spoil_the_others(at):
    """A fold, where zero is an eigenvalue, and a pair elsewhere that has to stay exact."""
    pair = np.array([[0.3, 2.0], [-2.0, 0.3]])
    rest = ss.diags_array(-np.arange(1.0, 400.0))
    matrix = ss.block_diag([[[at]], pair, rest], format="csc")
    found = rightmost(matrix)
    assert np.abs(found.values - (0.3 + 2.0j)).min() < 1e-12
    assert np.abs(found.values - at).min() < 1e-12
