"""Figure 2: cornering characteristics of the tyres, and the slip that shimmy uses of them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif import continue_equilibria, continue_orbits, load_model
from racs_bif.plots.panels import common_legend, panels
from racs_bif.plots.plate import Plate, stated, write_plate
from racs_bif.plots.style import BLACK, BLUE, style

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from racs_bif.fractional.system import System
    from racs_bif.results.branch import Profile
    from racs_bif.symbolic.field import Array

AXLES: Final = {"front": ("alpha_f", "F_f", BLACK, "-"), "rear": ("alpha_r", "F_r", BLUE, "--")}
LIMIT: Final = 0.35
"""Slip shown [rad]."""


def run(out: Path, *, speed: float = 20.0, progress: Callable[[float], None] | None = None) -> Path:
    """Draw the figure and return the path of the picture.

    Parameters
    ----------
    out : Path
        Folder.
    speed : float
        At which the orbit's slip is shown [m/s]; above the Hopf speed.
    progress : callable, optional
        Told the share that is done.
    """
    system = load_model("racs", parameters={"delta_f": 0.0})
    slip = np.linspace(-LIMIT, LIMIT, 1401)
    # Sliding sideways without turning, both slip angles are v/u.
    u = system.parameters["u"]
    curves = outputs(system, np.array([u * slip, 0.0 * slip, 0.0 * slip, 0.0 * slip]))
    loaded = load_model("racs")
    hopf = continue_equilibria(loaded, "u", (5.0, speed + 1.0))["H1"]
    orbits = continue_orbits(hopf, (5.0, speed + 1.0), method="harmonic-balance", at=(speed,))
    moving = loaded.with_parameters({"u": speed})
    used = outputs(moving, _states(orbits.profiles[orbits.at(u=speed).name]))
    if progress is not None:
        progress(0.8)

    figure, axes = panels(1, 1, height=2.5, legend_rows=2)
    ax = axes[0]
    numbers: dict[str, dict[str, float]] = {}
    with style():
        for axle, (angle, force, colour, pattern) in AXLES.items():
            values = system.parameters
            stiff = np.prod([values[f"{k}_{axle[0]}"] for k in "BCD"])
            peak = int(np.argmax(np.abs(curves[force])))
            at = abs(float(slip[peak]))
            ax.plot(slip, curves[force] / 1e3, color=colour, ls=pattern, lw=1.0, label=axle)
            for sign in (-1.0, 1.0):
                height = np.interp(sign * at, slip, curves[force]) / 1e3
                ax.plot([sign * at], [height], "o", ms=3.5, color=colour)
            low, high = float(used[angle].min()), float(used[angle].max())
            ax.plot(
                used[angle],
                used[force] / 1e3,
                color=colour,
                lw=3.0,
                alpha=0.3,
                label=f"{axle}, used by the orbit",
            )
            numbers[axle] = {
                "stiffness": -float(stiff),
                "peak_force": float(np.abs(curves[force][peak])),
                "peak_slip": at,
                "orbit_low": low,
                "orbit_high": high,
            }
        ax.axhline(0.0, color="0.85", lw=0.5, zorder=0)
        ax.axvline(0.0, color="0.85", lw=0.5, zorder=0)
        ax.set_xlabel("slip angle [rad]")
        ax.set_ylabel("lateral force [kN]")
    common_legend(figure, axes, columns=2)
    told = [
        f"{axle}: cornering stiffness {n['stiffness'] / 1e3:.1f} kN/rad, peak "
        f"{n['peak_force'] / 1e3:.2f} kN at {n['peak_slip']:.3f} rad "
        f"({np.degrees(n['peak_slip']):.1f} deg); the orbit's slip is {n['orbit_low']:.3f} to "
        f"{n['orbit_high']:.3f} rad, {_beyond(n)} the peak"
        for axle, n in numbers.items()
    ]
    caption = (
        "Lateral force over slip angle by the magic formula (8) with the values of table 1; dots "
        f"at the peaks. Broad lines: what is used by the orbit of the exact "
        f"operator at u = {speed:g} m/s, "
        f"{stated(loaded, 'C_s')}. The paper shows the curves alone.",
        ". ".join(text[0].upper() + text[1:] for text in told) + ".",
    )
    return write_plate(out, "fig02_tyres", figure, Plate(__doc__.strip(), caption, numbers))


def outputs(system: System, states: Array) -> dict[str, Array]:
    """Return the vehicle's outputs at states (4, N); the element's own output counts for none."""
    X = np.vstack([states, np.zeros(states.shape[1])])
    P = system.compiled.padded(system.values)
    found = system.compiled.output_values(X, P)
    return {name: np.broadcast_to(value, states.shape[1:]) for name, value in found.items()}


def _states(profile: Profile) -> Array:
    return np.asarray(profile.states.T)


def _beyond(numbers: dict[str, float]) -> str:
    """Say whether a range of slip goes beyond the peak."""
    most = max(abs(numbers["orbit_low"]), abs(numbers["orbit_high"]))
    return "beyond" if most > numbers["peak_slip"] else "short of"
