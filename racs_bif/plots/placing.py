"""Labels beside points, where they cover neither each other nor the curves."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np
from matplotlib.transforms import Bbox

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.text import Annotation
    from numpy.typing import NDArray

_POINTS_PER_INCH: Final = 72.0
_DIRECTIONS: Final = np.column_stack(
    [function(np.deg2rad([135, 45, 90, 225, 315, 270, 180, 0])) for function in (np.cos, np.sin)]
).round(3)
_DISTANCES: Final = (4.0, 9.0, 14.0, 20.0, 28.0, 40.0)
"""How far a label may stand from its point, in typographic points."""
_ALONE: Final = 14.0
"""A label farther off than this, or a point nearer than this to another, needs a line."""
_MARKER: Final = 2.5
# What a label may cover is weighed: text and markers never, a curve only if nothing else is left.
_OUTSIDE, _COVERS, _CROSSES, _FAR = 1e6, 1e4, 40.0, 1.0


@dataclass(frozen=True)
class Label:
    """A text that belongs to a point, in data coordinates."""

    text: str
    x: float
    y: float


@dataclass
class _Sheet:
    """What a label must keep clear of, in pixels."""

    frame: Bbox
    curves: NDArray[np.float64]
    areas: list[Bbox]
    lines: list[NDArray[np.float64]] = field(default_factory=list)

    def cost(self, box: Bbox, line: NDArray[np.float64]) -> float:
        """Weigh what a label in a box, with a line to its point, would cover."""
        frame = self.frame
        outside = box.x0 < frame.x0 or box.y0 < frame.y0 or box.x1 > frame.x1 or box.y1 > frame.y1
        covered = sum(bool(box.overlaps(area)) for area in self.areas)
        covered += sum(_crossed(box, other) > 0 for other in self.lines)
        # The line begins among the markers, which is no matter; texts and lines are.
        covered += sum(_crossed(area, line[2:]) > 0 for area in self.areas)
        covered += sum(_meet(line, other) for other in self.lines)
        return _OUTSIDE * bool(outside) + _COVERS * covered + _CROSSES * _crossed(box, self.curves)


def place(ax: Axes, labels: Sequence[Label], *, taken: Sequence[Bbox] = ()) -> list[Annotation]:
    """Write labels beside their points.

    Each goes, in turn, where it covers least: tried are eight directions at six distances. Where
    points are close together or a label far off, a thin line tells what belongs together.

    Parameters
    ----------
    ax : Axes
        With everything else drawn and its limits final.
    labels : sequence of Label
        What to write and where it belongs.
    taken : sequence of Bbox
        Further areas to keep free, such as the legend's; pixels.

    Returns
    -------
    list of Annotation
        One for each label.
    """
    scale = ax.figure.dpi / _POINTS_PER_INCH
    places = np.array([[label.x, label.y] for label in labels]).reshape(-1, 2)
    spots = ax.transData.transform(places)
    half = _MARKER * scale
    markers = [Bbox([spot - half, spot + half]) for spot in spots]
    sheet = _Sheet(ax.bbox, _curve_pixels(ax), [*markers, *taken])
    drawn = []
    for label, spot in zip(labels, spots, strict=True):
        near = np.hypot(*(spots - spot).T) < _ALONE * scale
        alone = np.count_nonzero(near) == 1
        size = _size(ax, label.text)
        best, offset, area, line = np.inf, np.zeros(2), Bbox.null(), np.empty((0, 2))
        for distance in _DISTANCES:
            for direction in _DIRECTIONS:
                box, leader = _try(spot, direction, distance * scale, size)
                if alone and distance < _ALONE:
                    leader = leader[:0]
                cost = sheet.cost(box, leader) + _FAR * distance
                if cost < best:
                    best, offset, area, line = cost, direction * distance, box, leader
        sheet.areas.append(area)
        if len(line):
            sheet.lines.append(line)
        drawn.append(_write(ax, label, offset, leader=len(line) > 0))
    return drawn


def covers_curve(ax: Axes, area: Bbox) -> bool:
    """Tell whether an area, in pixels, lies over one of the curves."""
    return _crossed(area, _curve_pixels(ax)) > 0


def _write(ax: Axes, label: Label, offset: NDArray[np.float64], *, leader: bool) -> Annotation:
    line = {"arrowstyle": "-", "linewidth": 0.4, "shrinkA": 0.0, "shrinkB": 1.0}
    note = ax.annotate(
        label.text,
        (label.x, label.y),
        xytext=(float(offset[0]), float(offset[1])),
        textcoords="offset points",
        ha=("center", "left", "right")[_sign(offset[0])],
        va=("center", "bottom", "top")[_sign(offset[1])],
        fontsize="small",
        arrowprops=line if leader else None,
        zorder=6,
    )
    note.set_in_layout(False)
    return note


def _try(
    spot: NDArray[np.float64],
    direction: NDArray[np.float64],
    distance: float,
    size: tuple[float, float],
) -> tuple[Bbox, NDArray[np.float64]]:
    """Return the box of a label and points along its line, in pixels."""
    width, height = size
    x, y = anchor = spot + direction * distance
    left = x + (-0.5 * width, 0.0, -width)[_sign(direction[0])]
    bottom = y + (-0.5 * height, 0.0, -height)[_sign(direction[1])]
    line = spot + np.linspace(0.15, 1.0, 12)[:, None] * (anchor - spot)
    return Bbox.from_bounds(left, bottom, width, height), line


def _meet(one: NDArray[np.float64], other: NDArray[np.float64]) -> bool:
    """Tell whether two straight lines cross."""
    if not (len(one) and len(other)):
        return False
    a, b, c, d = one[0], one[-1], other[0], other[-1]
    return _side(a, b, c) != _side(a, b, d) and _side(c, d, a) != _side(c, d, b)


def _side(a: NDArray[np.float64], b: NDArray[np.float64], c: NDArray[np.float64]) -> bool:
    return bool((b[0] - a[0]) * (c[1] - a[1]) > (b[1] - a[1]) * (c[0] - a[0]))


def _sign(number: float) -> int:
    """Return 0, 1 or -1, which also counts from the end of a triple."""
    return int(np.sign(round(number, 6)))


def _crossed(box: Bbox, curves: NDArray[np.float64]) -> int:
    (x0, y0), (x1, y1) = box.min, box.max
    x, y = curves.T
    return int(np.count_nonzero((x > x0) & (x < x1) & (y > y0) & (y < y1)))


def _size(ax: Axes, text: str) -> tuple[float, float]:
    trial = ax.text(0.5, 0.5, text, transform=ax.transAxes, fontsize="small")
    extent = trial.get_window_extent()
    trial.remove()
    return extent.width, extent.height


def _curve_pixels(ax: Axes) -> NDArray[np.float64]:
    """Return points along all curves of the axes, two pixels apart at most."""
    pieces = [np.empty((0, 2))]
    for line in ax.get_lines():
        pixels = line.get_transform().transform(line.get_xydata())
        pixels = pixels[np.isfinite(pixels).all(axis=1)]
        if line.get_linestyle() == "None" or len(pixels) < 2:
            continue
        along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(pixels, axis=0).T))])
        count = int(min(along[-1] / 2.0, 2e4)) + 2
        at = np.linspace(0.0, along[-1], count)
        pieces.append(np.column_stack([np.interp(at, along, column) for column in pixels.T]))
    return np.concatenate(pieces)
