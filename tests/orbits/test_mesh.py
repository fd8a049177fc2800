import numpy as np
import pytest

from racs_bif.errors import UsageError
from racs_bif.orbits.mesh import Mesh, equidistributed


def test_equidistribution_evens_out_the_error():
    # error h^4 |x''''| of a function with a layer of width 1/50 in the middle
    def errors(mesh):
        middle = 0.5 * (mesh.nodes[1:] + mesh.nodes[:-1])
        return mesh.widths**4 / (np.abs(middle - 0.5) + 0.02) ** 4

    mesh = Mesh.uniform(64, 8)
    before = errors(mesh)
    for _ in range(3):
        mesh = equidistributed(mesh, errors(mesh), 4, 64, 8)
    assert errors(mesh).max() < before.max() / 20
    share = errors(mesh) ** 0.25
    assert share.max() < 2.1 * share.mean()


def test_no_error_gives_a_uniform_mesh():
    mesh = Mesh(np.array([0.0, 0.1, 0.7, 1.0]), 1)
    even = equidistributed(mesh, np.zeros(3), 4, 10, 4)
    assert even.steps == 12  # rounded up to whole segments
    np.testing.assert_allclose(even.widths, 1 / 12)


@pytest.mark.parametrize(
    ("nodes", "segments", "message"),
    [
        ([0.0, 0.5, 0.9], 1, "from 0 to 1"),
        ([0.0, 0.6, 0.5, 1.0], 1, "must rise"),
        ([0.0, 0.3, 0.6, 1.0], 2, "do not share out"),
    ],
)
def test_meshes_are_checked(nodes, segments, message):
    with pytest.raises(UsageError, match=message):
        Mesh(np.array(nodes), segments)
