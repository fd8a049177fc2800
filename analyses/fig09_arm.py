"""Figure 9: the steering angle over the dimension c, at two stiffnesses."""

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

SPAN: Final = (0.02, 0.5)
SPEED: Final = 20.0
PAPER: Final = 0.15
"""Where the paper has the Hopf bifurcation [m]."""


def run(
    out: Path,
    *,
    members: int = 80,
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
    own = pinned({"u": SPEED, "c": PAPER})
    cases = sweeps(
        {"Fig. 3": calibrated, "Fig. 9": own},
        {"u": SPEED},
        "c",
        SPAN,
        marks={"the paper's Hopf point": PAPER},
        members=members,
        duration=duration,
        points=points,
        progress=progress,
    )
    figure = picture(cases, columns=2, height=2.6)
    numbers = {"C_s": [calibrated, own], "hopf_c": [hopf_values(case, "c") for case in cases]}
    caption = (
        "Compliance steering angle over c; "
        f"{stated(load_model('racs'), 'm_c', 'alpha', 'delta_f')}, "
        f"u = {SPEED:g} m/s. (a) the stiffness calibrated to the paper's Fig. 3, (b) the one that "
        f"puts the exact Hopf point at c = {PAPER:g} m. {CAVEAT}",
        "The paper: stable at small c, a Hopf bifurcation at 0.15 m, then a serious unstable "
        "state, which is chaos.",
        " ".join(describe(case) for case in cases)
        + " Beyond the orbits the vehicle spins out, to one side or the other from one value of c "
        "to the next: this looks like disorder in a sweep, but each simulation comes to rest. The "
        "analysis `chaos` decides it.",
    )
    return write_plate(out, "fig09_arm", figure, Plate(__doc__.strip(), caption, numbers))
