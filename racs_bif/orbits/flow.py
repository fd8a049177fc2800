"""The discrete flow over the segments of a mesh, and its exact derivative.

All steps are solved at once when a good guess of the stages is at hand (the last solution, moved along
its own derivative): the stage equations of a segment are a block bidiagonal system, so that one chord
iteration is one vectorised evaluation of f, one batched product and a sweep of small products. Without a
guess, or when that fails, the segments are marched side by side, step after step.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from racs_bif.errors import ConvergenceError, ModelError, RacsBifError
from racs_bif.orbits.dense import Profile
from racs_bif.orbits.mesh import Mesh
from racs_bif.orbits.radau import ABSCISSAE, STAGES, StageFactors, defects, slopes_of
from racs_bif.symbolic.field import Array, VectorField
from racs_bif.symbolic.paths import ParameterPath

_TOLERANCE: Final = 1e-13
_STAGNATION: Final = 1e-9
"""Changes of the stages below this that no longer shrink are rounding errors."""
_ITERATIONS: Final = 25
_SLOW: Final = 0.2
"""Contraction per chord iteration above which the factors are renewed."""
_LOST: Final = 1e3
"""Change of the stages, relative to their size, at which an iteration is given up."""


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
    """Derivative of a flow with respect to the starts of the segments, the period and the parameter.

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
        self.field = field
        self.path = path
        self.floor = floor
        self.count = 0
        """Vectorised evaluations of the right-hand side so far."""

    def flow(  # the arguments are those of the flow, and two guesses
        self,
        mesh: Mesh,
        starts: Array,
        period: float,
        active: float,
        stages: Array | None = None,
        factors: StageFactors | None = None,
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
        factors : StageFactors, optional
            Factors of the stage equations from a solution near by.

        Raises
        ------
        ConvergenceError
            If a step fails, or the right-hand side is not finite; the message names the time.
        ModelError
            If the right-hand side raises or returns a wrong shape.
        """
        if not (np.all(np.isfinite(starts)) and np.isfinite(period) and np.isfinite(active)):
            raise ConvergenceError("the integrator was asked to start from a value that is not finite")
        if period <= 0.0:
            raise ConvergenceError(f"the period became {period:.6g}, which is not positive")
        p = self.path.vector(active)
        if stages is not None:
            try:
                solved, slopes = self._solve(mesh, starts, period, p, stages, factors)
                return self._flow(mesh, starts, period, active, (solved, slopes))
            except ConvergenceError:
                pass  # the guess was poor: marching finds its own
        return self._flow(mesh, starts, period, active, self._march(mesh, starts, period, p))

    def derivative(self, flow: Flow) -> Derivative:
        """Return the exact derivative of the discrete flow."""
        mesh, size = flow.mesh, flow.origins.shape[1]
        tau = flow.period * mesh.widths
        p = self.path.vector(flow.active)
        factors = self._factors(flow.stages, p, tau)
        by_period = mesh.widths[:, None, None] * flow.slopes
        by_active = tau[:, None, None] * self._by_parameter(flow)
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
        return self._rates(points[:, None, :], self.path.vector(active), np.zeros(len(points)))[:, 0]

    @staticmethod
    def _flow(
        mesh: Mesh, starts: Array, period: float, active: float, solved: tuple[Array, Array]
    ) -> Flow:
        stages, slopes = solved
        return Flow(mesh, period, active, _origins(mesh, starts, stages), stages, slopes)

    def _march(
        self, mesh: Mesh, starts: Array, period: float, p: Array
    ) -> tuple[Array, Array]:
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
        factors: StageFactors | None,
    ) -> tuple[Array, Array]:
        column = _Column(mesh.nodes[:-1], mesh.widths)
        return self._iterate(column, starts, period, p, guess, factors)

    def _iterate(
        self,
        column: _Column,
        starts: Array,
        period: float,
        p: Array,
        guess: Array,
        factors: StageFactors | None,
    ) -> tuple[Array, Array]:
        """Solve the stage equations of segments that start at `starts`; return stages and slopes."""
        tau = period * column.widths
        chord = _Chord(factors)
        stages = guess
        times = period * column.nodes
        for _ in range(_ITERATIONS):
            slopes = self._rates(stages, p, times)
            if chord.stale:
                chord.renew(self._factors(stages, p, tau))
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

    def _rates(self, stages: Array, p: Array, times: Array) -> Array:
        """Return f at the stages (N, s, n), checked."""
        self.count += 1
        points = np.ascontiguousarray(stages.reshape(-1, stages.shape[-1]).T)
        values = self._call("right-hand side", points.shape, self.field.f, points, p)
        self._finite(values.T, stages.shape[1], times)
        return np.ascontiguousarray(values.T).reshape(stages.shape)

    def _factors(self, stages: Array, p: Array, tau: Array) -> StageFactors:
        size = stages.shape[-1]
        points = np.ascontiguousarray(stages.reshape(-1, size).T)
        shape = (points.shape[1], size, size)
        jacobians = self._call("Jacobian", shape, self.field.f_x, points, p)
        self._finite(jacobians.reshape(len(jacobians), -1), STAGES, np.cumsum(tau) - tau)
        try:
            return StageFactors(jacobians.reshape(*stages.shape, size), tau)
        except np.linalg.LinAlgError as error:
            raise ConvergenceError(
                "the stage equations of the integrator are singular: take more steps"
            ) from error

    def _by_parameter(self, flow: Flow) -> Array:
        p, dp = self.path.vector(flow.active), self.path.direction(flow.active)
        points = np.ascontiguousarray(flow.stages.reshape(-1, flow.stages.shape[-1]).T)
        values = self._call("parameter derivative", points.shape, self.field.f_p, points, p, dp)
        self._finite(values.T, STAGES, flow.period * flow.mesh.nodes[:-1])
        return np.ascontiguousarray(values.T).reshape(flow.stages.shape)

    @staticmethod
    def _call(what: str, shape: tuple[int, ...], function: object, *arguments: Array) -> Array:
        """Call the user's function; whatever goes wrong in there is the user's error."""
        assert callable(function)
        try:
            with np.errstate(all="ignore"):
                values = np.asarray(function(*arguments))
        except RacsBifError:
            raise
        except Exception as error:
            raise ModelError(f"the {what} raised {type(error).__name__}: {error}") from error
        if values.shape != shape or values.dtype.kind not in "fiu":
            raise ModelError(
                f"the {what} returned {values.dtype} values shaped {values.shape}, "
                f"but real values shaped {shape} are needed"
            )
        return values.astype(float, copy=False)

    @staticmethod
    def _finite(values: Array, per_step: int, times: Array) -> None:
        if not np.isfinite(values.sum()):
            good = np.isfinite(values).all(axis=1)
            if not good.all():
                time = times[int(np.argmin(good)) // per_step]
                raise ConvergenceError(
                    f"the right-hand side is not finite near t = {time:.6g} of the orbit"
                )


@dataclass(frozen=True, eq=False)
class _Column:
    """Starts and widths of the steps that are solved at once."""

    nodes: Array
    widths: Array

    @property
    def steps(self) -> int:
        return len(self.widths)


class _Chord:
    """Newton's method on the stages with factors kept as long as they contract."""

    def __init__(self, factors: StageFactors | None) -> None:
        self._factors = factors
        self._last = np.inf
        self._maps: Array | None = None
        self.failed = False

    @property
    def stale(self) -> bool:
        """Whether factors are wanted."""
        return self._factors is None

    def renew(self, factors: StageFactors) -> None:
        """Take new factors."""
        self._factors, self._maps = factors, None

    def step(self, residual: Array, segments: int) -> Array:
        """Return the change of the stages (N, 3, n) of all steps, chained within the segments."""
        assert self._factors is not None
        own: Array = self._factors.solve(residual[..., None])[..., 0]
        steps, _, size = own.shape
        if steps == segments:
            return own
        if self._maps is None:
            self._maps = self._factors.sensitivities()
        last = own[:, -1].reshape(segments, -1, size, 1)
        maps = self._maps[:, -1].reshape(segments, -1, size, size)
        shifts = np.zeros_like(last)
        for k in range(last.shape[1] - 1):
            shifts[:, k + 1] = last[:, k] + maps[:, k] @ shifts[:, k]
        spread: Array = (self._maps @ shifts.reshape(steps, 1, size, 1))[..., 0]
        return own + spread

    def judge(self, change: float) -> bool:
        """Return whether the iteration has converged; renew the factors when it is slow."""
        known = np.isfinite(self._last)
        rate = change / self._last if known else 1.0
        if change <= _TOLERANCE or (rate < 1.0 and rate * change <= _TOLERANCE):
            return True
        if known and rate > 0.5 and change <= _STAGNATION:
            return True
        if not np.isfinite(change) or change > _LOST:
            self.failed = True
        if (known and rate > _SLOW) or change > 1.0:
            self._factors = None
        self._last = change
        return False


def _origins(mesh: Mesh | _Column, starts: Array, stages: Array) -> Array:
    """Return the starts of the steps (N, n): of the segment, or where the step before ended."""
    origins = np.empty((mesh.steps, starts.shape[1]))
    origins[1:] = stages[:-1, -1]
    origins[:: mesh.steps // len(starts)] = starts
    return origins
