"""The bifurcation diagram: equilibria, extremes of orbits, special points."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.errors import UsageError, nearest
from racs_bif.plots.style import BLACK, BLUE, SIZE, VERMILION, style
from racs_bif.plots.text import axis_label
from racs_bif.results.stability import merged, stretches

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.legend import Legend
    from numpy.typing import NDArray

    from racs_bif.results.branch import Branch
    from racs_bif.results.diagram import Diagram
    from racs_bif.results.special import SpecialPoint


@dataclass(frozen=True)
class Look:
    """How a kind of branch is drawn and what the legend calls it."""

    title: str
    colour: str
    width: float


LOOKS: Final = {
    "equilibrium": Look("equilibrium", BLACK, 1.0),
    "orbit": Look("orbit, max and min", BLUE, 1.5),
}
PATTERNS: Final = {"stable": "-", "unstable": (0, (3.2, 1.6)), "unknown": (0, (0.8, 1.2))}
"""Line patterns by stability."""
MARKERS: Final = {"H": "o", "LP": "s", "BP": "D", "LPC": "s", "PD": "^", "NS": "v", "BPC": "D"}
_FLAT: Final = 1e-9
_OTHER: Final = "X"
_UNMARKED: Final = frozenset({"EP", "MX"})


def draw(diagram: Diagram, state: str | None = None, *, ax: Axes | None = None) -> Axes:
    """Draw a bifurcation diagram.

    Equilibria and the largest and smallest values on orbits against the first active parameter;
    solid where stable, dashed where unstable, dotted where that is not known.

    Parameters
    ----------
    diagram : Diagram
        What to draw.
    state : str, optional
        State or other quantity on the vertical axis. By default what the model suggests: the input
        of its first fractional element, or its first state; where that is a flat line, the state
        that varies most.
    ax : Axes, optional
        Where to draw; a new figure by default.

    Returns
    -------
    Axes
        What was drawn on.

    Raises
    ------
    UsageError
        If no branch has the quantity.
    """
    quantity = shown_quantity(diagram, state)
    with style():
        if ax is None:
            from matplotlib import pyplot as plt

            ax = plt.subplots(figsize=SIZE, layout="constrained")[1]
            _draw(diagram, quantity, ax)
            _label(diagram, quantity, ax, settle=True)
        else:
            _draw(diagram, quantity, ax)
            _label(diagram, quantity, ax, settle=False)
    return ax


def picture(diagram: Diagram, state: str | None = None) -> Figure:
    """Return the diagram as a figure of its own, for a file; no window is opened.

    Raises
    ------
    UsageError
        If no branch has the quantity.
    """
    from matplotlib.figure import Figure

    quantity = shown_quantity(diagram, state)
    with style():
        figure = Figure(figsize=SIZE, layout="constrained")
        ax = figure.add_subplot()
        _draw(diagram, quantity, ax)
        _label(diagram, quantity, ax, settle=True)
    # The layout is final, and the labels with it.
    figure.set_layout_engine("none")
    return figure


def shown_quantity(diagram: Diagram, state: str | None = None) -> str:
    """Return the quantity on the vertical axis: unless told, what the model suggests.

    Where that is a flat line it is the state that varies most.

    Raises
    ------
    UsageError
        If no branch has the one that is wanted.
    """
    system = diagram.branches[0].system
    known = list(dict.fromkeys(name for branch in diagram for name in _quantities(branch)))
    if state is None:
        suggested = next(name for name in (system.shown, *system.states, *known) if name in known)
        ranges = {name: _range(diagram, name) for name in known if name in system.states}
        widest = max(ranges, key=lambda name: ranges[name], default=suggested)
        flat = ranges.get(suggested, 1.0) <= _FLAT * ranges.get(widest, 0.0)
        return widest if flat else suggested
    if state not in known:
        msg = f"nothing called '{state}' to plot; {nearest(state, known)}"
        raise UsageError(msg)
    return state


def _range(diagram: Diagram, name: str) -> float:
    """Return the width of the values that a quantity has on all branches."""
    columns = [column for branch in diagram for column in _curves(branch, name)]
    values = np.concatenate(columns) if columns else np.zeros(1)
    values = values[np.isfinite(values)]
    return float(np.ptp(values)) if len(values) else 0.0


def _quantities(branch: Branch) -> list[str]:
    extremes = [name[4:] for name in branch.measures if name.startswith("max ")]
    plain = [name for name in branch.measures if not name.startswith(("max ", "min "))]
    return [*(branch.state_names if branch.kind == "equilibrium" else ()), *extremes, *plain]


def _curves(branch: Branch, quantity: str) -> list[NDArray[np.float64]]:
    """Return the columns that show a quantity: itself, or its largest and smallest values."""
    if f"max {quantity}" in branch.measures:
        return [branch.column(f"max {quantity}"), branch.column(f"min {quantity}")]
    return [branch.column(quantity)] if quantity in _quantities(branch) else []


def _draw(diagram: Diagram, quantity: str, ax: Axes) -> None:
    titles: set[str] = set()
    for branch in diagram:
        look = LOOKS.get(branch.kind, Look(branch.kind, VERMILION, 1.0))
        x = branch.parameter
        for y in _curves(branch, quantity):
            for part in merged(stretches(branch)):
                title = f"{look.title}, {part.kind}"
                ax.plot(
                    x[part.first : part.last + 1],
                    y[part.first : part.last + 1],
                    color=look.colour,
                    linewidth=look.width,
                    linestyle=PATTERNS[part.kind],
                    label=title if title not in titles else f"_{branch.name}",
                )
                titles.add(title)
            _mark(branch, y, ax)
    first = diagram.branches[0]
    name = first.parameters[0]
    ax.set_xlabel(axis_label(name, first.system.unit(name)))
    ax.set_ylabel(axis_label(quantity, first.system.unit(quantity)))
    ax.margins(x=0.02, y=0.12)


def _mark(branch: Branch, y: NDArray[np.float64], ax: Axes) -> None:
    colour = LOOKS[branch.kind].colour if branch.kind in LOOKS else VERMILION
    for point in branch.special:
        if point.label in _UNMARKED or point.index < 0:
            continue
        user = point.label == "UZ"
        ax.plot(
            [branch.parameter[point.index]],
            [y[point.index]],
            marker="o" if user else MARKERS.get(point.label, _OTHER),
            markersize=2.0 if user else 3.4,
            markerfacecolor="white" if user else colour,
            markeredgecolor=colour if user else "white",
            markeredgewidth=0.5 if user else 0.3,
            linestyle="None",
            label=f"_{point.name}",
            zorder=5,
        )


def _label(diagram: Diagram, quantity: str, ax: Axes, *, settle: bool) -> None:
    """Add the legend, then the names of special points where nothing else is."""
    from racs_bif.plots.placing import Label, covers_curve, place

    ax.autoscale_view()
    legend: Legend = ax.legend(loc="best")
    if settle:
        _settle(ax)
        if covers_curve(ax, legend.get_window_extent()):
            legend = _legend_above(ax)
            _settle(ax)
    labels = []
    for branch in diagram:
        for y in _curves(branch, quantity)[:1]:
            for point in filter(_is_named, branch.special):
                x = float(branch.parameter[point.index])
                labels.append(Label(point.name, x, float(y[point.index])))
    place(ax, labels, taken=[legend.get_window_extent()])


def _legend_above(ax: Axes) -> Legend:
    handles, titles = ax.get_legend_handles_labels()
    ax.legend().remove()
    figure = ax.figure
    return figure.legend(handles, titles, loc="outside upper center", ncols=2, columnspacing=1.2)


def _settle(ax: Axes) -> None:
    """Let the layout of a figure that was made here find its final place for the axes."""
    figure = ax.get_figure()
    if figure is not None:
        figure.draw_without_rendering()  # type: ignore[union-attr]  # no subfigure


def _is_named(point: SpecialPoint) -> bool:
    return point.label not in _UNMARKED | {"UZ"} and point.index >= 0
