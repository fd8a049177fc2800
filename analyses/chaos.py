"""Chaos at c = 0.3? Exponents, spectra, sections and orbits over C_s, and where chaos is."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif import load_model
from racs_bif.plots.panels import common_legend, letter, panels
from racs_bif.plots.plate import Plate, stated, write_plate
from racs_bif.plots.style import BLACK, BLUE, VERMILION, style
from racs_bif.plots.sweep import describe, draw

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from matplotlib.axes import Axes

    from analyses._attractors import Family, Motion, family, motion
    from analyses._pinned import pinned
    from analyses._swept import CAVEAT, computed
else:
    from racs_bif.shelf.analyses._attractors import family, motion
    from racs_bif.shelf.analyses._pinned import pinned
    from racs_bif.shelf.analyses._swept import CAVEAT, computed

SPEED: Final = 20.0
ARM: Final = 0.3
"""Where the paper has chaos [m]."""
STIFFNESSES: Final = (6e3, 36e3)
ORDERS: Final = (0.30, 0.60)
"""Orders alpha at the paper's c and the calibrated stiffness, where chaos can be told apart."""
_SHOWN: Final = 20.0
LOOKS: Final = ((BLACK, "o"), (BLUE, "s"), (VERMILION, "^"))


def run(
    out: Path,
    *,
    members: int = 31,
    duration: float = 160.0,
    points: int = 150,
    progress: Callable[[float], None] | None = None,
) -> Path:
    """Write ``chaos.png`` with its caption and numbers, and return its path.

    Parameters
    ----------
    out : Path
        Folder.
    members : int
        Values of C_s, and of alpha.
    duration : float
        Of every simulation [s].
    points : int
        Most orbits of a branch.
    progress : callable, optional
        Told the share that is done.
    """
    tell = progress or (lambda _share: None)
    claimed = {"u": SPEED, "c": ARM}
    over_stiffness = family(
        claimed,
        "C_s",
        np.linspace(*STIFFNESSES, members),
        duration,
        lambda share: tell(0.3 * share),
    )
    over_order = family(
        {"u": SPEED},
        "alpha",
        np.linspace(*ORDERS, members),
        duration,
        lambda share: tell(0.3 + 0.35 * share),
    )
    case = computed(
        f"c = {ARM:g} m over C_s",
        claimed,
        "C_s",
        STIFFNESSES,
        members=2 * members,
        duration=min(duration, 60.0),
        points=points,
        report=lambda share: tell(0.65 + 0.25 * share),
    )
    close = _motions(over_order, duration)
    figure, axes = panels(2, 3, height=2.3, legend_rows=2)
    draw(case.sweep, case.diagram, ax=axes[0])
    axes[0].locator_params(axis="x", nbins=4)
    _exponents(over_stiffness, 1e-3, r"$C_s$ [kN/rad]", axes[1])
    _exponents(over_order, 1.0, r"$\alpha$", axes[2])
    _spectra(close, axes[3])
    _sections(close, axes[4])
    _angles(close, axes[5])
    titles = [
        f"c = {ARM:g} m: simulated, continued",
        f"c = {ARM:g} m: largest exponent",
        r"c = 0.35 m, over $\alpha$: the same",
        "power spectra",
        "Poincare sections",
        "steering angle",
    ]
    letter(axes, titles)
    common_legend(figure, [axes[0], axes[3]], columns=4)
    numbers = {
        "claimed": _numbers(over_stiffness),
        "orders": _numbers(over_order),
        "section_points": {title: len(m.section) for title, m in close.items()},
    }
    caption = (
        f"The paper claims chaos at c = {ARM:g} m, u = {SPEED:g} m/s (Figs 9, 11); C_s is not "
        f"given. {stated(load_model('racs'), 'm_c', 'alpha', 'gamma', 'delta_f')}; {members} "
        f"values of C_s, {duration:g} s each, the second half counted. Bars are two standard "
        f"errors. Sections are where delta_c rises through the middle of its range. {CAVEAT}",
        f"Verdict for c = {ARM:g} m: {verdict(over_stiffness)}",
        f"For comparison c = 0.35 m, the calibrated C_s, over alpha: {verdict(over_order)} The "
        f"motion shown, {list(close)[2]}, {_lasting(list(close.values())[2])}.",
        describe(case),
    )
    return write_plate(out, "chaos", figure, Plate(__doc__.strip(), caption, numbers))


def verdict(found: Family) -> str:
    """Say what a family of simulations is, from what was computed alone."""
    name, total = found.parameter, len(found.values)
    top = int(np.nanargmax(found.exponent - 2.0 * found.error))
    parts = [f"{found.count(k)} {k}" for k in ("rest", "periodic", "chaos", "undecided")]
    text = (
        f"of {total} values {', '.join(parts)}. Furthest above zero, by its error, is the exponent "
        f"{found.exponent[top]:.3g} +- {found.error[top]:.2g} 1/s at {name} = "
        f"{found.values[top]:.5g}. "
    )
    chaotic = [v for v, kind in zip(found.values, found.kinds, strict=True) if kind == "chaos"]
    sides = found.side[found.side != 0.0]
    flips = int(np.count_nonzero(np.diff(sides)))
    if chaotic:
        return text + f"Chaos it is from {name} = {min(chaotic):.4g} to {max(chaotic):.4g}."
    if found.doubtful:
        return text + (
            f"Not decided: {found.doubtful} have a positive exponent but too few crossings of the "
            "section to tell; make the duration longer."
        )
    return text + (
        "It is not chaos: the vehicle shimmies periodically or comes to rest. The disorder of a "
        f"sweep is which of the coexisting equilibria it ends on: the side of delta_c changes "
        f"{flips} times among the {len(sides)} neighbours at rest."
    )


def _motions(over_order: Family, duration: float) -> Mapping[str, Motion]:
    """Look closely at two vehicles of the claim, and one amid chaos."""
    own = pinned({"u": SPEED, "c": 0.15})
    calibrated = load_model("racs").parameters["C_s"]
    chaotic = [k for k, kind in enumerate(over_order.kinds) if kind == "chaos"]
    most = int(np.nanargmax(over_order.exponent))
    worst = float(over_order.values[chaotic[len(chaotic) // 2] if chaotic else most])
    conditions = {
        f"c = {ARM:g} m, {calibrated:.0f} N/rad": {"c": ARM, "C_s": calibrated},
        f"c = {ARM:g} m, {own:.0f} N/rad": {"c": ARM, "C_s": own},
        f"alpha = {worst:.3g}": {"alpha": worst},
    }
    return {k: motion({"u": SPEED, **values}, duration) for k, values in conditions.items()}


def _lasting(found: Motion) -> str:
    if found.rests:
        return "has come to rest at its end: it was chaotic for a time"
    return "goes on to the end of the run; that it does so for ever is not proved"


def _numbers(found: Family) -> dict[str, object]:
    return {
        "values": found.values,
        "exponent": found.exponent,
        "error": found.error,
        "repeats": found.repeats,
        "kinds": list(found.kinds),
    }


def _exponents(found: Family, scale: float, label: str, ax: Axes) -> None:
    colours = {"rest": BLACK, "periodic": BLUE, "chaos": VERMILION, "undecided": "0.6"}
    marks = {"rest": ".", "periodic": "s", "chaos": "^", "undecided": "x"}
    with style():
        ax.axhline(0.0, color="0.7", lw=0.6, zorder=0)
        for kind, colour in colours.items():
            at = np.array([each == kind for each in found.kinds])
            if at.any():
                ax.errorbar(
                    scale * found.values[at],
                    found.exponent[at],
                    yerr=2.0 * found.error[at],
                    fmt=marks[kind],
                    color=colour,
                    ms=3.0,
                    elinewidth=0.6,
                    label=kind,
                )
        low, high = ax.get_ylim()
        ax.set_ylim(low, high + 0.4 * (high - low))  # room for the legend
        ax.legend(loc="upper left", handlelength=1.0, ncols=2, columnspacing=0.8)
        ax.set_xlabel(label)
        ax.set_ylabel(r"$\lambda_1$ [1/s]")


def _spectra(close: Mapping[str, Motion], ax: Axes) -> None:
    with style():
        for (title, found), (colour, _) in zip(close.items(), LOOKS, strict=True):
            level = 10.0 * np.log10(np.maximum(found.power, 1e-12))
            ax.plot(found.frequency, level, color=colour, lw=0.7, label=title)
        ax.set_xlim(0.0, 10.0)
        ax.set_ylim(-100.0, 5.0)
        ax.set_xlabel("frequency [Hz]")
        ax.set_ylabel(r"power of $\delta_c$ [dB of the peak]")


def _sections(close: Mapping[str, Motion], ax: Axes) -> None:
    with style():
        for found, (colour, mark) in zip(close.values(), LOOKS, strict=True):
            x, y = found.section.T
            ax.plot(x, y, mark, color=colour, ms=2.6, mew=0.0, ls="None")
        ax.set_xlabel(r"$w$ [rad/s]")
        ax.set_ylabel(r"$v$ [m/s]")
        ax.margins(0.15)


def _angles(close: Mapping[str, Motion], ax: Axes) -> None:
    """Draw the last seconds of the angles."""
    with style():
        for found, (colour, _) in zip(close.values(), LOOKS, strict=True):
            late = found.times > found.times[-1] - _SHOWN
            ax.plot(found.times[late], found.angle[late], color=colour, lw=0.7)
        ax.set_xlabel("time [s]")
        ax.set_ylabel(r"$\delta_c$ [rad]")
        ax.margins(x=0.0, y=0.1)
