"""Floquet multipliers of orbits, in and about the unit circle."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.plots.style import BLACK, BLUE, SIZE, VERMILION, style

if TYPE_CHECKING:
    from collections.abc import Mapping

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

_LOOKS: Final = (("o", BLUE), ("s", VERMILION), ("^", BLACK))


def draw(multipliers: Mapping[str, NDArray[np.complex128]], *, ax: Axes | None = None) -> Axes:
    """Draw multipliers in the complex plane.

    Parameters
    ----------
    multipliers : mapping of str to complex array
        What the legend calls an orbit, and its multipliers; NaN is passed over.
    ax : Axes, optional
        Where to draw; a new figure by default.

    Returns
    -------
    Axes
        What was drawn on.
    """
    angle = np.linspace(0.0, 2.0 * np.pi, 361)
    with style():
        if ax is None:
            from matplotlib import pyplot as plt

            ax = plt.subplots(figsize=SIZE, layout="constrained")[1]
        ax.plot(np.cos(angle), np.sin(angle), color="0.6", linewidth=0.6)
        ax.axhline(0.0, color="0.85", linewidth=0.5, zorder=0)
        ax.axvline(0.0, color="0.85", linewidth=0.5, zorder=0)
        for (title, values), (marker, colour) in zip(
            multipliers.items(), _LOOKS * len(multipliers), strict=False
        ):
            known = values[np.isfinite(values)]
            ax.plot(
                known.real,
                known.imag,
                linestyle="None",
                marker=marker,
                markersize=3.2,
                markerfacecolor="none",
                markeredgecolor=colour,
                markeredgewidth=0.8,
                label=title,
            )
        ax.set_aspect("equal", adjustable="datalim")
        ax.set_xlabel(r"Re $\mu$")
        ax.set_ylabel(r"Im $\mu$")
    return ax
