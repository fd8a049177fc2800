"""Periodic orbits by multiple shooting; single shooting is one segment."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.continuation.stopped import Stopped
from racs_bif.errors import ConvergenceError, UsageError
from racs_bif.orbits.assembly import TAIL, dense_jacobian, ring_solver
from racs_bif.orbits.dense import Profile
from racs_bif.orbits.floquet import Floquet, floquet
from racs_bif.orbits.flow import Derivative, Flow, Integrator
from racs_bif.orbits.generations import Generations
from racs_bif.orbits.polishing import direction, polished
from racs_bif.orbits.problem import FEWEST_TOLD, OrbitProblem
from racs_bif.orbits.radau import ABSCISSAE
from racs_bif.orbits.reference import Reference
from racs_bif.orbits.remesh import better_mesh, interpolated
from racs_bif.orbits.settings import OrbitSettings

if TYPE_CHECKING:
    from racs_bif.continuation.points import Point
    from racs_bif.continuation.problem import Solver
    from racs_bif.orbits.mesh import Mesh
    from racs_bif.symbolic.field import Array, VectorField
    from racs_bif.symbolic.paths import ParameterPath

_SAME: Final = 1e-9
"""Relative distance below which the derivative of the flow is taken over."""
_HALF: Final = 200
"""Samples by which the halves of a doubled orbit are compared."""
_DENSE: Final = 128
"""Unknowns up to which a dense LU factorisation is faster than condensation (measured)."""


def _departures(profile: Profile) -> Array:
    """Return the first half of an orbit less the second (k, n)."""
    times = np.linspace(0.0, 0.5, _HALF, endpoint=False)
    return np.asarray(profile(times) - profile(times + 0.5))


@dataclass(eq=False)
class _Solution:
    """The flow at one z, and its derivative when it is asked for."""

    z: Array
    flow: Flow
    integrator: Integrator

    @cached_property
    def derivative(self) -> Derivative:
        return self.integrator.derivative(self.flow)


class ShootingProblem(OrbitProblem):
    """Periodic orbits x' = f(x, p) by shooting over the segments of a mesh.

    The unknowns are z = (X_1, ..., X_M, T, g, lambda): the starts of the M segments, the period,
    the number of the mesh and phase condition in use, and the active parameter. The equations are
    Phi_m(X_m, T, lambda) = X_(m+1) on the ring, divided by the scales of the states, the integral
    phase condition against the orbit accepted before, and g = its number. The flow Phi is that of
    the Radau IIA method, differentiated exactly.

    The number g never changes while an orbit is solved for; `adapt` gives every accepted orbit a
    new one. A solution thus knows the equations that it solves, whatever the mesh has become since:
    events between earlier points can be located and profiles drawn at any time.

    Parameters
    ----------
    field : VectorField
        The right-hand side.
    path : ParameterPath
        Where the active parameter leads; the first of its names is the continuation parameter.
    reference : Reference
        The first mesh and phase condition; its stages are the guess of the first orbit.
    settings : OrbitSettings, optional
        How orbits are resolved, and when the branch ends.
    turns : int
        2 where the branch begins at a period doubling; see `OrbitProblem`.
    """

    def __init__(
        self,
        field: VectorField,
        path: ParameterPath,
        reference: Reference,
        settings: OrbitSettings | None = None,
        *,
        turns: int = 1,
    ) -> None:
        self.name = "periodic orbits by shooting"
        self.turns = turns
        self.parameter = path.names[0]
        self.field = field
        self.path = path
        self.settings = settings or OrbitSettings()
        self.trivial = self.settings.trivial
        self.integrator = Integrator(field, path)
        self.generations = Generations(self.integrator, reference)
        self._size = len(field.states)
        self._solution: _Solution | None = None
        self._base: _Solution | None = None
        self._floquet: tuple[Array, Floquet] | None = None
        self._first_period: float | None = None

    # ------------------------------------------------------------------ the unknowns

    def join(self, starts: Array, period: float, active: float, number: int = 0) -> Array:
        """Return z from starts (M, n), period, parameter and number of the reference."""
        return np.concatenate((starts.ravel(), (period, float(number), active)))

    def starts(self, z: Array) -> Array:
        """Return the starts of the segments (M, n)."""
        return z[:-TAIL].reshape(-1, self._size)

    def unknown_states(self, z: Array) -> Array:
        """Return the starts of the segments (M, n)."""
        return self.starts(z)

    def period(self, z: Array) -> float:
        """Return the period, in units of time."""
        return float(z[-3])

    def reference(self, z: Array) -> Reference:
        """Return the mesh and phase condition that `z` belongs to.

        Raises
        ------
        UsageError
            If it belongs to none of this problem's.
        """
        reference = self.generations[z[-2]]
        if len(z) != reference.mesh.segments * self._size + TAIL:
            raise UsageError(
                f"{len(z)} unknowns do not fit {reference.mesh.segments} segments of {self._size} "
                "states: take a point of this problem's own branch"
            )
        return reference

    # ------------------------------------------------------------------ the equations

    def flow(self, z: Array) -> Flow:
        """Return the flow over all segments at `z`.

        Raises
        ------
        ConvergenceError
            If the integration fails.
        """
        return self._at(z).flow

    def residual(self, z: Array) -> Array:
        """Return the gaps between the segments (M n), the phase, and the number's distance."""
        flow, reference = self._at(z).flow, self.reference(z)
        gaps = (flow.ends - np.roll(flow.starts, -1, axis=0)) / reference.scales
        number = z[-2] - np.round(z[-2])
        return np.concatenate((gaps.ravel(), (reference.phase(flow.stages), number)))

    def jacobian(self, z: Array) -> Array:
        """Return the exact derivative (M n + 2, M n + 3) of the residual."""
        return dense_jacobian(*self._blocks(z), self.reference(z).scales)

    def bordered(self, z: Array, row: Array) -> Solver:
        """Return a solver of [jacobian; row].

        Small matrices are factorised densely; large ones have their ring of segments condensed by
        orthogonal transformations.
        """
        if len(z) <= _DENSE:
            return super().bordered(z, row)
        return ring_solver(*self._blocks(z), self.reference(z).scales, row)

    def _blocks(self, z: Array) -> tuple[Array, Array]:
        """Return the derivatives of the ends (M, n, n + 2) and of the phase (M n + 2,)."""
        flow, derivative = self._near(z)
        size, mesh = self._size, flow.mesh
        # phase: weights times stages, which depend on the start of the step and so on the segment's
        per_step = np.einsum("kia,kiab->kb", self.reference(z).weights, derivative.steps)
        per_segment = (per_step[:, None, :size] @ derivative.heads)[:, 0]
        per_segment[:, size:] += per_step[:, size:]
        summed = per_segment.reshape(mesh.segments, mesh.per_segment, -1).sum(axis=1)
        tail = summed[:, size:].sum(axis=0)
        return derivative.ends, np.concatenate((summed[:, :size].ravel(), tail))

    def _at(self, z: Array) -> _Solution:
        """Solve the flow at `z`, from the last solution moved along its derivative."""
        reference = self.reference(z)
        if self._solution is not None and self._solution.flow.mesh is reference.mesh:
            known = self._solution.z
            if np.array_equal(known[:-2], z[:-2]) and known[-1] == z[-1]:
                return self._solution
        starts, period, active = self.starts(z), self.period(z), float(z[-1])
        base = self._base
        if base is None or base.flow.mesh is not reference.mesh:
            stages, near = reference.stages, None
        else:
            flow, derivative = base.flow, base.derivative
            change = (starts - flow.starts, period - flow.period, active - flow.active)
            stages, near = flow.stages + derivative.changes(*change)[1], derivative
        self.integrator.floor = 1e-3 * reference.scales
        flow = self.integrator.flow(reference.mesh, starts, period, active, stages, near)
        self._solution = _Solution(np.array(z), flow, self.integrator)
        return self._solution

    def _near(self, z: Array) -> tuple[Flow, Derivative]:
        """Return flow and derivative at `z`, or where they are known within rounding of it."""
        base = self._base
        if base is not None and base.flow.mesh is self.reference(z).mesh:
            distance = np.abs(z - base.z) / self.magnitudes(z)
            distance[-2] = 0.0
            if float(distance.max()) < _SAME:
                return base.flow, base.derivative
        self._base = self._at(z)
        return self._base.flow, self._base.derivative

    # ------------------------------------------------------------------ what the engine asks

    def degenerate(self, z: Array) -> bool:
        """Return whether there is no amplitude, or it has changed sign at an equilibrium."""
        if self.at_crossing(z):
            return True
        flow, reference = self._at(z).flow, self.reference(z)
        if self.turns == 2:
            return self._halves_agree(flow, reference)
        relative = flow.profile.ranges() / reference.scales
        if float(relative.max()) < self.settings.smallest:
            return True
        return reference.correlation(flow.stages) < 0.0

    def _halves_agree(self, flow: Flow, reference: Reference) -> bool:
        """Return whether the halves of a doubled orbit are the same, or have changed places."""
        here = _departures(flow.profile) / reference.scales
        if float(np.abs(here).max()) < self.settings.smallest:
            return True
        if reference.degenerate:
            return False
        origins = np.roll(reference.stages[:, -1], 1, axis=0)
        before = _departures(Profile(reference.mesh, origins, reference.stages))
        return float(np.sum(here * before / reference.scales)) < 0.0

    def floquet(self, z: Array) -> Floquet:
        """Return the multipliers, from the transition matrices without their product."""
        if self._floquet is None or not np.array_equal(self._floquet[0], z):
            flow, derivative = self._near(z)
            at_ends = flow.slopes[flow.mesh.per_segment - 1 :: flow.mesh.per_segment, -1]
            velocities = np.roll(at_ends, 1, axis=0)
            scales = self.reference(z).scales
            found = floquet(derivative.ends[:, :, : self._size], velocities, scales)
            self._floquet = (np.array(z), found)
        return self._floquet[1]

    def scales(self, z: Array) -> Array:
        """Return the scales of the states, the same for all segments, the period, and 1."""
        reference = self.reference(z)
        states = np.tile(reference.scales, reference.mesh.segments)
        return np.concatenate((states, (abs(self.period(z)), 1.0)))

    def ends(self, point: Point) -> Stopped | None:
        """Return why the branch ends here: long period, no amplitude left, accuracy lost."""
        z = point.z
        if self._first_period is None:
            self._first_period = self.period(z)
        if self.period(z) > self.settings.longest * self._first_period:
            return Stopped.PERIOD
        reference = self.reference(z)
        if self.degenerate(z):
            return None if reference.degenerate else self.vanished
        full = reference.mesh.steps >= self.settings.most_steps
        if full and self.floquet(z).health > self.settings.trivial:
            return Stopped.ACCURACY
        return None

    def adapt(self, z: Array, tangent: Array) -> tuple[Array, Array] | None:
        """Take this orbit as the reference of the next, on a better mesh where the error asks."""
        if self.degenerate(z):
            return None
        flow, derivative = self._near(z)
        scales = np.maximum(self.reference(z).scales, flow.profile.ranges())
        health = self.floquet(z).health
        mesh = better_mesh(flow, derivative, scales, self.settings, health=health)
        if mesh is not None:
            # if that fails the old mesh serves, until it no longer does and the branch ends
            with suppress(ConvergenceError, np.linalg.LinAlgError):
                z, tangent = self.on_mesh(z, mesh, tangent)
        z = self._follow(z)
        return z, self.tangent(z, tangent)

    # ------------------------------------------------------------------ from mesh to mesh

    def _follow(self, z: Array) -> Array:
        """Return `z` with this orbit itself as the reference of its phase."""
        flow = self._at(z).flow
        scales = np.maximum(self.reference(z).scales, flow.profile.ranges())
        reference = Reference(flow.mesh, flow.stages, flow.period * flow.slopes, scales)
        followed = np.array(z)
        followed[-2] = self.generations.add(reference, flow.starts, flow.period, flow.active)
        self._solution = _Solution(followed, flow, self.integrator)
        return followed

    def on_mesh(self, z: Array, mesh: Mesh, tangent: Array | None = None) -> tuple[Array, Array]:
        """Solve for the same orbit on another mesh.

        Parameters
        ----------
        z : array (M n + 3,)
            A solution.
        mesh : Mesh
            The other mesh.
        tangent : array (M n + 3,), optional
            The direction in which not to move; without it the parameter is held.

        Returns
        -------
        tuple of array (M' n + 3,)
            The solution and the direction on the other mesh.

        Raises
        ------
        ConvergenceError, numpy.linalg.LinAlgError
            If the orbit is not found there.
        """
        flow, derivative = self._near(z)
        held = np.zeros(len(z)) if tangent is None else tangent
        change = derivative.changes(self.starts(held), float(held[-3]), float(held[-1]))
        stages, starts, directions = interpolated(flow, change, mesh)
        rates = self.integrator.rates(stages.reshape(-1, self._size), float(z[-1]))
        velocities = self.period(z) * rates.reshape(stages.shape)
        reference = Reference(mesh, stages, velocities, self.reference(z).scales)
        number = self.generations.add(reference, starts, self.period(z), float(z[-1]))
        there = self.join(starts, self.period(z), float(z[-1]), number)
        moved = self.join(directions, float(held[-3]), float(held[-1]))
        if tangent is None:
            moved[-1] = 1.0
        return polished(self, there, moved), moved

    def tangent(self, z: Array, near: Array) -> Array:
        """Return the direction of the branch at `z`, as long as `near` in the problem's scales."""
        return direction(self, z, near)

    # ------------------------------------------------------------------ results

    def extrema(self, z: Array) -> tuple[Array, Array]:
        """Return the highest and the lowest values (n,) of the states."""
        return self.flow(z).profile.extrema()

    def telling(self, z: Array) -> Array:
        """Return times in the mesh's own steps, one for each stage."""
        return self.reference(z).mesh.dense(len(ABSCISSAE), FEWEST_TOLD)

    def sample(self, z: Array, fractions: Array) -> Array:
        """Return the states (n, m) at fractions (m,) of the period."""
        return np.ascontiguousarray(self.flow(z).profile(fractions).T)
