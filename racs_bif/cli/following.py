"""Following branches of orbits for ``racs-bif continue``: from Hopf points, and on from there."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from racs_bif.cli.parser import assignment, number
from racs_bif.errors import RacsBifError

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Callable, Iterable

    from racs_bif.cli.terminal import Task
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
    """What was computed, and what went wrong on the way; `keep` is given every branch done."""

    branches: list[Branch] = field(default_factory=list)
    troubles: list[str] = field(default_factory=list)
    apart: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    interrupted: bool = False
    failure: Exception | None = None
    keep: Callable[[list[Branch]], None] | None = None

    def add(self, branches: Iterable[Branch]) -> None:
        """Take branches that are done, and have them kept."""
        self.branches.extend(branches)
        if self.keep is not None:
            self.keep(self.branches)


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
                    follow_orbits(point, arguments, done, task)
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
        try:
            report = task(f"cascade from {first.name}", span)
            found = period_doubling_cascade(first, arguments.cascade, span=span, progress=report)
        except RacsBifError as error:
            done.troubles.append(f"no cascade from {first.name}: {error}")
            continue
        done.add(found.branches)
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


def follow_orbits(point: SpecialPoint, arguments: Namespace, done: Run, task: Task) -> None:
    """Follow the orbits that leave a point; note where they are those of a known branch."""
    from racs_bif.results.diagram import Diagram
    from racs_bif.verbs.orbits import continue_orbits

    span = (arguments.low, arguments.high)
    named = targets(arguments)
    at = tuple(named.get(arguments.parameter, ())) if set(named) <= {arguments.parameter} else named
    known = Diagram(*done.branches).branches
    try:
        report = task(f"orbits from {point.name}", span)
        method = arguments.orbits if point.label == "H" else None
        branch = continue_orbits(point, span, method=method, at=at, known=known, progress=report)
    except RacsBifError as error:
        done.troubles.append(f"no orbits from {point.name}: {error}")
        return
    met = branch.special[-1].data.get("met") if branch.special else None
    if met is not None and len(branch) <= STUB:
        done.notes.append(f"The orbits from {point.name} are those of {met}.")
        return
    done.add([branch])


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
