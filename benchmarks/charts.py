"""Stability charts: cost against a painted grid, and a map of a million cells.

Run ``python benchmarks/charts.py``; ``--cells`` and ``--grid`` make it smaller. The grid is
independent of the chart: Newton's method from the model's guess and the argument principle of
`racs_bif.fractional.argument`, one cell at a time.
"""

from __future__ import annotations

import argparse
import resource
import time
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import numpy as np

import racs_bif as rb
from racs_bif.charts.plane import Plane
from racs_bif.fractional.argument import count_unstable

if TYPE_CHECKING:
    from racs_bif.fractional.system import System

SPANS = ((0.02, 0.6), (5.0, 400.0))
CURVE = ((0.281572, 5.0), (0.295587, 100.0), (0.332436, 400.0))


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--grid", type=int, default=200, help="cells each way of the grid")
    parser.add_argument("--cells", type=int, default=1000, help="cells each way of the map")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--only", choices=("grid", "map"))
    options = parser.parse_args()
    system = rb.load_model("racs", parameters={"u": 20.0})
    if options.only != "map":
        against_grid(system, options.grid)
    if options.only != "grid":
        million(system, options.cells, options.workers)


def against_grid(system: System, n: int) -> None:
    """Compare a chart with a grid of counts."""
    began = time.perf_counter()
    chart = rb.stability_chart(system, "c", "m_c", SPANS, marks={"m_c": (100.0,)})
    spent = time.perf_counter() - began
    (boundary,) = chart.boundaries
    print(f"chart: {chart.evaluations} evaluations, {spent:.2f} s, {len(boundary)} points")
    ends = [boundary.values[0], list(boundary.points[0].parameters.values()), boundary.values[-1]]
    print("through", *(f"({c:.6f}, {m:g})" for c, m in ends), "expected", *CURVE)

    plane = Plane(system, ("c", "m_c"), SPANS)
    steps = (np.arange(n) + 0.5) / n
    places = np.array([a.ravel() for a in np.meshgrid(steps, steps, indexing="ij")])
    began, evaluations = time.perf_counter(), 0
    counts = np.empty(places.shape[1], dtype=int)
    for k, p in enumerate(plane.vectors(places).T):
        X = system.exact_point(system.equilibrium(p), p)
        counted = count_unstable(system.exact, X, p)
        counts[k], evaluations = counted.unstable, evaluations + counted.evaluations
    spent = time.perf_counter() - began
    print(f"grid {n} x {n}: {evaluations} evaluations, {spent:.1f} s")
    print(f"the grid takes {evaluations / chart.evaluations:.0f} times as many evaluations")
    cut = cells_cut(plane.places(boundary.line.T), n)
    differ = counts != chart.unstable_on(plane.values(places).T)
    print(f"{differ.sum()} cells differ, {(differ & ~cut).sum()} of them not cut; {cut.sum()} cut")


def cells_cut(line: np.ndarray, n: int) -> np.ndarray:
    """Return which cells (n * n,) a line (2, k) passes through."""
    share = np.linspace(0.0, 1.0, 400)
    dense = line[:, :-1, None] + share * np.diff(line, axis=1)[:, :, None]
    i, j = np.clip((dense.reshape(2, -1) * n).astype(int), 0, n - 1)
    cut = np.zeros((n, n), dtype=bool)
    cut[i, j] = True
    return cut.ravel()


def million(system: System, n: int, workers: int) -> None:
    """Map the damping of the rightmost root."""
    with TemporaryDirectory() as folder:
        began = time.perf_counter()
        chart = rb.stability_chart(
            system,
            "c",
            "m_c",
            SPANS,
            quantity="damping",
            shape=(n, n),
            workers=workers,
            tiles=Path(folder) / "tiles",
        )
        spent = time.perf_counter() - began
    found = chart.map
    assert found is not None  # it was asked for
    unknown = int((found.unstable < 0).sum() + (~np.isfinite(found.sigma)).sum())
    print(
        f"map {n} x {n}, {workers} workers: {spent:.1f} s, {1e6 * spent / n**2:.0f} us a cell, "
        f"{found.evaluations / n**2:.1f} evaluations a cell, {unknown} unknown"
    )
    for who, which in (("here", resource.RUSAGE_SELF), ("a worker", resource.RUSAGE_CHILDREN)):
        print(f"peak memory, {who}: {resource.getrusage(which).ru_maxrss / 1024:.0f} MB")


if __name__ == "__main__":
    main()
