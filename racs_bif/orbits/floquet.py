"""Floquet multipliers from the transition matrices of the segments, without their product."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from racs_bif.orbits.condense import Ring
from racs_bif.symbolic.field import Array

Multipliers = NDArray[np.complex128]

_NEAR: Final = 0.05
"""How far from 1 a multiplier may be and still be a candidate for the trivial one."""


@dataclass(frozen=True, eq=False)
class Floquet:
    """The multipliers of a periodic orbit.

    Attributes
    ----------
    multipliers : complex array (n,)
        The trivial multiplier first, then the others by falling modulus; infinite where the
        eigenproblem says so.
    trivial_error : float
        Distance of the trivial multiplier from 1: the health of the orbit and its multipliers.
    """

    multipliers: Multipliers
    trivial_error: float


def floquet(transitions: Array, velocity: Array | None = None, scales: Array | None = None) -> Floquet:
    """Compute the multipliers of the product P_M ... P_2 P_1.

    The ring of segments is condensed by orthogonal transformations to A x_1 + B x_(M+1) = 0, and
    A v = -mu B v is solved by the QZ algorithm: large multipliers do not drown the small ones
    (T. F. Fairgrieve and A. D. Jepson, SIAM J. Numer. Anal. 28, 1991).

    Parameters
    ----------
    transitions : array (M, n, n)
        Transition matrices of the segments in their order.
    velocity : array (n,), optional
        Direction of the flow at the start of the first segment, the eigenvector of the trivial
        multiplier. It tells the trivial multiplier from others that are close to 1.
    scales : array (n,), optional
        Typical magnitudes of the states; the eigenproblem is balanced by them.

    Returns
    -------
    Floquet
        The multipliers.
    """
    import scipy.linalg  # noqa: PLC0415 - slow to import

    size = transitions.shape[-1]
    scale = np.ones(size) if scales is None else scales
    balanced = transitions * (scale / scale[:, None])
    ring = Ring(balanced, np.broadcast_to(-np.eye(size), balanced.shape))
    pairs, vectors = scipy.linalg.eig(
        ring.before, -ring.after, homogeneous_eigvals=True, check_finite=True
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        values = np.asarray(pairs[0] / pairs[1], dtype=complex)
    values[~np.isfinite(values)] = np.inf
    trivial = _trivial(values, vectors, None if velocity is None else velocity / scale)
    rest = np.delete(values, trivial)
    # conjugates share modulus and real part up to rounding: sort by those rounded
    modulus = np.abs(rest)
    order = np.lexsort((-rest.imag, -_rounded(rest.real, modulus), -_rounded(modulus, modulus)))
    ordered = np.concatenate((values[[trivial]], rest[order]))
    return Floquet(ordered, float(abs(ordered[0] - 1.0)))


def _rounded(values: Array, sizes: Array) -> Array:
    """Round to ten digits of the sizes, so that a conjugate pair sorts as one."""
    with np.errstate(divide="ignore", invalid="ignore"):
        digits = np.floor(np.log10(sizes))
        unit = 10.0 ** (np.where(np.isfinite(digits), digits, 0.0) - 9.0)
        rounded = np.round(values / unit) * unit
    return np.where(np.isfinite(rounded), rounded, values)


def _trivial(values: Multipliers, vectors: NDArray[np.complex128], velocity: Array | None) -> int:
    """Return the place of the trivial multiplier.

    Among the multipliers near 1 it is the one whose eigenvector points along the flow; without a
    flow (an orbit of no amplitude), or with none near 1, it is the nearest.
    """
    distance = np.abs(values - 1.0)
    near = np.flatnonzero(distance < _NEAR)
    nearest = int(np.argmin(distance))
    if velocity is None or len(near) < 2:
        return nearest
    length = float(np.linalg.norm(velocity))
    if length == 0.0 or not np.isfinite(length):
        return nearest
    candidates = vectors[:, near]
    alignment = np.abs(velocity @ candidates) / np.linalg.norm(candidates, axis=0)
    best = int(near[np.argmax(alignment)])
    # two eigenvectors that merge (a fold of cycles) both point along the flow: nearest it is
    merged = np.sort(alignment)[-2] > 0.999 * alignment.max()
    return nearest if merged else best
