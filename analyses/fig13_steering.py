"""Figure 13: the steering angle of the rear over that of the front wheel, at two stiffnesses."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from racs_bif import load_model
from racs_bif.plots.plate import Plate, stated, write_plate
from racs_bif.plots.sweep import describe, picture

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from analyses._compared import sweeps
    from analyses._pinned import pinned
    from analyses._swept import CAVEAT, hopf_values
else:
    from racs_bif.shelf.analyses._compared import sweeps
    from racs_bif.shelf.analyses._pinned import pinned
    from racs_bif.shelf.analyses._swept import CAVEAT, hopf_values

SPAN: Final = (0.0, 0.2)
SPEED: Final = 20.0
PAPER: Final = 0.08
"""Above this front steering angle the paper has a stable vehicle [rad]."""


def run(
    out: Path,
    *,
    members: int = 71,
    duration: float = 60.0,
    points: int = 150,
    progress: Callable[[float], None] | None = None,
) -> Path:
    """Draw the figure and return the path of the picture.

    Parameters
    ----------
    out : Path
        Folder.
    members, duration
        Number of simulations of a sweep, and how long each is [s].
    points : int
        Most orbits of a branch.
    progress : callable, optional
        Told the share that is done.
    """
    calibrated = load_model("racs").parameters["C_s"]
    own = pinned({"u": SPEED, "delta_f": PAPER})
    cases = sweeps(
        {"Fig. 3": calibrated, "Fig. 13": own},
        {"u": SPEED},
        "delta_f",
        SPAN,
        marks={"the paper's boundary": PAPER},
        members=members,
        duration=duration,
        points=points,
        longest=6.0,
        progress=progress,
    )
    figure = picture(cases, columns=2, height=2.6)
    numbers = {
        "C_s": [calibrated, own],
        "hopf_delta_f": [hopf_values(case, "delta_f") for case in cases],
    }
    caption = (
        "Compliance steering angle over delta_f; "
        f"{stated(load_model('racs'), 'c', 'm_c', 'alpha')}, u = {SPEED:g} m/s. (a) the stiffness "
        "calibrated to the paper's Fig. 3, (b) the one that puts the exact Hopf point at delta_f = "
        f"{PAPER:g} rad. {CAVEAT}",
        "The paper: periodic oscillation below 0.08 rad, stable above.",
        " ".join(describe(case) for case in cases),
    )
    return write_plate(out, "fig13_steering", figure, Plate(__doc__.strip(), caption, numbers))
