import numpy as np
import pytest

from racs_bif.orbits.condense import BorderedRing, Ring


@pytest.mark.parametrize("count", [1, 2, 3, 4, 7, 8, 13])
def test_bordered_ring_against_the_dense_solution(count):
    rng = np.random.default_rng(count)
    n, k = 3, 2
    before, after = rng.standard_normal((2, count, n, n))
    columns, rows = rng.standard_normal((count, n, k)), rng.standard_normal((k, count, n))
    corner = rng.standard_normal((k, k))
    rhs, border = rng.standard_normal((count, n, 2)), rng.standard_normal((k, 2))
    dense = np.zeros((count * n + k, count * n + k))
    for m in range(count):
        rows_m, next_m = slice(m * n, m * n + n), (m + 1) % count * n
        dense[rows_m, m * n : m * n + n] += before[m]
        dense[rows_m, next_m : next_m + n] += after[m]
        dense[rows_m, count * n :] = columns[m]
    dense[count * n :, : count * n] = rows.reshape(k, -1)
    dense[count * n :, count * n :] = corner
    expected = np.linalg.solve(dense, np.concatenate((rhs.reshape(-1, 2), border)))
    points, unknowns = BorderedRing(Ring(before, after), columns, rows, corner).solve(rhs, border)
    np.testing.assert_allclose(points.reshape(-1, 2), expected[: count * n], rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(unknowns, expected[count * n :], rtol=1e-9, atol=1e-11)


def test_growth_and_decay_of_thirty_orders_do_no_harm():
    # x_1 -> ... with factors 1e4 and 1e-4 in each of 8 segments: the product is 1e32 and 1e-32
    turn = np.array([[0.6, -0.8], [0.8, 0.6]])
    blocks = np.array([turn @ np.diag([1e4, 1e-4]) @ turn.T] * 8)
    exact = np.arange(16.0).reshape(8, 2) - 5.0
    rhs = (blocks @ exact[:, :, None])[:, :, 0] - np.roll(exact, -1, axis=0)
    ring = Ring(blocks, np.broadcast_to(-np.eye(2), blocks.shape))
    empty = np.zeros((8, 2, 0)), np.zeros((0, 8, 2)), np.zeros((0, 0))
    points, _ = BorderedRing(ring, *empty).solve(rhs[:, :, None], np.zeros((0, 1)))
    np.testing.assert_allclose(points[:, :, 0], exact, rtol=1e-9, atol=1e-9)
