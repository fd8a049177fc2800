"""A stability chart: filled regions, their numbers of unstable roots, boundaries by frequency."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from racs_bif.plots.style import BLACK, COLUMN, style
from racs_bif.plots.text import axis_label, symbol
from racs_bif.results.chart import describe_count

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable
    from matplotlib.figure import Figure
    from matplotlib.text import Text
    from matplotlib.transforms import Bbox

    from racs_bif.results.chart import Chart, ChartBoundary, ChartRegion, Reals
    from racs_bif.results.chart_slices import ChartSlices

COLOURS: Final = "cividis"
"""Uniform in lightness: the same in grey and with any colour vision (J. R. Nunez, C. R. Anderton,
R. S. Renslow, PLoS ONE 13 (2018) e0199239)."""
SHADES: Final = ("#ffffff", "#e4e4e4", "#c6c6c6", "#a9a9a9", "#8d8d8d")
"""Fillings for 0, 1, 2, 3 and more unstable roots."""
_SIZE: Final = (COLUMN, 0.92 * COLUMN)
_PAGE: Final = 2.05 * COLUMN
_HATCHES: Final = {-2: "////", -1: "xxxx"}
_LINES: Final = {"static": "static loss", "fold": "fold: the equilibrium ends"}
_STYLES: Final = {"static": (0, (1.0, 1.0)), "fold": (0, (5.0, 1.5))}
_ROOM: Final = 1.1
_CLEAR: Final = 0.06
_HEIGHTS: Final = (0.0, 0.12, -0.12, 0.2, -0.2)


@dataclass(frozen=True)
class _Scale:
    """Colours for what a colour bar explains."""

    low: float
    high: float
    title: str


def draw(chart: Chart, *, ax: Axes | None = None) -> Axes:
    """Draw a stability chart.

    Regions are filled the darker the more roots are unstable, and say so; hatched where there is no
    equilibrium or its roots could not be counted. Hopf boundaries are coloured by their frequency,
    with white dashes where they are subcritical. With a map of damping the real part of the
    rightmost root fills the plane instead. A star marks the model's own values.

    Parameters
    ----------
    chart : Chart
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

            ax = plt.subplots(figsize=_SIZE, layout="constrained")[1]
        scale = _scale([chart])
        shown = _draw(chart, ax, scale)
        if shown is not None and scale is not None:
            ax.figure.colorbar(shown, ax=ax, label=scale.title, pad=0.02)
        handles, titles = _legend_entries([ax])
        if handles:
            # Above the axes it covers nothing.
            place: dict[str, Any] = {"loc": "lower left", "bbox_to_anchor": (0.0, 1.0)}
            ax.legend(handles, titles, ncols=2, borderaxespad=0.2, columnspacing=1.0, **place)
        _annotate(chart, ax)
    return ax


def picture(chart: Chart) -> Figure:
    """Return the chart as a figure of its own, for a file; no window is opened."""
    from matplotlib.figure import Figure

    with style():
        figure = Figure(figsize=_SIZE, layout="constrained")
        draw(chart, ax=figure.add_subplot())
    # The layout is final, and the labels with it.
    figure.set_layout_engine("none")
    return figure


def picture_slices(slices: ChartSlices) -> Figure:
    """Return all slices side by side on one figure, with the same axes and colours."""
    from matplotlib.figure import Figure

    columns = 2 if len(slices) > 1 else 1
    rows = -(-len(slices) // columns)
    with style():
        figure = Figure(figsize=(_PAGE, 0.42 * _PAGE * rows), layout="constrained")
        grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
        scale = _scale(list(slices))
        shown = None
        for chart, ax in zip(slices, grid.flat, strict=False):
            shown = _draw(chart, ax, scale) or shown
            unit = chart.system.unit(slices.parameter)
            value = chart.system.parameters[slices.parameter]
            ax.set_title(f"{symbol(slices.parameter)} = {value:g} {unit}".rstrip(), fontsize=8.0)
        for ax in grid.flat:
            ax.label_outer()
        for ax in grid.flat[len(slices) :]:
            ax.set_visible(False)
        if shown is not None and scale is not None:
            figure.colorbar(shown, ax=grid, label=scale.title, pad=0.02)
        handles, titles = _legend_entries(list(grid.flat))
        if handles:
            figure.legend(handles, titles, loc="outside lower center", ncols=3)
        for chart, ax in zip(slices, grid.flat, strict=False):
            _annotate(chart, ax)
    figure.set_layout_engine("none")
    return figure


def _scale(charts: list[Chart]) -> _Scale | None:
    """Return what the colours of charts on one figure mean."""
    maps = [c.map.sigma for c in charts if c.map is not None and c.map.quantity == "damping"]
    known = [sigma[np.isfinite(sigma)] for sigma in maps]
    if known and any(len(values) for values in known):
        values = np.concatenate(known)
        low, high = np.percentile(values, [1.0, 99.0])
        return _Scale(float(low), float(high), r"rightmost root, Re $s$ [1/s]")
    omegas = [b.omega for chart in charts for b in chart.boundaries if b.kind == "hopf"]
    if not omegas:
        return None
    every = np.concatenate(omegas)
    low, high = float(every.min()), float(every.max())
    margin = max(0.0, 0.5 * (0.1 * high - (high - low)))
    return _Scale(low - margin, high + margin, r"frequency on the boundary, $\omega$ [rad/s]")


def _draw(chart: Chart, ax: Axes, scale: _Scale | None) -> ScalarMappable | None:
    """Draw everything but text; return what a colour bar explains."""
    from matplotlib.patches import PathPatch

    damping = chart.map is not None and chart.map.quantity == "damping" and scale is not None
    image = _damping(chart, ax, scale) if damping and scale is not None else None
    for region in chart.regions:
        filled = region.unstable < 0 or not damping
        if not filled:
            continue
        ax.add_patch(
            PathPatch(
                _path(region),
                facecolor=SHADES[min(max(region.unstable, 0), len(SHADES) - 1)],
                edgecolor="#808080" if region.unstable < 0 else "none",
                hatch=_HATCHES.get(region.unstable),
                linewidth=0.0,
                zorder=0.5,
            )
        )
    lines = None
    for boundary in chart.boundaries:
        drawn = _boundary(boundary, ax, None if damping else scale)
        lines = drawn if drawn is not None else lines
    (low, high), (bottom, top) = chart.spans
    ax.set_xlim(low, high)
    ax.set_ylim(bottom, top)
    first, second = chart.parameters
    ax.set_xlabel(axis_label(first, chart.system.unit(first)))
    ax.set_ylabel(axis_label(second, chart.system.unit(second)))
    if chart.nominal is not None:
        ax.plot(
            *chart.nominal[:, None],
            marker="*",
            markersize=7.0,
            markerfacecolor="white",
            markeredgecolor=BLACK,
            markeredgewidth=0.7,
            linestyle="None",
            zorder=5,
            clip_on=False,
        )
    return image if damping else lines


def _path(region: ChartRegion) -> Any:  # noqa: ANN401 - matplotlib's path
    from matplotlib.path import Path

    codes, vertices = [], []
    for loop in region.loops:
        vertices.append(np.vstack([loop, loop[:1]]))
        codes += [Path.MOVETO, *[Path.LINETO] * (len(loop) - 1), Path.CLOSEPOLY]
    return Path(np.vstack(vertices), codes)


def _damping(chart: Chart, ax: Axes, scale: _Scale) -> ScalarMappable:
    assert chart.map is not None  # as the caller knows
    (low, high), (bottom, top) = chart.spans
    return ax.imshow(
        chart.map.sigma.T,
        origin="lower",
        extent=(low, high, bottom, top),
        aspect="auto",
        cmap=COLOURS,
        vmin=scale.low,
        vmax=scale.high,
        interpolation="nearest",
        zorder=0.4,
    )


def _boundary(boundary: ChartBoundary, ax: Axes, scale: _Scale | None) -> ScalarMappable | None:
    """Draw a boundary; return its colours if it has any."""
    from matplotlib.collections import LineCollection

    x, y = boundary.line.T
    casing: dict[str, Any] = {"solid_capstyle": "round", "zorder": 3.0}
    if boundary.kind != "hopf" or scale is None:
        look = _STYLES.get(boundary.kind, "-")
        ax.plot(x, y, color="white", linewidth=2.2, **casing)
        label = _LINES.get(boundary.kind, "_hopf")
        ax.plot(x, y, color=BLACK, linewidth=1.2, linestyle=look, zorder=3.1, label=label)
        return None
    ax.plot(x, y, color=BLACK, linewidth=2.8, label="_hopf", **casing)
    pieces = np.stack([boundary.line[:-1], boundary.line[1:]], axis=1)
    at = np.linspace(0.0, len(boundary) - 1.0, len(boundary.line))
    omega = np.interp(at, np.arange(len(boundary)), boundary.omega)
    lines = LineCollection(list(pieces), cmap=COLOURS, linewidths=1.6, zorder=3.1, capstyle="round")
    lines.set_array(0.5 * (omega[:-1] + omega[1:]))
    lines.set_clim(scale.low, scale.high)
    ax.add_collection(lines, autolim=False)
    l1 = np.interp(at, np.arange(len(boundary)), boundary.l1)
    if np.any(l1 > 0.0):
        ax.plot(
            np.where(l1 > 0.0, x, np.nan),
            np.where(l1 > 0.0, y, np.nan),
            color="white",
            linewidth=1.0,
            linestyle=(0, (1.5, 2.5)),
            zorder=3.2,
            label="subcritical",
        )
    for point in boundary.points:
        if point.label == "GH":
            place = list(point.parameters.values())
            ax.plot(
                place[:1],
                place[1:],
                marker="D",
                markersize=4.0,
                color=BLACK,
                markeredgecolor="white",
                markeredgewidth=0.5,
                linestyle="None",
                zorder=4,
            )
    return lines


def _annotate(chart: Chart, ax: Axes) -> None:
    """Write what the regions hold, and the names of points, where they cover nothing."""
    from racs_bif.plots.placing import Label, place

    ax.get_figure().draw_without_rendering()  # type: ignore[union-attr] # it has one
    taken: list[Bbox] = []
    small: list[Label] = []
    for region in chart.regions:
        text = describe_count(region.unstable)
        written = _inside(chart, region, text, ax)
        if written is not None:
            taken.append(written.get_window_extent())
        elif region.area > 2e-4:
            small.append(Label(text, float(region.place[0]), float(region.place[1])))
    for boundary in chart.boundaries:
        for point in boundary.points:
            if point.label == "GH":
                x, y = point.parameters.values()
                small.append(Label("GH", x, y))
    if chart.nominal is not None:
        small.append(Label("nominal", *map(float, chart.nominal)))
    for note in place(ax, small, taken=taken):
        note.set_bbox({"facecolor": "white", "alpha": 0.75, "edgecolor": "none", "pad": 0.6})


def _legend_entries(axes: list[Axes]) -> tuple[list[Any], list[str]]:
    """Return what a legend has to explain: lines that are not coloured by frequency."""
    from matplotlib.lines import Line2D

    kept: dict[str, Any] = {}
    for ax in axes:
        handles, titles = ax.get_legend_handles_labels()
        kept |= dict(zip(titles, handles, strict=True))
    if "subcritical" in kept:
        dark = Line2D([], [], color=BLACK, linewidth=2.8)
        kept["subcritical"] = (dark, kept["subcritical"])
    return list(kept.values()), list(kept)


def _inside(chart: Chart, region: ChartRegion, text: str, ax: Axes) -> Text | None:
    """Write a text well inside a region; None, and nothing written, where it does not fit."""
    damping = chart.map is not None and chart.map.quantity == "damping"
    box = {"facecolor": "white", "alpha": 0.8, "edgecolor": "none", "pad": 1.0}
    boxed = damping or region.unstable < 0
    (x, y), height = region.place, chart.spans[1][1] - chart.spans[1][0]
    for up in _HEIGHTS:
        written = ax.text(
            float(x),
            float(y) + up * height,
            text,
            ha="center",
            va="center",
            fontsize="small",
            zorder=6,
            bbox=box if boxed else None,
        )
        extent = written.get_window_extent()
        if _fits(chart, region, extent, ax):
            return written
        written.remove()
    return None


def _fits(chart: Chart, region: ChartRegion, extent: Bbox, ax: Axes) -> bool:
    """Say whether a text is in a region, and not on the model's own values."""
    middle = np.array([0.5 * (extent.x0 + extent.x1), 0.5 * (extent.y0 + extent.y1)])
    wide = 0.5 * _ROOM * np.array([extent.width, extent.height])
    around = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [0, -1], [0, 1]])
    places = ax.transData.inverted().transform(middle + wide * around)
    if not _contains(chart, region, places):
        return False
    if chart.nominal is None:
        return True
    spot = ax.transData.transform(chart.nominal)
    clear = 0.5 * np.array([extent.width, extent.height]) + _CLEAR * ax.figure.dpi
    return bool(np.any(np.abs(spot - middle) > clear))


def _contains(chart: Chart, region: ChartRegion, places: Reals) -> bool:
    from racs_bif.charts.faces import Face

    low, high = np.array(chart.spans).T
    outline, *holes = ((loop - low) / (high - low) for loop in region.loops)
    return bool(Face(outline, tuple(holes)).contains((places - low) / (high - low)).all())
