"""What every program's driver does: run a problem, in its own process, and say what it took.

A driver is run as ``python -m benchmarks._by_NAME RUNS`` by the Python that has the program, with
the problem as JSON on standard input; it prints what was found as JSON on its last line. Nothing
is imported here but the standard library, so that a cold process has the program's own imports.
"""

from __future__ import annotations

import json
import resource
import sys
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

ON_EQUILIBRIA: Final = {"HB": "H", "LP": "LP", "BP": "BP"}
ON_ORBITS: Final = {"LP": "LPC", "BP": "BPC", "PD": "PD", "TR": "NS"}
"""Our names of AUTO's labels."""


def in_our_names(labels: Iterable[tuple[str, float]], *, orbits: bool) -> list[tuple[str, float]]:
    """Return AUTO's special points by our labels; other labelled points are left out."""
    names = ON_ORBITS if orbits else ON_EQUILIBRIA
    return [(names[label], value) for label, value in labels if label in names]


def spent_so_far() -> float:
    """Return the CPU time of this process and of its children that have ended, in seconds."""
    total = 0.0
    for whose in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN):
        used = resource.getrusage(whose)
        total += used.ru_utime + used.ru_stime
    return total


def drive(run: Callable[[dict[str, Any]], dict[str, Any]]) -> None:
    """Run the problem on standard input as often as the command line says and print the result."""
    problem, seconds, found = json.load(sys.stdin), [], {}
    for _ in range(int(sys.argv[1])):
        before = spent_so_far()
        found = run(problem)
        seconds.append(spent_so_far() - before)
    print("\n" + json.dumps(found | {"seconds": seconds}))
