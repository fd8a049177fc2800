"""A phase response curve: how far a kick to a state shifts the phase, over one period."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.errors import UsageError, nearest
from racs_bif.markup import with_unit
from racs_bif.plots.style import BLACK, BLUE, COLUMN, SIZE, style
from racs_bif.plots.text import axis_label, symbol

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from racs_bif.orbits.phase_response import PhaseResponse

_STRIP: Final = 0.5
"""Height of a further strip, of a column's width."""


def draw(response: PhaseResponse, name: str | None = None, *, ax: Axes | None = None) -> Axes:
    """Draw the response to kicks of one state, with the state itself behind it.

    Parameters
    ----------
    response : PhaseResponse
        What to draw.
    name : str, optional
        A state; the first by default.
    ax : Axes, optional
        Where to draw; a new figure by default.

    Returns
    -------
    Axes
        What was drawn on.

    Raises
    ------
    UsageError
        If there is no such state.
    """
    place = _place(response, name)
    name = response.states[place]
    unit = response.units.get(name, "")
    with style():
        if ax is None:
            from matplotlib import pyplot as plt

            ax = plt.subplots(figsize=SIZE, layout="constrained")[1]
        behind = ax.twinx()
        behind.plot(response.times, response.orbit[place], color=BLUE, linestyle=":", linewidth=0.8)
        behind.set_ylabel(axis_label(name, unit), color=BLUE)
        behind.tick_params(colors=BLUE, which="both")
        behind.margins(y=0.08)
        ax.axhline(0.0, color="0.6", linewidth=0.6)
        ax.plot(response.times, response.profile[place], color=BLACK, linewidth=1.0)
        # the response, not the state, is what the picture is of: it lies on top
        ax.set_zorder(behind.get_zorder() + 1)
        ax.patch.set_visible(False)
        ax.tick_params(right=False)
        ax.set_xlabel(with_unit("time of the kick", response.time_unit))
        ax.set_ylabel(_label(name, unit, response.time_unit))
        ax.margins(x=0.0, y=0.08)
    return ax


def picture(response: PhaseResponse, *names: str) -> Figure:
    """Return a figure for a file, a strip for each state; no window is opened.

    Parameters
    ----------
    response : PhaseResponse
        What to draw.
    *names : str
        States; by default all.

    Raises
    ------
    UsageError
        If there is no such state.
    """
    from matplotlib.figure import Figure

    names = names or response.states
    for name in names:
        _place(response, name)
    height = SIZE[1] + _STRIP * COLUMN * (len(names) - 1)
    with style():
        figure = Figure(figsize=(SIZE[0], height), layout="constrained")
        strips = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
        for name, ax in zip(names, strips, strict=True):
            draw(response, name, ax=ax)
            ax.set_xlim(0.0, response.period)
            if ax is not strips[-1]:
                ax.set_xlabel("")
                ax.tick_params(labelbottom=False)
        figure.align_ylabels(np.asarray(strips).tolist())
    return figure


def _place(response: PhaseResponse, name: str | None) -> int:
    if name is None:
        return 0
    if name not in response.states:
        msg = f"the phase response has no state '{name}'; {nearest(name, response.states)}"
        raise UsageError(msg)
    return response.states.index(name)


def _label(name: str, unit: str, time: str) -> str:
    """Return the advance over a kick as an axis label, in the model's time over the state."""
    below = f"({unit})" if unit and not unit.isalpha() else unit
    per = f"{time or 1}/{below}" if below else time
    return with_unit(rf"advance $\partial t / \partial${symbol(name)}", per)
