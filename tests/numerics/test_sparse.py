"""Sparse factors against dense ones: solutions, signs of determinants, singular values."""

import numpy as np
import pytest
from scipy import sparse as ss

from racs_bif.numerics import sparse


def example(seed, size, kind=float):
    rng = np.random.default_rng(seed)
    matrix = ss.random_array((size, size), density=0.3, rng=rng)
    matrix = matrix + ss.diags_array(rng.standard_normal(size))
    return (matrix + (0.5j * ss.eye_array(size) if kind is complex else 0.0 * matrix)).tocsc()


@pytest.mark.parametrize("kind", [float, complex])
@pytest.mark.parametrize("shape", [(), (3,)])
def test_solutions_real_and_complex(kind, shape):
    matrix = example(1, 30, kind)
    right = np.random.default_rng(2).standard_normal((30, *shape))
    factors = sparse.Factors(matrix)
    for side in (right, right + 1j * right[::-1]):
        np.testing.assert_allclose(matrix @ factors.solve(side), side, atol=1e-12)
        if side.ndim == 1:
            adjoint = factors.adjoint(side)
            np.testing.assert_allclose(matrix.conj().T @ adjoint, side, atol=1e-11)


@pytest.mark.parametrize("seed", range(12))
def test_signs_of_determinants(seed):
    matrix = example(seed, 6 + seed)
    expected = np.linalg.slogdet(matrix.toarray())[0]
    assert sparse.Factors(matrix).sign == expected
    swapped = matrix[[1, 0, *range(2, matrix.shape[0])]].tocsc()
    assert sparse.Factors(swapped, last=1e-3).sign == -expected


@pytest.mark.parametrize("seed", range(4))
def test_smallest_singular_values(seed):
    matrix = example(seed, 40)
    expected = np.linalg.svd(matrix.toarray(), compute_uv=False)[-1]
    found = sparse.smallest_singular(matrix, sparse.Factors(matrix))
    assert found == pytest.approx(expected, rel=1e-8)


def test_borders_are_solved_with_though_the_matrix_is_singular():
    n = 400
    matrix = ss.diags_array([np.ones(n - 1), -2.0 * np.ones(n), np.ones(n - 1)], offsets=[-1, 0, 1])
    h = 1.0 / (n + 1)
    matrix = (matrix + 4.0 * np.sin(np.pi * h / 2) ** 2 * ss.eye_array(n)).tocsc()
    null = np.sin(np.pi * h * np.arange(1, n + 1))
    column, row = np.linspace(1.0, 2.0, n), np.append(null, 0.3)
    full = np.block([[matrix.toarray(), column[:, None]], [row[None, :]]])
    right = np.random.default_rng(0).standard_normal(n + 1)
    solve = sparse.bordered(sparse.beside(matrix, column), row)
    np.testing.assert_allclose(solve(right), np.linalg.solve(full, right), rtol=1e-7)


@pytest.mark.parametrize("spoilt", [0.0, np.nan, np.inf])
def test_singular_and_broken_matrices_are_refused(spoilt):
    matrix = example(3, 20).tolil()
    matrix[4] = 0.0
    matrix[4, 7] = spoilt
    with pytest.raises(np.linalg.LinAlgError):
        sparse.Factors(matrix.tocsc())


def test_a_constant_that_nothing_holds_is_refused():
    bands = [-np.ones(19), np.array([1.0, *[2.0] * 18, 1.0]), -np.ones(19)]
    with pytest.raises(np.linalg.LinAlgError):
        sparse.Factors(ss.diags_array(bands, offsets=[-1, 0, 1], format="csc"))


def test_sparse_pays_for_large_and_empty_matrices_only():
    eye = ss.eye_array(sparse.LARGE, format="csc")
    assert sparse.worthwhile(eye)
    assert not sparse.worthwhile(eye[1:, 1:])
    assert not sparse.worthwhile(ss.csc_array(np.ones((sparse.LARGE, sparse.LARGE))))


def test_a_matrix_that_is_singular_but_for_rounding_is_refused():
    rows = np.eye(60)
    rows[:2, :2] = [[0.1, 0.2], [0.3, 0.6 + 1e-16]]
    assert np.linalg.det(rows) != 0.0
    with pytest.raises(np.linalg.LinAlgError, match=r"the matrix is singular$"):
        sparse.Factors(ss.csc_array(rows))
    rows[1, 1] += 1e-3
    right = np.arange(60.0)
    found = sparse.Factors(ss.csc_array(rows)).solve(right)
    np.testing.assert_allclose(rows @ found, right, atol=1e-10)
