"""The matrix of the collocation equations, as a sparse array.

The solvers never need it: they eliminate interval by interval. It is what checks ask for.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from racs_bif.orbits.equations import Collocated
    from racs_bif.orbits.reference import Reference
    from racs_bif.symbolic.field import Array


def sparse_jacobian(at: Collocated, jacobians: Array, columns: Array, reference: Reference) -> Any:  # noqa: ANN401 - scipy's arrays have no types
    """Return the derivative (N m n + 2, N m n + 3) of defects, phase and number.

    Parameters
    ----------
    at : Collocated
        Where.
    jacobians : array (N, m, n, n)
        Derivatives of f at the Gauss points.
    columns : array (2, N, m, n)
        Derivatives of tau f by period and parameter.
    reference : Reference
        Scales and phase condition.
    """
    from scipy.sparse import block_array, bsr_array, csr_array

    g = at.curve.gauss
    count, degree, n = jacobians.shape[:3]
    width = degree * n
    blocks = -np.einsum("jl,kjab->kjlab", g.values, at.tau[:, None, None, None] * jacobians)
    diagonals = np.einsum("kjlaa->kjla", blocks)
    diagonals += g.slopes[:, :, None]
    blocks /= reference.scales[:, None]
    # rows of n x n blocks: the nodes of an interval, and the first of the next
    places = (np.arange(count)[:, None] * degree + np.arange(degree + 1)) % (count * degree)
    indices = np.repeat(places, degree, axis=0).ravel()
    starts = np.arange(count * degree + 1) * (degree + 1)
    ring = bsr_array((blocks.reshape(-1, n, n), indices, starts), shape=(count * width,) * 2)
    scaled = -(columns / reference.scales).reshape(2, -1)
    right = csr_array(np.stack((scaled[0], np.zeros_like(scaled[0]), scaled[1]), axis=1))
    rows = g.values.T @ reference.weights
    phase = rows[:, :degree].copy()
    phase[:, 0] += np.roll(rows[:, degree], 1, axis=0)
    border = csr_array(np.stack((phase.ravel(), np.zeros(count * width))))
    corner = csr_array([[0.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    return block_array([[ring, right], [border, corner]], format="csc")
