"""Whether the events found explain which eigenvalues changed side."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from racs_bif.numerics.eigen import match

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from racs_bif.continuation.points import Point
    from racs_bif.continuation.problem import Problem

_CHEAP = 200


def unexplained(problem: Problem, a: Point, b: Point, crossings: Iterable[int]) -> str:
    """Say what the events between two points leave unexplained.

    The number of unstable eigenvalues must change by a sum of the events' crossings, each up or
    down. Crossings in opposite directions cancel in that number: they are seen by following each
    eigenvalue to the nearest one at the other point.

    Parameters
    ----------
    problem : Problem
        Knows the sides.
    a, b : Point
        Two points, one after another.
    crossings : iterable of int
        How many eigenvalues change side at each event between them.

    Returns
    -------
    str
        Empty if all is explained.
    """
    if a.stable is None or b.stable is None:
        return ""  # there is no spectrum, or it is too poor to count by
    counts = [count for count in crossings if count]
    change = b.unstable - a.unstable
    sums = {0}
    for count in counts:
        sums = {total + sign * count for total in sums for sign in (1, -1)}
    if change not in sums:
        return f"the number of unstable eigenvalues goes from {a.unstable} to {b.unstable}"
    crossed = _crossed(problem, a, b)
    if crossed > sum(counts):
        return f"{crossed} eigenvalues cross, some each way"
    return ""


def hides_others(problem: Problem, a: Point, b: Point, events: Sequence[tuple[Point, int]]) -> bool:
    """Say whether the spectra at events show that there are more of them between two points.

    On one side of an event there are as many unstable eigenvalues as at it without those on the
    axis, on the other side as many as with all of them. Sums do not tell: where a fold makes one
    unstable and a Hopf point two, one in the end may be two and one less, or all three and a
    second Hopf point that was not found. Where the spectrum is rough either side may be the one.

    Parameters
    ----------
    problem : Problem
        Knows the sides.
    a, b : Point
        Two points, one after another.
    events : sequence of (Point, int)
        What was found between them, in order, and how many eigenvalues change side there.
    """
    if a.stable is None or b.stable is None:
        return False
    possible = {a.unstable}
    for point, count in events:
        if not count:
            continue
        rest = problem.unstable_beside(point.spectrum, count)
        if rest is None:
            return False
        sides = {rest, rest + count}
        before = possible & sides
        if not before:
            return True
        possible = sides if problem.rough else {2 * rest + count - one for one in before}
    return b.unstable not in possible


def _crossed(problem: Problem, a: Point, b: Point) -> int:
    """Return how many eigenvalues changed side, as far as that is cheap to tell."""
    size = len(a.spectrum)
    one_way = min(a.unstable, b.unstable) == 0
    if one_way or len(b.spectrum) != size or size > _CHEAP:
        return abs(b.unstable - a.unstable)
    if not (np.isfinite(a.spectrum).all() and np.isfinite(b.spectrum).all()):
        return abs(b.unstable - a.unstable)
    places = match(a.spectrum, b.spectrum)
    return int(np.count_nonzero(problem.sides(a.spectrum) != problem.sides(b.spectrum)[places]))
