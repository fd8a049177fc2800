"""Figure 11: phase portraits at c = 0.2 and c = 0.3 m, at two stiffnesses."""

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

VALUES: Final = (0.2, 0.3)
"""Of c [m]."""
SPAN: Final = (0.1, 0.5)
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
    own = pinned({"u": SPEED, "c": 0.15})
    found = rides(
        {"Fig. 3": calibrated, "Fig. 9": own},
        {"u": SPEED},
        "c",
        VALUES,
        span=SPAN,
        duration=duration,
        step=step,
        points=points,
        progress=progress,
    )
    caption = (
        method(list(found.values()), "u", "m_c", "alpha", "delta_f"),
        "The paper: periodic motion at c = 0.2 m, chaotic motion at c = 0.3 m. The stiffness of "
        "Fig. 3 and the one that puts the Hopf point of Fig. 9 at 0.15 m; see the analysis `chaos` "
        "for all between.",
        " ".join(told(title, one) for title, one in found.items()),
    )
    numbers = {plain(title): numbers_of(one) for title, one in found.items()}
    plate = Plate(__doc__.strip(), caption, numbers)
    return write_plate(out, "fig11_phase_arm", portraits(found), plate)
