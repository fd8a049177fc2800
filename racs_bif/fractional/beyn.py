"""Roots in a disc by contour integrals of the inverse matrix.

Source: W.-J. Beyn, *An integral method for solving nonlinear eigenvalue problems*, Linear Algebra
Appl. 436 (2012) 3839-3863, algorithm 2 (more roots than rows: a block Hankel matrix of moments).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from racs_bif.fractional.characteristic import Characteristic
    from racs_bif.fractional.laws import Complex

_NODES = 64
_RANK = 1e-9


def roots_in_disc(
    ch: Characteristic, centre: complex, radius: float, most: int, *, nodes: int = _NODES
) -> Complex:
    """Return estimates of the zeros of det Delta(exp(t)) in a disc over t.

    Parameters
    ----------
    ch : Characteristic
        The characteristic matrix.
    centre : complex
        Centre of the disc.
    radius : float
        Its radius.
    most : int
        Number of roots that can be told apart, at least.
    nodes : int
        Points of the trapezoidal rule on the circle.

    Returns
    -------
    array (k,)
        Estimates, also poor ones of roots near to or beyond the circle: to be polished and counted.
    """
    unit = np.exp(2j * np.pi * (np.arange(nodes) + 0.5) / nodes)
    matrix = ch.matrix(centre + radius * unit, ch.shift(np.array([centre])))
    rows = np.abs(matrix).max(axis=2, keepdims=True)
    # One scaling for all points, or the moments would not be those of one function.
    matrix = matrix / rows.max(axis=0)
    inverse = np.linalg.inv(matrix)
    inverse /= np.abs(inverse).max(axis=(0, 2))[:, None]
    moments = -(-most // ch.size) + 1
    powers = unit[None, :] ** np.arange(1, 2 * moments + 1)[:, None]
    A = np.einsum("kN,Nij->kij", powers, inverse) / nodes
    places = np.arange(moments)
    index = places[:, None] + places[None, :]
    size = moments * ch.size
    first = A[index].transpose(0, 2, 1, 3).reshape(size, size)
    second = A[index + 1].transpose(0, 2, 1, 3).reshape(size, size)
    u, sigma, vh = np.linalg.svd(first)
    rank = int(np.sum(sigma > _RANK * sigma[0])) if sigma[0] > 0.0 else 0
    if rank == 0:
        return np.zeros(0, dtype=complex)
    u, v = u[:, :rank], vh[:rank].conj().T
    small = (u.conj().T @ second @ v) / sigma[:rank]
    return np.asarray(centre + radius * np.linalg.eigvals(small))
