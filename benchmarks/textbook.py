"""Four problems of the textbooks by racs_bif, AUTO-07p and Python peers: cost, and what is found.

Run ``python -m benchmarks.textbook --peers FOLDER``; with ``--install`` the peers are installed
there first, each in a virtual environment of its own. It prints the table of README.

Every program follows the equilibria, and the orbits born at the first Hopf point, with everything
detected: collocation with 40 intervals of degree 4, Newton's tolerance 1e-8, special points located
to 1e-7; racs_bif has its own steps and also runs by shooting, its default. AUTO and the peers built
on it have one set of steps, for at most as many points as ours, and eight Newton steps where five
are usual: with five, xpplab takes up to four times as many points and finds nothing more. Their
orbits of Lorenz's equations end after 32 points, at a period of 8.9; those of the axon where they
have come to the second Hopf point. Ten times shorter steps find them no more of the axon's points.

Times are CPU seconds of one thread, the least of ``--least`` runs. First: with an empty cache of
compiled models (racs_bif) or nothing compiled (AUTO). Cold: a whole process, start of Python and
imports included. Warm: again in the same process; AUTO has none, and is given its cold time. bifpy
compiles in every run. The ratio is of warm times to the first row of the problem.

Errors are relative, the largest of: the parameter at every known point found, of a homoclinic orbit
that at which the orbits end or are said to, and the period of the last Brusselator cycle, against a
simulation to 1e-12. Points reported that do not exist are counted as wrong, save folds and
branch points of orbits at the Hopf point where they are born or end.
"""

from __future__ import annotations

import argparse
import platform
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path
from subprocess import CalledProcessError
from typing import TYPE_CHECKING, Final

from benchmarks import _auto
from benchmarks._peers import NOT_DRIVEN, PEERS, by_auto, install, last_line, run
from benchmarks._textbook import PROBLEMS, score

if TYPE_CHECKING:
    from collections.abc import Callable

    from benchmarks._peers import Cost
    from benchmarks._textbook import Problem

OURS: Final = (("racs_bif", "collocation"), ("racs_bif, shooting", "shooting"))
OUR_DRIVER: Final = "benchmarks._by_racs_bif"
AUTO: Final = "AUTO-07p"
HEAD: Final = (
    "| problem | program | first, s | cold, s | warm, s | ratio | points | known | wrong | error |",
    "|---|---|--:|--:|--:|--:|--:|--:|--:|--:|",
)


def row(problem: Problem, program: str, cost: Cost, ours: Cost) -> str:
    """Return a row of the table."""
    result = score(problem, cost.found)
    known = result.found + len(result.missed)
    cells = (
        problem.title,
        program,
        "" if cost.first is None else f"{cost.first:.2f}",
        f"{cost.cold:.2f}",
        f"{cost.warm:.2f}",
        f"{cost.warm / ours.warm:.2f}",
        str(cost.found.points),
        f"{result.found} of {known}",
        str(len(result.wrong)),
        f"{result.error:.0e}",
    )
    return f"| {' | '.join(cells)} |"


def absent(problem: Problem, program: str) -> str:
    """Return the row of a program without figures; a note has the reason."""
    return f"| {problem.title} | {program} | not run: see below {'|' * 8}"


def notes(problem: Problem, program: str, cost: Cost) -> list[str]:
    """Return what a program missed and what it reported wrongly."""
    result = score(problem, cost.found)
    found = [f"{program} misses {what}" for what in result.missed]
    found += [f"{program} reports {what}, which is not there" for what in result.wrong]
    return [f"- {problem.title}: {text}." for text in found]


def attempt(measure: Callable[[], Cost]) -> Cost | str:
    """Return what a program took, or why it could not be run."""
    try:
        return measure()
    except (RuntimeError, CalledProcessError, StopIteration, OSError) as error:
        return last_line(str(error)) or type(error).__name__


def measured(
    problem: Problem, peers: Path | None, failed: dict[str, str], least: int
) -> dict[str, Cost | str]:
    """Measure all programs on a problem; text is why one has no figures."""
    costs: dict[str, Cost | str] = {}
    for program, method in OURS:
        costs[program] = run(sys.executable, OUR_DRIVER, problem, least, method)
    costs[AUTO] = attempt(lambda: by_auto(problem, least)) if _auto.available() else _auto.MISSING
    for peer in PEERS:
        name = f"{peer.name} {peer.version}"
        if peer.name in failed:
            costs[name] = failed[peer.name]
        elif peers is None or not python_of(peers, peer.name).exists():
            costs[name] = "not installed: give --peers FOLDER and --install"
        else:
            python = str(python_of(peers, peer.name))
            costs[name] = attempt(lambda: run(python, peer.driver, problem, least))  # noqa: B023 - called now
    return costs


def python_of(peers: Path, name: str) -> Path:
    """Return the Python of a peer."""
    return peers.absolute() / name / "bin" / "python"


def table(problem: Problem, costs: dict[str, Cost | str]) -> tuple[list[str], list[str]]:
    """Return the rows of a problem, and what is missed, is wrong or was not run."""
    lines, beneath, ours = [], [], costs[OURS[0][0]]
    for program, cost in costs.items():
        if isinstance(cost, str) or isinstance(ours, str):
            lines.append(absent(problem, program))
            beneath.append(f"- {problem.title}: {program} was not run: {cost}.")
        else:
            lines.append(row(problem, program, cost, ours))
            beneath += notes(problem, program, cost)
    return lines, beneath


def machine() -> str:
    """Return what the figures were measured on and with."""
    told = Path("/proc/cpuinfo").read_text() if Path("/proc/cpuinfo").exists() else ""
    names = [line.split(":", 1)[1].strip() for line in told.splitlines() if "model name" in line]
    versions = [f"{name} {version(name)}" for name in ("numpy", "scipy")]
    asked = ["dpkg-query", "-W", "-f", "${Version}", "auto-07p"]
    try:
        package = subprocess.run(asked, capture_output=True, text=True, check=True).stdout
    except (OSError, CalledProcessError):
        package = "of unknown version"
    versions += [f"AUTO-07p {package}", *(f"{peer.name} {peer.version}" for peer in PEERS)]
    processor = names[0] if names else platform.processor()
    return f"{processor}; Python {platform.python_version()}, {', '.join(versions)}"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description="textbook problems by racs_bif and others")
    parser.add_argument("--peers", type=Path, help="folder of the peers' virtual environments")
    parser.add_argument("--install", action="store_true", help="install the peers there first")
    parser.add_argument("--problems", nargs="+", choices=list(PROBLEMS), default=list(PROBLEMS))
    parser.add_argument("--least", type=int, default=3, help="of how many runs the least is taken")
    options = parser.parse_args()
    if options.install and options.peers is None:
        parser.error("--install needs --peers FOLDER")
    failed = install(options.peers.absolute()) if options.install else {}
    print("\n".join(HEAD))
    beneath = []
    for name in options.problems:
        costs = measured(PROBLEMS[name], options.peers, failed, options.least)
        lines, told = table(PROBLEMS[name], costs)
        print("\n".join(lines), flush=True)
        beneath += told
    beneath += [f"- {name} has no rows: {reason}." for name, reason in NOT_DRIVEN.items()]
    print("\n".join(["", *beneath]))
    print(f"\nMeasured on {machine()}.")


if __name__ == "__main__":
    main()
