"""Which eigenvalue became which."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Spectrum = NDArray[np.complex128]


def match(before: Spectrum, after: Spectrum) -> NDArray[np.intp]:
    """Return the places (m,) in `after` of the eigenvalues in `before`, as near as can be.

    The sum of all distances is the smallest (linear assignment).
    """
    distance = np.abs(before[:, None] - after[None, :])
    nearest: NDArray[np.intp] = distance.argmin(axis=1)
    if len(np.unique(nearest)) == len(before):
        return nearest
    # A slow import, and rarely needed.
    from scipy.optimize import linear_sum_assignment

    places: NDArray[np.intp] = linear_sum_assignment(distance)[1]
    return places
