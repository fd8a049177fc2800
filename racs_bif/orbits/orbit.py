"""One periodic orbit as a result."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.orbits.remesh import halved

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from racs_bif.orbits.shooting import ShootingProblem
    from racs_bif.symbolic.field import Array


@dataclass(frozen=True, eq=False)
class Orbit:
    """A periodic orbit.

    Attributes
    ----------
    states : tuple of str
        Names of the n states.
    parameter : str
        Name of the active parameter.
    value : float
        Its value.
    period : float
        The period, in units of time.
    times : array (m,)
        From 0 to the period, where the method knows the orbit: dense where its mesh is.
    profile : array (n, m)
        The states there.
    maxima, minima : array (n,)
        True extrema of the states, which may lie between the samples.
    multipliers : complex array (n,)
        Floquet multipliers, the trivial one first, then by falling modulus.
    stable : bool or None
        Whether all but the trivial one are inside the unit circle.
    trivial_error : float
        Distance of the trivial multiplier from 1: the health of the orbit.
    """

    states: tuple[str, ...]
    parameter: str
    value: float
    period: float
    times: Array
    profile: Array
    maxima: Array
    minima: Array
    multipliers: NDArray[np.complex128]
    stable: bool | None
    trivial_error: float


@dataclass(frozen=True, eq=False)
class Refinement:
    """What an orbit becomes on a mesh of twice as many steps: its error estimate.

    Attributes
    ----------
    orbit : Orbit
        The orbit on the finer mesh, at the same value of the parameter.
    period : float
        Change of the period, relative: an estimate of the coarser mesh's error.
    extremes : array (n,)
        Largest change of maxima and minima, relative to the range of each state.
    multiplier : float
        Largest change of a multiplier, relative to the larger of its modulus and 1.
    """

    orbit: Orbit
    period: float
    extremes: Array
    multiplier: float


def refined(problem: ShootingProblem, z: Array) -> Refinement:
    """Solve for an orbit again on a mesh of twice as many steps, at the same parameter.

    Parameters
    ----------
    problem : ShootingProblem
        The problem that the orbit is a solution of.
    z : array (M n + 3,)
        The orbit.

    Returns
    -------
    Refinement
        The finer orbit, and how far the coarser one is from it.

    Raises
    ------
    ConvergenceError
        If the orbit is not found on the finer mesh.
    """
    coarse = problem.orbit(z)
    finer, _ = problem.on_mesh(z, halved(problem.reference(z).mesh))
    return compare(coarse, problem.orbit(finer))


def compare(coarse: Orbit, fine: Orbit) -> Refinement:
    """Return the differences between an orbit and the same one on a finer mesh."""
    ranges = np.maximum(fine.maxima - fine.minima, np.finfo(float).tiny)
    extremes = np.maximum(np.abs(fine.maxima - coarse.maxima), np.abs(fine.minima - coarse.minima))
    finite = np.isfinite(coarse.multipliers) & np.isfinite(fine.multipliers)
    before, after = coarse.multipliers[finite], fine.multipliers[finite]
    moved = np.abs(after - before) / np.maximum(1.0, np.abs(after))
    return Refinement(
        orbit=fine,
        period=abs(fine.period - coarse.period) / fine.period,
        extremes=extremes / ranges,
        multiplier=float(moved.max(initial=0.0)),
    )
