import numpy as np
import pytest

from racs_bif.orbits.floquet import floquet


def blocks_of(core, count, seed):
    """Split Q_0 core^(1/count) ... so that the blocks' product is Q_0 core Q_0^T exactly."""
    rng = np.random.default_rng(seed)
    n = len(core[0])
    frames = [np.linalg.qr(rng.standard_normal((n, n)))[0] for _ in range(count)]
    return np.array([frames[(m + 1) % count] @ core[m] @ frames[m].T for m in range(count)])


@pytest.mark.parametrize("count", [5, 8, 16])  # a single block of norm 1e10 has lost 1e-10 already
def test_multipliers_from_1e10_to_1e_minus_10(count):
    exact = np.array([1.0, 3.2e10, -4.5e4, 0.7, -2e-5, 1.5e-10])
    rng = np.random.default_rng(1)
    # upper triangular factors with diagonals exact^(1/count), the sign in the first of them
    cores = []
    for m in range(count):
        diagonal = np.abs(exact) ** (1.0 / count)
        diagonal = diagonal * np.sign(exact) if m == 0 else diagonal
        strict = np.triu(0.1 * rng.standard_normal((6, 6)), 1) * diagonal
        cores.append(np.diag(diagonal) + strict)
    found = floquet(blocks_of(cores, count, 2)).multipliers
    assert found[0] == pytest.approx(1.0, abs=1e-6)
    order = np.argsort(-np.abs(exact[1:]))
    np.testing.assert_allclose(found[1:], exact[1:][order], rtol=2e-4)


def test_complex_multipliers_and_order():
    c, s = np.cos(1.1), np.sin(1.1)
    core = np.zeros((4, 4))
    core[:2, :2] = 0.9 * np.array([[c, -s], [s, c]])
    core[2, 2], core[3, 3] = 1.0, -1.7
    found = floquet(blocks_of([core, np.eye(4), np.eye(4)], 3, 5))
    expected = [1.0, -1.7, 0.9 * np.exp(1.1j), 0.9 * np.exp(-1.1j)]
    np.testing.assert_allclose(found.multipliers, expected, atol=1e-12)
    assert found.trivial_error < 1e-12


def test_the_trivial_multiplier_is_the_one_along_the_flow():
    # a slow multiplier closer to 1 than the trivial one's error: the flow's direction decides
    frame = np.array([[0.6, -0.8, 0.0], [0.8, 0.6, 0.0], [0.0, 0.0, 1.0]])
    core = np.diag([1.0 + 1e-4, 1.0 - 1e-7, 0.5])
    block = (frame @ core @ frame.T)[None]
    found = floquet(block, velocities=frame[None, :, 0])
    assert found.trivial_error == pytest.approx(1e-4, rel=1e-8)
    assert found.multipliers[1].real == pytest.approx(1.0 - 1e-7, abs=1e-13)
    assert floquet(block).trivial_error == pytest.approx(1e-7, rel=1e-5)


def test_scales_do_not_change_the_multipliers():
    rng = np.random.default_rng(7)
    blocks = rng.standard_normal((4, 3, 3))
    scales = np.array([1e-3, 1.0, 1e4])
    plain = np.sort_complex(floquet(blocks).multipliers)
    units = blocks * (scales[:, None] / scales)
    np.testing.assert_allclose(np.sort_complex(floquet(units, scales=scales).multipliers), plain)
