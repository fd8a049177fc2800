"""Labels beside points, where they cover neither each other nor the curves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from matplotlib.transforms import Bbox

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.text import Annotation
    from numpy.typing import NDArray

_POINTS_PER_INCH: Final = 72.0
_DIRECTIONS: Final = tuple(
    (float(np.round(np.cos(angle), 3)), float(np.round(np.sin(angle), 3)))
    for angle in np.deg2rad([135, 45, 90, 225, 315, 270, 180, 0])
)
_DISTANCES: Final = (4.0, 9.0, 16.0, 26.0, 40.0)
"""How far a label may stand from its point, in typographic points; the last ones need a line."""
_LEADER: Final = 10.0
_MARKER: Final = 3.0
# What a label may cover is weighed: text and markers never, a curve only if nothing else is left.
_OUTSIDE, _COVERS, _CROSSES, _FAR = 1e6, 1e4, 40.0, 1.0


@dataclass(frozen=True)
class Label:
    """A text that belongs to a point, in data coordinates."""

    text: str
    x: float
    y: float


def place(ax: Axes, labels: Sequence[Label], *, taken: Sequence[Bbox] = ()) -> list[Annotation]:
    """Write labels beside their points.

    Each goes, in turn, where it covers least: tried are eight directions at five distances.

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
    curves = _curve_pixels(ax)
    spots = ax.transData.transform(
        np.array([[label.x, label.y] for label in labels]).reshape(-1, 2)
    )
    half = _MARKER * scale
    areas = [Bbox([spot - half, spot + half]) for spot in spots]
    areas += list(taken)
    drawn = []
    for label, spot in zip(labels, spots, strict=True):
        width, height = _size(ax, label.text)
        best, offset, area = np.inf, (0.0, 0.0), Bbox.null()
        for distance in _DISTANCES:
            for direction in _DIRECTIONS:
                shift = np.array(direction) * (distance * scale)
                box = _box(spot + shift, direction, width, height)
                cost = _cost(box, ax.bbox, areas, curves) + _FAR * distance
                if cost < best:
                    best, area = cost, box
                    offset = (direction[0] * distance, direction[1] * distance)
        areas.append(area)
        drawn.append(_write(ax, label, offset))
    return drawn


def covers_curve(ax: Axes, area: Bbox) -> bool:
    """Tell whether an area, in pixels, lies over one of the curves."""
    return _crossed(area, _curve_pixels(ax)) > 0


def _write(ax: Axes, label: Label, offset: tuple[float, float]) -> Annotation:
    far = float(np.hypot(*offset)) > _LEADER
    note = ax.annotate(
        label.text,
        (label.x, label.y),
        xytext=offset,
        textcoords="offset points",
        ha=("center", "left", "right")[_sign(offset[0])],
        va=("center", "bottom", "top")[_sign(offset[1])],
        fontsize="small",
        arrowprops={"arrowstyle": "-", "linewidth": 0.4, "shrinkA": 0, "shrinkB": 2}
        if far
        else None,
        zorder=6,
    )
    note.set_in_layout(False)
    return note


def _box(anchor: NDArray[np.float64], direction: tuple[float, float], w: float, h: float) -> Bbox:
    left = anchor[0] + (-0.5 * w, 0.0, -w)[_sign(direction[0])]
    bottom = anchor[1] + (-0.5 * h, 0.0, -h)[_sign(direction[1])]
    return Bbox.from_bounds(left, bottom, w, h)


def _sign(number: float) -> int:
    """Return 0, 1 or -1, which also counts from the end of a triple."""
    return int(np.sign(round(number, 6)))


def _cost(box: Bbox, inside: Bbox, areas: Sequence[Bbox], curves: NDArray[np.float64]) -> float:
    (x0, y0), (x1, y1) = box.min, box.max
    outside = bool(x0 < inside.x0 or y0 < inside.y0 or x1 > inside.x1 or y1 > inside.y1)
    covered = sum(bool(box.overlaps(area)) for area in areas)
    return _OUTSIDE * outside + _COVERS * covered + _CROSSES * _crossed(box, curves)


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
