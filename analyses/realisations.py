"""How far realisations of the viscoelastic law move the Hopf point, over random vehicles.

Vehicles are drawn evenly from `RANGES`; those count whose exact Hopf point on the branch near
straight running lies between 3 and 40 m/s. Every realisation gets the same band. The fitted
realisation is refitted at each vehicle's Hopf point, so its error is rounding.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif import continue_equilibria, load_model
from racs_bif.errors import RacsBifError
from racs_bif.fractional.compare import compare
from racs_bif.fractional.realisations import REALISATIONS, choose_realisation

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from racs_bif.fractional.system import System
    from racs_bif.results.special import SpecialPoint

RANGES = {
    "c": (0.2, 0.5),
    "m_c": (50.0, 200.0),
    "alpha": (0.15, 0.45),
    "gamma": (0.55, 0.85),
    "C_s": (2e4, 4.5e4),
    "delta_f": (0.0, 0.03),
}
"""Ranges of the parameters, SI."""
SPAN = (3.0, 40.0)
"""Speeds between which the Hopf point has to be [m/s]."""
BAND = (1.0, 60.0)
"""Band of every realisation [rad/s]."""


@dataclass(frozen=True)
class Row:
    """One realisation over all vehicles.

    Parameters
    ----------
    name : str
        Its name.
    states : int
        Memory states; 0 where it refused all laws.
    worst, median : float
        Relative error of the Hopf speed; NaN where it refused all.
    refused : int
        Number of vehicles whose law it refused.
    """

    name: str
    states: int
    worst: float
    median: float
    refused: int


def run(
    out: Path,
    *,
    vehicles: int = 40,
    seed: int = 1,
    progress: Callable[[float], None] | None = None,
) -> Path:
    """Write the table as ``realisations.md`` and return its path.

    Parameters
    ----------
    out : Path
        Folder.
    vehicles : int
        Number of vehicles with a Hopf point.
    seed : int
        Of the random numbers.
    progress : callable, optional
        Told the share that is done.
    """
    rows = table(vehicles, seed, progress)
    lines = [
        f"# Error of the Hopf speed over {vehicles} random vehicles",
        "",
        f"Band {BAND[0]:g} to {BAND[1]:g} rad/s for every realisation, seed {seed}. Ranges: "
        + ", ".join(f"{name} {low:g} to {high:g}" for name, (low, high) in RANGES.items())
        + ".",
        "",
        "| realisation | states | worst | median | refused |",
        "|---|---:|---:|---:|---:|",
    ]
    lines += [
        f"| {row.name} | {row.states} | {row.worst:.1e} | {row.median:.1e} | {row.refused} |"
        for row in rows
    ]
    out.mkdir(parents=True, exist_ok=True)
    path = out / "realisations.md"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def table(vehicles: int, seed: int, progress: Callable[[float], None] | None = None) -> list[Row]:
    """Return the rows, a realisation each."""
    wanted = [choose_realisation(name, BAND) for name in REALISATIONS]
    errors: dict[str, list[float]] = {name: [] for name in REALISATIONS}
    states = dict.fromkeys(REALISATIONS, 0)
    random = np.random.default_rng(seed)
    found = 0
    while found < vehicles:
        values = {name: float(random.uniform(*span)) for name, span in RANGES.items()}
        system, hopf = _hopf(values)
        if hopf is None or hopf.exact is None:
            continue
        found += 1
        at = ("u", hopf.exact.parameters["u"], hopf.exact.omega)
        for row in compare(system, wanted, band=BAND, hopf=at):
            if not row.refused and row.hopf_error is not None:
                errors[row.name].append(abs(row.hopf_error))
                states[row.name] = row.states
        if progress is not None:
            progress(found / vehicles)
    return [
        Row(
            name,
            states[name],
            max(errors[name], default=float("nan")),
            float(np.median(errors[name])) if errors[name] else float("nan"),
            vehicles - len(errors[name]),
        )
        for name in REALISATIONS
    ]


def _hopf(values: dict[str, float]) -> tuple[System, SpecialPoint | None]:
    system = load_model("racs", parameters=values)
    try:
        branch = continue_equilibria(system, "u", SPAN)
    except RacsBifError:
        return system, None
    points = [p for p in branch.special if p.label == "H" and p.exact is not None]
    return system, points[0] if points else None
