"""Where a curve in two parameters starts: a special point found in one of them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from racs_bif.errors import RacsBifError, UsageError

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Iterator

    from racs_bif.fractional.system import System
    from racs_bif.results.branch import Branch
    from racs_bif.results.diagram import Diagram
    from racs_bif.results.special import SpecialPoint

_CYCLES: Final = ("LPC", "PD", "NS", "EP")
_PROBES: Final = 6


def starting_point(
    system: System,
    arguments: Namespace,
    label: str,
    span: tuple[float, float],
    task: Any,  # noqa: ANN401 - of the terminal
) -> SpecialPoint:
    """Return the first special point of a label, or the one that the user names.

    Raises
    ------
    UsageError
        If there is none; the message says which there are.
    """
    from racs_bif.results.diagram import Diagram

    troubles: list[str] = []
    found: list[Branch] = []
    for more in _searches(system, arguments, label, (span, task), troubles):
        found += more
        diagram = Diagram(*found)
        there = _fitting(diagram, label)
        for point in there:
            if arguments.point in {None, point.name}:
                return point
    there = _fitting(Diagram(*found), label)
    names = ", ".join(point.name for point in there)
    if there:
        msg = f"no point '{arguments.point}'; there are: {names}"
    else:
        low, high = span
        what = "orbit that tends to a homoclinic one" if label == "EP" else label
        msg = f"no {what} as {arguments.first} goes from {low:g} to {high:g}; give another --span"
        msg += f" ({'; '.join(troubles)})" if troubles else ""
    raise UsageError(msg)


def _fitting(diagram: Diagram, label: str) -> list[SpecialPoint]:
    """Return the points of a label; of end points, those that tend to a homoclinic orbit."""
    points = [point for point in diagram.special_points if point.label == label]
    if label != "EP":
        return points
    return [point for point in points if point.data.get("connection") == "homoclinic"]


def _searches(
    system: System,
    arguments: Namespace,
    label: str,
    where: tuple[tuple[float, float], Any],
    troubles: list[str],
) -> Iterator[list[Branch]]:
    """Give branches, the cheap and likely ones first."""
    from racs_bif.verbs.all_equilibria import all_equilibria

    span, task = where
    first: Diagram | None = None
    for probes in (0, _PROBES):
        report = task("equilibria", span)
        equilibria = all_equilibria(system, arguments.first, span, probes=probes, progress=report)
        new = [b for b in equilibria if first is None or b.name not in {a.name for a in first}]
        first = equilibria
        yield new
        if label in _CYCLES:
            for branch in new:
                yield from _orbits(branch, arguments, (span, task), troubles)


def _orbits(
    branch: Branch,
    arguments: Namespace,
    where: tuple[tuple[float, float], Any],
    troubles: list[str],
) -> Iterator[list[Branch]]:
    """Give the branches of orbits from the Hopf points of a branch, and on from theirs."""
    from racs_bif.verbs.orbits import continue_orbits

    span, task = where
    waiting = [(point, 0) for point in branch.special if point.label == "H"]
    while waiting:
        point, level = waiting.pop(0)
        report = task(f"orbits from {point.name}", span)
        try:
            orbits = continue_orbits(point, span, method="collocation", progress=report)
        except RacsBifError as error:
            troubles.append(f"no orbits from {point.name}: {error}")
            continue
        if level < arguments.branches:
            more = [p for p in orbits.special if p.label in {"PD", "BPC"}]
            waiting += [(p, level + 1) for p in more]
        yield [orbits]
