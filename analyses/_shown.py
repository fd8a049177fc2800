"""How rides of the vehicle are drawn: against time, and in the plane of delta_c and its rate."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from racs_bif.plots.panels import common_legend, letter, panels
from racs_bif.plots.phase import draw as draw_phase
from racs_bif.plots.plate import plain, stated
from racs_bif.plots.style import BLACK, BLUE, VERMILION, style
from racs_bif.plots.text import axis_label

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from analyses._ridden import Ride

LOOKS: Final = ((BLACK, "-"), (BLUE, "--"), (VERMILION, ":"))
PLANE: Final = ("delta_c", "ddelta_c")


def over_time(rides: Mapping[str, Ride], name: str, ax: Axes) -> None:
    """Draw a state of one ride or several against time, with the range of the only ride's orbit."""
    with style():
        for (title, ride), (colour, pattern) in zip(rides.items(), LOOKS, strict=False):
            history = ride.history
            ax.plot(
                history.times,
                history.column(name),
                color=colour,
                linestyle=pattern,
                linewidth=0.7,
                label=title,
            )
            ax.set_ylabel(axis_label(name, history.units[name]))
            if len(rides) == 1 and ride.orbit is not None:
                for value in ride.orbit_range(name):
                    ax.axhline(value, color=BLUE, linewidth=1.0, label="range of the exact orbit")
            if len(rides) == 1:
                ax.axhline(
                    ride.rest[name],
                    color=VERMILION,
                    linewidth=0.8,
                    linestyle="-" if ride.stable else (0, (3.2, 1.6)),
                    label=f"equilibrium, {'stable' if ride.stable else 'unstable'}",
                )
        ax.set_xlabel("time [s]")
        ax.margins(x=0.0, y=0.08)


def portraits(rides: Mapping[str, Ride], *, columns: int = 2, height: float = 2.3) -> Figure:
    """Return a figure with the phase portrait of each ride, the last third of it darker."""
    rows = -(-len(rides) // columns)
    figure, axes = panels(rows, columns, height=height, legend_rows=2)
    for ride, ax in zip(rides.values(), axes, strict=True):
        draw_phase(
            ride.history,
            PLANE,
            orbits=() if ride.orbit is None else ((ride.orbit, ride.orbit_stable),),
            equilibria=((ride.rest, ride.stable), *ride.others),
            late=2.0 * ride.history.times[-1] / 3.0,
            ax=ax,
        )
    letter(axes, list(rides))
    common_legend(figure, axes, columns=3)
    return figure


def told(title: str, ride: Ride) -> str:
    """Say in words what a ride showed."""
    text = f"{plain(title)}: the equilibrium is {'stable' if ride.stable else 'unstable'}"
    if len(ride.roots):
        s = ride.roots[0]
        text += f", rightmost exact root {s.real:+.4f} {'+-' if s.imag else ''} {abs(s.imag):.4f}i"
        text += " 1/s"
    if ride.orbit is not None:
        low, high = ride.orbit_range("delta_c")
        text += (
            f"; the exact orbit has period {ride.period:.5g} s and delta_c from {low:.4f} to "
            f"{high:.4f} rad, and is {'stable' if ride.orbit_stable else 'unstable'}"
        )
    if any(stable for _, stable in ride.others):
        places = ", ".join(f"{state['delta_c']:.4f}" for state, stable in ride.others if stable)
        text += f"; spun-out equilibria are stable at delta_c = {places} rad"
    low, high = ride.history.extremes("delta_c", after=2.0 * ride.history.times[-1] / 3.0)
    end = float(ride.history.times[-1])
    return text + (
        f"; the simulation has delta_c from {low:.4f} to {high:.4f} rad in the last third of "
        f"{end:g} s."
    )


def numbers_of(ride: Ride) -> dict[str, object]:
    """Return the numbers of a ride."""
    low, high = ride.history.extremes("delta_c", after=2.0 * ride.history.times[-1] / 3.0)
    return {
        "roots": ride.roots,
        "stable": ride.stable,
        "period": ride.period,
        "orbit": list(ride.orbit_range("delta_c")),
        "multipliers": ride.multipliers,
        "simulated": [low, high],
        "error": ride.history.errors["delta_c"],
    }


def method(rides: Sequence[Ride], *names: str) -> str:
    """Say how rides were computed."""
    first = rides[0]
    worst = max(ride.history.errors["delta_c"] for ride in rides)
    return (
        f"Simulations of the exact fractional operator from delta_c = 0.01 rad at rest, steps of "
        f"{first.history.step:.4g} s, estimated error of delta_c {worst:.1e} rad at most, that "
        "of the phase included; "
        f"{stated(first.system, *names)}. The memory of "
        "the material decays algebraically: after a finite time a simulation is still beside the "
        "equilibrium or the orbit that it tends to."
    )
