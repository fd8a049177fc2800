"""Curves of special points in a parameter plane, with their points of codimension two."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.errors import UsageError
from racs_bif.plots.style import BLACK, BLUE, SIZE, VERMILION, style
from racs_bif.plots.text import axis_label

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from racs_bif.results.branch import Branch

_LOOKS: Final = {
    "HC": ("Hopf curve", BLUE, "-"),
    "LC": ("fold curve", BLACK, "-"),
    "BC": ("branch points", VERMILION, "-"),
    "LPCC": ("folds of cycles", BLACK, "--"),
    "PDC": ("period doublings", VERMILION, "--"),
    "HOM": ("homoclinic orbit", BLACK, ":"),
    "NSC": ("Neimark-Sacker points", BLUE, "-."),
}
_OTHER: Final = ("curve", VERMILION, "-")
_UNMARKED: Final = frozenset({"EP", "MX", "UZ"})


def draw(curves: Sequence[Branch], *, ax: Axes | None = None) -> Axes:
    """Draw curves in the plane of their two parameters.

    Parameters
    ----------
    curves : sequence of Branch
        Branches of kind "curve" in the same plane. The part of a Hopf curve on which the pair has
        become two real eigenvalues of opposite sign (neutral saddles) is dotted.
    ax : Axes, optional
        Where to draw; a new figure by default.

    Returns
    -------
    Axes
        What was drawn on.

    Raises
    ------
    UsageError
        If the curves lie in different planes.
    """
    _check(curves)
    with style():
        if ax is None:
            from matplotlib import pyplot as plt

            ax = plt.subplots(figsize=SIZE, layout="constrained")[1]
        _draw(curves, ax)
    return ax


def picture(curves: Sequence[Branch]) -> Figure:
    """Return the curves as a figure of their own, for a file."""
    from matplotlib.figure import Figure

    _check(curves)
    with style():
        figure = Figure(figsize=SIZE, layout="constrained")
        _draw(curves, figure.add_subplot())
    figure.set_layout_engine("none")
    return figure


def _check(curves: Sequence[Branch]) -> None:
    planes = {curve.parameters for curve in curves}
    if len(planes) != 1 or len(next(iter(planes))) != 2:
        told = " and ".join(sorted("-".join(plane) for plane in planes)) or "none"
        msg = f"curves must share one plane of two parameters, not {told}; draw a plane at a time"
        raise UsageError(msg)


def _draw(curves: Sequence[Branch], ax: Axes) -> None:
    from racs_bif.plots.placing import Label, place

    labels = []
    for curve in curves:
        title, colour, pattern = _LOOKS.get(curve.name.rstrip("0123456789"), _OTHER)
        x, y = curve.values[:, 0], curve.values[:, 1]
        neutral = np.nan_to_num(curve.measures.get("neutral", np.zeros(len(x)))) > 0.5
        ax.plot(*_where(x, y, ~neutral), color=colour, ls=pattern, lw=1.2, label=title)
        if neutral.any():
            ax.plot(*_where(x, y, neutral), color=colour, ls=":", lw=1.0, label="neutral saddles")
        for point in curve.special:
            if point.label not in _UNMARKED and point.index >= 0:
                at = float(x[point.index]), float(y[point.index])
                ax.plot(*at, "o", ms=3.4, mfc=colour, mec="white", mew=0.3, zorder=5)
                labels.append(Label(point.name, *at))
    first = curves[0]
    (a, b), system = first.parameters, first.system
    ax.set_xlabel(axis_label(a, system.unit(a)))
    ax.set_ylabel(axis_label(b, system.unit(b)))
    ax.margins(0.05)
    legend = ax.legend(loc="best")
    figure = ax.get_figure()
    if figure is not None:
        figure.draw_without_rendering()  # type: ignore[union-attr]  # no subfigure
    place(ax, labels, taken=[legend.get_window_extent()])


def _where(x: np.ndarray, y: np.ndarray, mask: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return a curve with gaps, one point beyond each end of a part so that parts meet."""
    wide = mask.copy()
    wide[1:] |= mask[:-1]
    wide[:-1] |= mask[1:]
    return np.where(wide, x, np.nan), np.where(wide, y, np.nan)
