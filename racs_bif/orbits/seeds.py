"""What the first orbit of a branch is, before it is discretised."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.errors import UsageError
from racs_bif.orbits.mesh import Mesh, equidistributed

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from racs_bif.equilibria.hopf_form import HopfForm
    from racs_bif.symbolic.field import Array, VectorField

_REACH: Final = 0.05
"""Share of the parameter that the first scale of the amplitude moves it by."""
_BEND: Final = 0.5
"""Largest second order of the centre manifold over its first at that scale."""
_FINE: Final = 800
"""Samples by which the speed of an orbit is judged."""
_SMOOTH: Final = 8.0
"""Largest speed over the median at which equal steps serve."""
_BURSTS: Final = 4.0
"""How many times more steps an orbit that moves in bursts is given."""
_ZERO: Final = 1e-9
"""A parameter below it is zero but for rounding, and says nothing about its own magnitude."""
_STILL: Final = 1e-4
"""States that move less than this share of the others do not set a scale of their own."""


@dataclass(frozen=True, eq=False)
class Seed:
    """The first orbit of a branch as functions of time, in units of its period.

    Attributes
    ----------
    period, value : float
        Its period and the active parameter.
    scales : array (n,)
        Typical ranges of the states.
    points, velocities : callable
        Map times of any shape to states, and to their derivatives, with n appended.
    direction : callable or None
        The same for the direction in which to set off, period and parameter being unchanged to
        first order; None where the branch runs through the orbit. With it the first orbit has no
        amplitude yet.
    """

    period: float
    value: float
    scales: Array
    points: Callable[[Array], Array]
    velocities: Callable[[Array], Array]
    direction: Callable[[Array], Array] | None = None

    def mesh(self, steps: int, order: int, segments: int = 1) -> Mesh:
        """Return a mesh for the first orbit, finer where it moves faster.

        Parameters
        ----------
        steps : int
            Fewest steps; an orbit that moves in bursts is given more, up to `_BURSTS` times.
        order : int
            Power of the width with which the error of a step falls.
        segments : int
            Segments of the mesh.
        """
        uniform = Mesh.uniform(_FINE, 1)
        if self.direction is not None:
            return Mesh.uniform(steps, segments)
        speeds = np.abs(self.velocities(uniform.nodes) / self.scales).max(axis=1)
        fastest = np.maximum(speeds[1:], speeds[:-1])
        bursts = float(fastest.max() / np.median(fastest)) if np.median(fastest) > 0.0 else _BURSTS
        if bursts < _SMOOTH:
            return Mesh.uniform(steps, segments)
        more = min(max(1.0, bursts / _SMOOTH), _BURSTS)
        return equidistributed(uniform, fastest**order, order, int(more * steps), segments)


def hopf_seed(
    field: VectorField,
    point: ArrayLike,
    omega: float,
    q: NDArray[np.complex128],
    *,
    form: HopfForm | None = None,
) -> Seed:
    """Describe the branch of orbits that is born at a Hopf point.

    The first point is the equilibrium as an orbit of no amplitude and of period 2 pi / omega, and
    the branch leaves it along Re(q e^(i theta)), with period and parameter unchanged to first
    order. Steps of the engine are measured against an amplitude at which the orbits are no longer
    small: by the normal form, where the parameter has moved by a twentieth of itself.

    Parameters
    ----------
    field : VectorField
        The right-hand side.
    point : array (n + 1,)
        The Hopf point, the active parameter last.
    omega : float
        Frequency, rad per unit of time.
    q : complex array (n,)
        Eigenvector of i omega.
    form : HopfForm, optional
        The normal form of second order, with this eigenvector.

    Returns
    -------
    Seed
        The equilibrium and the direction in which the branch leaves it.

    Raises
    ------
    UsageError
        If the frequency is not positive, or sizes do not agree.
    """
    state, value = np.split(np.asarray(point, dtype=float), [-1])
    if not (np.isfinite(omega) and omega > 0.0):
        raise UsageError(f"a Hopf point must have a positive frequency, not {omega!r}")
    if not len(state) == len(q) == len(field.states):
        raise UsageError(
            f"a Hopf point of {len(field.states)} states needs as many components of the "
            f"equilibrium and of q, not {len(state)} and {len(q)}"
        )
    amplitude = _amplitude(state, float(value[0]), q, form)
    moving = np.maximum(np.abs(q), _STILL * np.abs(q).max())
    scales = 4.0 * amplitude * moving  # the range of 2 a Re(q e^(i theta))
    if form is not None:
        # what the mode leaves at rest, as symmetry may have it, moves by its square
        bent = np.abs(form.h11) + np.abs(form.h20)
        scales = np.maximum(scales, 2.0 * amplitude**2 * bent)

    def mode(times: Array, times_slope: int) -> Array:
        turned = q * np.exp(2j * np.pi * times)[..., None]
        return 2.0 * amplitude * np.asarray(((2j * np.pi) ** times_slope * turned).real)

    return Seed(
        period=2.0 * np.pi / omega,
        value=float(value[0]),
        scales=scales,
        points=lambda times: np.broadcast_to(state, (*times.shape, len(state))),
        velocities=lambda times: mode(times, 1),
        direction=lambda times: mode(times, 0),
    )


def samples_seed(field: VectorField, times: ArrayLike, profile: ArrayLike, value: float) -> Seed:
    """Describe an orbit known by samples: a simulation's tail, another method, a saved orbit.

    Parameters
    ----------
    field : VectorField
        The right-hand side.
    times : array (m,)
        Rising times of the samples; the last is one period after the first.
    profile : array (n, m)
        The states there. Last and first sample should agree; their difference is spread evenly.
    value : float
        The active parameter.

    Returns
    -------
    Seed
        A guess, for Newton's method to correct; no direction.

    Raises
    ------
    UsageError
        If the samples are too few, not finite, do not move, or do not fit the field.
    """
    from scipy.interpolate import CubicSpline

    t, x = np.asarray(times, dtype=float), np.asarray(profile, dtype=float)
    if t.ndim != 1 or len(t) < 5 or x.shape != (len(field.states), len(t)):
        raise UsageError(
            f"an orbit of {len(field.states)} states is sampled as times (m,) and a profile "
            f"({len(field.states)}, m) with m of at least 5, not {t.shape} and {x.shape}"
        )
    if not (np.all(np.isfinite(x)) and np.all(np.isfinite(t)) and np.all(np.diff(t) > 0.0)):
        raise UsageError("the samples of an orbit must be finite and their times must rise")
    ranges = np.ptp(x, axis=1)
    if ranges.max() == 0.0:
        raise UsageError("the samples of an orbit must move, these are an equilibrium")
    s = (t - t[0]) / (t[-1] - t[0])
    closed = x - np.outer(x[:, -1] - x[:, 0], s)
    closed[:, -1] = closed[:, 0]
    spline = CubicSpline(s, closed.T, bc_type="periodic")
    return Seed(
        period=float(t[-1] - t[0]),
        value=value,
        scales=np.maximum(ranges, _STILL * np.maximum(np.abs(x).max(axis=1), ranges.max())),
        points=spline,
        velocities=lambda times: np.asarray(spline(times, 1)),
    )


def _amplitude(
    state: Array, value: float, q: NDArray[np.complex128], form: HopfForm | None
) -> float:
    """Return the amplitude |w| at which orbits are no longer small."""
    size = float(np.linalg.norm(q))
    if form is None:
        equilibrium = float(np.linalg.norm(state))
        return (0.1 * equilibrium if equilibrium > 0.0 else 1.0) / size
    bend = float(np.linalg.norm(form.h20) + np.linalg.norm(form.h11))
    curvature = abs(form.parameter_curvature)
    reach = _REACH * (abs(value) if abs(value) > _ZERO else 1.0)
    limits = [1.0 / size] if bend == curvature == 0.0 else []
    if bend > 0.0:
        limits.append(_BEND * size / bend)
    if curvature > 0.0:
        limits.append(float(np.sqrt(reach / curvature)))
    return min(limits)
