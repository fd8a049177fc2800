"""Peak memory of long branches and fine maps, and the bounds that it is kept in.

Run ``python -m benchmarks.memory``; with ``--whole`` it goes up to a million points and a million
cells, which takes half an hour of CPU time. Every measurement has a process of its own. What one
point or cell takes is the difference between the peaks of two sizes, so that Python and its
packages do not count; the exit status is 1 where that is above its bound. A map of few cells adds
nothing to what the work on one of its tiles takes.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

import numpy as np

import racs_bif as rb
from benchmarks._paths import CHART, SPEEDS, vehicle
from benchmarks._spent import spent
from racs_bif.continuation.settings import StepSettings
from racs_bif.results.branch import Branch

ROOT: Final = Path(__file__).parent.parent
MEGABYTE: Final = 2.0**20


@dataclass(frozen=True)
class Load:
    """Something that can be made as large as one likes.

    Attributes
    ----------
    title : str
        What it is.
    make : callable
        Makes it with a number of points or cells; returns how many there are.
    bound : int
        Bytes that each of them may take at the peak.
    sizes : (int, int)
        Two sizes that tell what each of them takes.
    whole : int
        The size of ``--whole``.
    """

    title: str
    make: Callable[[int], int]
    bound: int
    sizes: tuple[int, int]
    whole: int = 1_000_000


def followed(model: str, parameter: str, span: tuple[float, float], points: int) -> Branch:
    """Follow the equilibria of a model in so short steps that there are about as many points."""
    long = rb.continue_equilibria(rb.load_model(model), parameter, span)
    step = float(long.arclength[-1]) / points
    settings = StepSettings(initial=step, maximum=step, minimum=1e-3 * step, points=2 * points)
    return rb.continue_equilibria(rb.load_model(model), parameter, span, settings=settings)


def brusselator(points: int) -> int:
    """Follow a model of two states."""
    return len(followed("brusselator", "B", (1.0, 4.0), points))


def racs(points: int) -> int:
    """Follow the vehicle, 18 states with those of its realisation."""
    return len(followed("racs", "u", SPEEDS, points))


def repeated(branch: Branch, points: int) -> Branch:
    """Return a branch with its points repeated up to as many."""
    rows = np.arange(points) % len(branch)
    return replace(
        branch,
        values=branch.values[rows],
        arclength=branch.arclength[rows],
        stable=branch.stable[rows],
        unstable=branch.unstable[rows],
        spectrum=branch.spectrum[rows],
        labels=tuple(branch.labels[row] for row in rows),
        states=branch.states[rows],
        measures={name: column[rows] for name, column in branch.measures.items()},
    )


def kept(points: int) -> int:
    """Save a branch of a model of two states and load it again."""
    branch = repeated(rb.continue_equilibria(rb.load_model("brusselator"), "B", (1.0, 4.0)), points)
    with TemporaryDirectory() as folder:
        again = rb.load(rb.save(branch, Path(folder) / "branch.nc"))
    assert isinstance(again, Branch)  # it was saved as one
    return len(again)


def cells(count: int) -> int:
    """Paint a map over a stability chart of the vehicle."""
    n = round(count**0.5)
    chart = rb.stability_chart(vehicle(), "c", "m_c", CHART, quantity="damping", shape=(n, n))
    assert chart.map is not None  # it was asked for
    return int(chart.map.unstable.size)


LOADS: Final = {
    "followed": Load("points followed, 2 states", brusselator, 1600, (5_000, 25_000)),
    "vehicle": Load("points followed, 18 states", racs, 3000, (1_000, 6_000), 50_000),
    "kept": Load("points saved and loaded, 2 states", kept, 300, (100_000, 1_000_000)),
    "cells": Load("cells of a map of damping", cells, 150, (10_000, 90_000)),
}


def peak(name: str, count: int, told: Path) -> tuple[int, float]:
    """Return how many points or cells a process of its own made, and its peak in megabytes."""
    command = [sys.executable, "-m", "benchmarks.memory", "--one", name, str(count)]
    run = spent(command, told, folder=ROOT)
    return int(run.printed.split()[-1]), run.megabytes


def main(arguments: list[str] | None = None) -> int:
    """Print the table; return the exit status."""
    parser = argparse.ArgumentParser(description="peak memory of long branches and fine maps")
    parser.add_argument("--only", nargs="+", choices=list(LOADS), default=list(LOADS))
    parser.add_argument("--whole", action="store_true", help="go up to a million")
    parser.add_argument("--one", nargs=2, help=argparse.SUPPRESS)
    options = parser.parse_args(arguments)
    if options.one is not None:
        print(LOADS[options.one[0]].make(int(options.one[1])))
        return 0
    above = []
    print(f"{'':36s} {'number':>9s} {'peak, MB':>9s} {'each, bytes':>12s} {'bound':>6s}")
    with TemporaryDirectory() as folder:
        for name in options.only:
            load = LOADS[name]
            sizes = load.sizes if not options.whole else (load.sizes[0], load.whole)
            (few, small), (many, large) = (peak(name, n, Path(folder) / "told") for n in sizes)
            each = max(large - small, 0.0) * MEGABYTE / (many - few)
            print(f"{load.title:36s} {few:9d} {small:9.0f}")
            print(
                f"{load.title:36s} {many:9d} {large:9.0f} {each:12.0f} {load.bound:6d}", flush=True
            )
            if each > load.bound:
                above.append(f"{load.title}: {each:.0f} bytes each, more than {load.bound}")
    print("\n".join(above) or "Everything is within its bounds.")
    return 1 if above else 0


if __name__ == "__main__":
    sys.exit(main())
