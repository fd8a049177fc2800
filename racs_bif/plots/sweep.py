"""A brute-force sweep, and the branches over it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.plots.diagram import draw as draw_diagram
from racs_bif.plots.panels import common_legend, letter, panels
from racs_bif.plots.plate import plain
from racs_bif.plots.style import SIZE, style
from racs_bif.results.stability import merged, stretches
from racs_bif.units import after

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from racs_bif.results.branch import Branch, Reals
    from racs_bif.results.diagram import Diagram
    from racs_bif.verbs.sweep import Sweep

GREY: Final = "#8a8a8a"
_MARKED: Final = 0.6
_MANY, _CHANGES = 6, 3
_ROUNDING: Final = 1e-9
_WAYS: Final = {
    "rest": "at rest or creeping",
    "oscillating": "oscillating",
    "dying": "oscillating but dying out",
}


@dataclass(frozen=True, eq=False)
class Case:
    """One panel: a sweep with its branches.

    Parameters
    ----------
    title : str
        Says what distinguishes it.
    sweep : Sweep
        The simulations.
    diagram : Diagram
        The branches in the same parameter.
    marks : mapping of str to float
        Values of the parameter that get a line across, by what the legend calls them.
    """

    title: str
    sweep: Sweep
    diagram: Diagram
    marks: Mapping[str, float] = field(default_factory=dict)


def draw(
    found: Sweep,
    diagram: Diagram | None = None,
    *,
    marks: Mapping[str, float] | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw where simulations ended, and the branches over it.

    Parameters
    ----------
    found : Sweep
        Each simulation gives a dot for every local extreme at its end.
    diagram : Diagram, optional
        Branches in the same parameter.
    marks : mapping of str to float, optional
        Values of the parameter that get a line across, and what the legend calls them.
    ax : Axes, optional
        Where to draw; its place on the figure must be final. A new figure by default.

    Returns
    -------
    Axes
        What was drawn on.
    """
    x = np.concatenate([np.full(len(t), v) for v, t in zip(found.values, found.turns, strict=True)])
    with style():
        if ax is None:
            from matplotlib import pyplot as plt

            figure, ax = plt.subplots(figsize=SIZE)
            figure.subplots_adjust(left=0.2, right=0.96, bottom=0.16, top=0.82)
        ax.plot(
            x,
            np.concatenate(found.turns),
            linestyle="None",
            marker="o",
            markersize=1.9,
            markeredgewidth=0.0,
            color=GREY,
            label="simulated, extremes at the end",
            zorder=1,
        )
        for title, value in (marks or {}).items():
            ax.axvline(value, color="0.45", linewidth=_MARKED, linestyle=(0, (1, 1.5)), label=title)
        if diagram is not None:
            draw_diagram(diagram, found.quantity, ax=ax)
            for note in ax.texts:  # names stay readable over dots
                note.set_bbox({"facecolor": "white", "alpha": 0.6, "linewidth": 0.0, "pad": 0.2})
    return ax


def picture(
    cases: Sequence[Case], *, columns: int = 1, height: float = 2.3, least: float = 0.0
) -> Figure:
    """Return a figure with a panel for each case, and one legend.

    Parameters
    ----------
    cases : sequence of Case
        What to draw.
    columns : int
        Panels in a row.
    height : float
        Of a row [inch].
    least : float
        Range that a vertical axis shows at least: no magnifying of what is next to nothing.
    """
    rows = -(-len(cases) // columns)
    legend_rows = 3 if columns == 1 else 2
    figure, axes = panels(rows, columns, height=height, legend_rows=legend_rows)
    for case, ax in zip(cases, axes, strict=True):
        low, high = float(np.nanmin(case.sweep.low)), float(np.nanmax(case.sweep.high))
        if high - low < least:
            ax.set_ylim(0.5 * (low + high - least), 0.5 * (low + high + least))
        draw(case.sweep, case.diagram, marks=case.marks, ax=ax)
    letter(axes, [case.title for case in cases])
    common_legend(figure, axes, columns=2 if columns == 1 else 3)
    return figure


def describe(case: Case) -> str:
    """Say in a sentence or two what branches and simulations of a case show."""
    name, unit = case.sweep.parameter, case.sweep.system.unit(case.sweep.parameter)
    seconds = after(case.sweep.system.time_unit)
    turning = after(case.sweep.system.frequency_unit)
    texts = []
    for branch in case.diagram:
        for point in branch.special if branch.kind == "equilibrium" and branch.connected else ():
            if point.label == "H":
                place = point if point.exact is None else point.exact
                texts.append(
                    f"{'' if point.exact is None else 'exact '}Hopf point {point.name} at {name} = "
                    f"{_plain_number(place.parameters[name])} {unit}".rstrip()
                    + f", {place.omega:.4g}{turning}, {point.criticality}"
                )
        if branch.kind == "orbit":
            x, period = _clean(branch), branch.measures["period"]
            texts.append(
                f"{branch.name} followed from {x[0]:.5g} to {x[-1]:.5g}, its period from "
                f"{period[0]:.3g} to {period[-1]:.3g}{seconds} ({_stability(branch)})"
            )
    texts = texts or [f"no Hopf point on the branch near straight running over all {name} shown"]
    ways = [f"{_WAYS[way]} {low:.4g} to {high:.4g}" for low, high, way in case.sweep.stretches]
    if len(ways) > _MANY:
        ways = [*ways[:_MANY], f"and {len(ways) - _MANY} more changes"]
    return (
        f"{plain(case.title)}: {'; '.join(texts)}. Simulations from a small disturbance, after "
        f"{case.sweep.duration:g}{seconds}: {', '.join(ways)}."
    )


def _stability(branch: Branch) -> str:
    """Say where a branch is stable; changes that follow one another closely are counted only."""
    x = _clean(branch)
    parts = merged(stretches(branch))
    words = [f"{p.kind} {x[p.first]:.6g} to {x[p.last]:.6g}" for p in parts[:_CHANGES]]
    left = len(parts) - _CHANGES
    return ", ".join(words) + (f", then {left} more changes" if left > 0 else "")


def _clean(branch: Branch) -> Reals:
    """Return the parameter along a branch, exactly zero where it is but rounding."""
    x = branch.parameter
    return np.where(np.abs(x) < _ROUNDING * np.abs(x).max(initial=0.0), 0.0, x)


def _plain_number(value: float) -> str:
    return f"{value if abs(value) > _ROUNDING else 0.0:.6g}"
