"""Errors of realisations over frequency."""

from __future__ import annotations

from itertools import cycle
from typing import TYPE_CHECKING

from racs_bif.markup import with_unit
from racs_bif.plots.style import COLUMN, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from racs_bif.verbs.realisations import RealisationTable

_COLOURS = ("#000000", "#D55E00", "#0072B2", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
_LINES = ("-", "--", "-.", ":")


def draw(table: RealisationTable, *, ax: Axes | None = None) -> Axes:
    """Draw the relative error of each realised law over frequency.

    Parameters
    ----------
    table : RealisationTable
        What to draw.
    ax : Axes, optional
        Where to draw; a new figure by default.

    Returns
    -------
    Axes
        What was drawn on.
    """
    with style():
        if ax is None:
            from matplotlib import pyplot as plt

            ax = plt.subplots(figsize=(COLUMN, COLUMN), layout="constrained")[1]
        _draw(table, ax)
    return ax


def picture(table: RealisationTable) -> Figure:
    """Return the errors as a figure of its own, for a file."""
    from matplotlib.figure import Figure

    with style():
        figure = Figure(figsize=(COLUMN, COLUMN), layout="constrained")
        _draw(table, figure.add_subplot())
        figure.draw_without_rendering()
    figure.set_layout_engine("none")
    return figure


def _draw(table: RealisationTable, ax: Axes) -> None:
    looks = zip(cycle(_COLOURS), cycle(_LINES), strict=False)
    for (name, errors), (colour, line) in zip(table.errors.items(), looks, strict=False):
        shown = errors.clip(min=1e-12)
        ax.loglog(table.omega, shown, color=colour, ls=line, lw=0.9, label=name)
    if "omega" in table.hopf:
        ax.axvline(table.hopf["omega"], color="0.6", lw=0.6)
        ax.annotate(
            "Hopf",
            (table.hopf["omega"], 0.98),
            xycoords=("data", "axes fraction"),
            xytext=(2, 0),
            textcoords="offset points",
            va="top",
            fontsize=6.5,
        )
    ax.set_xlim(table.omega[0], table.omega[-1])
    ax.set_ylim(1e-8, 10.0)
    ax.set_xlabel(with_unit("frequency", table.system.frequency_unit))
    ax.set_ylabel("relative error of the law")
    figure = ax.figure
    figure.legend(loc="outside upper center", ncols=2, columnspacing=1.2)
