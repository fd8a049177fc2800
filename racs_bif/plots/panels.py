"""Figures of several panels, whose places are fixed before anything is drawn in them.

Labels of points are placed in pixels, so that the layout must not move afterwards.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from racs_bif.plots.style import COLUMN, style

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PAGE: Final = 180e-3 / 25.4e-3
"""Width of a journal's page, two columns, inches."""
_LEFT, _RIGHT, _BELOW, _TITLE, _LEGEND = 0.62, 0.10, 0.42, 0.22, 0.16
"""Margins of a panel, and what its title and a row of the legend need, inches."""


def panels(
    rows: int,
    columns: int,
    *,
    height: float = 2.1,
    width: float | None = None,
    legend_rows: int = 1,
    shares: Sequence[float] = (),
) -> tuple[Figure, list[Axes]]:
    """Return a figure with panels, row by row.

    Parameters
    ----------
    rows, columns : int
        How many.
    height : float
        Of a row, with its labels [inch].
    width : float, optional
        Of the figure [inch]; a journal's column for one column of panels, a page for more.
    legend_rows : int
        Rows of a common legend to leave room for above.
    shares : sequence of float
        Relative widths of the columns; equal where left out.

    Returns
    -------
    figure : Figure
        Of no window.
    axes : list of Axes
        ``rows * columns`` of them.
    """
    from matplotlib.figure import Figure

    wide = width or (COLUMN if columns == 1 else PAGE)
    room = _LEGEND * legend_rows + (0.04 if legend_rows else 0.0)
    high = rows * height + room
    parts = list(shares) or [1.0] * columns
    cells = [wide * part / sum(parts) for part in parts]
    with style():
        figure = Figure(figsize=(wide, high))
        axes = []
        for k in range(rows * columns):
            row, column = divmod(k, columns)
            left = sum(cells[:column]) + _LEFT
            bottom = high - room - (row + 1) * height + _BELOW
            size = cells[column] - _LEFT - _RIGHT, height - _BELOW - _TITLE
            axes.append(
                figure.add_axes(
                    (left / wide, bottom / high, size[0] / wide, size[1] / high),
                )
            )
    return figure, axes


def letter(axes: Sequence[Axes], titles: Sequence[str]) -> None:
    """Write (a), (b), ... and a title above each panel; one panel alone gets no letter."""
    for k, (ax, title) in enumerate(zip(axes, titles, strict=True)):
        mark = f"({chr(ord('a') + k)}) " if len(axes) > 1 else ""
        ax.set_title(f"{mark}{title}", loc="left", fontsize=7.0, pad=3.0)


def common_legend(figure: Figure, axes: Sequence[Axes], *, columns: int = 4) -> None:
    """Put one legend above all panels, each entry once, and take away those of the panels."""
    entries: dict[str, Artist] = {}
    for ax in axes:
        for handle, title in zip(*ax.get_legend_handles_labels(), strict=True):
            entries.setdefault(str(title), handle)
        own = ax.get_legend()
        if own is not None:
            own.remove()
    with style():
        figure.legend(
            handles=list(entries.values()),
            labels=list(entries),
            loc="upper center",
            bbox_to_anchor=(0.5, 1.0),
            ncols=columns,
            columnspacing=1.2,
            borderaxespad=0.3,
            handlelength=2.2,
        )
