"""Figure 3: the steering angle over the speed, simulated and continued; period and multipliers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif import load_model
from racs_bif.plots.panels import common_legend, letter, panels
from racs_bif.plots.plate import Plate, stated, write_plate
from racs_bif.plots.style import BLACK, BLUE, VERMILION, style
from racs_bif.plots.sweep import describe, draw

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from matplotlib.axes import Axes

    from analyses._swept import CAVEAT, computed
    from racs_bif.results.branch import Branch
else:
    from racs_bif.shelf.analyses._swept import CAVEAT, computed

PAPER: Final = 10.2
"""The paper's critical speed, to which C_s is calibrated [m/s]."""
SPAN: Final = (5.0, 40.0)


def run(
    out: Path,
    *,
    members: int = 140,
    duration: float = 90.0,
    points: int = 150,
    longest: float = 4.2,
    progress: Callable[[float], None] | None = None,
) -> Path:
    """Draw the figure and return the path of the picture.

    Parameters
    ----------
    out : Path
        Folder.
    members, duration
        Number of simulations, and how long each is [s].
    points, longest
        Most orbits, and where their branch is left: its period over that at the Hopf point.
    progress : callable, optional
        Told the share that is done.
    """
    case = computed(
        "Over the speed",
        {},
        "u",
        SPAN,
        marks={"the paper's critical speed": PAPER},
        at=(12.0, 18.0, 20.0),
        members=members,
        duration=duration,
        points=points,
        longest=longest,
        report=progress,
    )
    hopf = case.diagram.branches[0]["H1"].exact
    assert hopf is not None  # the vehicle is fractional, and calibrated to have it
    orbits = next(branch for branch in case.diagram if branch.kind == "orbit")
    figure, axes = panels(1, 3, height=2.6, legend_rows=2)
    draw(case.sweep, case.diagram, marks=case.marks, ax=axes[0])
    _along(orbits, axes[1], axes[2])
    letter(axes, ["simulated and continued", "period of the orbits", "their multipliers"])
    common_legend(figure, axes[:1], columns=4)
    marked = {p.parameters["u"]: p for p in orbits.special if p.label == "UZ"}
    trivial = float(np.abs(np.nanmax(np.abs(orbits.spectrum[1:]), axis=1) - 1.0).max())
    numbers: dict[str, object] = {
        "hopf_u": hopf.parameters["u"],
        "hopf_omega": hopf.omega,
        "l1": hopf.l1,
        "orbits": {f"{u:g}": {"period": p.period} for u, p in marked.items()},
        "trivial_error": trivial,
        "oscillating": [
            [low, high] for low, high, way in case.sweep.stretches if way == "oscillating"
        ],
    }
    caption = (
        "Compliance steering angle over the speed, "
        + stated(load_model("racs"), "C_s", "c", "m_c", "alpha", "gamma", "delta_f")
        + f". {CAVEAT}",
        "The paper: stable below 10.2 m/s, a supercritical Hopf bifurcation there, shimmy above it "
        "with an amplitude that grows with the speed. C_s is calibrated to that speed, so the "
        "speed is no test; criticality and growth are.",
        describe(case)
        + " Towards the end of the branch the period climbs: the orbit passes ever more slowly by "
        "the spun-out equilibria, both tyres past their peak, which take the simulations over from "
        "there on. `racs-bif continue u 5 40` follows it further. Multiplier 1 is the trivial one, "
        f"off by {trivial:.1e} at most: the realisation's multipliers on the "
        "exact orbit. Others just below 1 belong to the realisation's memory, not to the vehicle.",
    )
    return write_plate(out, "fig03_speed", figure, Plate(__doc__.strip(), caption, numbers))


def _along(orbits: Branch, below: Axes, right: Axes) -> None:
    """Draw period and moduli of the leading multipliers along the branch."""
    u, size = orbits.parameter, -np.sort(-np.abs(orbits.spectrum), axis=1)
    with style():
        below.plot(u, orbits.measures["period"], color=BLUE)
        below.set_xlabel(r"$u$ [m/s]")
        below.set_ylabel("period [s]")
        for k, (colour, pattern) in enumerate(((BLACK, "-"), (BLUE, "--"), (VERMILION, ":"))):
            right.plot(u[1:], size[1:, k], color=colour, linestyle=pattern, label=f"{k + 1}")
        right.legend(loc="best", title="by modulus", title_fontsize=6.5)
        right.set_xlabel(r"$u$ [m/s]")
        right.set_ylabel(r"modulus of multiplier, $|\mu|$")
