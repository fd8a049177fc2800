"""One boundary, traced from a seed to the edges of its box or around to where it began."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.charts.problems import (
    FoldBoundary,
    HopfBoundary,
    SingularBoundary,
    StaticBoundary,
)
from racs_bif.continuation.settings import StepSettings
from racs_bif.continuation.stopped import Stopped
from racs_bif.continuation.trace import trace
from racs_bif.equilibria.generalised_hopf import GeneralisedHopf
from racs_bif.fractional.exact import ExactModel
from racs_bif.fractional.static import StaticField

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from racs_bif.charts.plane import Plane
    from racs_bif.charts.settings import ChartSettings
    from racs_bif.continuation.points import Point, Trace
    from racs_bif.continuation.points import SpecialPoint as RawPoint
    from racs_bif.equilibria.curve_problem import CurveProblem
    from racs_bif.symbolic.field import Array

AnyBoundary = HopfBoundary | FoldBoundary | StaticBoundary | SingularBoundary
BETWEEN = 4
"""Stretches of the line between two points."""
_NAMED = ("GH", "UZ")
_STRAIGHT = 0.5
_FIRST = 2e-3
_AT_BOX = 1e-8


@dataclass(frozen=True)
class Seed:
    """A point of a boundary.

    Parameters
    ----------
    kind : {"hopf", "static", "fold", "singular"}
        Which.
    X : array (size,)
        States and outputs of the elements.
    place : array (2,)
        In the unit square.
    omega : float
        Frequency [rad/s], 0 but for a Hopf boundary.
    """

    kind: str
    X: Array
    place: Array
    omega: float = 0.0


@dataclass(frozen=True)
class Special:
    """A point on a boundary: GH, where l1 changes sign, or UZ, asked for."""

    label: str
    values: Array
    data: dict[str, float]


@dataclass(frozen=True)
class Boundary:
    """A boundary, m points long.

    Parameters
    ----------
    kind : {"hopf", "static", "fold", "singular"}
        A pair crosses the imaginary axis, a real root crosses zero, the equilibrium ends, or the
        mass matrix is singular.
    values : array (m, 2)
        Parameters.
    states : array (m, size)
        States and outputs of the elements.
    omega : array (m,)
        Frequency [rad/s], NaN but on a Hopf boundary.
    l1 : array (m,)
        First Lyapunov coefficient, NaN where it was not asked for.
    gradient : array (m, 2)
        Derivative of the critical root's real part by the place in the unit square; NaN where only
        a change of sign is known.
    line : array (k, 2)
        The curve in the unit square, smoothly between the points.
    closed : bool
        Whether it is a closed curve.
    stopped : str
        Why it ended.
    complete : bool
        Whether that was at the box, or closed.
    special : tuple of Special
        Points of codimension two.
    evaluations : int
        Characteristic matrices, with derivatives.
    """

    kind: str
    values: Array
    states: Array
    omega: Array
    l1: Array
    gradient: Array
    line: Array
    closed: bool
    stopped: str
    complete: bool
    special: tuple[Special, ...]
    evaluations: int


def trace_boundary(
    plane: Plane,
    seed: Seed,
    settings: ChartSettings,
    *,
    lyapunov: bool = False,
    marks: Mapping[str, Sequence[float]] | None = None,
    progress: Callable[[Point], None] | None = None,
) -> Boundary:
    """Trace the boundary through a seed.

    Parameters
    ----------
    plane : Plane
        Its box clips the boundary exactly.
    seed : Seed
        Where to start.
    settings : ChartSettings
        Steps.
    lyapunov : bool
        Compute l1 along a Hopf boundary, and GH points.
    marks : mapping of str to sequence of float, optional
        Values of the two parameters at which points are wanted exactly; they are labelled UZ.
    progress : callable, optional
        Called with every point.

    Raises
    ------
    ConvergenceError
        If the seed is no point of such a boundary.
    """
    problem, z = _problem(plane, seed)
    detectors = []
    if isinstance(problem, HopfBoundary) and lyapunov:
        problem.wanted = True
        detectors.append(GeneralisedHopf())
    found = trace(
        problem,
        z,
        plane.spans[1],
        detectors,
        StepSettings(initial=_FIRST, maximum=settings.step, angle=settings.angle),
        targets=dict(marks or {}),
        tangent=_tangent(problem, z, plane),
        progress=progress,
    )
    return _boundary(plane, seed, problem, found)


def _problem(plane: Plane, seed: Seed) -> tuple[AnyBoundary, Array]:
    system = plane.system
    kinds: dict[str, type[AnyBoundary]] = {
        "hopf": HopfBoundary,
        "static": StaticBoundary,
        "fold": FoldBoundary,
        "singular": SingularBoundary,
    }
    extra = {"hopf": [seed.omega], "static": [0.0]}.get(seed.kind, [])
    # Static gains are exact: folds and static losses are those of the exact model, whose second
    # derivatives are known.
    exact = system.exact if seed.kind == "hopf" else ExactModel(system.field)
    static = StaticField(exact)
    problem = kinds[seed.kind](static, system.field, plane.path, plane.spans[0])
    z = np.concatenate([seed.X, extra, plane.values(seed.place)])
    return problem, z


def _tangent(problem: CurveProblem, z: Array, plane: Plane) -> Array:
    """Return the null vector of the Jacobian, in the scales of the unknowns and of the box."""
    problem.residual(z)
    scale = np.append(problem.scales(z), plane.width[1])
    jacobian = problem.jacobian(z) * scale
    rows = np.abs(jacobian).max(axis=1, keepdims=True)
    rows[rows == 0.0] = 1.0
    return np.asarray(np.linalg.svd(jacobian / rows)[2][-1] * scale)


def _boundary(
    plane: Plane,
    seed: Seed,
    problem: AnyBoundary,
    found: Trace,
) -> Boundary:
    n = problem.n
    # A Hopf boundary that runs into a static one may overstep it by a point.
    points = [p for p in found.points if seed.kind != "hopf" or p.z[n] > 0.0]
    closed = Stopped.CLOSED in {found.stopped, found.stopped_backward}
    values = np.array([p.z[-2:] for p in points])
    nan = np.full(len(points), np.nan)
    omega = np.array([p.z[n] for p in points]) if seed.kind == "hopf" else nan
    l1 = np.array([p.measures.get("l1", np.nan) for p in points])
    gradient = np.full((len(points), 2), np.nan)
    if isinstance(problem, HopfBoundary):
        gradient = np.array([problem.gradient(p.z) for p in points]) * plane.width
    line = _line(plane, points)
    ends = _ends(plane, found, values)
    special = tuple(_special(raw, n, seed.kind) for raw in found.special if raw.label in _NAMED)
    return Boundary(
        kind=seed.kind,
        values=values,
        states=np.array([p.z[:n] for p in points]),
        omega=omega,
        l1=l1,
        gradient=gradient,
        line=line,
        closed=closed,
        stopped=" ".join(dict.fromkeys(end.value for end in ends)),
        complete=all(end.complete or end is Stopped.STATIC for end in ends),
        special=special,
        evaluations=problem.evaluations,
    )


def _special(raw: RawPoint, n: int, kind: str) -> Special:
    data = {k: float(v) for k, v in raw.data.items() if isinstance(v, int | float)}
    data.pop("target", None)
    if kind == "hopf":
        data.setdefault("omega", float(raw.z[n]))
    return Special(raw.label, raw.z[-2:].copy(), data)


def _ends(plane: Plane, found: Trace, values: Array) -> list[Stopped]:
    """Return why it ended at its ends; at the box, whatever the engine ran into beyond it."""
    ends = []
    for stopped, place in ((found.stopped_backward, 0), (found.stopped, -1)):
        at = plane.places(values[place])
        if stopped is None and len(values) == 1:
            continue
        boxed = bool(np.any((at <= _AT_BOX) | (at >= 1.0 - _AT_BOX)))
        if stopped is not Stopped.CLOSED and boxed:
            ends.append(Stopped.SPAN)
        elif stopped is not None:
            ends.append(stopped)
    return ends


def _line(plane: Plane, points: list[Point]) -> Array:
    """Return points on cubics between the points, in the unit square."""
    at = plane.places(np.array([p.z[-2:] for p in points]).T).T
    slopes = np.array([p.tangent[-2:] for p in points]) / plane.width
    if len(points) < 2:
        return at
    chords = np.diff(at, axis=0)
    lengths = np.hypot(*chords.T)[:, None]
    lengths[lengths == 0.0] = 1e-300
    sizes = np.hypot(*slopes.T)[:, None]
    unit = slopes / np.where(sizes > 0.0, sizes, 1.0)
    begin, end = unit[:-1], unit[1:]
    # At a cusp the direction turns back: there the curve is drawn straight.
    straight = (
        np.minimum((begin * chords).sum(axis=1), (end * chords).sum(axis=1))
        < _STRAIGHT * lengths[:, 0]
    )
    begin = np.where(straight[:, None], chords / lengths, begin)
    end = np.where(straight[:, None], chords / lengths, end)
    pieces = []
    for share in np.arange(BETWEEN) / BETWEEN:
        s2, s3 = share**2, share**3
        pieces.append(
            (2 * s3 - 3 * s2 + 1) * at[:-1]
            + (s3 - 2 * s2 + share) * lengths * begin
            + (3 * s2 - 2 * s3) * at[1:]
            + (s3 - s2) * lengths * end
        )
    line = np.stack(pieces, axis=1).reshape(-1, 2)
    return np.asarray(np.clip(np.vstack([line, at[-1]]), 0.0, 1.0))
