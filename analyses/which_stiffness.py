"""Which C_s? The stiffness that the paper does not give, from each of its stability boundaries.

Every statement of the paper about stability is turned into the set of stiffnesses for which it is
true, by exact root counts over C_s and exact Hopf points; `_claimed` holds the statements. No
stiffness lies in all sets. The best reading is the variant and C_s that make most statements true;
beside it stands the one with the least squares of ln C_s, over the distances to the sets.

Straight running is judged by its linear stability. Whether a stable orbit exists where it is
unstable, and how large it is, is the business of `claims`.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif import load_model
from racs_bif.results.atomic import write_text

if TYPE_CHECKING:  # the folder is no package; the shelf finds its files in every installation
    from collections.abc import Callable
    from pathlib import Path

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from analyses._claimed import (
        STATEMENTS,
        Found,
        Intervals,
        describe,
        distance,
        find,
        holds,
        within,
    )
    from analyses._stability import VARIANTS
    from analyses._stability_search import SPAN
else:
    from racs_bif.shelf.analyses._claimed import STATEMENTS, describe, distance, find, holds, within
    from racs_bif.shelf.analyses._stability import VARIANTS
    from racs_bif.shelf.analyses._stability_search import SPAN

SHOWN: Final = (6e3, 8e5)
"""Stiffnesses that the pictures show [N/rad]."""
_FINE: Final = 20_001


@dataclass(frozen=True)
class Fit:
    """How well one variant can be made to agree with the paper.

    Parameters
    ----------
    variant : str
        Its name.
    found : tuple of tuple of Found
        For each statement, for each reading.
    most : int
        Most statements that one stiffness makes true.
    where : Intervals
        The stiffnesses that do [N/rad].
    missed : tuple of str
        The statements that are false there.
    never : int
        Statements that no stiffness makes true.
    calibrated : int
        Statements that the default stiffness, calibrated to Fig. 3 in variant `paper`, makes true.
    nearest : float
        Stiffness with the least squares of ln C_s [N/rad]; NaN where `never` is not zero.
    rms : float
        The root mean square distance there, of ln C_s.
    """

    variant: str
    found: tuple[tuple[Found, ...], ...]
    most: int
    where: Intervals
    missed: tuple[str, ...]
    never: int
    calibrated: int
    nearest: float
    rms: float


def run(
    out: Path, *, resolution: int = 400, progress: Callable[[float], None] | None = None
) -> Path:
    """Write ``which_stiffness.md`` and its pictures, and return the path of the former.

    Parameters
    ----------
    out : Path
        Folder.
    resolution : int
        Stiffnesses at which roots are counted; boundaries themselves are exact.
    progress : callable, optional
        Told the share that is done.
    """
    fits = []
    for k, variant in enumerate(VARIANTS):
        fits.append(fit(variant, resolution))
        if progress is not None:
            progress((k + 0.8) / (len(VARIANTS) + 1))
    out.mkdir(parents=True, exist_ok=True)
    draw(fits, out)
    path = out / "which_stiffness.md"
    write_text(path, report(fits))
    if progress is not None:
        progress(1.0)
    return path


def fit(variant: str, resolution: int = 400) -> Fit:
    """Find the stiffnesses that suit one variant best."""
    found = find(variant, STATEMENTS, resolution)
    sets = [holds(each) for each in found]
    edges = sorted({SPAN[0], SPAN[1], *(x for one in sets for pair in one for x in pair)})
    pieces = list(pairwise(edges))
    counts = [sum(within(float(np.sqrt(a * b)), one) for one in sets) for a, b in pieces]
    most = max(counts)
    where: list[tuple[float, float]] = []
    for (low, high), count in zip(pieces, counts, strict=True):
        if count == most and where and where[-1][1] == low:
            where[-1] = (where[-1][0], high)
        elif count == most:
            where.append((low, high))
    middle = float(np.sqrt(where[0][0] * where[0][1]))
    missed = tuple(
        s.key for s, one in zip(STATEMENTS, sets, strict=True) if not within(middle, one)
    )
    stiffness = np.geomspace(*SPAN, _FINE)
    apart = np.array([distance(stiffness, one) for one in sets])
    rms = np.sqrt(np.mean(apart**2, axis=0))
    never = sum(not one for one in sets)
    best = int(np.argmin(rms))
    default = load_model("racs").parameters["C_s"]
    return Fit(
        variant,
        found,
        most,
        tuple(where),
        missed,
        never,
        sum(within(default, one) for one in sets),
        float("nan") if never else float(stiffness[best]),
        float("nan") if never else float(rms[best]),
    )


def best_of(fits: list[Fit]) -> Fit:
    """Return the fit with most statements true, of several that with fewest true for no C_s."""
    return min(fits, key=lambda one: (-one.most, one.never))


def report(fits: list[Fit]) -> str:
    """Return the text of the report."""
    best = best_of(fits)
    total = len(STATEMENTS)
    calibrated = load_model("racs").parameters["C_s"]
    lines = [
        "# Which C_s?",
        "",
        f"Of {total} statements of the paper about stability, the stiffness that the paper does "
        f"not give can make at most {best.most} true: variant `{best.variant}`, C_s from "
        f"{describe(best.where)}. Not true there: {', '.join(best.missed) or 'none'}. Least "
        f"squares of ln C_s put `{best.variant}` at C_s = {best.nearest:.0f} N/rad, off by "
        f"{best.rms:.3f} (root mean square of ln C_s).",
        "",
        f"The default is calibrated to Fig. 3 alone: C_s = {calibrated:.3f} N/rad. In variant "
        f"`paper` it makes {fits[0].calibrated} of the statements true.",
        "",
        "C_s is named at the paper's E_0 = 0.5e5; where a statement has another E_0, the stiffness "
        f"follows it. Searched: {SPAN[0]:g} to {SPAN[1]:g} N/rad. 'Hopf' is asked for with the "
        "digits printed: stable on one side of the value by half a unit of its last digit, shimmy "
        "on the other (5 kg for 160 kg). Shimmy: an unstable pair above 1 rad/s.",
        "",
        "![intervals](which_stiffness_paper.png)",
        "",
        "![statements true](which_stiffness.png)",
        "",
        "| variant | true at most | for C_s [N/rad] | calibrated | never | least squares | rms |",
        "|---|---:|---|---:|---:|---:|---:|",
    ]
    lines += [
        f"| {one.variant} | {one.most} of {total} | {describe(one.where)} | {one.calibrated} "
        f"| {one.never} | {_number(one.nearest, 0)} | {_number(one.rms, 3)} |"
        for one in fits
    ]
    for one in fits:
        lines += ["", f"## Variant `{one.variant}`", "", *_table(one)]
    return "\n".join(lines) + "\n"


def _table(fitted: Fit) -> list[str]:
    lines = [
        "| statement | place | true for C_s [N/rad] | Hopf point exactly there [N/rad] (rad/s) |",
        "|---|---|---|---|",
    ]
    for statement, found in zip(STATEMENTS, fitted.found, strict=True):
        for each in found:
            sets = describe(each.holds)
            label = f", {each.reading.label}" if each.reading.label else ""
            hopf = ", ".join(
                f"{c:.2f} ({w:.4f})" for c, w in zip(each.hopf, each.omega, strict=True)
            )
            if not hopf:
                hopf = "none" if each.reading.boundary else ""
            lines.append(f"| {statement.short}{label} | {statement.place} | {sets} | {hopf} |")
    return lines


def _number(value: float, digits: int) -> str:
    return "" if np.isnan(value) else f"{value:.{digits}f}"


def draw(fits: list[Fit], out: Path) -> None:
    """Write the pictures: the sets of every variant, and how many statements are true over C_s."""
    from racs_bif.plots.style import save_picture, style

    with style():
        save_picture(_counts(fits), out / "which_stiffness.png")
        for one in fits:
            save_picture(_bars(one), out / f"which_stiffness_{one.variant}.png")


def _bars(fitted: Fit) -> Figure:
    """Draw the sets of one variant as bars on the axis of C_s."""
    from matplotlib.figure import Figure

    from racs_bif.plots.style import COLUMN, VERMILION

    rows = [
        (_title(statement.key, statement.short, each.reading.label), each)
        for statement, found in zip(STATEMENTS, fitted.found, strict=True)
        for each in found
    ]
    figure = Figure(figsize=(COLUMN, 0.075 * COLUMN * (len(rows) + 3)), layout="constrained")
    ax = figure.subplots()
    for k, (_, each) in enumerate(rows):
        _bar(ax, k, each)
    nearest = load_model("racs").parameters["C_s"]
    ax.axvline(nearest, color=VERMILION, linewidth=0.8, linestyle=(0, (4, 2)), zorder=0)
    ax.set_yticks(range(len(rows)), [title for title, _ in rows], fontsize=5.8)
    ax.tick_params(axis="y", length=0)
    ax.set_ylim(len(rows) - 0.4, -0.6)
    ax.set_title(f"variant {fitted.variant}; dashes: calibrated", fontsize=6.5, loc="right")
    _stiffness_axis(ax)
    return figure


def _bar(ax: Axes, row: int, each: Found) -> None:
    from racs_bif.plots.style import BLACK, BLUE

    for low, high in each.holds:
        a, b = max(low, SHOWN[0]), min(high, SHOWN[1])
        if a < b:
            ax.plot([a, b], [row, row], color=BLUE, linewidth=4.0, solid_capstyle="butt")
    for value in each.hopf:
        ax.plot(value, row, "|", color=BLACK, markersize=7.0, markeredgewidth=0.9)
    words = [f"{value:.0f}" for value in each.hopf]
    words += [] if each.holds else ["never true"]
    ax.annotate(
        ", ".join(words),
        (0.98, row),
        xycoords=("axes fraction", "data"),
        ha="right",
        va="center",
        fontsize=5.8,
    )


def _title(key: str, short: str, label: str) -> str:
    for name in ("alpha", "delta_f", "m_c"):
        symbol = name if name == "m_c" else f"\\{name}"
        short = short.replace(name, f"${symbol}$")
    number = key.removeprefix("fig").lstrip("0")
    return f"{number}: {short}" + (f" ({label})" if label else "")


def _counts(fits: list[Fit]) -> Figure:
    """Draw how many statements are true over C_s, a panel a variant."""
    from matplotlib.figure import Figure

    from racs_bif.plots.style import BLUE, COLUMN, VERMILION

    figure = Figure(figsize=(COLUMN, 0.95 * COLUMN), layout="constrained")
    panels = figure.subplots(3, 2, sharex=True, sharey=True)
    stiffness = np.geomspace(*SHOWN, 4001)
    nearest = load_model("racs").parameters["C_s"]
    for ax, one in zip(panels.flat, fits, strict=True):
        sets = [holds(each) for each in one.found]
        count = np.sum([distance(stiffness, where) == 0.0 for where in sets], axis=0)
        ax.fill_between(stiffness, count, step="mid", color=BLUE, alpha=0.25, linewidth=0.0)
        ax.step(stiffness, count, where="mid", color=BLUE, linewidth=0.8)
        ax.axvline(nearest, color=VERMILION, linewidth=0.8, linestyle=(0, (4, 2)))
        ax.set_title(one.variant, fontsize=7.0, pad=3.0)
        ax.set_ylim(0, len(STATEMENTS))
        ax.set_yticks(range(0, len(STATEMENTS) + 1, 4))
        ax.set_xscale("log")
        ax.set_xlim(*SHOWN)
    for ax in panels[-1]:
        _stiffness_axis(ax)
    figure.supylabel(f"statements true, of {len(STATEMENTS)}", fontsize=8.0)
    return figure


def _stiffness_axis(ax: Axes) -> None:
    from matplotlib.ticker import NullFormatter

    ax.set_xscale("log")
    ax.set_xlim(*SHOWN)
    ax.xaxis.set_minor_formatter(NullFormatter())
    ax.set_xticks([1e4, 3e4, 1e5, 3e5], ["10", "30", "100", "300"])
    ax.set_xlabel(r"$C_s$ [kN/rad]")
