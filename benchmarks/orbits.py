"""CPU time per point of the vehicle's branch of periodic orbits, by every method.

Run ``python benchmarks/orbits.py``. The branch goes from the Hopf point near u = 10.2 to u = 20
with all detectors on; collocation has 40 intervals of degree 4. The numbers are CPU milliseconds of
this process on one BLAS thread, of three runs the fastest. AUTO-07p is not run here.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import racs_bif as rb
from racs_bif.shelf.load import load_model
from racs_bif.verbs.orbits import METHODS

if TYPE_CHECKING:
    from racs_bif.results.branch import Branch
    from racs_bif.results.special import SpecialPoint

MODELS: tuple[tuple[str, dict[str, Any]], ...] = (
    ("as it is by default", {}),
    ("Oustaloup, 2 x 12 sections", {"realisation": "oustaloup", "order": 12, "band": (1e-2, 1e3)}),
)
SPAN = (5.0, 20.0)


def measure(hopf: SpecialPoint, method: str) -> tuple[Branch, float]:
    """Return the branch and the CPU milliseconds of a point."""
    before = time.process_time()
    branch = rb.continue_orbits(hopf, SPAN, method=method)
    return branch, 1e3 * (time.process_time() - before) / len(branch.arclength)


def main() -> None:
    """Print the table."""
    print(f"{'realisation':28s} {'states':>6s} {'method':18s} {'points':>6s} {'ms a point':>10s}")
    for title, options in MODELS:
        system = load_model("racs", **options)
        hopf = rb.continue_equilibria(system, "u", (5, 30))["H1"]
        for method in METHODS:
            runs = [measure(hopf, method) for _ in range(3)]
            branch, milliseconds = min(runs, key=lambda run: run[1])
            states = len(system.field.states)
            points = len(branch.arclength)
            print(f"{title:28s} {states:6d} {method:18s} {points:6d} {milliseconds:10.1f}")


if __name__ == "__main__":
    main()
