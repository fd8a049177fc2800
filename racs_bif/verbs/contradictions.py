"""Where exact roots and those of a realisation differ in number along a branch of equilibria."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.charts.along import count_along
from racs_bif.charts.counting import UNKNOWN
from racs_bif.errors import ConvergenceError
from racs_bif.fractional.argument import count_unstable
from racs_bif.fractional.certificates import Place, Resolved, at_fold, beside, near, resolve

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from numpy.typing import NDArray

    from racs_bif.continuation.points import Point, SpecialPoint, Spectrum, Trace
    from racs_bif.equilibria.problem import EquilibriumProblem
    from racs_bif.fractional.system import System

    Flags = NDArray[np.bool_]

_BESIDE: Final = 1e-3
"""Length of the branch, whose whole span counts 1, that is too near a special point to check."""
_STATIC: Final = ("LP", "BP")
_SHIFTED: Final = 0.1
"""Relative shift up to which an exact Hopf point is taken for the realisation's."""
_AROUND: Final = 4
"""Points on either side of these that are looked at."""


def contradiction(system: System, problem: EquilibriumProblem, found: Trace) -> str:
    """Say what of a branch the exact equations contradict; empty where nothing.

    Parameters
    ----------
    system : System
        The fractional system, with the realisation that was followed.
    problem : EquilibriumProblem
        Its equilibria along the parameter.
    found : Trace
        The branch.
    """
    folds = [float(point.z[-1]) for point in found.special if point.label in _STATIC]
    for place, unstable in _places(system, problem, found):
        if at_fold(folds, place.value):
            continue
        exact = _exact_count(system, problem, place)
        if exact is None or exact == unstable or _shifted(system, problem, found, place):
            continue
        told = f"at {problem.parameter} = {place.value:.6g} there are {exact} exact"
        return f"{told} unstable roots, not {unstable}"
    if not all(at_fold(folds, *interval) for interval in found.unexplained):
        return "the changes of stability are not all explained"
    return ""


def exact_hopf_near(
    system: System,
    problem: EquilibriumProblem,
    found: Trace,
    point: SpecialPoint,
    tolerance: float = 0.01,
) -> Resolved | None:
    """Return a Hopf point of a branch as the exact equations have it, None if it is elsewhere.

    That is, by default, where `certify` would say so.
    """
    reported = next(_as_places(system, problem, [found.points[point.index]]))
    values = [place.parameter for place in found.points]
    width, omega = max(values) - min(values), float(point.data["omega"])
    try:
        return resolve(
            system.exact, problem.path, reported, omega, width=width, tolerance=tolerance
        )
    except ConvergenceError:
        return None


def refused(system: System, problem: EquilibriumProblem, found: Trace) -> Iterator[SpecialPoint]:
    """Yield the Hopf points of a branch that the exact equations do not have, or elsewhere."""
    for point in found.special:
        if point.label == "H" and exact_hopf_near(system, problem, found, point) is None:
            yield point


def without(found: Trace, points: Sequence[SpecialPoint]) -> Trace:
    """Return a branch on which some special points are ordinary ones."""
    gone = {point.index for point in points}
    kept = [replace(p, label="") if k in gone else p for k, p in enumerate(found.points)]
    special = [point for point in found.special if point.index not in gone]
    return replace(found, points=kept, special=special)


def _shifted(system: System, problem: EquilibriumProblem, found: Trace, place: Place) -> bool:
    """Say whether a place lies between a Hopf point of the realisation and the exact one."""
    for point in found.special:
        if point.label != "H":
            continue
        exact = exact_hopf_near(system, problem, found, point, _SHIFTED)
        if exact is not None and near(place.X, exact.X):
            ends = sorted((float(point.z[-1]), exact.value))
            if ends[0] <= place.value <= ends[1]:
                return True
    return False


def contradicted(
    system: System, problem: EquilibriumProblem, found: Trace, gone: Sequence[SpecialPoint]
) -> Flags:
    """Return at which points (npoints,) the exact equations have another number, or none known.

    The points beside special points that are `gone` are among them, as what these told is not
    known, and those next to folds where the number is another between.
    """
    places = _as_places(system, problem, found.points)
    wrong = np.array(
        [
            not point.label and _exact_count(system, problem, place) != point.unstable
            for point, place in zip(found.points, places, strict=True)
        ],
        dtype=bool,
    )
    for j, place in _beside_folds(system, problem, found):
        wrong[j] |= _exact_count(system, problem, place) != found.points[j].unstable
    ordinary = np.array([not point.label for point in found.points])
    for point in gone:
        before, after = ordinary[: point.index], ordinary[point.index :]
        wrong[np.flatnonzero(before)[-1:]] = True
        wrong[point.index + np.flatnonzero(after)[:2]] = True
    return wrong


def _as_places(
    system: System, problem: EquilibriumProblem, points: Iterable[Point]
) -> Iterator[Place]:
    for point in points:
        X = system.exact_point(point.z[:-1], problem.path.vector(point.parameter))
        yield Place(X=X, value=point.parameter)


def _places(
    system: System, problem: EquilibriumProblem, found: Trace
) -> Iterator[tuple[Place, int]]:
    """Yield places where roots are to be counted, and the numbers of unstable eigenvalues there.

    They are points of the branch where not all counted together have that number already, and, as
    near as `certify` counts, places right beside folds and branch points: roots there may be
    slower than the band.
    """
    points = found.points
    for k in _doubtful(system, problem, found):
        yield next(_as_places(system, problem, [points[k]])), points[k].unstable
    for j, place in _beside_folds(system, problem, found):
        yield place, points[j].unstable


def _beside_folds(
    system: System, problem: EquilibriumProblem, found: Trace
) -> Iterator[tuple[int, Place]]:
    """Yield the neighbours of folds and branch points, and places between, near these."""
    points, special = found.points, {point.index for point in found.special}
    for k in (point.index for point in found.special if point.label in _STATIC):
        for j in (k - 1, k + 1):
            if 0 <= k < len(points) and 0 <= j < len(points) and j not in special:
                start, end = _as_places(system, problem, (points[k], points[j]))
                with suppress(ConvergenceError):
                    yield j, beside(system.exact, problem.path, start, end)


def _doubtful(system: System, problem: EquilibriumProblem, found: Trace) -> list[int]:
    """Return at which points the exact roots, counted together, have another number.

    Of points that could not be counted some are chosen.
    """
    places = list(_as_places(system, problem, found.points))
    P = np.array([problem.path.vector(place.value) for place in places]).T
    counts = count_along(system, np.array([place.X for place in places]).T, P)
    compared, chosen = set[int](), set[int]()
    for piece in _pieces(found):
        compared.update(piece)
        chosen.update(_chosen(found, piece))
    for k in (point.index for point in found.special if point.label in _STATIC):
        around = range(max(k - _AROUND, 0), min(k + _AROUND + 1, len(places)))
        chosen.update(j for j in around if not found.points[j].label)
    return [
        k
        for k in sorted(compared | chosen)
        if counts[k] != found.points[k].unstable and (counts[k] != UNKNOWN or k in chosen)
    ]


def _pieces(found: Trace) -> Iterator[list[int]]:
    """Yield the points between any two special points, apart from these."""
    places = sorted({0, *(point.index for point in found.special), len(found.points) - 1})
    for a, b in pairwise(places):
        start, end = found.points[a].arclength, found.points[b].arclength
        arclengths = [(k, found.points[k].arclength) for k in range(a, b + 1)]
        piece = [k for k, s in arclengths if min(abs(s - start), abs(s - end)) > _BESIDE]
        if piece:
            yield piece


def _chosen(found: Trace, piece: list[int]) -> set[int]:
    """Return the first, the middle and the last point of a piece, and two that are near to cross.

    At one a pair comes nearest to the imaginary axis for its frequency, the other has the slowest
    eigenvalue.
    """
    spectra = [found.points[k].spectrum for k in piece]
    pair = int(np.argmin([_nearest_pair(spectrum) for spectrum in spectra]))
    slow = int(np.argmin([np.abs(spectrum).min(initial=np.inf) for spectrum in spectra]))
    return {piece[k] for k in (0, len(piece) // 2, -1, pair, slow)}


def _nearest_pair(spectrum: Spectrum) -> float:
    """Return the least |Re| / |Im| of a pair, infinite where there is none."""
    pairs = spectrum[spectrum.imag > 0.0]
    return float((np.abs(pairs.real) / pairs.imag).min(initial=np.inf))


def _exact_count(system: System, problem: EquilibriumProblem, place: Place) -> int | None:
    p = problem.path.vector(place.value)
    try:
        X = system.exact.equilibrium(place.X, p)
        return count_unstable(system.exact, X, p).unstable
    except (ConvergenceError, ArithmeticError):
        return None
