"""Whether the events found explain which eigenvalues changed side."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from racs_bif.numerics.eigen import match

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from racs_bif.continuation.points import Point
    from racs_bif.continuation.problem import Problem
    from racs_bif.numerics.eigen import Spectrum

_CHEAP = 200
_CLEAR = 4.0
"""An eigenvalue is followed where the others are this many times farther away than it moves."""


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
    second Hopf point that was not found. Nor do counts where another pair crosses each way; it is
    seen from one event to the next, if it has not met others.

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
    before, others = a.spectrum, np.ones(len(a.spectrum), dtype=bool)
    for point, count in events:
        if not count:
            continue
        critical = problem.on_axis(point.spectrum, count)
        if critical is None:
            return False
        rest = problem.unstable(point.spectrum[~critical])
        possible = {2 * rest + count - one for one in possible & {rest, rest + count}}
        if not possible or _strays(problem, before[others], point.spectrum[~critical]):
            return True
        before, others = point.spectrum, ~critical
    return b.unstable not in possible or (
        not others.all() and _strays(problem, before[others], b.spectrum)
    )


def _strays(problem: Problem, before: Spectrum, after: Spectrum) -> bool:
    """Say whether a pair changes side that can be told from all others at both ends."""
    pairs = before[before.imag > 0.0]
    cheap = 1 < min(len(before), len(after)) <= max(len(before), len(after)) <= _CHEAP
    if not (cheap and len(pairs) and np.isfinite(before).all() and np.isfinite(after).all()):
        return False
    distance = np.abs(pairs[:, None] - after[None, :])
    nearest = distance.argmin(axis=1)
    moved = distance.min(axis=1)
    here = np.sort(np.abs(pairs[:, None] - before[None, :]), axis=1)[:, 1]  # the first is itself
    there = np.sort(np.abs(after[nearest][:, None] - after[None, :]), axis=1)[:, 1]
    clear = (after[nearest].imag > 0.0) & (_CLEAR * moved < np.minimum(here, there))
    return bool(np.any(problem.sides(pairs)[clear] != problem.sides(after[nearest])[clear]))


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
