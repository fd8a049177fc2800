"""Dense solves and what counts as singular."""

import numpy as np
import pytest

from racs_bif.numerics.bordered import factorise


def test_solution_for_one_and_several_right_hand_sides():
    random = np.random.default_rng(1)
    matrix = random.standard_normal((7, 7))
    kept = matrix.copy()
    solve = factorise(matrix)
    for shape in ((7,), (7, 3)):
        right = random.standard_normal(shape)
        np.testing.assert_allclose(matrix @ solve(right), right, atol=1e-12)
    assert np.array_equal(matrix, kept)


@pytest.mark.parametrize(
    "matrix",
    [
        np.zeros((2, 2)),
        np.ones((3, 3)),
        np.array([[0.1, 0.3], [0.2, 0.6]]),
        np.array([[1.0, np.nan], [0.0, 1.0]]),
    ],
)
def test_singular_matrices_are_refused(matrix):
    with pytest.raises(np.linalg.LinAlgError):
        factorise(matrix)


def test_units_of_rows_and_columns_do_not_make_a_matrix_singular():
    random = np.random.default_rng(2)
    units = 10.0 ** np.array([-12, 0, 9, 3, -6])
    matrix = random.standard_normal((5, 5)) * units
    right = random.standard_normal(5)
    np.testing.assert_allclose(matrix @ factorise(matrix)(right), right, rtol=1e-9)
    matrix = matrix.T.copy()
    right = right * units
    np.testing.assert_allclose(matrix @ factorise(matrix)(right), right, rtol=1e-9, atol=1e-6)
