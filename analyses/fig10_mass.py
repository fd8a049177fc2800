"""Figure 10: the steering angle over the mass m_c for three values of c, at two stiffnesses."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from racs_bif import load_model
from racs_bif.plots.plate import Plate, stated, write_plate
from racs_bif.plots.sweep import describe, picture

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from analyses._pinned import pinned, titled
    from analyses._swept import CAVEAT, computed, hopf_values, part
    from racs_bif.plots.sweep import Case
else:
    from racs_bif.shelf.analyses._pinned import pinned, titled
    from racs_bif.shelf.analyses._swept import CAVEAT, computed, hopf_values, part

SPAN: Final = (5.0, 300.0)
SPEED: Final = 20.0
ARMS: Final = (0.15, 0.2, 0.3)
"""Values of c [m], (a) to (c) of the paper."""
PAPER: Final = 160.0
"""Above this mass the paper has a steady vehicle, in its text for (a) [kg]."""


def run(
    out: Path,
    *,
    members: int = 41,
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
    own = pinned({"u": SPEED, "c": ARMS[0], "m_c": PAPER})
    cases: list[Case] = []
    for stiffness in (calibrated, own):
        for arm in ARMS:
            cases.append(
                computed(
                    f"c = {arm:g} m, {titled(stiffness)}",
                    {"u": SPEED, "C_s": stiffness, "c": arm},
                    "m_c",
                    SPAN,
                    marks={"the paper's boundary in (a)": PAPER},
                    members=members,
                    duration=duration,
                    points=points,
                    report=part(progress, len(cases), 2 * len(ARMS)),
                )
            )
    figure = picture(cases, columns=3, height=2.1, least=0.06)
    numbers = {"C_s": [calibrated, own], "hopf_m_c": [hopf_values(case, "m_c") for case in cases]}
    caption = (
        f"Compliance steering angle over m_c; {stated(load_model('racs'), 'alpha', 'delta_f')}, "
        f"u = {SPEED:g} m/s. (a) to (c) the stiffness calibrated to the paper's Fig. 3, (d) to (f) "
        f"the one that puts the exact Hopf point at m_c = {PAPER:g} kg for c = {ARMS[0]:g} m. "
        f"{CAVEAT}",
        "The paper: in (a) unstable below 160 kg, the more so the smaller the mass, and relatively "
        "steady above; the larger c, the larger the oscillation.",
        " ".join(describe(case) for case in cases),
    )
    return write_plate(out, "fig10_mass", figure, Plate(__doc__.strip(), caption, numbers))
