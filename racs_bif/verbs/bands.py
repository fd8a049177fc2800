"""Whether the band of a realisation holds what decides stability, and a wider one where not.

A realisation is good on its band; roots slower or faster than that are its own. The argument
principle counts the exact unstable roots at all points together, and right beside folds. Where the
realisation has other numbers there, or a Hopf point beyond its band, branches are followed again on
a wider one, unless the user chose the band.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Final, TypeVar

import numpy as np

from racs_bif.charts.along import count_along
from racs_bif.charts.counting import UNKNOWN
from racs_bif.errors import ConvergenceError, ParameterError
from racs_bif.fractional.argument import count_unstable
from racs_bif.fractional.certificates import ROUNDING, Place, beside, near, resolve
from racs_bif.fractional.realisations import choose_realisation
from racs_bif.units import after, frequency_unit
from racs_bif.verbs.assemble import interrupted

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from numpy.typing import NDArray

    from racs_bif.continuation.points import Point, Spectrum, Trace
    from racs_bif.equilibria.problem import EquilibriumProblem
    from racs_bif.fractional.system import System

    Followed = Sequence[tuple[EquilibriumProblem, Trace]]
    Flags = NDArray[np.bool_]

Band = tuple[float, float]
R = TypeVar("R")

_FURTHER: Final = 10.0
"""How much further a band reaches than what it must hold, or than it did."""
_LIMITS: Final = (1e-7, 1e6)
"""Beyond these multiples of the model's own band none is tried."""
_BESIDE: Final = 1e-3
"""Length of the branch, whose whole span counts 1, that is too near a special point to check."""
_STATIC: Final = ("LP", "BP")
_AROUND: Final = 4
"""Points on either side of these that are looked at."""
_MARGIN: Final = 2.0
"""How far within its band a realisation is good, as a factor."""


@dataclass(frozen=True)
class Remark:
    """What is to be said of a band.

    Parameters
    ----------
    text : str
        A sentence, empty where the first band holds.
    settled : bool
        Whether no contradiction to the exact equations is left.
    """

    text: str = ""
    settled: bool = True


def on_a_band_that_holds(
    system: System,
    work: Callable[[System], R],
    traces: Callable[[System, R], Followed],
) -> tuple[System, R, Remark]:
    """Follow branches, and again on wider bands until the exact equations agree.

    Parameters
    ----------
    system : System
        The system; one whose realisation is not the default keeps it.
    work : callable
        Follows branches of equilibria.
    traces : callable
        What it followed.

    Returns
    -------
    system : System
        The system with the band taken: its own, where none settles it.
    result
        Of `work`.
    remark : Remark
        What is to be said of it.
    """
    first = result = work(system)
    own: Band = tuple(system.compiled.meta["band"])
    if not system.fractional or system.settings != choose_realisation(None, own):
        return system, result, Remark()
    kept, remark = system, ""
    while True:
        followed = traces(kept, result)
        if any(interrupted(found) for _, found in followed):
            return kept, result, Remark(remark)
        trouble = _trouble(kept, followed)
        if trouble is None:
            return kept, result, Remark(remark)
        (low, high), told = trouble
        if low < _LIMITS[0] * own[0] or high > _LIMITS[1] * own[1]:
            return system, first, Remark(f" No wider band settles it: {told}.", settled=False)
        trial = replace(kept, settings=choose_realisation(None, (low, high)))
        try:
            result = work(trial)
        except (ConvergenceError, ParameterError):
            told = f" On a wider band nothing is found: {told}."
            return system, first, Remark(told, settled=False)
        kept = trial
        unit = after(frequency_unit(system.time_unit))
        remark = f" The realisation's band was widened to {low:.4g} to {high:.4g}{unit}: {told}."


def _trouble(system: System, followed: Followed) -> tuple[Band, str] | None:
    """Return the band that is wanted and why, None where the present one will do."""
    for problem, found in followed:
        trouble = _beyond(system, problem, found) or _contradicted(system, problem, found)
        if trouble is not None:
            return trouble
    return None


def _beyond(system: System, problem: EquilibriumProblem, found: Trace) -> tuple[Band, str] | None:
    low, high = system.settings.band
    unit = after(frequency_unit(system.time_unit))
    for point in found.special:
        omega = float(point.data.get("omega", low))
        if point.label == "H" and not _MARGIN * low <= omega <= high / _MARGIN:
            wider = min(low, omega / _FURTHER), max(high, omega * _FURTHER)
            name, value = problem.parameter, float(point.z[-1])
            return wider, f"there is a Hopf point of {omega:.4g}{unit} at {name} = {value:.6g}"
    return None


def _contradicted(
    system: System, problem: EquilibriumProblem, found: Trace
) -> tuple[Band, str] | None:
    low, high = system.settings.band
    for place, unstable in _places(system, problem, found):
        if _at_fold(found, place.value):
            continue
        exact = _exact_count(system, problem, place)
        if exact is None or exact == unstable or _shifted(system, problem, found, place):
            continue
        told = f"at {problem.parameter} = {place.value:.6g} there are {exact} exact"
        return (low / _FURTHER, high), f"{told} unstable roots, not {unstable}"
    if not all(_at_fold(found, *interval) for interval in found.unexplained):
        return (low / _FURTHER, high), "the changes of stability are not all explained"
    return None


def _at_fold(found: Trace, *values: float) -> bool:
    """Say whether values of the parameter are a fold's but for rounding."""
    folds = [float(point.z[-1]) for point in found.special if point.label in _STATIC]
    return any(max(abs(value - fold) for value in values) <= ROUNDING * abs(fold) for fold in folds)


def _shifted(system: System, problem: EquilibriumProblem, found: Trace, place: Place) -> bool:
    """Say whether a place lies between a Hopf point of the realisation and the exact one."""
    for point in found.special:
        if point.label != "H" or not point.data.get("omega"):
            continue
        reported = next(_as_places(system, problem, [found.points[point.index]]))
        with suppress(ConvergenceError):
            exact = resolve(system.exact, problem.path, reported, float(point.data["omega"]))
            ends = sorted((reported.value, exact.value))
            if ends[0] <= place.value <= ends[1] and near(place.X, exact.X):
                return True
    return False


def contradicted(system: System, problem: EquilibriumProblem, points: Sequence[Point]) -> Flags:
    """Return at which points (npoints,) the exact equations have another number, or none known."""
    return np.array(
        [
            not point.label and _exact_count(system, problem, place) != point.unstable
            for point, place in zip(points, _as_places(system, problem, points), strict=True)
        ],
        dtype=bool,
    )


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
    special = {point.index for point in found.special}
    for k in (point.index for point in found.special if point.label in _STATIC):
        for j in (k - 1, k + 1):
            if 0 <= k < len(points) and 0 <= j < len(points) and j not in special:
                start, end = _as_places(system, problem, (points[k], points[j]))
                with suppress(ConvergenceError):
                    beyond = beside(system.exact, problem.path, start, end)
                    yield beyond, points[j].unstable


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
        away = (min(abs(p.arclength - start), abs(p.arclength - end)) for p in found.points)
        piece = [k for k, distance in enumerate(away) if a <= k <= b and distance > _BESIDE]
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
