"""Figure 7: the order alpha at the paper's modulus, against time and continued."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from racs_bif.plots.plate import write_plate

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from analyses._orders import figure_of
else:
    from racs_bif.shelf.analyses._orders import figure_of

MODULUS: Final = 5e4
"""E_0 [Pa]; the paper prints MPa."""
SAYS: Final = (
    "alpha = 0.5 fluctuates at a higher level, 0.4 less, and at 0.3 the fluctuation disappears. "
    "Its Fig. 5 shows shimmy at alpha = 0.3 and the same speed: the two contradict each other."
)


def run(
    out: Path,
    *,
    members: int = 61,
    duration: float = 20.0,
    points: int = 120,
    progress: Callable[[float], None] | None = None,
) -> Path:
    """Draw the figure and return the path of the picture.

    Parameters
    ----------
    out : Path
        Folder.
    members : int
        Number of simulations of the sweep; each is three times as long as the histories.
    duration : float
        Of the histories [s].
    points : int
        Most orbits of a branch.
    progress : callable, optional
        Told the share that is done.
    """
    figure, plate = figure_of(
        __doc__.strip(),
        SAYS,
        MODULUS,
        members=members,
        duration=duration,
        points=points,
        progress=progress,
    )
    return write_plate(out, "fig07_order", figure, plate)
