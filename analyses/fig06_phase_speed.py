"""Figure 6: phase portraits below and above the critical speed, with the exact orbit."""

from __future__ import annotations

from typing import TYPE_CHECKING

from racs_bif.plots.plate import Plate, write_plate

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from analyses._ridden import ride
    from analyses._shown import method, numbers_of, portraits, told
else:
    from racs_bif.shelf.analyses._ridden import ride
    from racs_bif.shelf.analyses._shown import method, numbers_of, portraits, told


def run(
    out: Path,
    *,
    duration: float = 30.0,
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
    rides = {}
    for k, u in enumerate((10.0, 20.0)):
        rides[f"u = {u:g} m/s"] = ride({"u": u}, duration=duration, step=step, points=points)
        if progress is not None:
            progress(0.5 * (k + 0.9))
    caption = (
        method(list(rides.values()), "C_s", "c", "m_c", "alpha", "delta_f"),
        "The paper: a stable focus at 10 m/s, an unstable focus and a limit cycle at 20 m/s.",
        " ".join(told(title, found) for title, found in rides.items()),
    )
    numbers = {title: numbers_of(found) for title, found in rides.items()}
    plate = Plate(__doc__.strip(), caption, numbers)
    return write_plate(out, "fig06_phase_speed", portraits(rides), plate)
