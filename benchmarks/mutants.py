"""Mutants of the numerics: which small changes of the code does no test notice.

Run ``python -m benchmarks.mutants`` in an environment that has the test extra and cosmic-ray, which
makes the mutants (``pip install cosmic-ray``; the package does not depend on it). All the mutants
there are of `continuation/` and `fractional/` stand in one order, random with a fixed seed, changes
of constants last; a run takes them from the beginning and goes on where the last one stopped. Each
is shown to the tests that execute its line, the shortest first, in a process forked for it.

What is done is in a file of one JSON line a mutant. ``--again`` shows the survivors once more,
after tests were added or with a larger ``--budget``. Outcomes and explanations of the survivors are
kept in ``benchmarks/MUTANTS.md``.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import signal
import sys
import time
import warnings
from collections import Counter
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from benchmarks._forked import AT_FIRST, Changed, Watch, in_child, pytest, ready
from benchmarks._mutating import Mutant, made, population
from benchmarks._reach import Reach, files, measured

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

OUTCOMES: Final = ("killed", "too long", "survived")
_CLOCKS: Final = (signal.SIGPROF, signal.SIGALRM)
SLOWER: Final = 2.0
"""The tests of a mutant may take this many times the budget, before the next is left out."""
AT_ONCE: Final = 1.0
"""Seconds of the tests that are run before the files of the others are imported."""

Row = dict[str, Any]


def shown(mutant: Mutant, row: Row, reach: Reach, given: argparse.Namespace) -> Row:
    """Show one mutant to the tests that may notice it; return what became of it.

    `row` is what is known of it: tests that it was shown to are left out.
    """
    tests = [test for group in reach.tests(mutant) for test in group]
    if given.matching:
        tests = [test for test in tests if re.search(given.matching, test)]
        left = row["left"] + len(tests)
    else:
        tests = tests[row.get("shown", 0) :]
        left = len(tests)
    batches = _batches(reach, tests, given.budget)
    row = {"shown": 0} | row | {"outcome": "survived", "by": "", "left": left}
    begun = time.perf_counter()
    for line in in_child(partial(_show, mutant, batches, given)):
        word, _, rest = line.partition(" ")
        if word == "began":
            row |= {"last": rest, "shown": row["shown"] + 1, "left": row["left"] - 1}
        elif word == "failed":
            row |= {"outcome": "killed", "by": row["by"] or rest}
        elif word == "made":
            row |= json.loads(rest)
        elif word == "ended" and rest != "0" and row["outcome"] == "survived":
            clocks = (f"-{clock:d}" for clock in _CLOCKS)
            row |= {"outcome": "too long" if rest in clocks else "killed", "by": row.get("last")}
    row.pop("last", None)
    return asdict(mutant) | row | {"seconds": round(time.perf_counter() - begun, 2)}


def _batches(reach: Reach, tests: list[str], budget: float) -> list[dict[str, float]]:
    """Return the tests that the budget allows, with their shares, in two batches."""
    batches: list[dict[str, float]] = [{}, {}]
    spent = 0.0
    for test in tests:
        spent += reach.seconds[test]
        if spent > budget:
            break
        batches[spent > AT_ONCE][test] = reach.share(test)
    return [batch for batch in batches if batch]


def _show(
    mutant: Mutant,
    batches: list[dict[str, float]],
    given: argparse.Namespace,
    tell: Callable[[str], None],
) -> None:
    try:
        text, old, new = made(mutant)
    except AttributeError:  # cosmic-ray does not replace `a.b` among the exceptions caught
        tell("made " + json.dumps({"outcome": "no mutant"}))
        return
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            code = compile(text, str(mutant.path), "exec", dont_inherit=True)
    except SyntaxError:
        tell("made " + json.dumps({"old": old, "new": new, "outcome": "no mutant"}))
        return
    tell("made " + json.dumps({"old": old, "new": new}))
    sys.meta_path.insert(0, Changed(mutant.imported_as, mutant.path, code))
    for batch in batches:
        paths = dict.fromkeys(test.partition("::")[0] for test in batch)
        watch = Watch(tell, given.scratch / "cache", batch, until=AT_FIRST + SLOWER * given.budget)
        if pytest(paths, watch):
            return


def _worked(todo: list[tuple[Mutant, Row]], reach: Reach, given: argparse.Namespace) -> None:
    """Show one mutant after the other, and write down what became of each."""
    until = time.monotonic() + 60.0 * given.minutes
    for mutant, row in todo:
        if time.monotonic() > until:
            return
        told = json.dumps(shown(mutant, row, reach, given))
        with _log(given).open("a", encoding="utf-8") as file:
            file.write(told + "\n")


def _log(given: argparse.Namespace) -> Path:
    scratch: Path = given.scratch
    return scratch / "outcomes.jsonl"


def _known(given: argparse.Namespace) -> dict[Mutant, Row]:
    names = ("folder", "module", "operator", "occurrence", "line")
    lines = _log(given).read_text(encoding="utf-8").splitlines() if _log(given).exists() else []
    rows = (json.loads(line) for line in lines)
    return {Mutant(**{name: row[name] for name in names}): row for row in rows}


def _todo(
    mutants: list[Mutant], known: dict[Mutant, Row], given: argparse.Namespace
) -> Iterator[tuple[Mutant, Row]]:
    """Yield the mutants that are to be shown, with what is known of them."""
    for mutant in mutants:
        row = known.get(mutant, {})
        survived = row.get("outcome") == "survived"
        if given.matching:
            if survived:
                yield mutant, row
        elif not row or (given.again and survived):
            yield mutant, {}
        elif given.further and survived and row["left"]:
            yield mutant, row


def _reach(given: argparse.Namespace) -> Reach:
    """Return which tests execute which lines; a test that fails by itself ends the run."""
    of = {file: measured(file, given.scratch) for file in files()}
    for file, each in of.items():
        if each.failed or not each.seconds:
            sys.exit(f"{file} fails by itself: {', '.join(each.failed)}")
    return Reach(of)


def table(rows: list[Row], all_of_them: list[Mutant]) -> Iterator[str]:
    """Yield the lines of a table by module, then each survivor in one line."""
    counts = Counter((f"{row['folder']}/{row['module']}", row["outcome"]) for row in rows)
    there = Counter(f"{mutant.folder}/{mutant.module}" for mutant in all_of_them)
    yield "| module | " + " | ".join(OUTCOMES) + " | not run |"
    yield "|---|" + "---:|" * (len(OUTCOMES) + 1)
    for module in (*sorted(there), "all"):
        chosen = {outcome: n for (of, outcome), n in counts.items() if of == module}
        if module == "all":
            chosen = dict(Counter(row["outcome"] for row in rows))
        numbers = [chosen.get(outcome, 0) for outcome in OUTCOMES]
        left = (there[module] or len(all_of_them)) - sum(chosen.values())
        yield f"| {module} | " + " | ".join(map(str, (*numbers, left))) + " |"
    yield ""
    for row in sorted(rows, key=lambda row: (row["folder"], row["module"], row["line"])):
        if row["outcome"] == "survived":
            where = f"{row['folder']}/{row['module']}.py:{row['line']}"
            yield f"{where}: - {row['old']}  + {row['new']}  ({row['shown']} tests)"


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, help="how many mutants; all if not given")
    parser.add_argument("--minutes", type=float, default=1e6, help="after which none is begun")
    parser.add_argument("--budget", type=float, default=10.0, help="seconds of tests for a mutant")
    parser.add_argument("--processes", type=int, default=2, help="mutants at a time")
    parser.add_argument("--seed", type=int, default=9, help="of the order")
    parser.add_argument("--scratch", type=Path, default=Path("mutants"), help="folder to work in")
    parser.add_argument("--again", action="store_true", help="show the survivors once more")
    more = "show survivors the tests that the budget left out"
    only = "show survivors the tests, new ones say, whose names match this regular expression"
    parser.add_argument("--matching", help=only)
    parser.add_argument("--further", action="store_true", help=more)
    parser.add_argument("--table", action="store_true", help="only print what is done")
    given = parser.parse_args()
    given.scratch = given.scratch.resolve()
    return given


def main() -> None:
    """Show the mutants that are not done, and print what there is."""
    given = _arguments()
    wanted = population(given.seed)[: given.count]
    todo = [] if given.table else list(_todo(wanted, _known(given), given))
    if todo:
        ready(("coverage",))
        reach = _reach(given)
        ready(reach.imported)
        children = []
        for k in range(given.processes):
            children.append(os.fork())
            if not children[-1]:
                _worked(todo[k :: given.processes], reach, given)
                os._exit(0)
        for child in children:
            os.waitpid(child, 0)
    known = _known(given)
    print("\n".join(table([known[m] for m in wanted if m in known], wanted)))


if __name__ == "__main__":
    main()
