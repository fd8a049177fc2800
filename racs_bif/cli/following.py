"""Following branches of orbits for ``racs-bif continue``: from Hopf points, and on from there."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from racs_bif.cli.journal import Step
from racs_bif.cli.parser import assignment, number
from racs_bif.errors import RacsBifError

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Callable, Iterator

    from racs_bif.cli.journal import Journal
    from racs_bif.cli.terminal import Task
    from racs_bif.continuation.points import Point
    from racs_bif.results.branch import Branch
    from racs_bif.results.cascade import Cascade
    from racs_bif.results.diagram import Diagram
    from racs_bif.results.special import SpecialPoint

SWITCHED: Final = frozenset({"PD", "BPC"})
"""Points of branches of orbits at which others begin."""
STUB: Final = 8
"""Most points of a branch that runs onto a known one at once, and is left out."""


@dataclass
class Run:
    """What was computed, and what went wrong on the way; the journal keeps every step done."""

    branches: list[Branch] = field(default_factory=list)
    troubles: list[str] = field(default_factory=list)
    apart: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    interrupted: bool = False
    failure: Exception | None = None
    journal: Journal | None = None

    @contextmanager
    def step(self, name: str) -> Iterator[None]:
        """Do a step and, if it comes to its end, have it kept with what it adds."""
        branches, troubles, notes = len(self.branches), len(self.troubles), len(self.notes)
        yield
        if self.journal is not None and not self.interrupted:
            told = tuple(self.troubles[troubles:]), tuple(self.notes[notes:])
            self.journal.keep(Step(name, len(self.branches) - branches, *told), self.branches)

    def take(self, name: str, *, leads_on: bool) -> bool:
        """Take a step from the run that this one goes on with, if it was finished there.

        What branches begin at is not on disk: a step that others start from (`leads_on`), at a
        point of its branches, is done again.
        """
        found = None if self.journal is None else self.journal.earlier(name)
        if found is None:
            return False
        step, branches = found
        points = (point.label for branch in branches for point in branch.special)
        if leads_on and not SWITCHED.isdisjoint(points):
            return False
        with self.step(name):
            self.branches.extend(branches)
            self.troubles.extend(step.troubles)
            self.notes.extend(step.notes)
        return True


def follow_on(arguments: Namespace, done: Run, task: Task) -> None:
    """Follow cascades, and the branches that leave at period doublings and branch points."""
    from racs_bif.results.diagram import Diagram

    born = range(len(done.branches))
    for level in range(arguments.branches):
        # the names are those of the diagram: a second PD1 is PD2
        branches = Diagram(*done.branches).branches
        later = [branches[k] for k in born if branches[k].kind == "orbit"]
        born = range(len(branches), len(branches))
        for branch in later:
            for point in branch.special:
                left = point.label in SWITCHED and not (level and point.index == 0)
                if left and not done.interrupted:
                    leads_on = level + 1 < arguments.branches or bool(arguments.cascade)
                    follow_orbits(point, arguments, done, task, leads_on=leads_on)
        born = range(born.start, len(done.branches))
    if arguments.cascade:
        _follow_cascades(arguments, done, task)


def _follow_cascades(arguments: Namespace, done: Run, task: Task) -> None:
    from racs_bif.results.diagram import Diagram
    from racs_bif.verbs.cascade import period_doubling_cascade

    span = (arguments.low, arguments.high)
    branches = Diagram(*done.branches).branches
    for branch in branches:
        first = next((point for point in branch.special if point.label == "PD"), None)
        if branch.kind != "orbit" or first is None or done.interrupted:
            continue
        name = f"cascade from {first.name}"
        if done.take(name, leads_on=False):
            continue
        with done.step(name):
            try:
                found = period_doubling_cascade(
                    first, arguments.cascade, span=span, progress=task(name, span)
                )
            except RacsBifError as error:
                done.troubles.append(f"no {name}: {error}")
                continue
            done.branches.extend(found.branches)
            done.notes.append(f"Cascade from {first.name} of {branch.name}:\n{cascade_text(found)}")


def cascade_text(cascade: Cascade) -> str:
    """Return the doublings of a cascade in lines: where, period, ratio of the distances."""
    ratios = ["-", "-", *(f"{ratio:.5g}" for ratio in cascade.ratios)]
    lines = [
        f"  {cascade.parameter} = {value:<14.10g} period {point.period:<12.8g} ratio {ratio}"
        for value, point, ratio in zip(cascade.values, cascade.doublings, ratios, strict=False)
    ]
    if len(cascade.values) > 2:
        limit, error = cascade.limit
        lines.append(
            f"  by Feigenbaum's number it ends at {cascade.parameter} = {limit:.8g} +- {error:.1e}"
        )
    return "\n".join([*lines, f"  {cascade.stopped}"])


def follow_orbits(
    point: SpecialPoint, arguments: Namespace, done: Run, task: Task, *, leads_on: bool
) -> None:
    """Follow the orbits that leave a point, unless an earlier run did; `leads_on` as in `take`."""
    name = f"orbits from {point.name}"
    if done.take(name, leads_on=leads_on):
        return
    with done.step(name):
        _follow_orbits(point, arguments, done, task(name, (arguments.low, arguments.high)))


def _follow_orbits(
    point: SpecialPoint, arguments: Namespace, done: Run, report: Callable[[Point], None] | None
) -> None:
    """Note instead where they are those of a known branch."""
    from racs_bif.results.diagram import Diagram
    from racs_bif.verbs.orbits import continue_orbits

    span = (arguments.low, arguments.high)
    named = targets(arguments)
    at = tuple(named.get(arguments.parameter, ())) if set(named) <= {arguments.parameter} else named
    known = Diagram(*done.branches).branches
    try:
        method = arguments.orbits if point.label == "H" else None
        branch = continue_orbits(point, span, method=method, at=at, known=known, progress=report)
    except RacsBifError as error:
        done.troubles.append(f"no orbits from {point.name}: {error}")
        return
    met = branch.special[-1].data.get("met") if branch.special else None
    if met is not None and len(branch) <= STUB:
        done.notes.append(f"The orbits from {point.name} are those of {met}.")
        return
    done.branches.append(branch)


def targets(arguments: Namespace) -> dict[str, list[float]]:
    """Return the values wanted exactly by the names of their quantities."""
    found: dict[str, list[float]] = {}
    for name, value in arguments.at:
        found.setdefault(name or arguments.parameter, []).append(value)
    return found


def wanted(text: str) -> tuple[str, float]:
    """Return the name, empty for the parameter, and the value of ``[NAME=]VALUE``.

    Raises
    ------
    argparse.ArgumentTypeError
        If the text is none.
    """
    return assignment(text) if "=" in text else ("", number(text))


def more_branches(diagram: Diagram, arguments: Namespace) -> list[str]:
    """Say from which points further branches could be followed."""
    if arguments.branches or arguments.cascade:
        return []
    names = [
        point.name
        for branch in diagram
        if branch.kind == "orbit"
        for point in branch.special
        if point.label in SWITCHED
    ]
    if not names:
        return []
    return [f"Other branches of orbits begin at {', '.join(names)}: --branches 1 follows them."]


def tell_note(note: str, arguments: Namespace) -> None:
    """Print a note beneath the tables."""
    from racs_bif.cli.terminal import console

    console(arguments).print(f"\n{note}")
