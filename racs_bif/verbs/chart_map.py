"""Maps over a chart's plane: what is asked for, and what came of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.charts.maps import QUANTITIES, MapJob
from racs_bif.charts.running import run_map
from racs_bif.charts.sweeps import SWEEPS, Sweep
from racs_bif.errors import UsageError, nearest
from racs_bif.results.chart_map import ChartMap, SweepMap
from racs_bif.results.provenance import describe

if TYPE_CHECKING:
    from pathlib import Path

    from racs_bif.charts.backends import Backend
    from racs_bif.charts.boundary import Boundary
    from racs_bif.charts.lattice import Lattice
    from racs_bif.fractional.system import System

    Progress = Callable[[str, int, int], None]

_TURNS: Final = 60.0
"""Default duration of simulations, in periods of the slowest oscillation on a boundary."""


@dataclass(frozen=True, kw_only=True)
class SweepSettings:
    """What is simulated for a map of amplitude, Lyapunov exponents or periods.

    Parameters
    ----------
    duration : float, optional
        Of each simulation [s]; by default sixty periods of the slowest oscillation on the chart's
        Hopf boundaries.
    watch : str
        The state; by default what the model suggests.
    start : mapping of str to float
        States at t = 0, SI; see `racs_bif.charts.sweeps.Sweep`.
    tolerance : float
        Relative error of a step.
    """

    duration: float | None = None
    watch: str = ""
    start: Mapping[str, float] = field(default_factory=dict)
    tolerance: float = 1e-5

    def sweep(self, system: System, boundaries: list[Boundary]) -> Sweep:
        """Return what is simulated, defaults filled in.

        Raises
        ------
        UsageError
            If a state is unknown, or nothing tells how long to simulate.
        """
        duration = self.duration
        if duration is None:
            hopf = [b.omega for b in boundaries if b.kind == "hopf"]
            if not hopf:
                msg = (
                    "no Hopf boundary tells how long the map's simulations must be; give their "
                    "duration"
                )
                raise UsageError(msg)
            slowest = float(min(omega[omega > 0.0].min() for omega in hopf))
            duration = _TURNS * 2.0 * np.pi / slowest
        shown = describe(system).shown
        watch = self.watch or (shown if shown in system.states else system.states[0])
        made = Sweep(duration=duration, watch=watch, start=self.start, tolerance=self.tolerance)
        made.check(system)
        return made


@dataclass(frozen=True)
class MapRequest:
    """A map that was asked for.

    Parameters
    ----------
    quantity : str
        One of `racs_bif.charts.maps.QUANTITIES`.
    shape : (int, int)
        Its cells.
    settings : SweepSettings
        What is simulated, where that is needed.

    Raises
    ------
    UsageError
        If the quantity is unknown.
    """

    quantity: str
    shape: tuple[int, int]
    settings: SweepSettings

    def __post_init__(self) -> None:
        """Check the quantity."""
        if self.quantity not in QUANTITIES:
            msg = f"unknown map '{self.quantity}'; {nearest(self.quantity, QUANTITIES)}"
            raise UsageError(msg)

    def check(self, system: System) -> None:
        """Refuse unknown states, before anything is computed."""
        if self.quantity in SWEEPS:
            named = [name for name in (self.settings.watch, *self.settings.start) if name]
            for name in named:
                if name not in system.states:
                    msg = f"unknown state '{name}'; {nearest(name, system.states)}"
                    raise UsageError(msg)

    def job(self, lattice: Lattice, boundaries: list[Boundary]) -> MapJob:
        """Return the job over a plane that was searched."""
        sweep = None
        if self.quantity in SWEEPS:
            sweep = self.settings.sweep(lattice.plane.system, boundaries)
        return MapJob.over(lattice, self.shape, self.quantity, sweep)


def compute_map(
    job: MapJob, backend: Backend, tiles: Path | None, tell: Progress, *, resume: bool
) -> ChartMap:
    """Compute a map.

    Parameters
    ----------
    job : MapJob
        Which.
    backend : Backend
        Where.
    tiles : Path, optional
        Folder for finished tiles.
    tell : callable
        Told what is done, how much of it, and of how much.
    resume : bool
        Go on with the tiles there.
    """
    whole = run_map(
        job,
        backend,
        folder=tiles,
        resume=resume,
        progress=lambda done, of: tell("map", done, of),
    )
    nothing = np.full(job.shape, np.nan)
    sweep = None
    if job.sweep is not None:
        sweep = SweepMap(
            value=np.asarray(whole["value"], dtype=float),
            error=np.asarray(whole["error"], dtype=float),
            status=whole["status"].astype(np.int8),
            watch=job.sweep.watch,
            duration=job.sweep.duration,
            tolerance=job.sweep.tolerance,
            start=dict(job.sweep.start),
        )
    return ChartMap(
        quantity=job.quantity,
        unstable=whole["unstable"].astype(np.int8),
        sigma=np.asarray(whole.get("sigma", nothing), dtype=float),
        omega=np.asarray(whole.get("omega", nothing), dtype=float),
        evaluations=int(whole["evaluations"].astype(np.int64).sum()),
        sweep=sweep,
    )
