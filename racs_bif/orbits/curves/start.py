"""Where curves of special cycles begin: at a special point of a branch of orbits."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.orbits.collocation import CollocationProblem
from racs_bif.orbits.collocation_start import collocated_from_orbit
from racs_bif.orbits.curves.kinds import CycleKind, FoldKind, TorusKind
from racs_bif.orbits.curves.moving import begin
from racs_bif.orbits.curves.one_of import OneOf
from racs_bif.orbits.curves.problem import CycleCurve, Span
from racs_bif.orbits.curves.references import CycleReference
from racs_bif.orbits.history import reference_of
from racs_bif.orbits.piecewise import Piecewise
from racs_bif.orbits.polishing import polished
from racs_bif.orbits.twisted import Border, TwistedIntervals

if TYPE_CHECKING:
    from racs_bif.orbits.collocation_settings import CollocationSettings
    from racs_bif.orbits.problem import OrbitProblem
    from racs_bif.symbolic.field import Array
    from racs_bif.symbolic.paths import ParameterPath

_SEED: Final = 11


def as_collocated(
    problem: OrbitProblem, z: Array, settings: CollocationSettings | None = None
) -> tuple[CollocationProblem, Array]:
    """Return the same orbit by collocation.

    Parameters
    ----------
    problem : OrbitProblem
        Of any discretisation, or a curve of cycles.
    z : array
        The orbit.
    settings : CollocationSettings, optional
        How it is resolved, if it is not collocated already.

    Raises
    ------
    ConvergenceError
        If the orbit is not found.
    """
    if isinstance(problem, CollocationProblem):
        return problem, z
    if isinstance(problem, CycleCurve):
        return _of_curve(problem, z)
    start = collocated_from_orbit(problem, z, problem.path, settings=settings)
    row = np.zeros(len(start.z))
    row[-1] = 1.0
    return start.problem, polished(start.problem, start.z, row)


def _of_curve(curves: CycleCurve, z: Array) -> tuple[CollocationProblem, Array]:
    path = OneOf(curves.path, 1, float(z[-2]))
    curve = curves.curve(z)
    known = Piecewise(curve.mesh, curve.nodes)
    reference = reference_of(known, curves.reference(z).scales)
    problem = CollocationProblem(curves.field, path, reference, known, curves.settings)
    return problem, problem.join(curve.nodes, curves.period(z), float(z[-1]))


def eigenfunctions(problem: CollocationProblem, z: Array, twist: Array) -> Array:
    """Return the functions V (k, N, m, n) with V(1) = V(0) C that satisfy the equations best.

    Parameters
    ----------
    problem : CollocationProblem
        The orbit's problem.
    z : array
        The orbit.
    twist : array (k, k)
        C.

    Returns
    -------
    array (k, N, m, n)
        Their values at the nodes.
    """
    linear, shape, copies = problem.linearised(z), problem.nodes(z).shape, len(twist)
    random = np.random.default_rng(_SEED).standard_normal
    border = Border(
        columns=random((copies - 1, copies, *shape)),
        closing=np.zeros((copies - 1, copies, shape[-1])),
        rows=random((copies, copies, *shape)) / np.sqrt(np.prod(shape)),
    )
    solver = TwistedIntervals(linear, twist, border)
    wanted = np.zeros((copies, 1))
    wanted[-1] = 1.0
    found = solver.solve(np.zeros((1, copies, *shape)), wanted)
    return np.asarray(found.nodes[0] * problem.reference(z).scales)


def fold_function(problem: CollocationProblem, z: Array) -> tuple[Array, float]:
    """Return the null vector of a fold: the function (1, N, m, n) and the change of the period."""
    reference, shape = problem.reference(z), problem.nodes(z).shape
    forcing = problem.linearised(z).columns[:1]
    random = np.random.default_rng(_SEED).standard_normal((1, *shape)) / np.sqrt(np.prod(shape))
    rows = np.stack((reference.weights * reference.scales, random[0]))[:, None]
    border = Border(forcing[:, None], np.zeros((1, 1, shape[-1])), rows)
    solver = TwistedIntervals(problem.linearised(z), np.eye(1), border)
    found = solver.solve(np.zeros((1, 1, *shape)), np.array([[0.0], [1.0]]))
    return found.nodes[0] * reference.scales, float(found.unknowns[0, 0])


def cycle_curve(
    kind: CycleKind,
    orbit: tuple[CollocationProblem, Array],
    path: ParameterPath,
    spans: tuple[Span, Span],
    active: Array,
    *,
    angle: float = 0.0,
) -> tuple[CycleCurve, Array]:
    """Start a curve of special cycles in two parameters.

    Parameters
    ----------
    kind : CycleKind
        What is followed.
    orbit : (CollocationProblem, array)
        The special cycle; see `collocated`.
    path : ParameterPath
        The two parameters.
    spans : pair of (float, float)
        Their intervals.
    active : array (2,)
        Their values at the cycle.
    angle : float
        Argument of the critical multiplier of a Neimark-Sacker point.

    Returns
    -------
    problem : CycleCurve
        The equations.
    z : array
        The first point, to be corrected by the engine.
    """
    problem, z = orbit
    shape, reference = problem.nodes(z).shape, problem.reference(z)
    further = np.zeros(kind.further)
    if isinstance(kind, TorusKind):
        further[0] = np.cos(angle)
    if isinstance(kind, FoldKind):
        functions, further[0] = fold_function(problem, z)
    else:
        functions = eigenfunctions(problem, z, kind.twist(further))
    size = int(np.prod(shape))
    directions = np.zeros((2, size + 3))
    directions[1, -1] = directions[0, -2] = 1.0
    if isinstance(kind, FoldKind):
        directions[0] = np.concatenate((functions.ravel(), further, (0.0, 0.0)))
    curve = problem.curve(z)
    first = CycleReference(curve, reference.scales, np.zeros_like(functions), directions)
    curves = CycleCurve(problem.field, path, kind, first, spans, problem.settings)
    tail = np.array([problem.period(z), 0.0, *active])
    start = curves.layout.join(curve.nodes, functions, further, tail)
    return curves, begin(curves, start)
