"""Root loci: eigenvalues in the complex plane as a parameter moves."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.markup import with_unit
from racs_bif.plots.placing import Label, place
from racs_bif.plots.style import BLACK, COLUMN, style
from racs_bif.plots.text import axis_label, symbol
from racs_bif.units import frequency_unit, rate_unit

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from racs_bif.interop.root_locus import RootLocus

    Window = tuple[float, float, float, float]

_SIZE: Final = (COLUMN, 0.85 * COLUMN)
_REAL: Final = 1e-9
"""An eigenvalue whose imaginary part is below this share of its modulus is real."""
_NEAR: Final = 1.5
"""Real eigenvalues this many times farther left than all pairs are not shown."""


def draw(locus: RootLocus, *, window: Window | None = None, ax: Axes | None = None) -> Axes:
    """Draw eigenvalues, coloured by the parameter; of orbits, multipliers and the unit circle.

    Parameters
    ----------
    locus : RootLocus
        What to draw, from `racs_bif.root_locus`.
    window : (float, float, float, float), optional
        Limits of the real and of the imaginary axis. Where left out: around all pairs that are not
        real and all that is unstable, so that fast memory states do not squeeze the rest.
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

            ax = plt.subplots(figsize=_SIZE, layout="constrained")[1]
        _draw(locus, window, ax)
    return ax


def picture(locus: RootLocus, *, window: Window | None = None) -> Figure:
    """Return the root locus as a figure of its own, for a file."""
    from matplotlib.figure import Figure

    with style():
        figure = Figure(figsize=_SIZE, layout="constrained")
        _draw(locus, window, figure.add_subplot())
        figure.draw_without_rendering()
    figure.set_layout_engine("none")
    return figure


def _draw(locus: RootLocus, window: Window | None, ax: Axes) -> None:
    from matplotlib.collections import LineCollection

    values = locus.eigenvalues
    left, right, low, high = window or _window(locus)
    if locus.kind == "orbit":
        angle = np.linspace(0.0, 2.0 * np.pi, 361)
        ax.plot(np.cos(angle), np.sin(angle), color="0.6", lw=0.6)
    else:
        ax.axvspan(0.0, max(right, 0.0), color="0.93", lw=0)
        ax.axvline(0.0, color="0.6", lw=0.6)
    ax.axhline(0.0, color="0.6", lw=0.6)
    ends = np.stack([values[:-1], values[1:]], axis=-1)
    pieces = np.stack([ends.real, ends.imag], axis=-1).reshape(-1, 2, 2)
    middle = 0.5 * (locus.values[:-1] + locus.values[1:])
    lines = LineCollection(
        list(pieces), array=np.repeat(middle, values.shape[1]), cmap="cividis", linewidths=1.4
    )
    ax.add_collection(lines)
    # Seen by nobody but what places the labels.
    ax.plot(values.real, values.imag, color=BLACK, lw=0.0)
    for row, marker in ((0, "x"), (-1, "s")):
        where = f"{symbol(locus.parameter)} = {locus.values[row]:.4g}"
        parts = values[row].real, values[row].imag
        ax.plot(*parts, marker, color=BLACK, ms=3.0, mfc="none", mew=0.7, label=where)
    ax.set_xlim(left, right)
    ax.set_ylim(low, high)
    orbit = locus.kind == "orbit"
    ax.set_xlabel(r"Re $\mu$" if orbit else with_unit("Re s", rate_unit(locus.time_unit)))
    ax.set_ylabel(r"Im $\mu$" if orbit else with_unit("Im s", frequency_unit(locus.time_unit)))
    bar = ax.figure.colorbar(lines, ax=ax, pad=0.02, aspect=30)
    bar.set_label(axis_label(locus.parameter, locus.unit))
    ax.legend(loc="best", handlelength=1.0)
    _mark(locus, ax)


def _mark(locus: RootLocus, ax: Axes) -> None:
    """Mark the pair on the imaginary axis at each Hopf point."""
    labels = []
    for point in locus.special:
        if point.label == "H" and "omega" in point.data:
            ax.plot([0.0, 0.0], [point.omega, -point.omega], "o", color=BLACK, ms=3.5)
            labels.append(Label(point.name, 0.0, point.omega))
    low, high = ax.get_ylim()
    shown = [label for label in labels if low < label.y < high]
    ax.get_figure().draw_without_rendering()  # type: ignore[union-attr] # it has one
    legend = ax.get_legend()
    place(ax, shown, taken=[] if legend is None else [legend.get_window_extent()])


def _window(locus: RootLocus) -> Window:
    values = locus.eigenvalues[np.isfinite(locus.eigenvalues)]
    if locus.kind == "orbit":
        reach = 1.15 * max(1.0, float(np.abs(values).max()))
        return -reach, reach, -reach, reach
    pairs = np.abs(values.imag) > _REAL * np.abs(values)
    matter = values[pairs | (values.real > 0.0)]
    if not len(matter):
        matter = values
    left, right = float(matter.real.min()), max(0.0, float(matter.real.max()))
    near = values[(values.real >= _NEAR * left) & (values.real <= right)]
    left = min(left, float(near.real.min())) if len(near) else left
    width = (right - left) or 1.0
    height = 1.15 * max(float(np.abs(matter.imag).max()), 0.1 * width)
    return left - 0.08 * width, right + 0.12 * width, -height, height
