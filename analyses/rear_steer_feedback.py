"""Rear-steer feedback designed with python-control, its shimmy speed on the exact operator.

An actuator in parallel with the viscoelastic unit turns the rear axle by a moment T_a. The vehicle
is linearised above its shimmy speed, with its realised memory, and `control.lqr` designs a feedback
of all states. Only the four mechanical states can be measured, and two ways to do with them are
compared: the gains of the memory states are left out, or what they contribute in the shimmy mode is
given to delta_c, whose motion they remember, and its rate.

Attached is ``T_a = -kappa K x``: kappa = 0 is the vehicle as it is, kappa = 1 the design. Hopf
points and the curves of Hopf points in (kappa, u) are those of the exact fractional operator, so
that neither the realisation nor the linearisation at one speed is trusted with the answer.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from racs_bif import (
    continue_curve,
    continue_equilibria,
    load_model,
    margins,
    to_control,
    with_feedback,
)
from racs_bif.shelf.load import system_of

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from racs_bif.fractional.system import System
    from racs_bif.interop.loop import Margins
    from racs_bif.results.branch import Branch
    from racs_bif.results.special import SpecialPoint
    from racs_bif.symbolic.model import Model

LARGEST = {"w": 0.5, "delta_c": 0.05, "ddelta_c": 0.5}
"""What is taken for large (Bryson's rule): Q = diag(1 / LARGEST**2) [rad/s, rad, rad/s]."""
REMEMBERED = ("delta_c", "ddelta_c")
"""States to which the memory's share is given."""
SPAN = (5.0, 42.0)
"""Speeds [m/s]; farther up the equilibria of the vehicle with feedback end in folds."""
KAPPAS = (0.0, 1.5)
"""Span of kappa on the curves of Hopf points."""
LEFT_OUT, GIVEN = "memory left out", "memory given to delta_c"


@dataclass(frozen=True, eq=False)
class Design:
    """A feedback and what it does.

    Parameters
    ----------
    gains : dict of str to float
        Gains of T_a by the state they multiply [N m per unit of the state].
    branch : Branch
        Equilibria over u at kappa = 1.
    curve : Branch
        Exact Hopf points in (kappa, u).
    margins : Margins
        Of the exact loop through the viscoelastic unit at the speed of the design.
    """

    gains: Mapping[str, float]
    branch: Branch
    curve: Branch
    margins: Margins


@dataclass(frozen=True, eq=False)
class Study:
    """Everything that is reported.

    Parameters
    ----------
    share : float
        Of the moment that LQR demands in the shimmy mode, what the memory states contribute.
    without : Branch
        Equilibria over u without feedback.
    margins : Margins
        As in `Design`, without feedback.
    designs : dict of str to Design
        By how they treat the memory.
    """

    share: float
    without: Branch
    margins: Margins
    designs: Mapping[str, Design]


def run(
    out: Path,
    *,
    speed: float = 15.0,
    moment: float = 200.0,
    progress: Callable[[float], None] | None = None,
) -> Path:
    """Write ``rear_steer_feedback.md`` and ``.png``, and return the text's path.

    Parameters
    ----------
    out : Path
        Folder.
    speed : float
        Where the feedback is designed [m/s].
    moment : float
        Moment of the actuator that is taken for large [N m]: R = 1 / moment**2.
    progress : callable, optional
        Told the share that is done.
    """
    from racs_bif.plots.style import save_picture

    done = study(speed, moment, progress)
    out.mkdir(parents=True, exist_ok=True)
    save_picture(picture(done), out / "rear_steer_feedback.png")
    path = out / "rear_steer_feedback.md"
    path.write_text(report(done, speed, moment), encoding="utf-8")
    return path


def study(speed: float, moment: float, progress: Callable[[float], None] | None = None) -> Study:
    """Design the feedbacks, attach them, and follow the shimmy."""
    vehicle = actuated()
    plant = to_control(system_of(vehicle, parameters={"u": speed}), inputs=["T_a"])
    gains, share = designed(plant, len(vehicle.states), moment)
    passive = system_of(steered(vehicle))
    without = continue_equilibria(passive, "u", SPAN)
    done: dict[str, Design] = {}
    for name, row in gains.items():
        if progress is not None:
            progress(0.2 + 0.4 * len(done))
        table = dict(zip(vehicle.states, map(float, row), strict=True))
        done[name] = follow(passive, table, speed)
    at_speed = passive.with_parameters({"u": speed})
    return Study(share=share, without=without, margins=margins(at_speed), designs=done)


def actuated() -> Model:
    """Return the vehicle with the moment T_a as an input."""
    return with_feedback(
        load_model("racs"),
        forces={"w": "T_a", "ddelta_c": "-T_a"},  # where (9) has +- (d - c) F_d
        parameters={"T_a": 0.0},
        inputs=["T_a"],
        name="racs_actuated",
    )


def steered(vehicle: Model) -> Model:
    """Return the vehicle with the feedback, its gains zero."""
    law = " + ".join(f"k_{x}*{x}" for x in vehicle.states)
    return with_feedback(
        vehicle,
        {"T_a": f"-kappa*({law})"},
        parameters={"kappa": 0.0} | {f"k_{x}": 0.0 for x in vehicle.states},
        name="racs_rear_steer",
    )


def designed(
    plant: Any,  # noqa: ANN401 - control has no types
    own: int,
    moment: float,
) -> tuple[dict[str, NDArray[np.float64]], float]:
    """Return the gains of the mechanical states, and the memory's share of the moment."""
    import control

    weights = [1.0 / LARGEST[x] ** 2 if x in LARGEST else 0.0 for x in plant.state_labels]
    gain = control.lqr(plant.A, plant.B, np.diag(weights), [[1.0 / moment**2]])[0][0]
    values, vectors = np.linalg.eig(plant.A)
    mode = vectors[:, int(np.argmax(values.real))]
    memory = gain[own:] @ mode[own:]
    places = [plant.state_labels.index(x) for x in REMEMBERED]
    parts = np.array([mode[places].real, mode[places].imag])
    given = gain[:own].copy()
    given[places] += np.linalg.solve(parts, [memory.real, memory.imag])
    return {LEFT_OUT: gain[:own], GIVEN: given}, float(abs(memory) / abs(gain @ mode))


def follow(passive: System, gains: Mapping[str, float], speed: float) -> Design:
    """Continue equilibria with a feedback, and the exact Hopf point while it is turned up."""
    system = passive.with_parameters({f"k_{x}": k for x, k in gains.items()})
    start = continue_equilibria(system, "u", (5.0, 15.0))["H1"]
    active = system.with_parameters({"kappa": 1.0})
    return Design(
        gains=gains,
        branch=continue_equilibria(active, "u", SPAN),
        curve=continue_curve(start, ("kappa", "u"), (KAPPAS, SPAN), operator="exact"),
        margins=margins(active.with_parameters({"u": speed})),
    )


def shimmy(branch: Branch) -> list[SpecialPoint]:
    """Return the Hopf points of a branch that the exact operator confirms."""
    return [point for point in branch.special if point.label == "H" and point.exact is not None]


def report(done: Study, speed: float, moment: float) -> str:
    """Return the text."""
    scales = ", ".join(f"{name} {value:g}" for name, value in LARGEST.items())
    lines = [
        "# Rear-steer feedback against shimmy",
        "",
        f"`control.lqr` at u = {speed:g} m/s, R = 1/({moment:g} N m)^2, Q by Bryson's rule with "
        f"{scales}. In the shimmy mode {100 * done.share:.0f} % of the moment it demands come from "
        "the memory states, which cannot be measured.",
        "",
        "| gains of T_a [N m, SI] | " + " | ".join(done.designs[GIVEN].gains) + " |",
        "|---|" + "---:|" * len(done.designs[GIVEN].gains),
    ]
    lines += [
        f"| {name} | " + " | ".join(f"{k:.6g}" for k in design.gains.values()) + " |"
        for name, design in done.designs.items()
    ]
    lines += [
        "",
        f"Hopf points on the exact operator, {SPAN[0]:g} to {SPAN[1]:g} m/s:",
        "",
        "| feedback | Hopf point | u [m/s] | omega [rad/s] | l1 | shift of u by realising |",
        "|---|---|---:|---:|---:|---:|",
        *_rows("none", done.without),
    ]
    for name, design in done.designs.items():
        lines += _rows(name, design.branch)
    lines += [""]
    for name, design in done.designs.items():
        top = int(np.argmax(design.curve.parameter))
        lines.append(
            f"With the {name} there is no shimmy up to {SPAN[1]:g} m/s above kappa = "
            f"{design.curve.parameter[top]:.3f} (at u = {design.curve.column('u')[top]:.1f} m/s). "
        )
    lines += [
        "",
        f"Exact loop through the viscoelastic unit at {speed:g} m/s:",
        "",
        "| feedback | gain margin | phase margin [deg] | least distance from -1 |",
        "|---|---:|---:|---:|",
    ]
    found = {"none": done.margins} | {k: d.margins for k, d in done.designs.items()}
    lines += [f"| {k} | {m.gm:.4f} | {m.pm:.2f} | {m.sm:.4f} |" for k, m in found.items()]
    return "\n".join(lines) + "\n"


def _rows(name: str, branch: Branch) -> list[str]:
    rows = []
    for point in shimmy(branch):
        assert point.exact is not None  # shimmy has looked
        exact = point.exact
        rows.append(
            f"| {name} | {point.name} | {exact.parameters['u']:.6f} | {exact.omega:.6f} "
            f"| {exact.l1:.4g} | {exact.shift['u']:.1e} |"
        )
    return rows or [f"| {name} | none | | | | |"]


def picture(done: Study) -> Figure:
    """Return growth rates over the speed, and where the vehicle shimmies in (kappa, u)."""
    from matplotlib.figure import Figure

    from racs_bif.plots.style import BLACK, BLUE, COLUMN, VERMILION, style

    looks = ((VERMILION, "--"), (BLUE, "-."))
    with style():
        figure = Figure(figsize=(COLUMN, 1.5 * COLUMN), layout="constrained")
        above, below = figure.subplots(2, 1, sharex=True)
        above.axhline(0.0, color="0.6", lw=0.6)
        _rate(above, done.without, BLACK, "-", "no feedback")
        for (name, design), (colour, line) in zip(done.designs.items(), looks, strict=True):
            label = name.replace("delta_c", r"$\delta_c$")
            _rate(above, design.branch, colour, line, label)
            u, kappa = design.curve.column("u"), design.curve.parameter
            below.fill_between(u, 0.0, kappa, color="0.85", alpha=0.6, lw=0)
            below.plot(u, kappa, color=colour, ls=line, lw=1.2)
        above.set_ylabel("growth rate of shimmy [1/s]")
        above.legend(loc="lower right")
        below.axhline(1.0, color="0.6", lw=0.6)
        below.annotate("shimmy", (0.6, 0.12), xycoords="axes fraction", ha="center")
        below.annotate("no shimmy", (0.2, 0.9), xycoords="axes fraction", ha="center")
        below.set_xlim(SPAN)
        below.set_ylim(*KAPPAS)
        below.set_xlabel("speed $u$ [m/s]")
        below.set_ylabel(r"share $\kappa$ of the designed gain")
        figure.align_ylabels([above, below])
        figure.draw_without_rendering()
    figure.set_layout_engine("none")
    return figure


def _rate(ax: Any, branch: Branch, colour: str, line: str, label: str) -> None:  # noqa: ANN401
    ax.plot(branch.parameter, growth(branch), color=colour, ls=line, lw=1.2, label=label)
    for point in shimmy(branch):
        assert point.exact is not None  # shimmy has looked
        ax.plot([point.exact.parameters["u"]], [0.0], "o", color=colour, ms=3.5)


def growth(branch: Branch) -> NDArray[np.float64]:
    """Return the largest real part of pairs that oscillate at 1 rad/s or faster, (npoints,)."""
    fast = np.abs(branch.spectrum.imag) > 1.0
    rates = np.where(fast, branch.spectrum.real, -np.inf).max(axis=1)
    return np.where(np.isfinite(rates), rates, np.nan)
