"""Which eigenvalue became which."""

from __future__ import annotations

from itertools import permutations
from typing import Final

import numpy as np
from numpy.typing import NDArray

Spectrum = NDArray[np.complex128]

_FEW: Final = 5
"""Of so few eigenvalues all orders are tried."""


def match(before: Spectrum, after: Spectrum) -> NDArray[np.intp]:
    """Return the places (m,) in `after` of the eigenvalues in `before`, as near as can be.

    The sum of all distances is the smallest (linear assignment).
    """
    distance = np.abs(before[:, None] - after[None, :])
    nearest: NDArray[np.intp] = distance.argmin(axis=1)
    if len(np.unique(nearest)) == len(before):
        return nearest
    if len(before) == len(after) <= _FEW:
        orders = np.array(list(permutations(range(len(after)))), dtype=np.intp)
        sums = distance[np.arange(len(before)), orders].sum(axis=1)
        return np.asarray(orders[sums.argmin()])
    # A slow import, and rarely needed.
    from scipy.optimize import linear_sum_assignment

    places: NDArray[np.intp] = linear_sum_assignment(distance)[1]
    return places
