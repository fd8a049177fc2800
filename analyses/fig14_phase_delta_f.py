"""Figure 14: phase portraits at delta_f = 0.04 and 0.12 rad, at two stiffnesses."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from racs_bif import load_model
from racs_bif.plots.plate import Plate, plain, write_plate

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from analyses._compared import rides
    from analyses._pinned import pinned
    from analyses._shown import method, numbers_of, portraits, told
else:
    from racs_bif.shelf.analyses._compared import rides
    from racs_bif.shelf.analyses._pinned import pinned
    from racs_bif.shelf.analyses._shown import method, numbers_of, portraits, told

VALUES: Final = (0.04, 0.12)
"""Of delta_f [rad]."""
SPAN: Final = (0.0, 0.2)
SPEED: Final = 20.0


def run(
    out: Path,
    *,
    duration: float = 40.0,
    step: float = 0.005,
    points: int = 120,
    progress: Callable[[float], None] | None = None,
) -> Path:
    """Draw the figure and return the path of the picture.

    Parameters
    ----------
    out : Path
        Folder.
    duration, step : float
        Of the simulations [s].
    points : int
        Most orbits of a branch.
    progress : callable, optional
        Told the share that is done.
    """
    calibrated = load_model("racs").parameters["C_s"]
    own = pinned({"u": SPEED, "delta_f": 0.08})
    found = rides(
        {"Fig. 3": calibrated, "Fig. 13": own},
        {"u": SPEED},
        "delta_f",
        VALUES,
        span=SPAN,
        duration=duration,
        step=step,
        points=points,
        progress=progress,
    )
    caption = (
        method(list(found.values()), "u", "c", "m_c", "alpha"),
        "The paper: periodic motion at 0.04 rad, a stable focus at 0.12 rad. The stiffness of "
        "Fig. 3, and the one that puts the Hopf point of Fig. 13 at 0.08 rad.",
        " ".join(told(title, one) for title, one in found.items()),
    )
    numbers = {plain(title): numbers_of(one) for title, one in found.items()}
    plate = Plate(__doc__.strip(), caption, numbers)
    return write_plate(out, "fig14_phase_delta_f", portraits(found), plate)
