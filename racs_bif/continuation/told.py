"""The steps of a branch in the log: a table as AUTO prints it, one line a point."""

from __future__ import annotations

import logging
from itertools import count
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from racs_bif.continuation.points import Point, SpecialPoint
    from racs_bif.continuation.problem import Problem
    from racs_bif.continuation.stopped import Stopped

LOG: Final = logging.getLogger("racs_bif.continuation")
"""INFO: a line for each point of a branch. DEBUG: every trial step, and why it was rejected."""
_NUMBERS: Final = count(1)
_REPEATED: Final = 20
_MEASURES: Final = 3
_WIDTH: Final = 14


class Table:
    """Logs the points of a walk as they become known; nothing where nobody listens.

    Columns: number of the branch (BR) in this process, of the point (PT) on this walk, type (TY),
    number of the label (LAB), the parameter, the norm of the unknowns, the first measures or
    unknowns, how many roots are on the unstable side, the step in arclength and the Newton
    iterations it took.

    Parameters
    ----------
    problem : Problem
        Whose branch it is.
    number : int
        That of the branch.
    sense : int
        +1 or -1, the direction of the walk.
    """

    def __init__(self, problem: Problem, number: int, sense: int) -> None:
        self._problem, self._number = problem, number
        self._told = 0
        self._labels = 0
        self._before: Point | None = None
        way = "forwards" if sense > 0 else "backwards"
        LOG.info("%s, branch %d in %s, %s", problem.name, number, problem.parameter, way)

    def tell(self, nodes: Sequence[tuple[Point, SpecialPoint | None]]) -> None:
        """Log the points that were not yet logged; the last one again if it became special."""
        if 0 < self._told <= len(nodes) and self._before is not nodes[self._told - 1][0]:
            self._told -= 1
        for point, event in nodes[self._told :]:
            if self._told % _REPEATED == 0:
                LOG.info("%s", self._head(point))
            self._told += 1
            self._labels += event is not None
            LOG.info("%s", self._row(point, event))
            self._before = point

    def end(self, stopped: Stopped) -> None:
        """Log why the walk ended."""
        LOG.info("branch %d: %s", self._number, stopped.value)

    def _head(self, point: Point) -> str:
        names = [self._problem.parameter, "norm", *_columns(point)]
        columns = "".join(f"{_cut(name):>{_WIDTH}}" for name in names)
        return (
            f"{'BR':>4}{'PT':>5}  {'TY':<4}{'LAB':>4}{columns}{'unstable':>10}{'step':>10}{'it':>4}"
        )

    def _row(self, point: Point, event: SpecialPoint | None) -> str:
        label = "" if event is None else event.label
        number = "" if event is None else str(self._labels)
        norm = float(np.linalg.norm(point.z[:-1]))
        values = [point.parameter, norm, *_columns(point).values()]
        columns = "".join(f"{value:>{_WIDTH}.6E}" for value in values)
        unstable = "-" if point.stable is None else str(point.unstable)
        step = "" if self._before is None else _step(self._before, point)
        start = f"{self._number:>4}{self._told:>5}  {label:<4}{number:>4}"
        return f"{start}{columns}{unstable:>10}{step:>10}{point.iterations:>4}"


def table(problem: Problem, number: int, sense: int) -> Table | None:
    """Return a table for a walk, or None where nobody listens."""
    return Table(problem, number, sense) if LOG.isEnabledFor(logging.INFO) else None


def next_number() -> int:
    """Return the number of a new branch; 0 where nobody listens."""
    return next(_NUMBERS) if LOG.isEnabledFor(logging.INFO) else 0


def _columns(point: Point) -> dict[str, float]:
    """Return the first measures, or the first unknowns where there are none."""
    shown = point.measures or {f"U({k})": u for k, u in enumerate(point.z[:-1].tolist(), 1)}
    return dict(list(shown.items())[:_MEASURES])


def _cut(name: str) -> str:
    return name if len(name) < _WIDTH else f"{name[: _WIDTH - 3]}.."


def _step(before: Point, point: Point) -> str:
    return f"{abs(point.arclength - before.arclength):.2E}"
