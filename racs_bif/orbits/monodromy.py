"""Transition matrices along a given orbit: the variational equation alone is integrated."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from racs_bif.orbits.radau import STAGES, StageFactors

if TYPE_CHECKING:
    from racs_bif.orbits.mesh import Mesh
    from racs_bif.symbolic.field import Array


def transitions(jacobians: Array, mesh: Mesh, period: float) -> Array:
    """Integrate v' = J(t) v over the segments of a mesh by the Radau IIA method.

    Parameters
    ----------
    jacobians : array (3 N, n, n)
        J at the stages of the N steps.
    mesh : Mesh
        The steps.
    period : float
        Length of the mesh in time.

    Returns
    -------
    array (M, n, n)
        Transition matrices of the segments.
    """
    size = jacobians.shape[-1]
    stages = jacobians.reshape(mesh.steps, STAGES, size, size)
    maps = StageFactors(stages, period * mesh.widths).sensitivities()[:, -1]
    steps = maps.reshape(mesh.segments, mesh.per_segment, size, size)
    product = steps[:, 0]
    for k in range(1, mesh.per_segment):
        product = steps[:, k] @ product
    return np.asarray(product)
