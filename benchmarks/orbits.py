"""The vehicle's branch of periodic orbits by every method and by AUTO-07p: cost and accuracy.

Run ``python -m benchmarks.orbits``. The branch goes from the Hopf point near u = 10.2 to u = 20
with everything detected; collocation, ours and AUTO's, has 40 intervals of degree 4 and Newton's
tolerance 1e-8. AUTO-07p runs in the same run on the same equations, written out as Fortran with
Jacobians by its own differences. It is given the value of the Hopf point, shortly before which it
sets out.

Time is CPU time of one thread, start of Python left out, of three runs the least; every method has
a process of its own, whose peak memory is given, Python and its packages included. Errors are
relative: of shooting, collocation and AUTO against collocation with 80 intervals of degree 6 on
the same realisation; of harmonic balance, which has the exact operator, against its known values.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, Final

import racs_bif as rb
from benchmarks import _auto
from benchmarks._spent import spent
from racs_bif.orbits.collocation_settings import CollocationSettings
from racs_bif.shelf.load import load_model
from racs_bif.verbs.orbits import METHODS

if TYPE_CHECKING:
    from racs_bif.orbits.methods import Settings
    from racs_bif.results.branch import Branch
    from racs_bif.results.special import SpecialPoint

MODELS: Final[tuple[tuple[str, dict[str, Any]], ...]] = (
    ("as it is by default", {}),
    ("Oustaloup, 2 x 13 sections", {"realisation": "oustaloup", "order": 13, "band": (1e-2, 1e3)}),
)
SPAN: Final = (5.0, 20.0)
AT: Final = (12.0, 16.0, 18.0)
STATE: Final = "delta_c"
EXACT: Final = {12.0: (0.7393668, 0.0754349), 18.0: (1.1496047, 0.1009184)}
"""Period and highest delta_c of the exact operator, by harmonic balance to all digits given."""
FINE: Final = CollocationSettings(intervals=80, most_intervals=80, degree=6)
RUNS: Final = 3
AUTO: Final = "AUTO-07p"
BEFORE: Final = 0.05
"""How far before the Hopf point AUTO sets out, m/s."""

Orbits = dict[float, tuple[float, float]]
"""Period and highest value by value of the parameter."""


@dataclass(frozen=True)
class Cost:
    """What a method takes and finds."""

    method: str
    points: int
    seconds: float
    megabytes: float
    orbits: Orbits


def hopf_point(which: int) -> SpecialPoint:
    """Return where the orbits of a model are born."""
    system = load_model("racs", **MODELS[which][1])
    return rb.continue_equilibria(system, "u", (5, 30))["H1"]


def follow(hopf: SpecialPoint, method: str, settings: Settings | None = None) -> Branch:
    """Return the branch."""
    return rb.continue_orbits(hopf, SPAN, method=method, at=AT, orbit_settings=settings)


def orbits_of(branch: Branch) -> Orbits:
    """Return the orbits wanted."""
    highest = branch.measures[f"max {STATE}"]
    return {
        round(point.parameters["u"], 6): (point.period, float(highest[point.index]))
        for point in branch.special
        if point.label == "UZ"
    }


def measure(which: int, method: str) -> Cost:
    """Measure the time of a method in this process."""
    hopf = hopf_point(which)
    seconds = []
    for _ in range(RUNS):
        before = time.process_time()
        branch = follow(hopf, method)
        seconds.append(time.process_time() - before)
    return Cost(method, len(branch.arclength), min(seconds), 0.0, orbits_of(branch))


def apart(which: int, method: str) -> Cost:
    """Measure a method in a process of its own."""
    command = [sys.executable, "-m", "benchmarks.orbits", "--one", str(which), method]
    with TemporaryDirectory() as folder:
        run = spent(command, Path(folder) / "told", folder=Path(__file__).parent.parent)
    found = json.loads(run.printed) | {"megabytes": run.megabytes}
    orbits = {float(u): (period, top) for u, (period, top) in found.pop("orbits").items()}
    return Cost(**found, orbits=orbits)


def by_auto(which: int, hopf: SpecialPoint) -> Cost:
    """Measure AUTO-07p."""
    system = load_model("racs", **MODELS[which][1])
    state = system.field.states.index(STATE)
    with TemporaryDirectory() as folder:
        auto = _auto.Auto(system, "u", hopf.parameters["u"] - BEFORE, Path(folder))
        runs = [auto.orbits(SPAN[1], state, AT) for _ in range(RUNS)]
    best = min(runs, key=lambda run: run.seconds)
    return Cost(AUTO, best.points, best.seconds, best.megabytes, best.orbits)


def errors(found: Orbits, known: Orbits, k: int) -> str:
    """Return relative errors of the periods (k = 0) or of the highest values (k = 1) as text."""
    shown = []
    for u in AT:
        off = abs(found[u][k] / known[u][k] - 1.0) if u in known else None
        shown.append(f"{'-' if off is None else f'{off:.0e}':>6s}")
    return " ".join(shown)


def rows(which: int) -> None:
    """Print the rows of a model."""
    title, options = MODELS[which]
    hopf = hopf_point(which)
    known = orbits_of(follow(hopf, "collocation", FINE))
    costs = [by_auto(which, hopf)] if _auto.available() else []
    costs += [apart(which, method) for method in METHODS]
    rival = costs[0] if costs[0].method == AUTO else None
    states = len(load_model("racs", **options).field.states)
    print(f"{title}, {states} states")
    for cost in costs:
        each = cost.seconds / cost.points
        ratios = ["-", "-"]
        if rival is not None:
            ratios = [
                f"{rival.seconds / rival.points / each:.1f}",
                f"{rival.seconds / cost.seconds:.1f}",
            ]
        reference = EXACT if cost.method == "harmonic-balance" else known
        print(
            f"  {cost.method:16s} {cost.points:6d} {1e3 * each:10.1f} {ratios[0]:>7s} "
            f"{cost.seconds:7.2f} {ratios[1]:>7s} {cost.megabytes:6.0f}  "
            f"{errors(cost.orbits, reference, 0)}  {errors(cost.orbits, reference, 1)}"
        )
    distances = f"{errors(known, EXACT, 0)}  {errors(known, EXACT, 1)}"
    print(f"  {'the realisation against the exact operator':66s}{distances}")


def main() -> None:
    """Print the table, or measure one method."""
    parser = argparse.ArgumentParser(description="cost and accuracy of branches of orbits")
    parser.add_argument("--one", nargs=2, metavar=("MODEL", "METHOD"), help=argparse.SUPPRESS)
    parser.add_argument(
        "--models", nargs="+", type=int, choices=range(len(MODELS)), default=range(len(MODELS))
    )
    options = parser.parse_args()
    if options.one is not None:
        print(json.dumps(asdict(measure(int(options.one[0]), options.one[1]))))
        return
    if not _auto.available():
        print(_auto.MISSING)
    at = "12     16     18"
    print(f"{'':55s}  {'error of the period at u =':28s}and of max {STATE} at u =")
    print(
        f"  {'method':16s} {'points':>6s} {'ms a point':>10s} {'faster':>7s} {'all, s':>7s} "
        f"{'faster':>7s} {'MB':>6s}      {at}      {at}"
    )
    for which in options.models:
        rows(which)


if __name__ == "__main__":
    main()
