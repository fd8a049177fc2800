"""Curves of folds, period doublings and Neimark-Sacker points of cycles in two parameters."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.continuation.stopped import Stopped
from racs_bif.errors import ConvergenceError
from racs_bif.orbits.collocated import CollocatedProblem
from racs_bif.orbits.collocation_mesh import better_intervals
from racs_bif.orbits.collocation_settings import CollocationSettings
from racs_bif.orbits.curves.forms import coefficient
from racs_bif.orbits.curves.layout import Layout
from racs_bif.orbits.curves.moving import on_mesh, refer
from racs_bif.orbits.curves.references import CycleReference, CycleReferences
from racs_bif.orbits.curves.variation import Variation, around
from racs_bif.orbits.equations import Equations
from racs_bif.orbits.gauss import gauss
from racs_bif.orbits.intervals import BorderedIntervals
from racs_bif.orbits.polishing import direction
from racs_bif.orbits.twisted import TwistedIntervals

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from racs_bif.continuation.points import Point
    from racs_bif.continuation.problem import Bound, Solver
    from racs_bif.orbits.critical_mode import Coefficient
    from racs_bif.orbits.curves.kinds import CycleKind
    from racs_bif.orbits.reference import Reference
    from racs_bif.symbolic.field import Array, VectorField
    from racs_bif.symbolic.paths import ParameterPath

Span = tuple[float, float]

_LOOSE: Final = 3.0
"""Magnitude of an eigenfunction in lengths: it turns faster than the orbit, and matters less."""
_SMALLEST: Final = 4e-3
"""Range of the states over their means, or over the largest on the curve, at which it ends."""


class CycleCurve(CollocatedProblem):
    """Special cycles in two parameters, by collocation.

    The unknowns are z = (X, V, u, T, g, lambda_1, lambda_2): the orbit X (N, m, n) and the k
    eigenfunctions V (k, N, m, n) at the nodes of the mesh, the unknowns u of the kind, the period,
    the number of the reference and the parameters. The equations are those of the orbit, their
    linearisation along V with the kind's closing, and the phase and normalisation of V: the fully
    extended systems of AUTO (E. J. Doedel, H. B. Keller and J. P. Kernevez, *Numerical analysis and
    control of bifurcation problems II*, Int. J. Bifurcation Chaos 1, 1991). They are solved block
    by block: once for the orbit bordered by two directions, once for the eigenfunctions, so that a
    point costs a little more than one of a branch of orbits.

    Parameters
    ----------
    field : VectorField
        The right-hand side.
    path : ParameterPath
        The two active parameters.
    kind : CycleKind
        What is followed.
    first : CycleReference
        Mesh, phase and normalisation of the first point.
    spans : pair of (float, float)
        Intervals of the parameters; the engine is given the second.
    settings : CollocationSettings, optional
        How orbits are resolved, and when the curve ends.
    """

    def __init__(
        self,
        field: VectorField,
        path: ParameterPath,
        kind: CycleKind,
        first: CycleReference,
        spans: tuple[Span, Span],
        settings: CollocationSettings | None = None,
    ) -> None:
        super().__init__()
        self.name = f"{kind.label} curve by collocation"
        self.parameter = path.names[1]
        self.field, self.path, self.kind, self.spans = field, path, kind, spans
        self.settings = settings or CollocationSettings()
        self.equations = Equations(field, path)
        self.references = CycleReferences(first)
        self.layout = Layout(self.settings.degree, len(field.states), kind.copies, kind.further)
        self.gauss = gauss(self.settings.degree)
        self._first_period: float | None = None
        self._variation: tuple[Array, Variation] | None = None
        self._twisted: tuple[Array, TwistedIntervals] | None = None
        self._coefficient: tuple[Array, Coefficient] | None = None

    # ------------------------------------------------------------------ the unknowns

    def period(self, z: Array) -> float:
        """Return the period, in units of time."""
        return float(z[-4])

    def nodes(self, z: Array) -> Array:
        """Return the values of the orbit at the nodes (N, m, n)."""
        return self.layout.orbit(z)

    def unknown_states(self, z: Array) -> Array:
        """Return the values of the orbit at the nodes (N m, n)."""
        return self.nodes(z).reshape(-1, self.layout.states)

    def place(self, measure: str) -> int | None:
        """Return where in z the period is; no other measure is an unknown."""
        return -4 if measure == "period" else None

    def active(self, z: Array) -> Array:
        """Return the two parameters."""
        return z[-2:].copy()

    def reference(self, z: Array) -> Reference:
        """Return the mesh and phase condition that `z` belongs to."""
        return self.references.phase(z[-3])

    def variation(self, z: Array) -> Variation:
        """Return the eigenfunctions' equations at `z`, kept until they are asked for elsewhere."""
        if self._variation is None or not np.array_equal(self._variation[0], z):
            at = self.at(z)
            found = Variation(
                (self.field, self.path, self.equations),
                self.kind,
                at,
                self.reference(z),
                self.references[z[-3]].functions,
                (self.layout.functions(z).copy(), self.layout.further_of(z).copy()),
            )
            self._variation = (np.array(z), found)
        return self._variation[1]

    # ------------------------------------------------------------------ the equations

    def residual(self, z: Array) -> Array:
        """Return the defects of orbit and eigenfunctions over the scales, and the conditions."""
        at, reference = self.at(z), self.reference(z)
        phase = reference.phase(at.curve.stages())
        defects, conditions = self.variation(z).defects()
        orbit = at.defects() / reference.scales
        ends = (phase, z[-3] - np.round(z[-3]))
        return np.concatenate((orbit.ravel(), defects.ravel(), ends, conditions))

    def terms(self, z: Array) -> Array:
        """Return the sizes of the terms that the residual is made of."""
        at, reference, g = self.at(z), self.reference(z), self.gauss
        orbit = abs(g.slopes) @ np.abs(at.curve.closed)
        orbit += at.tau[:, None, None] * np.abs(at.rates)
        phase = float(np.sum(np.abs(reference.weights) * np.abs(at.curve.stages())))
        functions, conditions = self.variation(z).terms()
        parts = (orbit / reference.scales).ravel(), functions.ravel()
        return np.concatenate((*parts, (phase, abs(z[-3])), conditions))

    def turned(self, z: Array, mains: Array) -> Array:
        """Return how the eigenfunctions' equations (q, k, N, m, n) change, over the scales.

        Along q directions of orbit, period and parameters (q, N m n + 3).
        """
        nodes = mains[:, :-3].reshape(-1, *self.nodes(z).shape)
        moves = around(nodes, self.gauss.values)
        return self.variation(z).turned(moves, mains[:, -3:]) / self.reference(z).scales

    def jacobian(self, z: Array) -> Array:
        """Return the exact derivatives, column by column: for checks, the solvers do without."""
        return np.stack([self.product(z, column) for column in np.eye(len(z))], axis=1)

    def product(self, z: Array, step: Array) -> Array:
        """Return the derivative of the residual along a direction, exactly."""
        variation, layout, reference = self.variation(z), self.layout, self.reference(z)
        main, scales = layout.main(step), reference.scales
        nodes = layout.orbit(step)
        closed = np.concatenate((nodes, np.roll(nodes[:, :1], -1, axis=0)), axis=1)
        orbit = variation.linear(closed[None])[0]
        orbit -= np.tensordot(main[-3:], self.equations.columns(self.at(z)), 1)
        further = layout.further_of(step)
        moved = variation.closed(layout.functions(step), further)
        functions = variation.linear(moved) / scales + self.turned(z, main[None])[0]
        functions -= np.tensordot(further, variation.border.columns, 1)
        phase = float(np.sum(reference.weights * (self.gauss.values @ closed)))
        rows = variation.conditions(moved)
        parts = (orbit / scales).ravel(), functions.ravel()
        return np.concatenate((*parts, (phase, step[-3]), rows))

    # ------------------------------------------------------------------ solving

    def twisted(self, z: Array) -> TwistedIntervals:
        """Return the solver of the eigenfunctions' equations at `z`."""
        if self._twisted is None or not np.array_equal(self._twisted[0], z):
            twist = self.kind.twist(self.layout.further_of(z))
            solver = TwistedIntervals(self.linearised(z), twist, self.variation(z).border)
            self._twisted = (np.array(z), solver)
        return self._twisted[1]

    def solutions(self, z: Array, stages: Array, phase: Array) -> Array:
        """Return q particular solutions and two null vectors of the orbit's equations.

        Parameters
        ----------
        z : array
            The point.
        stages : array (q, N, m, n)
            Right-hand sides at the Gauss points, over the scales.
        phase : array (q,)
            Those of the phase condition.

        Returns
        -------
        array (q + 2, N m n + 3)
            Directions of orbit, period and parameters.
        """
        count, reference, shape = len(phase), self.reference(z), self.nodes(z).shape
        rows = self.references[z[-3]].directions / self.spread(z) ** 2
        nodes, weights = np.zeros((3, *shape)), np.zeros((3, *shape))
        nodes[1:] = rows[:, :-3].reshape(2, *shape) * reference.scales
        weights[0] = reference.weights * reference.scales
        corner = np.concatenate((np.zeros((1, 3)), rows[:, -3:]))
        solver = BorderedIntervals(self.linearised(z), nodes, weights, corner)
        border = np.zeros((3, count + 2))
        border[0, :count] = phase
        border[1, count] = border[2, count + 1] = 1.0
        rhs = np.concatenate((stages, np.zeros((2, *shape))))
        found, unknowns = solver.solve(rhs, border)
        flat = (found * reference.scales).reshape(count + 2, -1)
        return np.concatenate((flat, unknowns.T), axis=1)

    def bordered(self, z: Array, row: Array) -> Solver:
        """Return a solver of [jacobian; row], block by block."""
        layout, scales, twisted = self.layout, self.reference(z).scales, self.twisted(z)
        shape, copies = self.nodes(z).shape, self.kind.copies
        size, conditions = int(np.prod(shape)), self.kind.further + 1

        def solve(rhs: Array) -> Array:
            matrix = rhs.reshape(len(rhs), -1)
            count = matrix.shape[1]
            own, tail = matrix[: size * (1 + copies)], matrix[size * (1 + copies) :]
            stages = np.ascontiguousarray(own.T).reshape(count, 1 + copies, *shape)
            mains = self.solutions(z, stages[:, 0], tail[0])
            forcing = -self.turned(z, mains)
            forcing[:count] += stages[:, 1:]
            border = np.zeros((conditions, count + 2))
            border[:, :count] = tail[2 : 2 + conditions]
            found = twisted.solve(forcing, border)
            numbers = np.append(tail[1], (0.0, 0.0))
            whole = np.stack(
                [
                    layout.join(
                        main[:-3],
                        found.nodes[q] * scales,
                        found.unknowns[:, q],
                        np.array((main[-3], numbers[q], *main[-2:])),
                    )
                    for q, main in enumerate(mains)
                ]
            )
            # what is left: no share of the border's own column, and the engine's row
            null = whole[count:]
            small = np.stack((found.test[count:], null @ row))
            wanted = np.stack((-found.test[:count], tail[-1] - whole[:count] @ row))
            shares = np.linalg.solve(small, wanted)
            return np.asarray((whole[:count] + shares.T @ null).T.reshape(rhs.shape))

        return solve

    # ------------------------------------------------------------------ what the engine asks

    def spread(self, z: Array) -> Array:
        """Return magnitudes (N m n + 3,) of orbit, period and parameters, so that all count alike.

        The values at all nodes together count as one.
        """
        states = np.broadcast_to(self.reference(z).scales, self.nodes(z).shape).ravel()
        widths = [high - low for low, high in self.spans]
        return np.concatenate((states * np.sqrt(len(states)), (self.period(z), *widths)))

    def scales(self, z: Array) -> Array:
        """Return magnitudes of the unknowns; the first parameter counts like the second."""
        scales, shape = self.reference(z).scales, self.nodes(z).shape
        states = np.broadcast_to(scales, shape)
        functions = np.broadcast_to(_LOOSE * scales, (self.kind.copies, *shape))
        further = np.full(self.kind.further, self.kind.magnitude(self.period(z)))
        low, high = self.spans[0]
        width = (high - low) / np.sqrt(len(z) - 1.0)
        return self.layout.join(states, functions, further, np.array((self.period(z), 1.0, width)))

    def bounds(self) -> tuple[Bound, ...]:
        """Return the span of the first parameter."""
        return ((-2, *self.spans[0]),)

    def degenerate(self, z: Array) -> bool:
        """Return whether the orbit has no amplitude left, or one of the other sign.

        Orbits and equilibria of any period meet where the amplitude vanishes: the equations become
        singular there, and cannot be solved as far as those of a branch.
        """
        curve = self.curve(z)
        typical = np.maximum(np.abs(curve.mean()), self.reference(z).scales)
        if float((curve.ranges() / typical).max()) < _SMALLEST:
            return True
        return self.vanishing(z, self.references[z[-3]].curve, self.settings.smallest)

    def ends(self, point: Point) -> Stopped | None:
        """Return why the curve ends here: long period, no amplitude left, accuracy lost."""
        z = point.z
        if self._first_period is None:
            self._first_period = self.period(z)
        if self.period(z) > self.settings.longest * self._first_period:
            return Stopped.PERIOD
        if self.degenerate(z):
            return Stopped.VANISHED
        full = self.reference(z).mesh.steps >= self.settings.most_intervals
        if full and self.floquet(z).health > self.settings.trivial:
            return Stopped.ACCURACY
        return None

    def adapt(self, z: Array, tangent: Array) -> tuple[Array, Array] | None:
        """Take this point as the reference of the next, on a better mesh where the error asks."""
        if self.degenerate(z):
            return None
        scales, health = self.reference(z).scales, self.floquet(z).health
        mesh = better_intervals(self.curve(z), scales, self.settings, health=health)
        if mesh is not None:
            # if that fails the old mesh serves, until it no longer does and the curve ends
            with suppress(ConvergenceError, np.linalg.LinAlgError):
                z, tangent = on_mesh(self, z, mesh, tangent)
        followed = refer(self, z)
        return followed, direction(self, followed, tangent)

    def spectrum(self, z: Array) -> NDArray[np.complex128]:
        """Return the multipliers: the trivial one, those kept critical, and the others."""
        found = self.floquet(z).multipliers
        first, rest = [found[0]], list(found[1:])
        for wanted in self.kind.critical(self.layout.further_of(z)):
            k = int(np.argmin(np.abs(np.array(rest) - wanted)))
            first.append(rest.pop(k))
        return np.array(first + rest)

    def sides(self, spectrum: NDArray[np.complex128]) -> NDArray[np.bool_]:
        """Return which multipliers are outside the unit circle, those kept on it exempt."""
        outside = np.asarray(np.abs(spectrum) > 1.0)
        outside[: 1 + self.kind.copies] = False
        return outside

    def noncritical(self, spectrum: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """Return the multipliers that are not on the unit circle all along."""
        return spectrum[1 + self.kind.copies :]

    # ------------------------------------------------------------------ test functions

    def coefficient(self, z: Array) -> Coefficient:
        """Return the normal form's c or d, as `forms.coefficient` has it."""
        if self._coefficient is None or not np.array_equal(self._coefficient[0], z):
            self._coefficient = (np.array(z), coefficient(self, z))
        return self._coefficient[1]

    def measures(self, z: Array) -> dict[str, float]:
        """Return what every orbit has, the number of intervals and what the kind has besides."""
        numbers = {"intervals": float(self.reference(z).mesh.steps)}
        if self.kind.name == "lpc":
            numbers["beta"] = float(self.layout.further_of(z)[0])
        else:
            numbers[self.kind.coefficient] = self.coefficient(z).value.real
        if self.kind.name == "ns":
            kappa = float(self.layout.further_of(z)[0])
            neutral = abs(kappa) >= 1.0
            numbers["angle"] = float("nan") if neutral else float(np.arccos(kappa))
            numbers["neutral"] = float(neutral)
        return super().measures(z) | numbers
