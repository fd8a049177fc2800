"""The discrete flow over the segments of a mesh, and its exact derivative.

All steps are solved at once when a good guess of the stages is at hand (the last solution, moved
along its own derivative): the stage equations of a segment are a block bidiagonal system, so that
one chord iteration is one vectorised evaluation of f, one batched product and a sweep of small
products. Without a guess, or when that fails, the segments are marched side by side, step after
step.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.errors import ConvergenceError
from racs_bif.orbits.checked import CheckedField
from racs_bif.orbits.chord import Chord
from racs_bif.orbits.dense import Profile
from racs_bif.orbits.radau import ABSCISSAE, STAGES, StageFactors, defects, slopes_of

if TYPE_CHECKING:
    from racs_bif.orbits.mesh import Mesh
    from racs_bif.symbolic.field import Array, VectorField
    from racs_bif.symbolic.paths import ParameterPath

_ITERATIONS: Final = 25


@dataclass(frozen=True, eq=False)
class Flow:
    """Trajectories over all segments of a mesh.

    Attributes
    ----------
    mesh : Mesh
        The steps.
    period, active : float
        Length of the mesh in time; the active parameter.
    origins : array (N, n)
        Starts of the steps.
    stages, slopes : array (N, 3, n)
        Stages of the steps, and f there.
    """

    mesh: Mesh
    period: float
    active: float
    origins: Array
    stages: Array
    slopes: Array

    @property
    def starts(self) -> Array:
        """Starts of the segments (M, n)."""
        return self.origins[:: self.mesh.per_segment]

    @property
    def ends(self) -> Array:
        """Ends of the segments (M, n)."""
        return self.stages[self.mesh.per_segment - 1 :: self.mesh.per_segment, -1]

    @property
    def profile(self) -> Profile:
        """The dense output."""
        return Profile(self.mesh, self.origins, self.stages)


@dataclass(frozen=True, eq=False)
class Derivative:
    """Derivative of a flow by the starts of the segments, the period and the parameter.

    Attributes
    ----------
    factors : StageFactors
        Factors of the stage equations.
    steps : array (N, 3, n, n + 2)
        Stages of a step with respect to its own start, the period and the parameter.
    heads : array (N, n, n + 2)
        Start of a step with respect to the start of its segment, the period and the parameter.
    ends : array (M, n, n + 2)
        End of a segment with respect to the same; the first n columns are its transition matrix.
    """

    factors: StageFactors
    steps: Array
    heads: Array
    ends: Array

    @property
    def maps(self) -> Array:
        """Stages of a step with respect to its own start (N, 3, n, n)."""
        return self.steps[..., : self.steps.shape[2]]

    def changes(self, starts: Array, period: float, active: float) -> tuple[Array, Array]:
        """Return what small changes of starts (M, n), period and parameter do.

        Returns
        -------
        origins : array (N, n)
            Changes of the starts of the steps.
        stages : array (N, 3, n)
            Changes of the stages.
        """
        per_segment = len(self.heads) // len(starts)
        both = np.broadcast_to((period, active), (len(starts), 2))
        segment = np.repeat(np.concatenate((starts, both), axis=1), per_segment, axis=0)
        origins: Array = (self.heads @ segment[:, :, None])[:, :, 0]
        size = starts.shape[1]
        own = np.concatenate((origins, segment[:, size:]), axis=1)
        stages: Array = (self.steps @ own[:, None, :, None])[..., 0]
        return origins, stages


class Integrator:
    """Solves the stage equations of a vector field, and differentiates the solution exactly.

    Parameters
    ----------
    field : VectorField
        The right-hand side.
    path : ParameterPath
        Where the active parameter leads.
    floor : array (n,) or float
        Magnitudes of the states below which changes do not matter to the stage equations.
    """

    def __init__(
        self, field: VectorField, path: ParameterPath, floor: Array | float = 1e-12
    ) -> None:
        self.checked = CheckedField(field)
        self.path = path
        self.floor = floor

    def flow(  # the arguments are those of the flow, and two guesses
        self,
        mesh: Mesh,
        starts: Array,
        period: float,
        active: float,
        stages: Array | None = None,
        near: Derivative | None = None,
    ) -> Flow:
        """Integrate all segments.

        Parameters
        ----------
        mesh : Mesh
            The steps.
        starts : array (M, n)
            Where the segments start.
        period, active : float
            Length of the mesh in time; the active parameter.
        stages : array (N, 3, n), optional
            Guess of the stages.
        near : Derivative, optional
            The derivative of a solution near by, on the same mesh.

        Raises
        ------
        ConvergenceError
            If a step fails, or the right-hand side is not finite; the message names the time.
        ModelError
            If the right-hand side raises or returns a wrong shape.
        """
        if not (np.all(np.isfinite(starts)) and np.isfinite(period) and np.isfinite(active)):
            raise ConvergenceError("the orbit is not finite where the integrator was to start")
        if period <= 0.0:
            raise ConvergenceError(f"the period became {period:.6g}, which is not positive")
        p = self.path.vector(active)
        if stages is not None:
            try:
                solved, slopes = self._solve(mesh, starts, period, p, stages, near)
                return self._flow(mesh, starts, period, active, (solved, slopes))
            except ConvergenceError:
                pass  # the guess was poor: marching finds its own
        return self._flow(mesh, starts, period, active, self._march(mesh, starts, period, p))

    def derivative(self, flow: Flow) -> Derivative:
        """Return the exact derivative of the discrete flow."""
        mesh, size = flow.mesh, flow.origins.shape[1]
        tau = flow.period * mesh.widths
        p, dp = self.path.vector(flow.active), self.path.direction(flow.active)
        times = flow.period * mesh.nodes[:-1]
        factors = self._factors(flow.stages, p, tau, times)
        by_period = mesh.widths[:, None, None] * flow.slopes
        by_parameter = self.checked.by_parameter(flow.stages, p, dp, times)
        by_active = tau[:, None, None] * by_parameter
        steps = factors.sensitivities(by_period, by_active)
        own = steps[:, -1].reshape(mesh.segments, mesh.per_segment, size, size + 2)
        heads = np.zeros_like(own)
        head = np.zeros((mesh.segments, size, size + 2))
        head[:, :, :size] = np.eye(size)
        for k in range(mesh.per_segment):
            heads[:, k] = head
            head = own[:, k, :, :size] @ head
            head[:, :, size:] += own[:, k, :, size:]
        return Derivative(factors, steps, heads.reshape(mesh.steps, size, size + 2), head)

    def rates(self, points: Array, active: float) -> Array:
        """Return f at the points (k, n)."""
        times = np.zeros(len(points))
        return self.checked.rates(points[:, None, :], self.path.vector(active), times)[:, 0]

    @staticmethod
    def _flow(
        mesh: Mesh, starts: Array, period: float, active: float, solved: tuple[Array, Array]
    ) -> Flow:
        stages, slopes = solved
        return Flow(mesh, period, active, _origins(mesh, starts, stages), stages, slopes)

    def _march(self, mesh: Mesh, starts: Array, period: float, p: Array) -> tuple[Array, Array]:
        """Integrate the segments side by side, every step from the last one's polynomial."""
        per_segment, size = mesh.per_segment, starts.shape[1]
        stages = np.empty((mesh.segments, per_segment, STAGES, size))
        slopes = np.empty_like(stages)
        widths = mesh.widths.reshape(mesh.segments, per_segment)
        nodes = mesh.nodes[:-1].reshape(mesh.segments, per_segment)
        x = starts
        guess = np.repeat(x[:, None, :], STAGES, axis=1)
        for k in range(per_segment):
            column = _Column(nodes[:, k], widths[:, k])
            stages[:, k], slopes[:, k] = self._iterate(column, x, period, p, guess, None)
            x = stages[:, k, -1]
            rise = slopes[:, k, -1, None, :] * (period * widths[:, k, None, None])
            guess = x[:, None, :] + ABSCISSAE[:, None] * rise
        shape = (mesh.steps, STAGES, size)
        return stages.reshape(shape), slopes.reshape(shape)

    def _solve(
        self,
        mesh: Mesh,
        starts: Array,
        period: float,
        p: Array,
        guess: Array,
        near: Derivative | None,
    ) -> tuple[Array, Array]:
        column = _Column(mesh.nodes[:-1], mesh.widths)
        return self._iterate(column, starts, period, p, guess, near)

    def _iterate(
        self,
        column: _Column,
        starts: Array,
        period: float,
        p: Array,
        guess: Array,
        near: Derivative | None,
    ) -> tuple[Array, Array]:
        """Solve the stage equations of segments from `starts`; return stages and slopes."""
        tau = period * column.widths
        chord = Chord() if near is None else Chord(near.factors, near.maps)
        stages = guess
        times = period * column.nodes
        for _ in range(_ITERATIONS):
            slopes = self.checked.rates(stages, p, times)
            if chord.stale:
                chord.renew(self._factors(stages, p, tau, times))
            origins = _origins(column, starts, stages)
            step = chord.step(defects(origins, stages, slopes, tau), len(starts))
            stages = stages + step
            change = np.abs(step) / (np.abs(stages).max(axis=(0, 1)) + self.floor)
            if chord.judge(float(change.max())):
                return stages, slopes_of(_origins(column, starts, stages), stages, tau)
            if chord.failed:
                break
        worst = int(np.argmax(change.max(axis=(1, 2))))
        raise ConvergenceError(
            f"the integrator failed at t = {times[worst]:.6g} of a period of {period:.6g}: "
            "the step is too long there, take more steps"
        )

    def _factors(self, stages: Array, p: Array, tau: Array, times: Array) -> StageFactors:
        try:
            return StageFactors(self.checked.jacobians(stages, p, times), tau)
        except np.linalg.LinAlgError as error:
            raise ConvergenceError(
                "the stage equations of the integrator are singular: take more steps"
            ) from error


@dataclass(frozen=True, eq=False)
class _Column:
    """Starts and widths of the steps that are solved at once."""

    nodes: Array
    widths: Array

    @property
    def steps(self) -> int:
        return len(self.widths)


def _origins(mesh: Mesh | _Column, starts: Array, stages: Array) -> Array:
    """Return the starts of the steps (N, n): of the segment, or where the step before ended."""
    origins = np.empty((mesh.steps, starts.shape[1]))
    origins[1:] = stages[:-1, -1]
    origins[:: mesh.steps // len(starts)] = starts
    return origins
