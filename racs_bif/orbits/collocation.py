"""Periodic orbits by orthogonal collocation at Gauss points."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, Any

import numpy as np

from racs_bif.continuation.stopped import Stopped
from racs_bif.errors import ConvergenceError, UsageError
from racs_bif.orbits.assembly import TAIL
from racs_bif.orbits.collocated import CollocatedProblem
from racs_bif.orbits.collocation_mesh import better_intervals
from racs_bif.orbits.collocation_settings import CollocationSettings
from racs_bif.orbits.equations import Equations
from racs_bif.orbits.gauss import gauss
from racs_bif.orbits.history import History
from racs_bif.orbits.intervals import BorderedIntervals
from racs_bif.orbits.piecewise import Piecewise, equidistant
from racs_bif.orbits.polishing import followed, polished
from racs_bif.orbits.sparse_jacobian import sparse_jacobian

if TYPE_CHECKING:
    from racs_bif.continuation.points import Point
    from racs_bif.continuation.problem import Solver
    from racs_bif.orbits.equations import Active
    from racs_bif.orbits.mesh import Mesh
    from racs_bif.orbits.reference import Reference
    from racs_bif.symbolic.field import Array, VectorField
    from racs_bif.symbolic.paths import ParameterPath

_SOLVED = 10.0
"""Error, in tolerances, up to which an orbit's polynomials are near enough on another mesh."""


class CollocationProblem(CollocatedProblem):
    """Periodic orbits x' = f(x, p) as piecewise polynomials, collocated at Gauss points.

    The unknowns are z = (X, T, g, lambda): the values X (N, m, n) at the first m of m + 1
    equidistant nodes of N intervals, the period, the number of the mesh and phase condition in use,
    and the active parameter. The equations are p' = tau f(p) at the m Gauss points of every
    interval, divided by the scales of the states, the integral phase condition against the orbit
    accepted before, and g = its number, which never changes while an orbit is solved for.

    Gauss methods are not damped at infinity: a mode that decays by far within an interval is given
    a multiplier between 0 and 1 that is too large, never one outside the unit circle (even degree).

    Parameters
    ----------
    field : VectorField
        The right-hand side.
    path : ParameterPath
        Where the active parameter leads; the first of its names is the continuation parameter.
    reference : Reference
        The first phase condition, at the Gauss points of the first mesh.
    curve : Piecewise
        The first orbit's guess.
    settings : CollocationSettings, optional
        How orbits are resolved, and when the branch ends.
    turns : int
        2 where the branch begins at a period doubling: an orbit is a proper one of this branch if
        its halves differ. Otherwise 1.
    """

    def __init__(
        self,
        field: VectorField,
        path: ParameterPath,
        reference: Reference,
        curve: Piecewise,
        settings: CollocationSettings | None = None,
        *,
        turns: int = 1,
    ) -> None:
        super().__init__()
        self.name = "periodic orbits by collocation"
        self.parameter = path.names[0]
        self.field = field
        self.path = path
        self.settings = settings or CollocationSettings()
        self.trivial = self.settings.trivial
        self.turns = turns
        self.equations = Equations(field, path)
        self.history = History(reference, curve)
        self._size = len(field.states)
        self._degree = self.settings.degree
        self._gauss = gauss(self._degree)
        self._first_period: float | None = None
        self._vanishing: tuple[Array, bool] | None = None

    # ------------------------------------------------------------------ the unknowns

    def join(self, nodes: Array, period: float, active: float, number: int = 0) -> Array:
        """Return z from nodes (N, m, n), period, parameter and number of the reference."""
        return np.concatenate((nodes.ravel(), (period, float(number), active)))

    def nodes(self, z: Array) -> Array:
        """Return the values at the nodes (N, m, n)."""
        return z[:-TAIL].reshape(-1, self._degree, self._size)

    def unknown_states(self, z: Array) -> Array:
        """Return the values at the nodes (N m, n)."""
        return self.nodes(z).reshape(-1, self._size)

    def period(self, z: Array) -> float:
        """Return the period, in units of time."""
        return float(z[-3])

    def active(self, z: Array) -> Active:
        """Return the active parameter."""
        return float(z[-1])

    def reference(self, z: Array) -> Reference:
        """Return the mesh and phase condition that `z` belongs to.

        Raises
        ------
        UsageError
            If it belongs to none of this problem's.
        """
        reference = self.history[z[-2]]
        if len(z) != reference.mesh.steps * self._degree * self._size + TAIL:
            raise UsageError(
                f"{len(z)} unknowns do not fit {reference.mesh.steps} intervals of degree "
                f"{self._degree} and {self._size} states: take a point of this problem's own branch"
            )
        return reference

    # ------------------------------------------------------------------ the equations

    def residual(self, z: Array) -> Array:
        """Return the defects (N m n) over the scales, the phase, and the number's distance."""
        at, reference = self.at(z), self.reference(z)
        defects = at.defects() / reference.scales
        phase = reference.phase(at.curve.stages())
        return np.concatenate((defects.ravel(), (phase, z[-2] - np.round(z[-2]))))

    def jacobian(self, z: Array) -> Any:  # noqa: ANN401 - scipy's arrays have no types
        """Return the exact derivative (N m n + 2, N m n + 3) of the residual, a sparse array."""
        at, reference = self.at(z), self.reference(z)
        jacobians = self.equations.jacobians(at)
        return sparse_jacobian(at, jacobians, self.equations.columns(at), reference)

    def bordered(self, z: Array, row: Array) -> Solver:
        """Return a solver of [jacobian; row] by condensation; see `BorderedIntervals`."""
        scales, shape = self.reference(z).scales, self.nodes(z).shape
        solver = self._bordered(z, row)

        def solve(rhs: Array) -> Array:
            matrix = rhs.reshape(len(rhs), -1)
            width, number = matrix.shape[1], matrix[-2]
            stages = np.ascontiguousarray(matrix[:-TAIL].T).reshape(width, *shape)
            border = np.stack((matrix[-3], matrix[-1] - row[-2] * number))
            nodes, unknowns = solver.solve(stages, border)
            states = (nodes * scales).reshape(width, -1).T
            solution = np.concatenate((states, unknowns[:1], number[None], unknowns[1:]))
            return solution.reshape(rhs.shape)

        return solve

    def _bordered(self, z: Array, row: Array) -> BorderedIntervals:
        reference, shape = self.reference(z), self.nodes(z).shape
        nodes = np.zeros((2, *shape))
        nodes[1] = row[:-TAIL].reshape(shape) * reference.scales
        stages = np.zeros((2, *shape))
        stages[0] = reference.weights * reference.scales
        corner = np.array([[0.0, 0.0], [row[-3], row[-1]]])
        return BorderedIntervals(self.linearised(z), nodes, stages, corner)

    def singularity(self, z: Array, tangent: Array) -> float:
        """Return how far [jacobian; tangent] is from singular; see `OrbitProblem`."""
        magnitudes = self.magnitudes(z)
        row = tangent / magnitudes
        row /= np.linalg.norm(row)
        solver = self._bordered(z, row / magnitudes)
        shape = self.nodes(z).shape
        right = np.random.default_rng(shape[0]).standard_normal((1, *shape))
        nodes, unknowns = solver.solve(right, np.zeros((2, 1)))
        unknowns /= magnitudes[[-3, -1], None]
        length = float(np.hypot(np.linalg.norm(nodes), np.linalg.norm(unknowns)))
        return solver.sign() * float(np.linalg.norm(right)) / length

    # ------------------------------------------------------------------ what the engine asks

    def degenerate(self, z: Array) -> bool:
        """Return whether there is no amplitude, or it has changed sign where the branch began."""
        if self.at_crossing(z):
            return True
        # asked of every point by the engine and by each detector
        if self._vanishing is None or not np.array_equal(self._vanishing[0], z):
            before = self.history.curve(z[-2])
            vanishing = self.vanishing(z, before, self.settings.smallest, self.turns)
            self._vanishing = (np.array(z), vanishing)
        return self._vanishing[1]

    def scales(self, z: Array) -> Array:
        """Return the scales of the states, the same for all nodes, the period, and 1."""
        reference = self.reference(z)
        states = np.tile(reference.scales, reference.mesh.steps * self._degree)
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
        full = reference.mesh.steps >= self.settings.most_intervals
        if full and self.floquet(z).health > self.settings.trivial:
            return Stopped.ACCURACY
        return None

    def adapt(self, z: Array, tangent: Array) -> tuple[Array, Array] | None:
        """Take this orbit as the reference of the next, on a better mesh where the error asks."""
        if self.degenerate(z):
            return None
        curve = self.curve(z)
        scales = self._scales_of(z)
        mesh = better_intervals(curve, scales, self.settings, health=self.floquet(z).health)
        if mesh is not None:
            # if that fails the old mesh serves, until it no longer does and the branch ends
            with suppress(ConvergenceError, np.linalg.LinAlgError):
                near = float(curve.errors(scales).max()) <= _SOLVED * self.settings.tolerance
                z, tangent = (self._moved if near else self.on_mesh)(z, mesh, tangent)
        followed = np.array(z)
        followed[-2] = self.history.add(self.curve(z), self._scales_of(z))
        self._found = (followed, self.at(z))
        return followed, self._in_phase(followed, tangent)

    def _scales_of(self, z: Array) -> Array:
        """Return how far the states have moved: on one orbit, or from the first to this."""
        moved = np.abs(self.curve(z).mean() - self.history.curve(0).mean())
        return np.maximum(np.maximum(self.reference(z).scales, self.curve(z).ranges()), moved)

    def _in_phase(self, z: Array, tangent: Array) -> Array:
        """Return a tangent shifted along the orbit until it obeys the phase condition of `z`."""
        reference, n = self.reference(z), self._size
        moved = Piecewise(reference.mesh, self.nodes(tangent))
        shift = float(np.sum(reference.weights * moved.stages()))
        rates = self.equations.rates(self.nodes(z).reshape(-1, n), self.active(z))
        turned = np.array(tangent)
        turned[:-TAIL] -= shift * self.period(z) * rates.ravel()
        turned[-2] = 0.0
        return turned

    # ------------------------------------------------------------------ from mesh to mesh

    def on_mesh(self, z: Array, mesh: Mesh, tangent: Array | None = None) -> tuple[Array, Array]:
        """Solve for the same orbit on another mesh.

        Parameters
        ----------
        z : array (N m n + 3,)
            A solution.
        mesh : Mesh
            The other mesh.
        tangent : array (N m n + 3,), optional
            The direction in which not to move; without it the parameter is held.

        Returns
        -------
        tuple of array (N' m n + 3,)
            The solution and the direction on the other mesh.

        Raises
        ------
        ConvergenceError, numpy.linalg.LinAlgError
            If the orbit is not found there.
        """
        found, moved = self._moved(z, mesh, tangent)
        if tangent is None:
            return polished(self, found, moved), moved
        return followed(self, found, moved)

    def _moved(self, z: Array, mesh: Mesh, tangent: Array | None) -> tuple[Array, Array]:
        """Return an orbit as its polynomials have it on another mesh, and a direction."""
        curve, times = self.curve(z), equidistant(mesh, self._degree)
        there = Piecewise(mesh, curve(times))
        number = self.history.add(there, self._scales_of(z))
        found = self.join(there.nodes, float(z[-3]), float(z[-1]), number)
        if tangent is None:
            row = np.zeros(len(found))
            row[-1] = 1.0
            return found, row
        moved = Piecewise(curve.mesh, self.nodes(tangent))(times)
        return found, self.join(moved, float(tangent[-3]), float(tangent[-1]))

    # ------------------------------------------------------------------ results

    def measures(self, z: Array) -> dict[str, float]:
        """Return what every orbit has, the number of intervals and the error of the polynomials."""
        curve = self.curve(z)
        error = float(curve.errors(self._scales_of(z)).max())
        numbers = {"intervals": float(curve.mesh.steps), "mesh error": error}
        return super().measures(z) | numbers
