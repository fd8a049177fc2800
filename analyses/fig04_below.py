"""Figure 4: below the critical speed, against time: how fast the disturbance dies out."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.plots.panels import common_legend, letter, panels
from racs_bif.plots.plate import Plate, write_plate
from racs_bif.plots.style import BLUE, VERMILION, style

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from matplotlib.axes import Axes

    from analyses._ridden import Ride, ride
    from analyses._shown import method, numbers_of, over_time, told
    from racs_bif.results.history import TimeHistory
else:
    from racs_bif.shelf.analyses._ridden import ride
    from racs_bif.shelf.analyses._shown import method, numbers_of, over_time, told

SETTLED: Final = 0.05
"""Share of the largest deviation below which the vehicle counts as settled."""


def run(
    out: Path,
    *,
    speed: float = 10.0,
    duration: float = 80.0,
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
        Below the critical one [m/s].
    duration, step : float
        Of the simulation [s].
    points : int
        Most orbits of a branch.
    progress : callable, optional
        Told the share that is done.
    """
    found = ride({"u": speed}, duration=duration, step=step, points=points, span=(5.0, 12.0))
    if progress is not None:
        progress(0.9)
    figure, axes = panels(1, 3, height=2.3, legend_rows=1)
    for name, ax in zip(("delta_c", "w"), axes, strict=False):
        over_time({"exact operator": found}, name, ax)
    _envelope(found, axes[0])
    _roots(found, axes[2])
    titles = [f"steering angle, u = {speed:g} m/s", "yaw rate", "exact characteristic roots"]
    letter(axes, titles)
    common_legend(figure, axes, columns=4)
    times = {name: settling(found.history, name, found.rest[name]) for name in ("delta_c", "w")}
    rate = float(found.roots[0].real)
    numbers = numbers_of(found) | {"settling": times, "rate": rate}
    caption = (
        method([found], "u", "C_s", "c", "m_c", "alpha", "delta_f"),
        'The paper: "it takes about seven seconds to reach its steady-state value", of the yaw '
        "rate too.",
        f"{told('Found', found)} The leading pair decays with {rate:.4f} 1/s, a time constant of "
        f"{abs(1.0 / rate):.1f} s: within {SETTLED:.0%} of the largest deviation after "
        + " and ".join(_time(t, name, duration) for name, t in times.items())
        + ". The rest dies out algebraically, as the memory of the material does.",
    )
    return write_plate(out, "fig04_below", figure, Plate(__doc__.strip(), caption, numbers))


def settling(history: TimeHistory, name: str, rest: float) -> float:
    """Return from when on a state stays within a share of its largest deviation [s].

    NaN where that is not before the last twentieth: too late to be seen to stay.
    """
    off = np.abs(history.column(name) - rest)
    outside = np.flatnonzero(off > SETTLED * off.max())
    last = int(outside[-1]) + 1
    return float(history.times[last]) if last < 0.95 * len(history.times) else float("nan")


def _time(seconds: float, name: str, duration: float) -> str:
    return (
        f"{seconds:.1f} s ({name})"
        if np.isfinite(seconds)
        else f"more than {duration:g} s ({name})"
    )


def _envelope(found: Ride, ax: Axes) -> None:
    """Draw how the leading pair alone dies out, from the largest swing after one period on."""
    off = found.history.column("delta_c") - found.rest["delta_c"]
    late = found.history.times > 2.0 * np.pi / abs(found.roots[0].imag)
    at = int(np.argmax(np.abs(off) * late))
    t = found.history.times[at:]
    size = np.abs(off[at]) * np.exp(found.roots[0].real * (t - t[0]))
    with style():
        for sign in (-1.0, 1.0):
            y = found.rest["delta_c"] + sign * size
            ax.plot(t, y, color=BLUE, lw=0.8, ls="--", label="decay of the leading pair")


def _roots(found: Ride, ax: Axes) -> None:
    with style():
        ax.axvline(0.0, color="0.6", lw=0.6)
        s = found.roots
        ax.plot(s.real, s.imag, "x", color=VERMILION, ms=4.0)
        ax.set_xlabel(r"Re $s$ [1/s]")
        ax.set_ylabel(r"Im $s$ [rad/s]")
        ax.margins(0.15)
