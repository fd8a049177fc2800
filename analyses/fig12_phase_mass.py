"""Figure 12: phase portrait at m_c = 30 kg and c = 0.2 m, at two stiffnesses."""

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

VALUES: Final = (30.0,)
"""Of m_c [kg]."""
SPAN: Final = (5.0, 400.0)
SPEED: Final = 20.0
ARM: Final = 0.2
MARGIN: Final = 60.0
"""Mass at which the second stiffness puts the Hopf point: twice that of the portrait [kg]."""


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
    own = pinned({"u": SPEED, "c": ARM, "m_c": MARGIN})
    found = rides(
        {"Fig. 3": calibrated, "shimmy below 60 kg": own},
        {"u": SPEED, "c": ARM},
        "m_c",
        VALUES,
        span=SPAN,
        duration=duration,
        step=step,
        points=points,
        progress=progress,
    )
    caption = (
        method(list(found.values()), "u", "c", "alpha", "delta_f"),
        "The paper: periodic motion. It holds where straight running is unstable: the second "
        f"stiffness is one that puts the exact Hopf point at m_c = {MARGIN:g} kg, so that 30 kg "
        "shimmies.",
        " ".join(told(title, one) for title, one in found.items()),
    )
    numbers = {plain(title): numbers_of(one) for title, one in found.items()}
    plate = Plate(__doc__.strip(), caption, numbers)
    return write_plate(out, "fig12_phase_mass", portraits(found), plate)
