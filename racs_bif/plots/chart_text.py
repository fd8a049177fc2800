"""What is written on a stability chart, where it covers nothing."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.plots.style import BLACK
from racs_bif.results.chart import describe_count

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.text import Text
    from matplotlib.transforms import Bbox

    from racs_bif.results.chart import Chart, ChartRegion, Reals

_ROOM: Final = 1.1
_CLEAR: Final = 0.06
_HEIGHTS: Final = (0.0, 0.12, -0.12, 0.2, -0.2)


def annotate(chart: Chart, ax: Axes) -> None:
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
            # beside the region then, and a dot in it
            small.append(Label(text, float(region.place[0]), float(region.place[1])))
            ax.plot(*region.place, ".", color=BLACK, markersize=4.0, zorder=5.0, label="_region")
    for boundary in chart.boundaries:
        for point in boundary.points:
            if point.label == "GH":
                x, y = point.parameters.values()
                small.append(Label("GH", x, y))
    if chart.nominal is not None:
        small.append(Label("nominal", *map(float, chart.nominal)))
    for note in place(ax, small, taken=taken):
        note.set_bbox({"facecolor": "white", "alpha": 0.75, "edgecolor": "none", "pad": 0.6})


def _inside(chart: Chart, region: ChartRegion, text: str, ax: Axes) -> Text | None:
    """Write a text well inside a region, upright where it does not fit otherwise.

    None, and nothing written, where it does not fit at all.
    """
    filled = chart.map is not None and chart.map.shown is not None
    box = {"facecolor": "white", "alpha": 0.8, "edgecolor": "none", "pad": 1.0}
    boxed = filled or region.unstable < 0
    (x, y), height = region.place, chart.spans[1][1] - chart.spans[1][0]
    for turned, up in itertools.product((0.0, 90.0), _HEIGHTS):
        written = ax.text(
            float(x),
            float(y) + up * height,
            text,
            ha="center",
            va="center",
            rotation=turned,
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
