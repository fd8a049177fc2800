"""Adaptation of the mesh between steps along a branch."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.orbits.dense import ORDER, Profile
from racs_bif.orbits.mesh import Mesh, equidistributed, rounded
from racs_bif.orbits.radau import ABSCISSAE

if TYPE_CHECKING:
    from racs_bif.orbits.flow import Derivative, Flow
    from racs_bif.orbits.settings import OrbitSettings
    from racs_bif.symbolic.field import Array

_UNEVEN: Final = 2.0
"""Largest share of a step over the mean share at which the nodes stay where they are."""
_SPARE: Final = 1.25
"""How many more steps are taken than the tolerance asks for, and how much of them lies evenly."""
_TOO_MANY: Final = 2.0
"""Steps are given back when there are so many times more than needed, ..."""
_HEALTHY: Final = 0.01
"""... and the error of the trivial multiplier is this far below its bound."""


def better_mesh(
    flow: Flow,
    derivative: Derivative,
    scales: Array,
    settings: OrbitSettings,
    *,
    health: float,
) -> Mesh | None:
    """Return a better mesh for an orbit, or None where the present one will do.

    The steps are moved when their shares of the error have become uneven; their number follows the
    tolerance, and is doubled when the trivial multiplier is off (`Floquet.health`); the number of
    segments follows the growth of the variational solution over a segment.
    """
    mesh = flow.mesh
    errors = flow.profile.errors(scales)
    segments = _segments(mesh.segments, derivative, scales, settings)
    steps = rounded(_steps(mesh.steps, errors, settings, health), segments)
    share = errors ** (1.0 / ORDER)
    uneven = float(share.max()) > _UNEVEN * float(share.mean())
    same = steps == mesh.steps and segments == mesh.segments
    wanted = uneven and float(errors.max()) > 0.1 * settings.tolerance
    if same and not wanted:
        return None
    return equidistributed(mesh, errors, ORDER, steps, segments)


def _steps(steps: int, errors: Array, settings: OrbitSettings, health: float) -> int:
    needed = _SPARE * float(np.sum((errors / settings.tolerance) ** (1.0 / ORDER)))
    wanted = steps
    if needed > steps:
        wanted = int(np.ceil(_SPARE * needed))
    elif health > settings.trivial:
        wanted = 2 * steps
    elif _TOO_MANY * needed < steps and health < _HEALTHY * settings.trivial:
        wanted = int(np.ceil(_SPARE * needed))
    return min(max(wanted, settings.steps), settings.most_steps)


def _segments(segments: int, derivative: Derivative, scales: Array, settings: OrbitSettings) -> int:
    size = len(scales)
    balanced = derivative.ends[:, :, :size] * (scales / scales[:, None])
    growth = float(np.linalg.norm(balanced, axis=(1, 2)).max())
    if growth > settings.growth and 4 * segments <= settings.most_steps:
        return 2 * segments
    if growth < settings.growth**0.25 and segments >= 2 * settings.segments:
        return segments // 2
    return segments


def interpolated(flow: Flow, change: tuple[Array, Array], mesh: Mesh) -> tuple[Array, Array, Array]:
    """Interpolate an orbit and a change of it on another mesh, to the order of the dense output.

    Parameters
    ----------
    flow : Flow
        The orbit.
    change : tuple of array (N, n) and (N, 3, n)
        The change at the starts of the steps and at the stages.
    mesh : Mesh
        The other mesh.

    Returns
    -------
    stages : array (N', 3, n)
        The orbit at the Radau points.
    starts, directions : array (M', n)
        The orbit and the change where the segments start.
    """
    profile, changes = flow.profile, Profile(flow.mesh, *change)
    return profile(mesh.times(ABSCISSAE)), profile(mesh.starts), changes(mesh.starts)


def halved(mesh: Mesh) -> Mesh:
    """Return the mesh with every step halved."""
    nodes = mesh.nodes
    middles = 0.5 * (nodes[1:] + nodes[:-1])
    return Mesh(np.insert(nodes, np.arange(1, len(nodes)), middles), mesh.segments)
