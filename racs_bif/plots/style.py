"""One look for all pictures: a journal's column, readable in grey and to the colour-blind."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from matplotlib.figure import Figure

COLUMN: Final = 88e-3 / 25.4e-3
"""Width of a journal's column, inches."""
SIZE: Final = (COLUMN, 0.8 * COLUMN)
"""Size of a picture in one column, inches."""
DPI: Final = 300

# Okabe and Ito, "Color universal design" (2008): distinct for every kind of colour vision. As greys
# these have the luminances 0, 0.41 and 0.47, and lines differ in width and pattern besides.
BLACK: Final = "#000000"
BLUE: Final = "#0072B2"
VERMILION: Final = "#D55E00"

_SETTINGS: Final[dict[str, object]] = {
    "font.size": 8.0,
    "font.family": "sans-serif",
    "mathtext.fontset": "dejavusans",
    "axes.labelsize": 8.0,
    "axes.linewidth": 0.6,
    "axes.grid": False,
    "axes.formatter.useoffset": False,
    "axes.formatter.limits": (-4, 6),
    "axes.unicode_minus": True,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.top": True,
    "ytick.right": True,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.labelsize": 7.0,
    "ytick.labelsize": 7.0,
    "legend.fontsize": 6.5,
    "legend.frameon": False,
    "legend.handlelength": 2.6,
    "lines.dash_capstyle": "butt",
    "lines.solid_joinstyle": "round",
    "figure.dpi": 150,
    "savefig.dpi": DPI,
    "svg.hashsalt": "racs_bif",
}


@contextmanager
def style() -> Iterator[None]:
    """Draw in the project's look; matplotlib's settings are as before afterwards."""
    import matplotlib as mpl

    interactive = mpl.is_interactive()
    try:
        with mpl.rc_context(_SETTINGS):  # type: ignore[arg-type]
            try:
                yield
            finally:
                interactive = mpl.is_interactive()
    finally:
        # A notebook's backend turns it on when the first figure is made; forgotten, no other shows.
        mpl.interactive(interactive)


def save_picture(figure: Figure, path: Path) -> None:
    """Write a picture in the format that the name's ending says.

    The same picture gives the same file: no date is written.
    """
    metadata = {"Date": None} if path.suffix == ".svg" else {"Software": "racs_bif"}
    with style():
        figure.savefig(path, dpi=DPI, metadata=metadata)
