"""Where branches by shooting begin: at a Hopf point, or from a sampled orbit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.orbits.dense import ORDER
from racs_bif.orbits.radau import ABSCISSAE
from racs_bif.orbits.reference import Reference
from racs_bif.orbits.seeds import Seed, hopf_seed, samples_seed
from racs_bif.orbits.settings import OrbitSettings
from racs_bif.orbits.shooting import ShootingProblem

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from racs_bif.equilibria.hopf_form import HopfForm
    from racs_bif.symbolic.field import Array, VectorField
    from racs_bif.symbolic.paths import ParameterPath


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
    mesh = seed.mesh(settings.steps, ORDER, settings.segments)
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
