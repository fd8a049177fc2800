"""Figure 5: above the critical speed, against time: onto the exact orbit."""

from __future__ import annotations

from typing import TYPE_CHECKING

from racs_bif.plots.multipliers import draw as draw_multipliers
from racs_bif.plots.panels import common_legend, letter, panels
from racs_bif.plots.plate import Plate, write_plate

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from analyses._ridden import ride
    from analyses._shown import method, numbers_of, over_time, told
else:
    from racs_bif.shelf.analyses._ridden import ride
    from racs_bif.shelf.analyses._shown import method, numbers_of, over_time, told


def run(
    out: Path,
    *,
    speed: float = 20.0,
    duration: float = 20.0,
    step: float = 0.005,
    points: int = 120,
    progress: Callable[[float], None] | None = None,
) -> Path:
    """Draw the figure and return the path of the picture.

    Parameters
    ----------
    out : Path
        Folder.
    speed : float
        Above the critical one [m/s].
    duration, step : float
        Of the simulation [s].
    points : int
        Most orbits of a branch.
    progress : callable, optional
        Told the share that is done.
    """
    found = ride({"u": speed}, duration=duration, step=step, points=points)
    if progress is not None:
        progress(0.9)
    figure, axes = panels(1, 3, height=2.3, legend_rows=1)
    for name, ax in zip(("delta_c", "w"), axes, strict=False):
        over_time({"exact operator": found}, name, ax)
    draw_multipliers({"multipliers of the orbit": found.multipliers}, ax=axes[2])
    letter(axes, [f"steering angle, u = {speed:g} m/s", "yaw rate", "multipliers of the orbit"])
    common_legend(figure, axes[:2], columns=4)
    late = found.history.times[-1] / 2.0
    period = found.history.period("delta_c", after=late)
    numbers = numbers_of(found) | {"simulated_period": period}
    caption = (
        method([found], "u", "C_s", "c", "m_c", "alpha", "delta_f"),
        "The paper: above the critical speed the vehicle shimmies. Its Fig. 7 shows the same "
        "parameters (alpha = 0.3, u = 20 m/s) as stable: the two contradict each other.",
        f"{told('Found', found)} The simulated period is {period:.5g} s, the exact orbit's "
        f"{found.period:.5g} s. Multipliers are those of the realisation; what lies on the real "
        "axis just below 1 is its memory, not the vehicle's.",
    )
    return write_plate(out, "fig05_above", figure, Plate(__doc__.strip(), caption, numbers))
