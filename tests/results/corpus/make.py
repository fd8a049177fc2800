"""Write one small file of each kind in the present format; run it when the format changes.

Files of older formats are never written again: that they still load is what they are kept for.
"""

from __future__ import annotations

import dataclasses
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import racs_bif as rb
from racs_bif.charts.settings import ChartSettings
from racs_bif.continuation.settings import StepSettings
from racs_bif.results.files import FORMAT

if TYPE_CHECKING:
    from racs_bif.results.branch import Profile

FOLDER = Path(__file__).parent


def results() -> dict[str, object]:
    """Return a result of each kind, each of few points."""

    def coarse(profile: Profile) -> Profile:
        """Keep every fourth sample."""
        times, states = profile.times[::4], profile.states[::4]
        return dataclasses.replace(profile, times=times, states=states)

    def thin(branch: rb.Branch, count: int) -> rb.Branch:
        """Keep the first points of a branch and the special points among them."""
        columns = ("values", "arclength", "stable", "unstable", "spectrum", "labels")
        kept = {name: getattr(branch, name)[:count] for name in columns}
        special = tuple(p for p in branch.special if p.index < count)
        names = {p.name for p in special}
        return dataclasses.replace(
            branch,
            **kept,
            states=branch.states[:count],
            measures={k: v[:count] for k, v in branch.measures.items()},
            special=special,
            profiles={k: coarse(v) for k, v in branch.profiles.items() if k in names},
            samples={k: coarse(v) for k, v in branch.samples.items() if k < min(count, 2)},
        )

    steps = StepSettings(maximum=0.2)
    reaction = rb.load_model("fractional_brusselator", order=8)
    fractional = rb.continue_equilibria(reaction, "B", (1.5, 3.5), settings=steps)
    simple = rb.load_model("brusselator")
    born = rb.continue_equilibria(simple, "B", (1.5, 2.5), settings=steps)
    orbits = thin(rb.continue_orbits(born["H1"], (1.5, 2.5), at=(2.01,)), 5)
    plane = ((1.5, 3.5), (0.5, 1.5))
    return {
        "branch": thin(fractional, 12),
        "diagram": rb.Diagram(
            thin(born, born["H1"].index + 1), dataclasses.replace(orbits, samples={}, profiles={})
        ),
        "curve": thin(rb.continue_curve(fractional["H1"], ("B", "A"), plane, settings=steps), 10),
        "orbit": orbits,
        "chart": rb.stability_chart(
            reaction,
            "B",
            "A",
            plane,
            quantity="damping",
            shape=(3, 2),
            settings=ChartSettings(coarse=3, depth=3),
        ),
        "history": rb.simulate(reaction, 0.5, initial={"x": 1.1}, step=0.01),
    }


if __name__ == "__main__":
    for kind, result in results().items():
        path = FOLDER / f"format{FORMAT}_{kind}.nc"
        rb.save(result, path)
        sys.stdout.write(f"{path.name} {path.stat().st_size}\n")
