"""The order alpha of the viscoelastic law at one modulus: histories, sweep and branches.

Figures 7 and 8 of the paper differ in the modulus E_0 alone.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

from racs_bif import Diagram, load_model
from racs_bif.plots.panels import common_legend, letter, panels
from racs_bif.plots.plate import Plate
from racs_bif.plots.sweep import describe, draw
from racs_bif.verbs.shed import shed_diagram, through

if TYPE_CHECKING:
    from collections.abc import Callable

    from matplotlib.figure import Figure

    from analyses._ridden import ride
    from analyses._shown import method, numbers_of, over_time, told
    from analyses._swept import BAND, CAVEAT, computed
    from racs_bif.plots.sweep import Case
else:
    from racs_bif.shelf.analyses._ridden import ride
    from racs_bif.shelf.analyses._shown import method, numbers_of, over_time, told
    from racs_bif.shelf.analyses._swept import BAND, CAVEAT, computed

ALPHAS: Final = (0.3, 0.4, 0.5)
"""Those of the paper."""
SPAN: Final = (0.05, 0.65)
"""At alpha = gamma = 0.7 the law is a spring without damping."""
SPEED: Final = 20.0


def figure_of(
    title: str,
    says: str,
    modulus: float,
    *,
    members: int,
    duration: float,
    points: int,
    progress: Callable[[float], None] | None,
) -> tuple[Figure, Plate]:
    """Return the figure of one modulus, and what is to be said.

    Parameters
    ----------
    title, says : str
        Of the figure, and what the paper says.
    modulus : float
        E_0 [Pa]; C_s goes with it.
    members, duration, points
        Number of simulations, the length of histories [s], most orbits of a branch.
    progress : callable, optional
        Told the share that is done.
    """
    common = {"u": SPEED, "E_0": modulus}
    rides = {
        f"alpha = {alpha:g}": ride(common | {"alpha": alpha}, duration=duration, span=None)
        for alpha in ALPHAS
    }
    report = None if progress is None else lambda share: progress(0.3 + 0.7 * share)
    case = computed(
        "Over the order",
        common,
        "alpha",
        SPAN,
        members=members,
        duration=3.0 * duration,
        points=points,
        report=report,
    )
    case = _with_orbits(case, modulus, points)
    figure, axes = panels(1, 3, height=2.6, legend_rows=2, shares=(1.0, 1.0, 1.5))
    over_time(rides, "delta_c", axes[0])
    over_time(rides, "w", axes[1])
    draw(case.sweep, case.diagram, ax=axes[2])
    letter(axes, ["steering angle", "yaw rate", "over the order"])
    common_legend(figure, axes, columns=4)
    numbers: dict[str, object] = {name: numbers_of(found) for name, found in rides.items()}
    numbers["hopf_alpha"] = [
        p.exact.parameters["alpha"]
        for p in case.diagram.branches[0].special
        if p.label == "H" and p.exact is not None
    ]
    caption = (
        method(list(rides.values()), "u", "E_0", "C_s", "c", "m_c", "gamma", "delta_f"),
        f"The paper: {says}",
        " ".join(told(name, found) for name, found in rides.items()),
        f"{describe(case)} {CAVEAT}",
    )
    return figure, Plate(title, caption, numbers)


def _with_orbits(case: Case, modulus: float, points: int) -> Case:
    """Add the orbits of straight running that is unstable at every order, by way of the speed."""
    if any(branch.kind == "orbit" for branch in case.diagram):
        return case
    values = {"u": SPEED, "E_0": modulus}
    by_speed, _ = shed_diagram(
        load_model("racs", parameters=values, band=BAND),
        "u",
        (5.0, 1.02 * SPEED),
        at=(SPEED,),
        points=points,
    )
    orbits = [b for b in by_speed if b.kind == "orbit"]
    reached = [p for b in orbits for p in b.special if p.label == "UZ"]
    if not reached:
        return case
    found = through(reached[0], "alpha", SPAN, longest=1.17, points=points)
    return replace(case, diagram=Diagram(*case.diagram, found))
