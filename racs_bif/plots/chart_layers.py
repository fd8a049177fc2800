"""What a stability chart is drawn of: regions, a map, boundaries, curves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from racs_bif.markup import with_unit
from racs_bif.plots.style import BLACK, VERMILION
from racs_bif.plots.text import symbol
from racs_bif.plots.text import unit as in_print
from racs_bif.results.chart_curve import KINDS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Colormap, Normalize

    from racs_bif.results.chart import Chart, ChartBoundary, ChartRegion, Reals
    from racs_bif.results.chart_curve import ChartCurve

COLOURS: Final = "cividis"
"""Uniform in lightness: the same in grey and with any colour vision (J. R. Nunez, C. R. Anderton,
R. S. Renslow, PLoS ONE 13 (2018) e0199239)."""
SHADES: Final = ("#ffffff", "#e4e4e4", "#c6c6c6", "#a9a9a9", "#8d8d8d")
"""Fillings for 0, 1, 2, 3 and more unstable roots."""
HATCHES: Final = {-3: "....", -2: "////", -1: "xxxx"}
_LINES: Final = {
    "static": "static loss",
    "fold": "fold: the equilibrium ends",
    "singular": "singular mass matrix",
}
_STYLES: Final = {
    "static": (0, (1.0, 1.0)),
    "fold": (0, (5.0, 1.5)),
    "singular": (0, (8.0, 2.0, 1.0, 2.0)),
}
_CURVES: Final[dict[str, Any]] = {
    "lpc": (0, (3.0, 1.0, 1.0, 1.0)),
    "pd": (0, (1.5, 1.0)),
    "ns": (0, (4.0, 1.0, 1.0, 1.0, 1.0, 1.0)),
}
_TITLES: Final = {
    "damping": r"rightmost root, Re $s$",
    "lyapunov": r"largest Lyapunov exponent",
}
"""Of maps of rates."""


@dataclass(frozen=True)
class Scale:
    """Colours for what a colour bar explains.

    Parameters
    ----------
    low, high : float
        Ends.
    title : str
        What it is.
    numbers : tuple of float
        Whole numbers that have a colour each; none for a continuous scale.
    """

    low: float
    high: float
    title: str
    numbers: tuple[float, ...] = ()

    @property
    def colours(self) -> tuple[Colormap | str, Normalize | None]:
        """The colour map and, of whole numbers, which belongs to which."""
        if not self.numbers:
            return COLOURS, None
        from matplotlib import colormaps
        from matplotlib.colors import BoundaryNorm

        colours = colormaps[COLOURS].resampled(max(len(self.numbers), 2))
        edges = [n - 0.5 for n in (*self.numbers, self.numbers[-1] + 1.0)]
        if len(self.numbers) == 1:
            edges.append(edges[-1] + 1.0)
        return colours, BoundaryNorm(edges, colours.N)


def scale_of(charts: list[Chart]) -> Scale | None:
    """Return what the colours of charts on one figure mean."""
    maps = [chart.map for chart in charts if chart.map is not None]
    filled = [m.shown for m in maps if m.shown is not None]
    known = [values[np.isfinite(values)] for values in filled]
    if filled:
        every = np.concatenate(known)
        if maps[0].quantity == "periods":
            return _numbers(every, charts)
        title = _title(charts[0])
        if not len(every):
            return Scale(0.0, 1.0, title)
        low, high = np.percentile(every, [1.0, 99.0])
        if maps[0].quantity == "amplitude":
            low, high = 0.0, every.max()
        return Scale(float(low), float(max(high, low + 1e-12)), title)
    omegas = [b.omega for chart in charts for b in chart.boundaries if b.kind == "hopf"]
    if not omegas:
        return None
    every = np.concatenate(omegas)
    low, high = float(every.min()), float(every.max())
    margin = max(0.0, 0.5 * (0.1 * high - (high - low)))
    title = with_unit(r"frequency on the boundary, $\omega$", charts[0].system.frequency_unit)
    return Scale(low - margin, high + margin, title)


def _numbers(every: Reals, charts: list[Chart]) -> Scale:
    """Return the scale of numbers of crossings; those that do not repeat come after the last."""
    assert charts[0].map is not None  # as the caller knows
    sweep = charts[0].map.sweep
    title = f"crossings in which the orbit repeats, by {symbol(sweep.watch)}" if sweep else ""
    top = float(every.max()) if len(every) else 0.0
    many = any(
        c.map is not None and bool(np.isinf(c.map.sweep.value).any())
        for c in charts
        if c.map is not None and c.map.sweep is not None
    )
    numbers = [float(n) for n in range(int(top) + 1)]
    return Scale(0.0, top, title, tuple([*numbers, top + 1.0] if many else numbers))


def _title(chart: Chart) -> str:
    assert chart.map is not None  # as the caller knows
    title = _TITLES.get(chart.map.quantity)
    if title is not None:
        return with_unit(title, chart.map.unit(chart.system))
    if chart.map.sweep is None:
        return ""
    unit = in_print(chart.map.unit(chart.system))
    return f"amplitude of {symbol(chart.map.sweep.watch)}" + (f" [{unit}]" if unit else "")


def colour_bar(ax: Any, shown: ScalarMappable, scale: Scale, figure: Any) -> None:  # noqa: ANN401
    """Draw the colour bar beside axes."""
    bar = figure.colorbar(shown, ax=ax, label=scale.title, pad=0.02)
    if scale.numbers:
        texts = [f"{n:g}" for n in scale.numbers]
        if scale.numbers[-1] > scale.high:
            texts[-1] = "many"
        if scale.numbers[0] == 0.0:
            texts[0] = "rest"
        bar.set_ticks(list(scale.numbers), labels=texts)
        bar.ax.minorticks_off()


def fill_map(chart: Chart, ax: Axes, scale: Scale) -> ScalarMappable:
    """Fill the plane with a map; cells that are not certain are hatched."""
    assert chart.map is not None  # as the caller knows
    assert chart.map.shown is not None
    (low, high), (bottom, top) = chart.spans
    values = chart.map.shown.T
    extent = (low, high, bottom, top)
    unknown = np.isnan(values)
    if scale.numbers:
        values = np.where(np.isinf(values), scale.numbers[-1], values)
    colours, norm = scale.colours
    limits: dict[str, Any] = {}
    if norm is None:
        limits = {"vmin": scale.low, "vmax": scale.high}
    image = ax.imshow(
        np.ma.masked_invalid(values),
        origin="lower",
        extent=extent,
        aspect="auto",
        cmap=colours,
        norm=norm,
        interpolation="nearest",
        zorder=0.4,
        **limits,
    )
    if unknown.any() and chart.map.sweep is not None:
        _hatch(ax, unknown, chart)
    return image


def _hatch(ax: Axes, unknown: Any, chart: Chart) -> None:  # noqa: ANN401 - bool array
    from matplotlib.collections import PatchCollection
    from matplotlib.patches import Rectangle

    (low, high), (bottom, top) = chart.spans
    rows, columns = unknown.shape
    wide, tall = (high - low) / columns, (top - bottom) / rows
    cells = [
        Rectangle((low + j * wide, bottom + i * tall), wide, tall) for i, j in np.argwhere(unknown)
    ]
    look: dict[str, Any] = {"facecolor": "white", "edgecolor": "#606060", "hatch": "xxxxx"}
    ax.add_collection(PatchCollection(cells, linewidth=0.0, zorder=0.45, **look))
    nowhere = (float("nan"), float("nan"))
    ax.add_patch(Rectangle(nowhere, 0.0, 0.0, linewidth=0.0, label="unknown", **look))


def outline(region: ChartRegion) -> Any:  # noqa: ANN401 - matplotlib's path
    """Return a region as a path with holes."""
    from matplotlib.path import Path

    codes, vertices = [], []
    for loop in region.loops:
        vertices.append(np.vstack([loop, loop[:1]]))
        codes += [Path.MOVETO, *[Path.LINETO] * (len(loop) - 1), Path.CLOSEPOLY]
    return Path(np.vstack(vertices), codes)


def draw_boundary(boundary: ChartBoundary, ax: Axes, scale: Scale | None) -> ScalarMappable | None:
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


def draw_curve(curve: ChartCurve, ax: Axes) -> None:
    """Draw a curve of other points."""
    x, y = curve.values.T
    ax.plot(x, y, color="white", linewidth=2.4, solid_capstyle="round", zorder=3.3)
    ax.plot(
        x,
        y,
        color=VERMILION,
        linewidth=1.3,
        linestyle=_CURVES.get(curve.kind, "-"),
        zorder=3.4,
        label=KINDS[curve.kind] if curve.kind != "curve" else curve.name,
    )
