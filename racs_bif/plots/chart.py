"""A stability chart: filled regions, their numbers of unstable roots, boundaries by frequency."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from racs_bif.plots.chart_layers import (
    COLOURS,
    HATCHES,
    SHADES,
    Scale,
    colour_bar,
    draw_boundary,
    draw_curve,
    fill_map,
    outline,
    scale_of,
)
from racs_bif.plots.chart_text import annotate
from racs_bif.plots.style import BLACK, COLUMN, style
from racs_bif.plots.text import axis_label, symbol

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable
    from matplotlib.figure import Figure

    from racs_bif.results.chart import Chart
    from racs_bif.results.chart_slices import ChartSlices

__all__ = ["COLOURS", "SHADES", "draw", "picture", "picture_slices"]
_SIZE: Final = (COLUMN, 0.92 * COLUMN)
_PAGE: Final = 2.05 * COLUMN


def draw(chart: Chart, *, ax: Axes | None = None) -> Axes:
    """Draw a stability chart.

    Regions are filled the darker the more roots are unstable, and say so; hatched where there is no
    equilibrium or its roots could not be counted. Hopf boundaries are coloured by their frequency,
    with white dashes where they are subcritical. A map fills the plane instead, boundaries over it;
    cells that are not certain are hatched. A star marks the model's own values.

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
        scale = scale_of([chart])
        shown = _draw(chart, ax, scale)
        if shown is not None and scale is not None:
            colour_bar(ax, shown, scale, ax.figure)
        handles, titles = _legend_entries([ax])
        if handles:
            # Above the axes it covers nothing.
            place: dict[str, Any] = {"loc": "lower left", "bbox_to_anchor": (0.0, 1.0)}
            ax.legend(handles, titles, ncols=2, borderaxespad=0.2, columnspacing=1.0, **place)
        annotate(chart, ax)
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
        scale = scale_of(list(slices))
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
            colour_bar(grid, shown, scale, figure)
        handles, titles = _legend_entries(list(grid.flat))
        if handles:
            figure.legend(handles, titles, loc="outside lower center", ncols=3)
        for chart, ax in zip(slices, grid.flat, strict=False):
            annotate(chart, ax)
    figure.set_layout_engine("none")
    return figure


def _draw(chart: Chart, ax: Axes, scale: Scale | None) -> ScalarMappable | None:
    """Draw everything but text; return what a colour bar explains."""
    from matplotlib.patches import PathPatch

    mapped = chart.map is not None and chart.map.shown is not None
    image = fill_map(chart, ax, scale) if mapped and scale is not None else None
    for region in chart.regions:
        filled = region.unstable < 0 or not mapped
        if not filled:
            continue
        ax.add_patch(
            PathPatch(
                outline(region),
                facecolor=SHADES[min(max(region.unstable, 0), len(SHADES) - 1)],
                edgecolor="#808080" if region.unstable < 0 else "none",
                hatch=HATCHES.get(region.unstable),
                linewidth=0.0,
                zorder=0.5,
            )
        )
    lines = None
    for boundary in chart.boundaries:
        drawn = draw_boundary(boundary, ax, None if mapped else scale)
        lines = drawn if drawn is not None else lines
    for curve in chart.curves:
        draw_curve(curve, ax)
    (low, high), (bottom, top) = chart.spans
    ax.set_xlim(low, high)
    ax.set_ylim(bottom, top)
    first, second = chart.parameters
    ax.set_xlabel(axis_label(first, chart.system.unit(first)))
    ax.set_ylabel(axis_label(second, chart.system.unit(second)))
    ax.yaxis.set_offset_position("right")  # the legend is on the left
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
    return image if mapped else lines


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
