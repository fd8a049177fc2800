"""The hot paths: their cost against a reference kernel and their peak memory, beside baselines.

Run ``python -m benchmarks.hot_paths``. Each path has a process of its own, whose peak memory is
given, Python and packages included. Its CPU time is given as a ratio to a reference kernel that is
measured in turn with it, so that a slower or busier machine does not look like a slower program.
Both are compared with `baselines.json`: a path with a ratio above 1.5 times its baseline's, or more
than 1.25 times the memory, is measured once more, and if it still is, it is named and the exit
status is 1. ``--store`` makes what was measured the baseline; the history of that file in git is
the history of our speed.

Neither asv nor pytest-benchmark does this. Both compare times of one machine with times of the same
machine; what is kept here is compared on any. asv's own environments, one a commit, and
pytest-benchmark's in-process clock would both remain unused beside a measurement of our own; what
they would do for us is the file, the comparison and the table: what is in this module and in
`_baselines`.
"""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import asdict
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

import racs_bif as rb
from benchmarks import _baselines, _kernel
from benchmarks._baselines import Cost, Stored
from benchmarks._paths import MODELS, PATHS
from benchmarks._spent import Spent, spent

PROGRAMS: Final = {
    "import": ("import racs_bif, the whole process", ("-c", "import racs_bif")),
    "help": ("python -m racs_bif --help", ("-m", "racs_bif", "--help")),
}
"""Whole processes: what they are, and their arguments for Python."""
STARTS: Final = ("-c", "import argparse, ast, dataclasses, json, typing")
"""The reference of these: a Python that imports a little of its standard library."""
TITLES: Final = {name: path.title for name, path in PATHS.items()} | {
    name: title for name, (title, _) in PROGRAMS.items()
}
HEAD: Final = f"{'':18s} {'CPU, ms':>9s} {'ratio':>9s} {'change':>7s} {'MB':>6s} {'change':>7s}"
ROOT: Final = Path(__file__).parent.parent


def ours(folder: Path, *arguments: str) -> Spent:
    """Run this module in a process of its own; compiled models are kept in the folder.

    Sets have the same order in every process.
    """
    return spent(
        [sys.executable, "-m", "benchmarks.hot_paths", *arguments],
        folder / "told",
        folder=ROOT,
        variables={"RACS_BIF_CACHE": str(folder / "cache"), "PYTHONHASHSEED": "0"},
    )


def cost_of(name: str, folder: Path) -> Cost:
    """Measure one path in processes of its own; `folder` is one to write to."""
    if name in PROGRAMS:
        return program_cost(PROGRAMS[name][1], folder / "told")
    run = ours(folder, "--one", name)
    found = json.loads(run.printed.splitlines()[-1])
    return Cost(found["ratio"], 1e3 * found["seconds"], run.megabytes)


def program_cost(arguments: tuple[str, ...], told: Path, runs: int = 7) -> Cost:
    """Measure a whole process against one that only starts Python."""
    peaks = []

    def once(arguments: tuple[str, ...]) -> float:
        run = spent([sys.executable, *arguments], told, folder=ROOT)
        peaks.append(run.megabytes)
        return run.seconds

    found = _kernel.in_turn(lambda: once(arguments), lambda: once(STARTS), runs)
    return Cost(found.ratio, 1e3 * found.seconds, max(peaks))


def one(name: str) -> None:
    """Measure one path in this process and print what was found."""
    path = PATHS[name]
    print(json.dumps(asdict(_kernel.measured(path.begin(), path.runs))))


def row(name: str, cost: Cost, before: Stored | None) -> str:
    """Return a row of the table."""
    times = ["new", "new"]
    verdict = ""
    if before is not None:
        times = [
            f"x {cost.ratio / before.cost.ratio:.2f}",
            f"x {cost.megabytes / before.cost.megabytes:.2f}",
        ]
        verdict = " ".join(_baselines.worse(cost, before.cost))
        if not verdict and _baselines.better(cost, before.cost):
            verdict = "better"
    shown = (
        f"{name:18s} {cost.milliseconds:9.4g} {cost.ratio:9.4g} {times[0]:>7s} "
        f"{cost.megabytes:6.0f} {times[1]:>7s}"
    )
    return f"{shown} {verdict}".rstrip()


def measure(names: list[str], baselines: dict[str, Stored]) -> tuple[dict[str, Cost], list[str]]:
    """Measure paths and print a row of each; return the costs and what is worse."""
    costs, complaints = {}, []
    with TemporaryDirectory() as place:
        folder = Path(place)
        # Models are compiled once, by a process whose memory nobody asks for.
        ours(folder, "--compile")
        for name in names:
            before, cost = baselines.get(name), cost_of(name, folder)
            if before is not None and _baselines.worse(cost, before.cost):
                again = cost_of(name, folder)
                cost = Cost(*map(min, asdict(cost).values(), asdict(again).values()))
            print(row(name, cost, before), flush=True)
            costs[name] = cost
            if before is not None:
                since = f"since {before.date}, commit {before.commit}"
                words = _baselines.worse(cost, before.cost)
                complaints += [f"{name} is {word} {since}: {TITLES[name]}" for word in words]
    return costs, complaints


def main(arguments: list[str] | None = None) -> int:
    """Print the table; return the exit status."""
    parser = argparse.ArgumentParser(
        description="cost and peak memory of the hot paths beside their baselines",
        epilog="paths: " + "; ".join(f"{name}: {title}" for name, title in TITLES.items()),
    )
    parser.add_argument("--only", nargs="+", choices=list(TITLES), metavar="NAME")
    parser.add_argument("--store", action="store_true", help="make these costs the baselines")
    parser.add_argument("--one", choices=list(PATHS), help=argparse.SUPPRESS)
    parser.add_argument("--compile", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args(arguments)
    if options.one is not None:
        one(options.one)
        return 0
    if options.compile:
        for model in MODELS:
            rb.load_model(model)
        return 0
    baselines = _baselines.read()
    print(HEAD)
    costs, complaints = measure(options.only or list(TITLES), baselines)
    print(f"\nMeasured on {_baselines.machine()}.")
    others = {baselines[name].on for name in costs if name in baselines} - {_baselines.machine()}
    if others:
        print(f"Baselines were measured on {'; '.join(sorted(others))}.")
    if options.store:
        kept = {name: entry for name, entry in baselines.items() if name in TITLES}
        kept |= {name: _baselines.stored(cost) for name, cost in costs.items()}
        _baselines.write({name: kept[name] for name in TITLES if name in kept})
        return 0
    print("\n".join(complaints) or "Nothing is slower or larger than its baseline.")
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
