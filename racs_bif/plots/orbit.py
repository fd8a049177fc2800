"""Pictures of periodic orbits for files, and the period along a branch."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.errors import UsageError, nearest
from racs_bif.markup import with_unit
from racs_bif.plots.orbit_multipliers import draw_circle, draw_multipliers, mark_points
from racs_bif.plots.orbit_profiles import (
    check_orbits,
    draw_phase,
    draw_profile,
    new_axes,
    plane_of,
    profiles_of,
)
from racs_bif.plots.style import BLUE, COLUMN, SIZE, style
from racs_bif.plots.text import axis_label, symbol
from racs_bif.units import after

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from racs_bif.results.branch import Branch

KINDS: Final = ("profiles", "phase", "multipliers", "circle", "period")
"""What there is to draw of a branch of orbits."""
_STRIPS: Final = 4
"""Most states in the picture of one orbit."""


def draw_period(branch: Branch, *, ax: Axes | None = None) -> Axes:
    """Draw the period along a branch, solid where stable and dashed where not.

    Parameters
    ----------
    branch : Branch
        A branch of orbits.
    ax : Axes, optional
        Where to draw; a new figure by default.

    Raises
    ------
    UsageError
        If it has no period.
    """
    from racs_bif.plots.diagram import PATTERNS
    from racs_bif.results.stability import merged, stretches

    check_orbits(branch)
    periods = branch.column("period")
    with style():
        ax = ax or new_axes()
        seen: set[str] = set()
        for part in merged(stretches(branch)):
            ax.plot(
                branch.parameter[part.first : part.last + 1],
                periods[part.first : part.last + 1],
                color=BLUE,
                linewidth=1.2,
                linestyle=PATTERNS[part.kind],
                label=part.kind if part.kind not in seen else "_",
            )
            seen.add(part.kind)
        name = branch.parameters[0]
        ax.set_xlabel(axis_label(name, branch.system.unit(name)))
        ax.set_ylabel(with_unit("period", branch.system.time_unit))
        ax.margins(x=0.02, y=0.08)
        ax.legend(loc="best")
        mark_points(branch, ax, periods)
    return ax


def picture(branch: Branch, what: str, names: tuple[str, ...] = ()) -> Figure:
    """Return one kind of picture of a branch of orbits, for a file; no window is opened.

    Parameters
    ----------
    branch : Branch
        A branch of orbits.
    what : str
        One of `KINDS`: profiles, phase, multipliers (along the branch), circle, period.
    names : tuple of str
        Special points; all by default.

    Raises
    ------
    UsageError
        If it cannot be drawn.
    """
    from matplotlib.figure import Figure

    if what not in KINDS:
        msg = f"unknown picture '{what}'; {nearest(what, KINDS)}"
        raise UsageError(msg)
    with style():
        figure = Figure(figsize=SIZE, layout="constrained")
        ax = figure.add_subplot()
        if what == "profiles":
            draw_profile(branch, names, ax=ax)
            _lift_legend(figure, ax)
        elif what == "phase":
            draw_phase(branch, names, ax=ax)
            _lift_legend(figure, ax)
        elif what == "multipliers":
            draw_multipliers(branch, ax=ax)
        elif what == "circle":
            draw_circle(branch, names[-1] if names else None, ax=ax)
        else:
            draw_period(branch, ax=ax)
    return figure


def orbit_picture(branch: Branch, name: str | None = None, state: str | None = None) -> Figure:
    """Return the picture of one orbit: its states in time, phase portrait, multipliers.

    Parameters
    ----------
    branch : Branch
        A branch of orbits.
    name : str, optional
        One of its special points; the last by default.
    state : str, optional
        What the phase portrait has on its horizontal axis; what the model suggests by default.

    Raises
    ------
    UsageError
        If the point has no profile.
    """
    from matplotlib.figure import Figure

    point = branch[name] if name else branch.special[-1]
    profile = profiles_of(branch, (point.name,))[point.name]
    plane = plane_of(branch, state)
    with style():
        figure = Figure(figsize=(2.0 * COLUMN, 1.05 * COLUMN), layout="constrained")
        left, right = np.asarray(figure.subfigures(1, 2, width_ratios=[1.15, 1.0])).ravel()
        chosen = list(dict.fromkeys((*plane, *profile.names)))[:_STRIPS]
        strips = left.subplots(len(chosen), 1, sharex=True, squeeze=False)[:, 0]
        for shown, ax in zip(chosen, strips, strict=True):
            column = profile.states[:, profile.names.index(shown)]
            ax.plot(profile.times, column, color=BLUE, linewidth=1.0)
            ax.set_ylabel(axis_label(shown, branch.system.unit(shown)))
            ax.margins(x=0.0, y=0.1)
            ax.label_outer()
        strips[-1].set_xlabel(with_unit("time", branch.system.time_unit))
        left.align_ylabels()
        top, bottom = right.subplots(2, 1)
        draw_phase(branch, (point.name,), plane, ax=top)
        legend = top.get_legend()
        if legend is not None:
            legend.remove()
        draw_circle(branch, point.name, ax=bottom)
        where = ", ".join(f"{symbol(k)} = {v:.6g}" for k, v in point.parameters.items())
        figure.suptitle(
            f"{where}, period {point.period:.7g}{after(branch.system.time_unit)}", fontsize=8.0
        )
    return figure


def _lift_legend(figure: Figure, ax: Axes) -> None:
    handles, titles = ax.get_legend_handles_labels()
    legend = ax.get_legend()
    if legend is not None and len(handles) > 1:
        legend.remove()
        figure.legend(handles, titles, loc="outside upper center", ncols=2, columnspacing=1.2)
