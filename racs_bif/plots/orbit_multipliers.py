"""Floquet multipliers of a saved branch: on the unit circle, and along the branch."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.errors import UsageError
from racs_bif.plots.orbit_profiles import check_orbits, new_axes
from racs_bif.plots.style import BLACK, BLUE, VERMILION, style
from racs_bif.plots.text import axis_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from racs_bif.results.branch import Branch

_SHOWN: Final = 1e-3
"""Least modulus of a multiplier along a branch that is drawn."""
_MOST: Final = 8
"""Most multipliers along a branch that are drawn."""


def draw_circle(branch: Branch, name: str | None = None, *, ax: Axes | None = None) -> Axes:
    """Draw the multipliers of one orbit and the unit circle.

    Those beyond the picture are drawn as arrowheads at its border.

    Parameters
    ----------
    branch : Branch
        A branch of orbits.
    name : str, optional
        One of its special points; the last by default.
    ax : Axes, optional
        Where to draw; a new figure by default.

    Raises
    ------
    UsageError
        If there is no such point, or no multipliers are known there.
    """
    check_orbits(branch)
    point = branch[name] if name else branch.special[-1]
    row = branch.spectrum[point.index]
    values = row[~np.isnan(row)]
    if not len(values):
        msg = f"{point.name} of {branch.name} has no multipliers; take a point that is an orbit"
        raise UsageError(msg)
    with style():
        ax = ax or new_axes()
        angle = np.linspace(0.0, 2.0 * np.pi, 361)
        ax.plot(np.cos(angle), np.sin(angle), color=BLACK, linewidth=0.6)
        ax.axhline(0.0, color=BLACK, linewidth=0.3)
        ax.axvline(0.0, color=BLACK, linewidth=0.3)
        reach = float(np.clip(1.15 * np.abs(values[np.isfinite(values)]).max(), 1.3, 2.5))
        others = values[1:]
        outside = np.abs(others) > 1.0
        _mark(ax, values[:1], reach, BLACK, "trivial")
        _mark(ax, others[outside], reach, VERMILION, "unstable")
        _mark(ax, others[~outside], reach, BLUE, "stable")
        ax.set_xlim(-reach, reach)
        ax.set_ylim(-reach, reach)
        ax.set_aspect("equal")
        ax.set_xlabel(r"$\mathrm{Re}\,\mu$")
        ax.set_ylabel(r"$\mathrm{Im}\,\mu$")
        ax.legend(loc="upper left", bbox_to_anchor=(1.02, 1.0), handlelength=1.0)
    return ax


def draw_multipliers(branch: Branch, *, ax: Axes | None = None) -> Axes:
    """Draw the moduli of the largest multipliers along a branch, the trivial one left out.

    Parameters
    ----------
    branch : Branch
        A branch of orbits.
    ax : Axes, optional
        Where to draw; a new figure by default.

    Raises
    ------
    UsageError
        If no multipliers are known.
    """
    check_orbits(branch)
    moduli = np.abs(branch.spectrum[:, 1:])
    if not np.isfinite(moduli).any():
        msg = f"{branch.name} has no multipliers; take a branch of shooting or collocation"
        raise UsageError(msg)
    known = np.where(np.isfinite(moduli), moduli, -1.0)
    largest = -np.sort(-known, axis=1)[:, :_MOST]
    shown = np.where(largest >= _SHOWN, largest, np.nan)
    with style():
        ax = ax or new_axes()
        for column in shown.T:
            if np.isfinite(column).any():
                ax.plot(branch.parameter, column, color=BLUE, linewidth=0.9)
        ax.axhline(1.0, color=BLACK, linewidth=0.6, linestyle=(0, (4, 2)))
        ax.set_yscale("log")
        name = branch.parameters[0]
        ax.set_xlabel(axis_label(name, branch.system.unit(name)))
        ax.set_ylabel(r"$|\mu|$")
        ax.margins(x=0.02, y=0.08)
        mark_points(branch, ax, shown[:, 0])
    return ax


def mark_points(branch: Branch, ax: Axes, heights: NDArray[np.float64]) -> None:
    """Mark the special points of a branch at given heights (npoints,), and name them."""
    from racs_bif.plots.placing import Label, place
    from racs_bif.results.special import OPERATING

    ax.autoscale_view()
    labels = []
    for point in branch.special:
        height = heights[point.index]
        if point.label not in OPERATING and np.isfinite(height):
            x = float(branch.parameter[point.index])
            ax.plot([x], [height], marker="o", markersize=2.4, color=VERMILION, zorder=5)
            labels.append(Label(point.name, x, float(height)))
    place(ax, labels, taken=[])


def _mark(ax: Axes, values: NDArray[np.complex128], reach: float, colour: str, label: str) -> None:
    """Mark multipliers; those beyond the picture by an arrowhead at its border."""
    far = ~np.isfinite(values) | (np.abs(values) > reach)
    near = values[~far]
    if len(near):
        ax.plot(
            near.real,
            near.imag,
            marker="o",
            markersize=3.2,
            color=colour,
            markeredgecolor="white",
            markeredgewidth=0.3,
            linestyle="None",
            label=label,
            zorder=5,
        )
    for k, value in enumerate(values[far]):
        angle = float(np.angle(value)) if np.isfinite(value) else 0.0
        x, y = 0.93 * reach * np.cos(angle), 0.93 * reach * np.sin(angle)
        ax.plot(
            [x],
            [y],
            marker=(3, 0, np.degrees(angle) - 90.0),
            markersize=4.5,
            color=colour,
            linestyle="None",
            label="_" if len(near) or k else label,
        )
        size = f"{value.real:.2g}" if value.imag == 0.0 else f"|{abs(value):.2g}|"
        ax.annotate(
            size if np.isfinite(value) else r"$\infty$",
            (x, y),
            xytext=(0, 5),
            textcoords="offset points",
            ha="center",
            fontsize=6.0,
        )
