"""Period-doubling cascades, followed from doubling to doubling."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.continuation.settings import StepSettings
from racs_bif.continuation.stopped import Stopped
from racs_bif.errors import ConvergenceError, UsageError
from racs_bif.numerics.threads import single_threaded
from racs_bif.results.cascade import FEIGENBAUM, Cascade
from racs_bif.verbs.equilibria import check_span
from racs_bif.verbs.orbit_start import beginning
from racs_bif.verbs.orbits import STEPS, follow_orbits

if TYPE_CHECKING:
    from collections.abc import Callable

    from racs_bif.continuation.points import Point
    from racs_bif.orbits.methods import Settings
    from racs_bif.results.branch import Branch
    from racs_bif.results.special import SpecialPoint

_REACH: Final = 4.0
"""Span of a branch of the cascade, over the distance at which its doubling is expected."""
_FIRST: Final = 0.02
"""First step of such a branch."""


@single_threaded
def period_doubling_cascade(
    point: SpecialPoint,
    depth: int = 4,
    *,
    span: tuple[float, float] | None = None,
    method: str = "collocation",
    settings: Settings | None = None,
    progress: Callable[[Point], None] | None = None,
) -> Cascade:
    """Follow a period-doubling cascade from branch to branch.

    Every branch of orbits is followed to its first doubling, where that of twice the period is
    taken. From the second on it is looked for where the Feigenbaum number expects it, and on the
    whole span where it is not there.

    Parameters
    ----------
    point : SpecialPoint
        A Hopf point, or an orbit: PD is left at once, any other is followed to its first PD.
    depth : int
        How many doublings are wanted.
    span : (float, float), optional
        Interval of the parameter; that of the point's own branch where left out.
    method : str
        ``collocation``, ``shooting`` or ``harmonic-balance``; that of the point's branch, where it
        is one of orbits.
    settings : OrbitSettings, CollocationSettings or BalanceSettings, optional
        How orbits are resolved.
    progress : callable, optional
        Called with every new point.

    Returns
    -------
    Cascade
        Branches PO1, PO2, ... with their doublings, the ratios of distances between these, and the
        limit that they foretell.

    Raises
    ------
    UsageError
        If the depth is not at least 1, or no orbits start at the point.
    ConvergenceError
        If there is no orbit at the start.
    """
    if depth < 1:
        msg = f"a cascade has a depth of at least 1, not {depth!r}"
        raise UsageError(msg)
    wanted = method if point.label == "H" else None
    start = beginning(point, None, wanted, settings)
    parameter = start.begun.problem.parameter
    whole = span or start.span
    if whole is None:
        msg = f"give the span of '{parameter}': {point.name} lies on no branch that varies it"
        raise UsageError(msg)
    whole = check_span(start.system, parameter, whole)
    branches: list[Branch] = []
    doublings: list[SpecialPoint] = [point] if point.label == "PD" else []
    while len(doublings) < depth:
        number = len(branches) + 1
        near = _expected(doublings, parameter, whole)
        branch = None
        for tried in dict.fromkeys((near, whole)):
            try:
                branch = _to_doubling(start, tried, number, progress)
            except ConvergenceError:
                if tried == whole:
                    raise
                continue
            if _first(branch) is not None:
                break
        assert branch is not None
        branches.append(branch)
        found = _first(branch)
        if found is None:
            stopped = (
                f"{branch.name} has no period doubling from {whole[0]:g} to {whole[1]:g}. "
                f"{branch.stopped}"
            )
            return Cascade(tuple(branches), tuple(doublings), stopped)
        doublings.append(found)
        if len(doublings) < depth:
            start = beginning(found, None, None, None)
    return Cascade(tuple(branches), tuple(doublings), "The depth that was asked for is reached.")


def _to_doubling(
    start: object, span: tuple[float, float], number: int, progress: Callable[[Point], None] | None
) -> Branch:
    """Follow a branch to its first doubling."""
    steps = StepSettings(initial=_FIRST, maximum=STEPS.maximum, tolerance=STEPS.tolerance)
    branch = follow_orbits(
        start,  # type: ignore[arg-type] # a Beginning
        span,
        settings=steps,
        progress=progress,
        until=_Doubled(),
    )
    name = f"PO{number}"
    special = tuple(replace(point, branch=name) for point in branch.special)
    return replace(branch, name=name, special=special)


@dataclass
class _Doubled:
    """Ends a branch once a multiplier has passed -1."""

    before: int | None = None

    def __call__(self, before: Point, point: Point) -> Stopped | None:
        """Return `Stopped.FOUND` where the number of multipliers below -1 has changed."""
        first, last = _below(before), _below(point)
        return Stopped.FOUND if first is not None and last not in {first, None} else None


def _below(point: Point) -> int | None:
    """Return how many multipliers are below -1; None where there are none at all."""
    others = point.spectrum[1:]
    if not len(others):
        return None
    return int(np.count_nonzero((others.imag == 0.0) & (others.real < -1.0)))


def _first(branch: Branch) -> SpecialPoint | None:
    return next((point for point in branch.special if point.label == "PD"), None)


def _expected(
    doublings: list[SpecialPoint], parameter: str, whole: tuple[float, float]
) -> tuple[float, float]:
    """Return where the next doubling is expected, by the last two."""
    if len(doublings) < 2:
        return whole
    before, last = (point.parameters[parameter] for point in doublings[-2:])
    reach = _REACH * abs(last - before) / FEIGENBAUM
    return max(last - reach, whole[0]), min(last + reach, whole[1])
