"""The printed equations, audited: (10)-(12) against (9), (9) against rigid bodies, units, signs.

Everything is derived or computed when it is run: the state space form by sympy from (9), the rigid
bodies by Kane's method and again by Lagrange's equations, the dimension of every term, and the
number of unstable roots of straight running over speed and stiffness for three choices of signs.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif import continue_equilibria, load_model, spectrum
from racs_bif.results.atomic import write_text

if TYPE_CHECKING:  # the folder is no package; the shelf finds its files in every installation
    from collections.abc import Callable
    from pathlib import Path

    from matplotlib.artist import Artist
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from analyses._audit_dimensions import check_all
    from analyses._audit_symbols import (
        lagrange_agrees,
        missing_terms,
        reading_agrees,
        state_space_entries,
    )
    from analyses._stability import counts_over
    from analyses._stability_search import NONE, SLOW, SPAN, Array
else:
    from racs_bif.shelf.analyses._audit_dimensions import check_all
    from racs_bif.shelf.analyses._audit_symbols import (
        lagrange_agrees,
        missing_terms,
        reading_agrees,
        state_space_entries,
    )
    from racs_bif.shelf.analyses._stability import counts_over
    from racs_bif.shelf.analyses._stability_search import NONE, SLOW, SPAN

SIGNS: Final = {
    "printed": "(5), (7), (9) verbatim",
    "restoring": "$F_d$ turned round",
    "paper": r"$F_d$ and $\delta_c$ in (7) turned round",
}
"""The variants whose signs are compared."""
SPEEDS: Final = (1.0, 100.0)
"""Speeds of the maps [m/s]."""
_SHADES: Final = ("#ffffff", "#56B4E9", "#0072B2", "#000000", "#d9d9d9")
_NAMES: Final = ("0: stable", "1", "2", "3", "no equilibrium near straight")


@dataclass(frozen=True, eq=False)
class SignMap:
    """Unstable roots of one variant over speed and stiffness.

    Parameters
    ----------
    variant : str
        Its name.
    speeds : array (m,)
        Speeds [m/s].
    stiffness : array (n,)
        Stiffnesses C_s [N/rad].
    count : int array (m, n)
        Unstable roots; `NONE` without an equilibrium.
    omega : array (m, n)
        Frequency of the rightmost root [rad/s]; NaN where nothing is unstable.
    """

    variant: str
    speeds: Array
    stiffness: Array
    count: NDArray[np.int64]
    omega: Array


@dataclass(frozen=True, kw_only=True)
class PairCrossing:
    """Where a pair crosses the axis in variant `printed`, beside a real unstable root."""

    speed: float
    omega: float
    before: int
    after: int


def run(
    out: Path,
    *,
    resolution: int = 160,
    speeds: int = 100,
    progress: Callable[[float], None] | None = None,
) -> Path:
    """Write ``audit_equations.md`` and ``audit_signs.png``, and return the path of the former.

    Parameters
    ----------
    out : Path
        Folder.
    resolution : int
        Stiffnesses of the maps.
    speeds : int
        Speeds of the maps.
    progress : callable, optional
        Told the share that is done.
    """
    maps = []
    for k, variant in enumerate(SIGNS):
        maps.append(sign_map(variant, resolution, speeds))
        if progress is not None:
            progress((k + 1) / (len(SIGNS) + 1))
    out.mkdir(parents=True, exist_ok=True)
    from racs_bif.plots.style import save_picture, style

    with style():
        save_picture(_draw(maps), out / "audit_signs.png")
    path = out / "audit_equations.md"
    sections = (_state_space(), _mechanics(), _dimensions(), _signs(maps))
    write_text(path, "\n".join(["# The printed equations, audited", *sections]))
    if progress is not None:
        progress(1.0)
    return path


def sign_map(variant: str, resolution: int, speeds: int) -> SignMap:
    """Count the unstable roots of a variant over speeds and stiffnesses."""
    at = np.linspace(*SPEEDS, speeds)
    stiffness, count, omega = counts_over(variant, [{"u": float(u)} for u in at], resolution)
    return SignMap(variant, at, stiffness, count, omega)


def printed_crossing() -> PairCrossing:
    """Find where, at the calibrated C_s, a pair of `printed` crosses the axis."""
    system = load_model("racs", variant="printed")
    hopf = next(p for p in continue_equilibria(system, "u", (5.0, 60.0)).special if p.label == "H")
    if hopf.exact is None:
        msg = "the Hopf point has no exact counterpart"
        raise RuntimeError(msg)
    speed = hopf.exact.parameters["u"]
    counts = [
        spectrum(system.with_parameters({"u": speed + step})).roots.unstable for step in (-0.1, 0.1)
    ]
    return PairCrossing(speed=speed, omega=hopf.exact.omega, before=min(counts), after=max(counts))


def _state_space() -> str:
    entries = state_space_entries()
    wrong = [entry for entry in entries if not entry.agrees]
    lines = [
        "",
        "## (10)-(12) from (9)",
        "",
        f"{len(entries)} entries derived from (9); {len(wrong)} differ from what is printed.",
        "",
        "| entry | printed | derived |",
        "|---|---|---|",
    ]
    for entry in wrong:
        printed = "nothing" if entry.printed is None else f"`{entry.printed}`"
        lines.append(f"| {entry.name} | {printed} | `{entry.derived}` |")
    lines += [
        "",
        "B_2 is printed with two entries for three forces. Read as [0, c/X, -(d-c)/X], X = e (c-e) "
        f"m_c - I_cs, it {'agrees' if reading_agrees() else 'does NOT agree'}; the variants "
        "`printed12` and `paper12` read it so.",
    ]
    return "\n".join(lines)


def _mechanics() -> str:
    agrees = "agrees" if lagrange_agrees() else "does NOT agree"
    lines = [
        "",
        "## (9) and (7) against rigid bodies hinged at Q",
        "",
        "Derived by Kane's method (variant `lagrange`), to first order; Lagrange's equations in "
        f"quasi-velocities: {agrees}. Left side minus right side has, beyond (9) and (7):",
        "",
        "| row | terms that (9), (7) have not |",
        "|---|---|",
    ]
    lines += [f"| {name} | `{terms}` |" for name, terms in missing_terms().items()]
    return "\n".join(lines)


def _dimensions() -> str:
    base = load_model("racs").parameters
    arm = base["d"] / (base["d"] - base["c"])
    checks = check_all()
    passed = not any(check.wrong for check in checks)
    lines = [
        "",
        "## Dimensions",
        "",
        "| equation | dimension of its terms | wrong |",
        "|---|---|---|",
        *(f"| {c.name} | {c.unit} | {c.wrong or 'nothing'} |" for c in checks),
        "",
        f"{'No equation fails' if passed else 'Some equations fail'}: the entries of (12) that do "
        "not follow from (9) have its dimensions too. So has (6), although its d should be "
        f"the arm d - c of the strain: C_s is too large by d/(d-c) = {arm:.4f} for given A and h.",
        "",
        f"E_0 = {base['E_0']:g} is printed in MPa. The calibrated C_s = {base['C_s']:.3f} N/rad "
        f"then needs A/h = {base['A_h'] * 1e-6:.4g} m; read in Pa it needs {base['A_h']:.6g} m.",
    ]
    return "\n".join(lines)


def _signs(maps: list[SignMap]) -> str:
    crossing = printed_crossing()
    calibrated = load_model("racs").parameters["C_s"]
    lines = [
        "",
        "## Signs",
        "",
        "![unstable roots](audit_signs.png)",
        "",
        f"Unstable exact roots of the equilibrium near straight running, C_s from {SPAN[0]:g} to "
        f"{SPAN[1]:g} N/rad, u from {SPEEDS[0]:g} to {SPEEDS[1]:g} m/s; shares of the map (evenly "
        "spaced in u and log C_s):",
        "",
        "| variant | 0 | 1 | 2 | 3 | no equilibrium | rightmost root, at most [rad/s] |",
        "|---|---:|---:|---:|---:|---:|---:|",
    ]
    for one in maps:
        shares = [float(np.mean(one.count == k)) for k in (0, 1, 2, 3, NONE)]
        paired = one.omega[np.isfinite(one.omega) & (one.omega > 0.0)]
        fastest = f"{paired.max():.3f}" if len(paired) else "real"
        listed = " | ".join(f"{share:.1%}" for share in shares)
        lines.append(f"| {one.variant} | {listed} | {fastest} |")
    always = bool(np.all(maps[0].count >= 1))
    three = maps[0].speeds[(maps[0].count == 3).any(axis=1)]
    region = f"on the map from u = {three.min():.0f} m/s on" if len(three) else "nowhere on the map"
    lines += [
        "",
        f"`printed`: {'everywhere' if always else 'NOT everywhere'} on the map at least one root "
        "is unstable, so that nothing the paper calls stable is. There is a Hopf point all the "
        f"same: at the calibrated C_s = {calibrated:.3f} N/rad a pair crosses at u = "
        f"{crossing.speed:.4f} m/s (omega = {crossing.omega:.4f} rad/s) beside the real root; "
        f"{crossing.before} unstable root(s) on one side, {crossing.after} on the other. "
        f"Three unstable roots are found {region}. No orbit born there is stable.",
        "",
        *(f"{_pairs(one)}\n" for one in maps[1:]),
    ]
    return "\n".join(lines)


def _pairs(one: SignMap) -> str:
    """Say what pairs are unstable next to how large a stable region."""
    paired = one.omega[one.count == 2]
    found = f"from {paired.min():.3f} to {paired.max():.3f} rad/s" if len(paired) else "none"
    shimmy = "this is shimmy" if len(paired) and paired.max() > SLOW else "this is no shimmy"
    return (
        f"`{one.variant}`: stable on {np.mean(one.count == 0):.1%} of the map; frequencies of the "
        f"rightmost root where a pair is unstable {found}: {shimmy}."
    )


def _draw(maps: list[SignMap]) -> Figure:
    from matplotlib.colors import ListedColormap
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    from racs_bif.plots.style import COLUMN, VERMILION

    figure = Figure(figsize=(COLUMN, 1.35 * COLUMN), layout="constrained")
    panels = figure.subplots(len(maps), 1, sharex=True)
    calibrated = load_model("racs").parameters["C_s"] / 1e3
    for ax, one in zip(panels, maps, strict=True):
        level = np.where(one.count == NONE, 4, np.clip(one.count, 0, 3))
        ax.pcolormesh(
            one.speeds,
            one.stiffness / 1e3,
            level.T,
            cmap=ListedColormap(_SHADES),
            vmin=-0.5,
            vmax=4.5,
            shading="nearest",
            rasterized=True,
        )
        ax.axhline(calibrated, color=VERMILION, linewidth=0.8, linestyle=(0, (4, 2)))
        ax.set_yscale("log")
        ax.set_title(f"{one.variant}: {SIGNS[one.variant]}", fontsize=6.5, pad=3.0)
        ax.set_yticks([1.0, 1e1, 1e2, 1e3, 1e4], ["1", "10", "100", "1000", "10000"])
        ax.set_ylabel(r"$C_s$ [kN/rad]", fontsize=7.0)
    panels[-1].set_xlabel("$u$ [m/s]")
    handles: list[Artist] = [
        Patch(facecolor=shade, edgecolor="black", linewidth=0.4, label=name)
        for shade, name in zip(_SHADES, _NAMES, strict=True)
    ]
    handles.append(Line2D([], [], color=VERMILION, linewidth=0.8, linestyle="--"))
    handles[-1].set_label("calibrated")
    figure.legend(
        handles=handles,
        loc="outside upper center",
        ncols=3,
        fontsize=6.0,
        title="unstable roots",
        title_fontsize=6.5,
        handlelength=1.4,
    )
    return figure
