"""Periodic orbits by multiple shooting; single shooting is one segment."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.continuation.stopped import Stopped
from racs_bif.errors import ConvergenceError, UsageError
from racs_bif.orbits.condense import BorderedRing, Ring
from racs_bif.orbits.floquet import Floquet, floquet
from racs_bif.orbits.flow import Derivative, Flow, Integrator
from racs_bif.orbits.mesh import Mesh
from racs_bif.orbits.orbit import Orbit, Refinement, compare
from racs_bif.orbits.problem import OrbitProblem
from racs_bif.orbits.reference import Reference
from racs_bif.orbits.remesh import better_mesh, moved
from racs_bif.orbits.settings import OrbitSettings

if TYPE_CHECKING:
    from racs_bif.continuation.points import Point
    from racs_bif.continuation.problem import Solver
    from racs_bif.symbolic.field import Array, VectorField
    from racs_bif.symbolic.paths import ParameterPath

_SAME: Final = 1e-9
"""Relative distance below which the derivative of the flow is taken over."""
_POLISHING: Final = 6
"""Newton iterations on a new mesh."""


@dataclass(eq=False)
class _Solution:
    """The flow at one z, and what is derived from it when it is asked for."""

    z: Array
    flow: Flow
    integrator: Integrator = field(repr=False)

    @cached_property
    def derivative(self) -> Derivative:
        return self.integrator.derivative(self.flow)


class ShootingProblem(OrbitProblem):
    """Periodic orbits x' = f(x, p) by shooting over the segments of a mesh.

    The unknowns are z = (X_1, ..., X_M, T, lambda): the starts of the M segments, the period and the
    active parameter. The equations are Phi_m(X_m, T, lambda) = X_(m+1) on the ring, divided by the
    scales of the states, and the integral phase condition against the orbit accepted last. The flow
    Phi is that of the Radau IIA method, differentiated exactly.

    A point that was accepted brings back the mesh and the phase condition that it was found with
    when it is given again, so that profiles can be drawn and branches gone back to at any time.

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
    """

    def __init__(
        self,
        field: VectorField,
        path: ParameterPath,
        reference: Reference,
        settings: OrbitSettings | None = None,
    ) -> None:
        self.name = "periodic orbits by shooting"
        self.parameter = path.names[0]
        self.field = field
        self.path = path
        self.settings = settings or OrbitSettings()
        self.reference = reference
        self.integrator = Integrator(field, path, 1e-6 * reference.scales)
        self._size = len(field.states)
        self._solution: _Solution | None = None
        self._base: _Solution | None = None
        self._floquet: tuple[Array, Floquet] | None = None
        self._known: dict[bytes, Reference] = {}
        self._first_period = 0.0

    # ------------------------------------------------------------------ the equations

    @property
    def mesh(self) -> Mesh:
        """The mesh in use."""
        return self.reference.mesh

    def split(self, z: Array) -> tuple[Array, float, float]:
        """Return starts of the segments (M, n), period and parameter."""
        return z[:-2].reshape(-1, self._size), float(z[-2]), float(z[-1])

    def flow(self, z: Array) -> Flow:
        """Return the flow over all segments at `z`.

        Raises
        ------
        ConvergenceError
            If the integration fails.
        UsageError
            If `z` belongs to another mesh and was never accepted here.
        """
        return self._at(z).flow

    def residual(self, z: Array) -> Array:
        """Return the gaps between the segments, (M n,), and the phase."""
        flow = self._at(z).flow
        gaps = (flow.ends - np.roll(flow.starts, -1, axis=0)) / self.reference.scales
        return np.append(gaps.ravel(), self.reference.phase(flow.stages))

    def jacobian(self, z: Array) -> Array:
        """Return the exact derivative (M n + 1, M n + 2) of the residual."""
        ends, phase = self._blocks(z)
        count, size = len(ends), self._size
        scaled = ends / self.reference.scales[:, None]
        jacobian = np.zeros((count * size + 1, count * size + 2))
        following = np.diag(1.0 / self.reference.scales)
        for m in range(count):
            rows, own, after = (slice(k * size, (k + 1) * size) for k in (m, m, (m + 1) % count))
            jacobian[rows, own] += scaled[m, :, :size]
            jacobian[rows, after] -= following
            jacobian[rows, -2:] = scaled[m, :, size:]
        jacobian[-1] = phase
        return jacobian

    def bordered(self, z: Array, row: Array) -> Solver:
        """Return a solver of [jacobian; row] that condenses the ring of segments orthogonally."""
        ends, phase = self._blocks(z)
        count, size, scales = len(ends), self._size, self.reference.scales
        scaled = ends / scales[:, None]
        transitions = scaled[:, :, :size] * scales
        rows = np.stack((phase, row))
        borders = rows[:, :-2].reshape(2, count, size) * scales
        ring = Ring(transitions, np.broadcast_to(-np.eye(size), transitions.shape))
        solver = BorderedRing(ring, scaled[:, :, size:], borders, rows[:, -2:])

        def solve(rhs: Array) -> Array:
            matrix = rhs.reshape(len(rhs), -1)
            width = matrix.shape[1]
            points, unknowns = solver.solve(matrix[:-2].reshape(count, size, width), matrix[-2:])
            points *= scales[:, None]
            return np.concatenate((points.reshape(-1, width), unknowns)).reshape(rhs.shape)

        return solve

    def _blocks(self, z: Array) -> tuple[Array, Array]:
        """Return the derivatives of the ends (M, n, n + 2) and of the phase (M n + 2,)."""
        derivative = self._near(z)[1]
        size, mesh = self._size, self.mesh
        # phase: weights times stages, which depend on the start of the step and so on the segment's
        per_step = np.einsum("kia,kiab->kb", self.reference.weights, derivative.steps)
        per_segment = (per_step[:, None, :size] @ derivative.heads)[:, 0]
        per_segment[:, size:] += per_step[:, size:]
        summed = per_segment.reshape(mesh.segments, mesh.per_segment, -1).sum(axis=1)
        tail = summed[:, size:].sum(axis=0)
        return derivative.ends, np.concatenate((summed[:, :size].ravel(), tail))

    def _at(self, z: Array) -> _Solution:
        """Solve the flow at `z`, from the last solution moved along its derivative."""
        if self._solution is not None and np.array_equal(self._solution.z, z):
            return self._solution
        self._recall(z)
        starts, period, active = self.split(z)
        base = self._base
        if base is None or base.flow.mesh is not self.mesh:
            stages, factors = self.reference.stages, None
        else:
            flow, derivative = base.flow, base.derivative
            moved = (starts - flow.starts, period - flow.period, active - flow.active)
            stages, factors = flow.stages + derivative.changes(*moved)[1], derivative.factors
        flow = self.integrator.flow(self.mesh, starts, period, active, stages, factors)
        self._solution = _Solution(np.array(z), flow, self.integrator)
        return self._solution

    def _near(self, z: Array) -> tuple[Flow, Derivative]:
        """Return flow and derivative at `z`, or where they are known within rounding of it."""
        base = self._base
        if base is not None and base.z.shape == z.shape and base.flow.mesh is self.mesh:
            scales = np.append(self.scales(z), max(1.0, abs(z[-1])))
            if float(np.abs((z - base.z) / scales).max()) < _SAME:
                return base.flow, base.derivative
        self._base = self._at(z)
        return self._base.flow, self._base.derivative

    def _recall(self, z: Array) -> None:
        """Return to the mesh that `z` was accepted on; refuse a z of another mesh."""
        known = self._known.get(z.tobytes())
        if known is not None and known.mesh is not self.mesh:
            self.use(known)
        if len(z) != self.mesh.segments * self._size + 2:
            raise UsageError(
                f"an orbit of {len(z)} unknowns does not fit {self.mesh.segments} segments of "
                f"{self._size} states: take a point of this problem's own branch"
            )

    def use(self, reference: Reference) -> None:
        """Compute on another mesh and with another phase condition from now on."""
        self.reference = reference
        self._solution = self._base = None
        self._floquet = None

    # ------------------------------------------------------------------ what the engine asks

    def period(self, z: Array) -> float:
        """Return the period, in units of time."""
        return float(z[-2])

    def degenerate(self, z: Array) -> bool:
        """Return whether the orbit has no amplitude, or lies across an equilibrium from the last."""
        flow = self._at(z).flow
        relative = flow.profile.ranges() / self.reference.scales
        if float(relative.max()) < self.settings.smallest:
            return True
        return self.reference.correlation(flow.stages) < 0.0

    def floquet(self, z: Array) -> Floquet:
        """Return the multipliers, from the transition matrices without their product."""
        if self._floquet is None or not np.array_equal(self._floquet[0], z):
            flow, derivative = self._near(z)
            velocity = flow.slopes[-1, -1]
            found = floquet(derivative.ends[:, :, : self._size], velocity, self.reference.scales)
            self._floquet = (np.array(z), found)
        return self._floquet[1]

    def measures(self, z: Array) -> dict[str, float]:
        """Return the period, the highest and lowest value of each state and the trivial error."""
        self._known[z.tobytes()] = self.reference
        highest, lowest = self.extrema(z)
        measures = {"period": self.period(z)}
        for j, state in enumerate(self.field.states):
            measures[f"max {state}"] = float(highest[j])
            measures[f"min {state}"] = float(lowest[j])
        measures["trivial error"] = self.floquet(z).trivial_error
        return measures

    def extrema(self, z: Array) -> tuple[Array, Array]:
        """Return the highest and the lowest values (n,) of the states."""
        return self._at(z).flow.profile.extrema()

    def scales(self, z: Array) -> Array:
        """Return the scales of the states, the same for all segments, and the period."""
        states = np.tile(self.reference.scales, self.mesh.segments)
        return np.append(states, abs(self.period(z)))

    def ends(self, point: Point) -> Stopped | None:
        """Return why the branch ends here: long period, no amplitude left, accuracy lost."""
        z = point.z
        self._first_period = self._first_period or self.period(z)
        if self.period(z) > self.settings.longest * self._first_period:
            return Stopped.PERIOD
        if not self.reference.degenerate and self.degenerate(z):
            return Stopped.VANISHED
        error = self.floquet(z).trivial_error
        if error > self.settings.trivial and not self.degenerate(z):
            return Stopped.ACCURACY if self.mesh.steps >= self.settings.most_steps else None
        return None

    def adapt(self, z: Array, tangent: Array) -> tuple[Array, Array] | None:
        """Take this orbit as the reference of the next, on a better mesh where the error asks."""
        if self.degenerate(z):
            return None
        flow, derivative = self._near(z)
        scales = np.maximum(self.reference.scales, flow.profile.ranges())
        error = self.floquet(z).trivial_error
        mesh = better_mesh(flow, derivative, scales, self.settings, trivial_error=error)
        if mesh is not None:
            try:
                return self._move(z, tangent, mesh)
            except (ConvergenceError, np.linalg.LinAlgError):
                pass  # the old mesh serves: the branch ends by itself when it does so no longer
        self._follow(self._at(z).flow, scales)
        self._known[z.tobytes()] = self.reference
        return z, self.tangent(z, tangent)

    def _follow(self, flow: Flow, scales: Array) -> None:
        """Compare phases with this orbit from now on."""
        velocities = flow.period * flow.slopes
        self.reference = Reference(flow.mesh, flow.stages, velocities, scales)
        self.integrator.floor = 1e-6 * scales

    def _move(self, z: Array, tangent: Array, mesh: Mesh) -> tuple[Array, Array]:
        """Solve for the same orbit on another mesh, where the branch crosses the same hyperplane."""
        before = self.reference
        there = moved(*self._near(z), tangent, mesh)
        rates = self.integrator.rates(there.stages.reshape(-1, self._size), float(z[-1]))
        velocities = self.period(z) * rates.reshape(there.stages.shape)
        self.use(Reference(mesh, there.stages, velocities, before.scales))
        try:
            solved = self._polish(there.z, there.tangent)
            flow = self._at(solved).flow
            self._follow(flow, np.maximum(before.scales, flow.profile.ranges()))
            self._known[solved.tobytes()] = self.reference
            return solved, self.tangent(solved, there.tangent)
        except (ConvergenceError, np.linalg.LinAlgError):
            self.use(before)
            raise

    def _polish(self, z: Array, tangent: Array) -> Array:
        """Return the solution in the hyperplane through `z` with the normal `tangent`."""
        scales = np.append(self.scales(z), max(1.0, abs(z[-1])))
        row = tangent / scales**2
        for _ in range(_POLISHING):
            step = self.bordered(z, row)(np.append(self.residual(z), 0.0))
            z = z - step
            size = float(np.abs(step / scales).max())
            if size < _SAME:
                return z
            if not size < 1.0:
                break
        raise ConvergenceError("the orbit was not found again on its new mesh")

    def tangent(self, z: Array, near: Array) -> Array:
        """Return the branch's direction at `z`, as long as `near` is in the problem's scales."""
        scales = np.append(self.scales(z), max(1.0, abs(z[-1])))
        rhs = np.zeros(len(z))
        rhs[-1] = 1.0
        direction = self.bordered(z, near / scales**2)(rhs)
        if not np.all(np.isfinite(direction)):
            raise ConvergenceError("the direction of the branch of orbits is not defined here")
        length = np.linalg.norm(near / scales) / np.linalg.norm(direction / scales)
        return np.asarray(direction * length)

    def refined(self, z: Array) -> Refinement:
        """Solve for the orbit on a mesh of twice as many steps, at the same parameter.

        Returns
        -------
        Refinement
            The finer orbit, and how far the coarser one is from it.

        Raises
        ------
        ConvergenceError
            If the orbit is not found on the finer mesh.
        """
        coarse, flow = self.orbit(z), self._at(z).flow
        nodes = self.mesh.nodes
        finer = np.insert(nodes, np.arange(1, len(nodes)), 0.5 * (nodes[1:] + nodes[:-1]))
        hold = np.zeros(len(z))
        hold[-1] = 1.0
        other = ShootingProblem(self.field, self.path, self.reference, self.settings)
        there = moved(flow, self._near(z)[1], hold, Mesh(finer, self.mesh.segments))
        rates = self.integrator.rates(there.stages.reshape(-1, self._size), float(z[-1]))
        velocities = self.period(z) * rates.reshape(there.stages.shape)
        other.use(Reference(there.mesh, there.stages, velocities, self.reference.scales))
        return compare(coarse, other.orbit(other._polish(there.z, hold)))  # noqa: SLF001 - own class

    # ------------------------------------------------------------------ results

    def orbit(self, z: Array, samples: int = 201) -> Orbit:
        """Return the orbit as a result, sampled at equal times over one period."""
        flow = self._at(z).flow
        found = self.floquet(z)
        highest, lowest = self.extrema(z)
        grid = np.linspace(0.0, 1.0, samples)
        return Orbit(
            states=self.field.states,
            parameter=self.parameter,
            value=float(z[-1]),
            period=self.period(z),
            times=grid * self.period(z),
            profile=np.ascontiguousarray(flow.profile(grid).T),
            maxima=highest,
            minima=lowest,
            multipliers=found.multipliers,
            stable=self.stable(found.multipliers),
            trivial_error=found.trivial_error,
        )
