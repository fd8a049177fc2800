"""Where branches by collocation begin: at a Hopf point, a sampled orbit, or another branch."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.errors import UsageError
from racs_bif.orbits.collocation import CollocationProblem
from racs_bif.orbits.collocation_settings import CollocationSettings
from racs_bif.orbits.folded import BorderedFolds, Folds
from racs_bif.orbits.history import reference_of
from racs_bif.orbits.intervals import GROWTH
from racs_bif.orbits.mesh import Mesh
from racs_bif.orbits.piecewise import Piecewise, equidistant
from racs_bif.orbits.reference import Reference
from racs_bif.orbits.seeds import Seed, hopf_seed, samples_seed
from racs_bif.orbits.switching import crossing, leave

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from racs_bif.equilibria.hopf_form import HopfForm
    from racs_bif.orbits.problem import OrbitProblem
    from racs_bif.symbolic.field import Array, VectorField
    from racs_bif.symbolic.paths import ParameterPath

_SAMPLES: Final = 401
"""Samples by which an orbit of another discretisation is taken over."""
_AMPLITUDE: Final = 0.1
"""Length of the direction in which a branch is left, in ranges of the states."""
_SINGULAR: Final = 1e-3
"""How nearly a branch point's or a doubling's matrix must be singular."""
_SEED: Final = 7


@dataclass(frozen=True, eq=False)
class CollocationStart:
    """All that the engine needs to follow a branch of orbits by collocation.

    Attributes
    ----------
    problem : CollocationProblem
        The equations.
    z : array (N m n + 3,)
        The first point.
    tangent : array (N m n + 3,) or None
        The direction in which to set off, where the start decides it.
    """

    problem: CollocationProblem
    z: Array
    tangent: Array | None


def collocated_from(
    seed: Seed,
    field: VectorField,
    path: ParameterPath,
    settings: CollocationSettings | None = None,
) -> CollocationStart:
    """Start a branch by collocation.

    Parameters
    ----------
    seed : Seed
        The first orbit.
    field : VectorField
        The right-hand side.
    path : ParameterPath
        Where the active parameter leads.
    settings : CollocationSettings, optional
        How orbits are resolved.
    """
    settings = settings or CollocationSettings()
    mesh = seed.mesh(settings.intervals, settings.degree + 1)
    times = equidistant(mesh, settings.degree)
    curve = Piecewise(mesh, np.array(seed.points(times)))
    at_gauss = mesh.times(curve.gauss.abscissae)
    reference = Reference(
        mesh,
        stages=seed.points(at_gauss),
        velocities=seed.velocities(at_gauss),
        scales=seed.scales,
        degenerate=seed.direction is not None,
        quadrature=curve.gauss.weights,
    )
    problem = CollocationProblem(field, path, reference, curve, settings)
    z = problem.join(curve.nodes, seed.period, seed.value)
    tangent = seed.direction and problem.join(seed.direction(times), 0.0, 0.0)
    return CollocationStart(problem, z, tangent)


def collocated_from_hopf(
    field: VectorField,
    path: ParameterPath,
    point: ArrayLike,
    omega: float,
    q: NDArray[np.complex128],
    *,
    form: HopfForm | None = None,
    settings: CollocationSettings | None = None,
) -> CollocationStart:
    """Start the branch of orbits that is born at a Hopf point; see `hopf_seed`."""
    seed = hopf_seed(field, point, omega, q, form=form)
    return collocated_from(seed, field, path, settings)


def collocated_from_samples(
    field: VectorField,
    path: ParameterPath,
    times: ArrayLike,
    profile: ArrayLike,
    value: float,
    *,
    settings: CollocationSettings | None = None,
) -> CollocationStart:
    """Start from an orbit known by samples; see `samples_seed`."""
    return collocated_from(samples_seed(field, times, profile, value), field, path, settings)


def collocated_from_orbit(
    problem: OrbitProblem,
    z: Array,
    path: ParameterPath,
    *,
    settings: CollocationSettings | None = None,
) -> CollocationStart:
    """Start from an orbit of any discretisation.

    Parameters
    ----------
    problem : OrbitProblem
        The problem that the orbit is a solution of.
    z : array
        The orbit; its parameter must be that of `path`.
    path : ParameterPath
        Where the active parameter leads.
    settings : CollocationSettings, optional
        How orbits are resolved.
    """
    fractions = np.linspace(0.0, 1.0, _SAMPLES)
    times, profile = fractions * problem.period(z), problem.sample(z, fractions)
    return collocated_from_samples(
        problem.field, path, times, profile, float(z[-1]), settings=settings
    )


def doubled(problem: CollocationProblem, z: Array) -> CollocationStart:
    """Start the branch of orbits of twice the period that is born at a period doubling.

    The first point is the orbit run through twice; the branch leaves it along the eigenfunction of
    the multiplier -1, with period and parameter unchanged to first order.

    Parameters
    ----------
    problem : CollocationProblem
        The problem whose branch the doubling lies on.
    z : array (N m n + 3,)
        The period doubling.

    Raises
    ------
    UsageError
        If no multiplier is -1 there.
    """
    mode = _mode(problem, z, -1.0)
    curve, settings = problem.curve(z), problem.settings
    nodes = curve.mesh.nodes
    mesh = Mesh(np.concatenate((0.5 * nodes, 0.5 + 0.5 * nodes[1:])), 1)
    mesh.nodes[-1] = 1.0
    both = Piecewise(mesh, np.concatenate((curve.nodes, curve.nodes)))

    def twice(scales: Array) -> tuple[CollocationProblem, Array]:
        first = replace(reference_of(both, scales), degenerate=True)
        longer = CollocationProblem(problem.field, problem.path, first, both, settings, turns=2)
        return longer, longer.join(both.nodes, 2.0 * problem.period(z), float(z[-1]))

    longer, start = twice(problem.reference(z).scales)
    across = longer.join(np.concatenate((mode, -mode)), 0.0, 0.0)
    found = leave(longer, start, across, twice)
    assert isinstance(found.problem, CollocationProblem)
    return CollocationStart(found.problem, found.z, found.direction)


def switched(problem: CollocationProblem, z: Array, tangent: Array) -> CollocationStart:
    """Start the other branch at a point where two branches of orbits cross (BPC).

    Parameters
    ----------
    problem : CollocationProblem
        The problem whose branch the point lies on.
    z, tangent : array (N m n + 3,)
        The branch point and the direction of the branch known.

    Raises
    ------
    UsageError
        If branches do not cross there.
    """

    def rescaled(scales: Array) -> tuple[CollocationProblem, Array]:
        start = collocated_through(problem, z, problem.path, float(z[-1]), scales=scales)
        return start.problem, start.z

    found = crossing(problem, z, tangent, rescaled)
    assert isinstance(found.problem, CollocationProblem)
    return CollocationStart(found.problem, found.z, found.direction)


def collocated_through(
    problem: CollocationProblem,
    z: Array,
    path: ParameterPath,
    value: float,
    settings: CollocationSettings | None = None,
    scales: Array | None = None,
) -> CollocationStart:
    """Start at an orbit of another branch, on its mesh, with a parameter of one's own.

    Parameters
    ----------
    problem : CollocationProblem
        The problem that the orbit is a solution of.
    z : array (N m n + 3,)
        The orbit.
    path : ParameterPath
        Where the active parameter leads, which may be another.
    value : float
        Its value at the orbit.
    settings : CollocationSettings, optional
        How orbits are resolved; by default as on the other branch.
    scales : array, optional
        Scales of the unknown states; by default as on the other branch.
    """
    chosen, curve = settings or problem.settings, problem.curve(z)
    if chosen.degree != problem.settings.degree:
        mesh = curve.mesh
        curve = Piecewise(mesh, curve(equidistant(mesh, chosen.degree)))
    scales = problem.reference(z).scales if scales is None else scales
    reference = reference_of(curve, scales)
    own = CollocationProblem(problem.field, path, reference, curve, chosen)
    return CollocationStart(own, own.join(curve.nodes, problem.period(z), value), None)


def _mode(problem: CollocationProblem, z: Array, multiplier: float) -> Array:
    """Return the eigenfunction of a real multiplier at the nodes (N, m, n), as wide as a range."""
    equations, scales = problem.linearised(z), problem.reference(z).scales
    g = equations.gauss
    transitions = equations.transitions.copy()
    transitions[-1] /= multiplier
    count, size = transitions.shape[:2]
    border = np.random.default_rng(_SEED).standard_normal((2, 1, count, size))
    border /= np.sqrt(count * size)
    columns, corner = np.ascontiguousarray(np.moveaxis(border[0], 0, -1)), np.zeros((1, 1))
    ring = BorderedFolds(Folds(transitions, GROWTH), columns, border[1], corner)
    points, singularity = ring.solve(np.zeros((count, size, 1)), np.ones((1, 1)))
    starts = points[None, :, :, 0]
    if abs(singularity[0, 0]) > _SINGULAR * float(np.abs(starts).max()):
        raise UsageError(
            f"this orbit has no multiplier {multiplier:g}, it is no period doubling: "
            "start from a PD point"
        )
    stages = equations.stages.solve(equations.from_starts(starts))[0]
    inner = starts[0][:, None] * g.inner_start[:, None] + g.inner @ stages
    nodes = np.concatenate((starts[0][:, None], inner), axis=1)
    return np.asarray(nodes * scales * (_AMPLITUDE / float(np.abs(nodes).max())))
