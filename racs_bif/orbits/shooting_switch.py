"""Branches by shooting that begin on another branch: doubled, crossing, or another parameter's."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from racs_bif.orbits.mesh import Mesh
from racs_bif.orbits.reference import Reference
from racs_bif.orbits.shooting import ShootingProblem
from racs_bif.orbits.start import Start
from racs_bif.orbits.switching import leave, null_direction

if TYPE_CHECKING:
    from racs_bif.orbits.settings import OrbitSettings
    from racs_bif.symbolic.field import Array
    from racs_bif.symbolic.paths import ParameterPath


def shooting_through(
    problem: ShootingProblem,
    z: Array,
    path: ParameterPath,
    value: float,
    settings: OrbitSettings | None = None,
    scales: Array | None = None,
) -> Start:
    """Start at an orbit of another branch, on its mesh, with a parameter of one's own.

    Parameters
    ----------
    problem : ShootingProblem
        The problem that the orbit is a solution of.
    z : array (M n + 3,)
        The orbit.
    path : ParameterPath
        Where the active parameter leads, which may be another.
    value : float
        Its value at the orbit.
    settings : OrbitSettings, optional
        How orbits are resolved; by default as on the other branch.
    scales : array, optional
        Scales of the unknown states; by default as on the other branch.
    """
    flow = problem.flow(z)
    scales = problem.reference(z).scales if scales is None else scales
    reference = Reference(flow.mesh, flow.stages, flow.period * flow.slopes, scales)
    own = ShootingProblem(problem.field, path, reference, settings or problem.settings)
    return Start(own, own.join(problem.starts(z), problem.period(z), value), None)


def shooting_doubled(problem: ShootingProblem, z: Array, tangent: Array) -> Start:
    """Start the branch of orbits of twice the period that is born at a period doubling.

    The first point is the orbit run through twice; the branch leaves it in the direction in which
    the equations of two turns are singular, besides that of the branch known.

    Parameters
    ----------
    problem : ShootingProblem
        The problem whose branch the doubling lies on.
    z, tangent : array (M n + 3,)
        The period doubling and the direction of its branch.

    Raises
    ------
    UsageError
        If no multiplier is -1 there.
    """
    flow, starts = problem.flow(z), problem.starts(z)
    nodes = flow.mesh.nodes
    mesh = Mesh(np.concatenate((0.5 * nodes, 0.5 + 0.5 * nodes[1:])), 2 * flow.mesh.segments)

    def twice(scales: Array) -> tuple[ShootingProblem, Array]:
        reference = Reference(
            mesh,
            np.concatenate((flow.stages, flow.stages)),
            2.0 * flow.period * np.concatenate((flow.slopes, flow.slopes)),
            scales,
            degenerate=True,
        )
        path, settings = problem.path, problem.settings
        longer = ShootingProblem(problem.field, path, reference, settings, turns=2)
        start = longer.join(np.concatenate((starts, starts)), 2.0 * flow.period, float(z[-1]))
        return longer, start

    longer, start = twice(problem.reference(z).scales)
    along = problem.starts(tangent)
    known = longer.join(
        np.concatenate((along, along)), 2.0 * float(tangent[-3]), float(tangent[-1])
    )
    mode = longer.starts(null_direction(longer, start, known))
    half = len(starts)
    mode = 0.5 * (mode[:half] - mode[half:])
    across = longer.join(np.concatenate((mode, -mode)), 0.0, 0.0)
    found = leave(longer, start, across, twice)
    assert isinstance(found.problem, ShootingProblem)
    return Start(found.problem, found.z, found.direction)
