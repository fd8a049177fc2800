"""Phase portraits: trajectories, the orbit they end on, equilibria."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.plots.style import BLACK, BLUE, SIZE, VERMILION, style
from racs_bif.plots.text import axis_label

if TYPE_CHECKING:
    from collections.abc import Mapping

    from matplotlib.axes import Axes

    from racs_bif.results.branch import Profile, Reals
    from racs_bif.results.history import TimeHistory

_GREY: Final = "#8a8a8a"
_FINE: Final = 1201


def draw(
    history: TimeHistory,
    names: tuple[str, str],
    *,
    orbits: Sequence[tuple[Profile, bool]] = (),
    equilibria: Sequence[tuple[Mapping[str, float], bool]] = (),
    late: float | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw a trajectory in a plane of two states, with what the model has there.

    Parameters
    ----------
    history : TimeHistory
        The trajectory.
    names : (str, str)
        States on the axes.
    orbits : sequence of (Profile, bool)
        Periodic orbits, and whether they are stable: solid or dashed.
    equilibria : sequence of (mapping of str to float, bool)
        Equilibria, and whether they are stable: full or empty dots. One that is farther from the
        trajectory than this is wide would squeeze the picture, and is left out.
    late : float, optional
        From when on the trajectory is drawn darker [s].
    ax : Axes, optional
        Where to draw; a new figure by default.

    Returns
    -------
    Axes
        What was drawn on.
    """
    first, second = names
    x, y = history.column(first), history.column(second)
    with style():
        if ax is None:
            from matplotlib import pyplot as plt

            ax = plt.subplots(figsize=SIZE, layout="constrained")[1]
        ax.plot(x, y, color=_GREY, linewidth=0.5, label="simulated")
        if late is not None:
            end = history.times >= late
            ax.plot(
                x[end], y[end], color=BLACK, linewidth=0.8, label=f"the same, after {late:.3g} s"
            )
        for profile, stable in orbits:
            loop = _smooth(profile)
            ax.plot(
                *(loop[:, profile.names.index(name)] for name in names),
                color=BLUE,
                linewidth=1.5,
                linestyle="-" if stable else (0, (3.2, 1.6)),
                label=f"orbit, {'stable' if stable else 'unstable'}",
            )
        reach = float(np.ptp(x))
        for state, stable in equilibria:
            if not x.min() - reach <= state[first] <= x.max() + reach:
                continue
            ax.plot(
                [state[first]],
                [state[second]],
                linestyle="None",
                marker="o",
                markersize=4.0,
                markerfacecolor=VERMILION if stable else "white",
                markeredgecolor=VERMILION,
                label=f"equilibrium, {'stable' if stable else 'unstable'}",
                zorder=5,
            )
        ax.set_xlabel(axis_label(first, history.units[first]))
        ax.set_ylabel(axis_label(second, history.units[second]))
        ax.locator_params(axis="x", nbins=6)
        ax.margins(0.06)
    return ax


def _smooth(profile: Profile) -> Reals:
    """Return an orbit at many times, by periodic cubic splines."""
    from scipy.interpolate import CubicSpline

    closed = np.array(profile.states)
    closed[-1] = closed[0]
    spline = CubicSpline(profile.times, closed, bc_type="periodic")
    return np.asarray(spline(np.linspace(profile.times[0], profile.times[-1], _FINE)))
