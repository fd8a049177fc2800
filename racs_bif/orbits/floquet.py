"""Floquet multipliers from the transition matrices of the segments, without their product."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from racs_bif.orbits.condense import Ring

if TYPE_CHECKING:
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

    @property
    def health(self) -> float:
        """The error of the trivial multiplier times its distance from the nearest other, up to 1.

        At a fold of cycles two multipliers meet at 1 and an error e of the monodromy splits them by
        its root, so that the trivial one looks worse than it is.
        """
        others = np.abs(self.multipliers[1:] - self.multipliers[0])
        return self.trivial_error * float(min(1.0, others.min(initial=1.0)))


def floquet(
    transitions: Array, velocities: Array | None = None, scales: Array | None = None
) -> Floquet:
    """Compute the multipliers of the product P_M ... P_2 P_1.

    The ring of segments is condensed by orthogonal transformations to A x_1 + B x_(M+1) = 0, and
    A v = -mu B v is solved by the QZ algorithm: large multipliers do not drown the small ones
    (T. F. Fairgrieve and A. D. Jepson, SIAM J. Numer. Anal. 28, 1991).

    With the direction of the flow given, the trivial multiplier is told from others close to 1 by
    its eigenvector, and these others are taken from the linearised Poincare map, across the flow: a
    multiplier that passes through 1 at a fold of cycles is then simple, and not split off the
    trivial one by the root of its error.

    Parameters
    ----------
    transitions : array (M, n, n)
        Transition matrices of the segments in their order.
    velocities : array (M, n), optional
        Directions of the flow at the starts of the segments.
    scales : array (n,), optional
        Typical magnitudes of the states; the eigenproblem is balanced by them.

    Returns
    -------
    Floquet
        The multipliers.
    """
    size = transitions.shape[-1]
    scale = np.ones(size) if scales is None else scales
    balanced = transitions * (scale / scale[:, None])
    values, vectors = _eigen(balanced)
    if velocities is None or not np.all(np.abs(velocities).max(axis=1) > 0.0):
        trivial = int(np.argmin(np.abs(values - 1.0)))
        rest = np.delete(values, trivial)
    else:
        flow = velocities / scale
        trivial = _trivial(values, vectors, flow[0])
        rest = np.delete(values, trivial)
        near = np.abs(rest - 1.0) < _NEAR
        if near.any():
            across = _across(balanced, flow)
            rest[near] = across[np.argsort(np.abs(across - 1.0))[: np.count_nonzero(near)]]
    # conjugates share modulus and real part up to rounding: sort by those rounded
    modulus = np.abs(rest)
    order = np.lexsort((-rest.imag, -_rounded(rest.real, modulus), -_rounded(modulus, modulus)))
    ordered = np.concatenate((values[[trivial]], rest[order]))
    return Floquet(ordered, float(abs(ordered[0] - 1.0)))


def _eigen(transitions: Array) -> tuple[Multipliers, NDArray[np.complex128]]:
    """Return the eigenvalues and eigenvectors of the product of transition matrices."""
    from scipy.linalg import eig

    ring = Ring(transitions, np.broadcast_to(-np.eye(transitions.shape[-1]), transitions.shape))
    pairs, vectors = eig(ring.before, -ring.after, homogeneous_eigvals=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        values = np.asarray(pairs[0] / pairs[1], dtype=complex)
    values[~np.isfinite(values)] = np.inf
    return values, vectors


def _across(transitions: Array, flow: Array) -> Multipliers:
    """Return the multipliers (n - 1,) of the linearised Poincare map, across the flow (M, n)."""
    frames = np.linalg.qr(flow[:, :, None], mode="complete")[0][:, :, 1:]
    following = np.swapaxes(np.roll(frames, -1, axis=0), 1, 2)
    return _eigen(following @ transitions @ frames)[0]


def _rounded(values: Array, sizes: Array) -> Array:
    """Round to ten digits of the sizes, so that a conjugate pair sorts as one."""
    with np.errstate(divide="ignore", invalid="ignore"):
        digits = np.floor(np.log10(sizes))
        unit = 10.0 ** (np.where(np.isfinite(digits), digits, 0.0) - 9.0)
        rounded = np.round(values / unit) * unit
    return np.where(np.isfinite(rounded), rounded, values)


def _trivial(values: Multipliers, vectors: NDArray[np.complex128], velocity: Array) -> int:
    """Return the place of the trivial multiplier, among those near 1 the one along the flow."""
    distance = np.abs(values - 1.0)
    near = np.flatnonzero(distance < _NEAR)
    nearest = int(np.argmin(distance))
    if len(near) < 2:
        return nearest
    candidates = vectors[:, near]
    alignment = np.abs(velocity @ candidates) / np.linalg.norm(candidates, axis=0)
    best = int(near[np.argmax(alignment)])
    # two eigenvectors that merge (a fold of cycles) both point along the flow: nearest it is
    merged = np.sort(alignment)[-2] > 0.999 * alignment.max()
    return nearest if merged else best
