"""Figure 14: phase portraits at delta_f = 0.04 and 0.12 rad, at two stiffnesses."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from racs_bif import load_model
from racs_bif.plots.plate import Plate, plain, write_plate
from racs_bif.plots.text import symbol

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from analyses._pinned import pinned, titled
    from analyses._ridden import ride
    from analyses._shown import method, numbers_of, portraits, told
    from analyses._swept import part
else:
    from racs_bif.shelf.analyses._pinned import pinned, titled
    from racs_bif.shelf.analyses._ridden import ride
    from racs_bif.shelf.analyses._shown import method, numbers_of, portraits, told
    from racs_bif.shelf.analyses._swept import part

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
    rides = {}
    for stiffness, source in ((calibrated, "Fig. 3"), (own, "Fig. 13")):
        for value in VALUES:
            title = f"{symbol('delta_f')} = {value:g} rad, {titled(stiffness, source)}"
            condition = {"u": SPEED, "delta_f": value, "C_s": stiffness}
            rides[title] = ride(
                condition,
                duration=duration,
                step=step,
                points=points,
                parameter="delta_f",
                span=SPAN,
            )
            report = part(progress, len(rides) - 1, 2 * len(VALUES))
            if report is not None:
                report(0.9)
    caption = (
        method(list(rides.values()), "u", "c", "m_c", "alpha"),
        "The paper: periodic motion at 0.04 rad, a stable focus at 0.12 rad. The stiffness of "
        "Fig. 3, and the one that puts the Hopf point of Fig. 13 at 0.08 rad.",
        " ".join(told(title, found) for title, found in rides.items()),
    )
    numbers = {plain(title): numbers_of(found) for title, found in rides.items()}
    plate = Plate(__doc__.strip(), caption, numbers)
    return write_plate(out, "fig14_phase_delta_f", portraits(rides), plate)
