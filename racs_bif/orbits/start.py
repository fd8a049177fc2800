"""Where branches of periodic orbits begin: at a Hopf point, or from a sampled orbit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.errors import UsageError
from racs_bif.orbits.mesh import Mesh
from racs_bif.orbits.radau import ABSCISSAE
from racs_bif.orbits.reference import Reference
from racs_bif.orbits.settings import OrbitSettings
from racs_bif.orbits.shooting import ShootingProblem

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from racs_bif.equilibria.hopf_form import HopfForm
    from racs_bif.symbolic.field import Array, VectorField
    from racs_bif.symbolic.paths import ParameterPath

_REACH: Final = 0.05
"""Share of the parameter that the first scale of the amplitude moves it by."""
_BEND: Final = 0.5
"""Largest second order of the centre manifold over its first at that scale."""
_STILL: Final = 1e-4
"""States that move less than this share of the others do not set a scale of their own."""


@dataclass(frozen=True, eq=False)
class Start:
    """All that the engine needs to follow a branch of orbits.

    Attributes
    ----------
    problem : ShootingProblem
        The equations.
    z : array (M n + 3,)
        The first point.
    tangent : array (M n + 3,) or None
        The direction in which to set off, where the start decides it.
    """

    problem: ShootingProblem
    z: Array
    tangent: Array | None


def from_hopf(
    field: VectorField,
    path: ParameterPath,
    point: ArrayLike,
    omega: float,
    q: NDArray[np.complex128],
    *,
    form: HopfForm | None = None,
    settings: OrbitSettings | None = None,
) -> Start:
    """Start the branch of orbits that is born at a Hopf point; see `hopf_seed`."""
    seed = hopf_seed(field, point, omega, q, form=form)
    return shooting_from(seed, field, path, settings)


def from_samples(
    field: VectorField,
    path: ParameterPath,
    times: ArrayLike,
    profile: ArrayLike,
    value: float,
    *,
    settings: OrbitSettings | None = None,
) -> Start:
    """Start from an orbit known by samples; see `samples_seed`."""
    return shooting_from(samples_seed(field, times, profile, value), field, path, settings)


def shooting_from(
    seed: Seed, field: VectorField, path: ParameterPath, settings: OrbitSettings | None = None
) -> Start:
    """Start a branch by shooting.

    Parameters
    ----------
    seed : Seed
        The first orbit.
    field : VectorField
        The right-hand side.
    path : ParameterPath
        Where the active parameter leads.
    settings : OrbitSettings, optional
        How orbits are resolved.
    """
    settings = settings or OrbitSettings()
    mesh = Mesh.uniform(settings.steps, settings.segments)
    times = mesh.times(ABSCISSAE)
    reference = Reference(
        mesh,
        stages=seed.points(times),
        velocities=seed.velocities(times),
        scales=seed.scales,
        degenerate=seed.direction is not None,
    )
    problem = ShootingProblem(field, path, reference, settings)
    z = problem.join(seed.points(mesh.starts), seed.period, seed.value)
    tangent = seed.direction and problem.join(seed.direction(mesh.starts), 0.0, 0.0)
    return Start(problem, z, tangent)


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
    path : ParameterPath
        Where the active parameter leads.
    point : array (n + 1,)
        The Hopf point, the active parameter last.
    omega : float
        Frequency, rad per unit of time.
    q : complex array (n,)
        Eigenvector of i omega.
    form : HopfForm, optional
        The normal form of second order, with this eigenvector.
    settings : OrbitSettings, optional
        How orbits are resolved.

    Returns
    -------
    Start
        Problem, first point and tangent.

    Raises
    ------
    UsageError
        If the frequency is not positive, or sizes do not agree.
    """
    state, value = np.split(np.asarray(point, dtype=float), [-1])
    if not (np.isfinite(omega) and omega > 0.0):
        raise UsageError(f"a Hopf point has a positive frequency, not {omega!r}")
    if not len(state) == len(q) == len(field.states):
        raise UsageError(
            f"a Hopf point of {len(field.states)} states needs as many components of the "
            f"equilibrium and of q, not {len(state)} and {len(q)}"
        )
    amplitude = _amplitude(state, float(value[0]), q, form)
    moving = np.maximum(np.abs(q), _STILL * np.abs(q).max())

    def mode(times: Array, times_slope: int) -> Array:
        turned = q * np.exp(2j * np.pi * times)[..., None]
        return 2.0 * amplitude * np.asarray(((2j * np.pi) ** times_slope * turned).real)

    return Seed(
        period=2.0 * np.pi / omega,
        value=float(value[0]),
        scales=4.0 * amplitude * moving,  # the range of 2 a Re(q e^(i theta))
        points=lambda times: np.broadcast_to(state, (*times.shape, len(state))),
        velocities=lambda times: mode(times, 1),
        direction=lambda times: mode(times, 0),
    )


def samples_seed(
    field: VectorField, times: ArrayLike, profile: ArrayLike, value: float
) -> Seed:
    """Describe an orbit known by samples: a simulation's tail, another method, a saved orbit.

    Parameters
    ----------
    field : VectorField
        The right-hand side.
    path : ParameterPath
        Where the active parameter leads.
    times : array (m,)
        Rising times of the samples; the last is one period after the first.
    profile : array (n, m)
        The states there. Last and first sample should agree; their difference is spread evenly.
    value : float
        The active parameter.
    settings : OrbitSettings, optional
        How orbits are resolved.

    Returns
    -------
    Start
        Problem and first guess, for Newton's method to correct; no tangent.

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
        raise UsageError("the samples do not move: this is an equilibrium, not an orbit")
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


def hopf_orbit(start: Start, amplitude: float, omega: float, form: HopfForm) -> Array:
    """Predict a small orbit near a Hopf point to second order.

    Parameters
    ----------
    start : Start
        From `from_hopf`.
    amplitude : float
        |w| of the normal form: the orbit is 2 |w| Re(q e^(i theta)) to first order.
    omega : float
        Frequency at the Hopf point.
    form : HopfForm
        Its normal form.

    Returns
    -------
    array (M n + 3,)
        Unknowns, for Newton's method to correct.
    """
    mesh = start.problem.reference(start.z).mesh
    w = amplitude * np.exp(2j * np.pi * mesh.starts)[:, None]
    shift = form.parameter_curvature * amplitude**2
    equilibrium = start.z[: len(form.q)] + form.h11 * amplitude**2 + form.drift * shift
    starts = equilibrium + (2.0 * w * form.q + w**2 * form.h20).real
    frequency = omega + form.frequency_curvature * amplitude**2
    return start.problem.join(starts, 2.0 * np.pi / frequency, float(start.z[-1]) + shift)


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
    reach = _REACH * (abs(value) if value else 1.0)
    limits = [1.0 / size] if bend == curvature == 0.0 else []
    if bend > 0.0:
        limits.append(_BEND * size / bend)
    if curvature > 0.0:
        limits.append(float(np.sqrt(reach / curvature)))
    return min(limits)
