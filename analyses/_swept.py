"""Sweeps with the branches over them, as figures 3, 7 to 10 and 13 of the paper need them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif import load_model
from racs_bif.plots.sweep import Case
from racs_bif.verbs.shed import shed_diagram
from racs_bif.verbs.sweep import sweep

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

BAND: Final = (0.01, 50.0)
"""Simulations creep for minutes: their realisation reaches that far down [rad/s]."""
START: Final = {"delta_c": 0.01}
"""Small disturbance that every simulation begins with [rad]."""
CAVEAT: Final = (
    "Solid lines are stable, dashed ones unstable. Equilibria and orbits are those of the exact "
    "fractional operator, multipliers and simulations those of a realisation on "
    f"{BAND[0]:g} to {BAND[1]:g} rad/s. Every simulation begins with delta_c = "
    f"{START['delta_c']:g} rad and all else at rest; as the memory of "
    "the material decays algebraically, it ends still beside the equilibrium or orbit it tends to."
)


def computed(  # noqa: PLR0913 - a panel's choices
    title: str,
    values: Mapping[str, float],
    parameter: str,
    span: tuple[float, float],
    *,
    marks: Mapping[str, float] | None = None,
    at: Sequence[float] = (),
    members: int = 80,
    duration: float = 60.0,
    points: int = 150,
    longest: float = 3.5,
    report: Callable[[float], None] | None = None,
) -> Case:
    """Follow the branches of a vehicle in one parameter, and sweep it.

    Parameters
    ----------
    title : str
        Of the panel.
    values : mapping of str to float
        Parameters that are not the paper's own.
    parameter, span
        What is varied, and over what.
    marks : mapping of str to float, optional
        Values that get a line, by what the legend calls them.
    at : sequence of float
        Orbits wanted exactly.
    members : int
        Simulations, evenly spaced.
    duration : float
        Of each [s]; its last third is drawn.
    points, longest
        See `racs_bif.verbs.shed.shed_diagram`.
    report : callable, optional
        Told the share that is done.
    """
    system = load_model("racs", parameters=values, band=BAND)
    diagram, troubles = shed_diagram(system, parameter, span, at=at, points=points, longest=longest)
    if report is not None:
        report(0.3)
    found = sweep(
        system,
        parameter,
        np.linspace(*span, members),
        initial=START,
        duration=duration,
        kept=duration / 3.0,
        progress=None if report is None else lambda share: report(0.3 + 0.7 * share),
    )
    note = f" ({'; '.join(troubles)})" if troubles else ""
    return Case(f"{title}{note}", found, diagram, dict(marks or {}))


def part(
    progress: Callable[[float], None] | None, number: int, of: int
) -> Callable[[float], None] | None:
    """Return the progress of one of several equal parts."""
    return None if progress is None else lambda share: progress((number + share) / of)


def hopf_values(case: Case, parameter: str) -> list[float]:
    """Return where the exact Hopf points of the branch near straight running are."""
    return [
        point.exact.parameters[parameter]
        for point in case.diagram.branches[0].special
        if point.label == "H" and point.exact is not None
    ]
