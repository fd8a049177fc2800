"""A time history: one strip for each quantity, or one against another."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from racs_bif.markup import with_unit
from racs_bif.plots.style import BLACK, BLUE, COLUMN, SIZE, VERMILION, style
from racs_bif.plots.text import axis_label, symbol

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from racs_bif.results.history import TimeHistory

_LOOKS: Final = ((BLACK, "-"), (BLUE, "--"), (VERMILION, ":"))
"""Lines differ in pattern besides colour."""
_STRIP: Final = 0.42
"""Height of a further strip, of a column's width."""


def draw(history: TimeHistory, *names: str, ax: Axes | None = None) -> Axes:
    """Draw columns of a time history against time, on one pair of axes.

    Parameters
    ----------
    history : TimeHistory
        What to draw.
    *names : str
        States, outputs or inputs; by default what the model suggests.
    ax : Axes, optional
        Where to draw; a new figure by default.

    Returns
    -------
    Axes
        What was drawn on.

    Raises
    ------
    UsageError
        If the history has no such column.
    """
    names = names or (shown_column(history),)
    columns = [history.column(name) for name in names]
    with style():
        if ax is None:
            from matplotlib import pyplot as plt

            ax = plt.subplots(figsize=SIZE, layout="constrained")[1]
        for k, (name, column) in enumerate(zip(names, columns, strict=True)):
            colour, pattern = _LOOKS[k % len(_LOOKS)]
            ax.plot(
                history.times,
                column,
                color=colour,
                linestyle=pattern,
                linewidth=0.9,
                label=symbol(name),
            )
        units = {history.units[name] for name in names}
        ax.set_xlabel(with_unit("time", history.system.time_unit))
        if len(names) == 1:
            ax.set_ylabel(axis_label(names[0], history.units[names[0]]))
        else:
            ax.legend(loc="best")
            if len(units) == 1 and (unit := units.pop()):
                ax.set_ylabel(f"[{unit}]")
        ax.margins(x=0.0, y=0.08)
    return ax


def picture(history: TimeHistory, *names: str) -> Figure:
    """Return a figure for a file, a strip for each column; no window is opened.

    Parameters
    ----------
    history : TimeHistory
        What to draw.
    *names : str
        States, outputs or inputs; by default what the model suggests.

    Raises
    ------
    UsageError
        If the history has no such column.
    """
    from matplotlib.figure import Figure

    names = names or (shown_column(history),)
    for name in names:
        history.column(name)
    height = SIZE[1] + _STRIP * COLUMN * (len(names) - 1)
    with style():
        figure = Figure(figsize=(SIZE[0], height), layout="constrained")
        strips = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
        for name, ax in zip(names, strips, strict=True):
            draw(history, name, ax=ax)
            ax.label_outer()
    return figure


def shown_column(history: TimeHistory) -> str:
    """Return the column that is drawn unless another is asked for."""
    suggested = history.system.shown
    return suggested if suggested in history.names else history.names[0]
