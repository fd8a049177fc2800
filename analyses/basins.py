"""Basins: the share of initial conditions that ends on the orbit, or spun out, over the speed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif import load_model
from racs_bif.plots.panels import common_legend, letter, panels
from racs_bif.plots.plate import Plate, stated, write_plate
from racs_bif.plots.style import BLACK, BLUE, VERMILION, style

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from matplotlib.axes import Axes

    from analyses._outcomes import BAND, BOX, OUTCOMES, Places, outcomes, places, wilson
    from racs_bif.symbolic.field import Array
else:
    from racs_bif.shelf.analyses._outcomes import (
        BAND,
        BOX,
        OUTCOMES,
        outcomes,
        places,
        wilson,
    )

SPEEDS: Final = (8.0, 32.0)
MAPS: Final = (20.0, 25.0)
PURPLE: Final = "#CC79A7"
COLOURS: Final = {
    "straight": "#ffffff",
    "orbit": BLUE,
    "right": VERMILION,
    "left": PURPLE,
    "unsettled": "#8a8a8a",
}
TITLES: Final = {
    "straight": "straight running",
    "orbit": "orbit (shimmy)",
    "right": r"spun out, $\delta_c > 0$",
    "left": r"spun out, $\delta_c < 0$",
    "unsettled": "unsettled",
}
LOOKS: Final = {
    "straight": (BLACK, "-", "o"),
    "orbit": (BLUE, "-", "s"),
    "right": (VERMILION, "-", "^"),
    "left": (PURPLE, "--", "v"),
    "unsettled": ("#8a8a8a", ":", "x"),
}


def run(
    out: Path,
    *,
    speeds: int = 13,
    samples: int = 80,
    resolution: int = 40,
    duration: float = 60.0,
    seed: int = 1,
    progress: Callable[[float], None] | None = None,
) -> Path:
    """Write ``basins.png`` with its caption and numbers and ``basins.csv``; return the first.

    Parameters
    ----------
    out : Path
        Folder.
    speeds, samples : int
        Speeds, and initial conditions at each.
    resolution : int
        Initial conditions along an axis of a map.
    duration : float
        Of every simulation [s].
    seed : int
        Of the random initial conditions.
    progress : callable, optional
        Told the share that is done.
    """
    tell = progress or (lambda _share: None)
    u = np.linspace(*SPEEDS, speeds)
    where = places(np.array([*u, *MAPS]))
    random = np.random.default_rng(seed)
    drawn = {k: random.uniform(*BOX[k], speeds * samples) for k in ("v", "w")}
    spun = np.repeat([place.spun for place in where[:speeds]], samples)
    ended = outcomes(
        np.repeat(u, samples), drawn["v"], drawn["w"], spun, duration, lambda s: tell(0.4 * s)
    )
    counts = np.array(
        [np.bincount(row, minlength=len(OUTCOMES)) for row in ended.reshape(speeds, samples)]
    )
    axes_of = {k: np.linspace(*BOX[k], resolution) for k in ("v", "w")}
    V, W = (grid.ravel() for grid in np.meshgrid(axes_of["v"], axes_of["w"]))
    maps = {}
    for k, speed in enumerate(MAPS):
        full = np.full(len(V), 1.0)
        maps[speed] = outcomes(
            speed * full,
            V,
            W,
            where[speeds + k].spun * full,
            duration,
            lambda s, k=k: tell(0.4 + 0.3 * (k + s)),  # type: ignore[misc] # bound at once
        )

    figure, axes = panels(1, 3, height=2.5, legend_rows=1)
    _shares(u, counts, samples, axes[0])
    for found, ax in zip(maps.values(), axes[1:], strict=True):
        _map(axes_of, found.reshape(resolution, resolution), ax)
    letter(axes, ["share of initial conditions", *(f"u = {speed:g} m/s" for speed in MAPS)])
    common_legend(figure, axes, columns=5)
    numbers = {
        "u": u,
        "samples": samples,
        "counts": {name: counts[:, k] for k, name in enumerate(OUTCOMES)},
        "stable": [place.stable for place in where],
        "maps": {f"{s:g}": np.bincount(m, minlength=len(OUTCOMES)) for s, m in maps.items()},
    }
    path = write_plate(
        out, "basins", figure, Plate(__doc__.strip(), _caption(u, counts, maps, where), numbers)
    )
    _table(out, u, counts, samples)
    tell(1.0)
    return path


def _caption(
    u: Array, counts: Array, maps: Mapping[float, Array], where: list[Places]
) -> tuple[str, ...]:
    told = []
    for k, (speed, found) in enumerate(maps.items()):
        total = len(found)
        shares = [
            f"{name} {np.count_nonzero(found == j) / total:.1%}"
            for j, name in enumerate(OUTCOMES)
            if np.any(found == j)
        ]
        stable = where[len(u) + k].stable
        sides = [name for name in ("right", "left") if not stable[name]]
        ghosts = [name for name in sides if np.any(found == OUTCOMES.index(name))]
        text = f"u = {speed:g} m/s: {', '.join(shares)}; stable equilibria: " + ", ".join(
            f"{name} {number}" for name, number in stable.items()
        )
        if ghosts:
            text += (
                f". There is no stable equilibrium on the {' and '.join(ghosts)} side: vehicles "
                "seen there linger where a fold has taken it, and will leave"
            )
        told.append(text)
    share = counts[:, OUTCOMES.index("orbit")] / counts.sum(axis=1)
    most = int(np.argmax(share))
    return (
        f"Where vehicles are that began with v in {_span('v')} m/s and w in {_span('w')} rad/s, "
        f"evenly drawn, delta_c = 0: {stated(load_model('racs'), 'C_s', 'c', 'm_c', 'delta_f')}, "
        f"realised on {BAND[0]:g} to {BAND[1]:g} rad/s. Bars: 95 % confidence (Wilson). 'right' "
        "is spun out with delta_c > 0, 'left' with delta_c < 0, both tyres past their peak.",
        f"The share on the orbit is largest at u = {u[most]:g} m/s, {share[most]:.0%}, and "
        f"{share[-1]:.0%} at {u[-1]:g} m/s.",
        ". ".join(told) + ".",
    )


def _span(name: str) -> str:
    return f"{BOX[name][0]:g} to {BOX[name][1]:g}"


def _shares(u: Array, counts: Array, samples: int, ax: Axes) -> None:
    with style():
        for k, name in enumerate(OUTCOMES):
            if not counts[:, k].any():
                continue
            share = counts[:, k] / samples
            ends = np.array([wilson(int(n), samples) for n in counts[:, k]]).T
            colour, pattern, mark = LOOKS[name]
            ax.errorbar(
                u,
                share,
                yerr=np.abs(ends - share),
                color=colour,
                ls=pattern,
                marker=mark,
                ms=3.0,
                lw=0.8,
                elinewidth=0.6,
                label=TITLES[name],
            )
        ax.set_xlabel(r"$u$ [m/s]")
        ax.set_ylabel("share")
        ax.set_ylim(-0.03, 1.03)


def _map(grid: Mapping[str, Array], found: Array, ax: Axes) -> None:
    from matplotlib.colors import ListedColormap

    with style():
        ax.pcolormesh(
            grid["v"],
            grid["w"],
            found,
            cmap=ListedColormap([COLOURS[name] for name in OUTCOMES]),
            vmin=-0.5,
            vmax=len(OUTCOMES) - 0.5,
            shading="nearest",
            rasterized=True,
        )
        ax.set_xlabel(r"initial $v$ [m/s]")
        ax.set_ylabel(r"initial $w$ [rad/s]")


def _table(out: Path, u: Array, counts: Array, samples: int) -> None:
    """Write the shares and their confidence intervals."""
    from racs_bif.results.atomic import write_text

    lines = ["u,outcome,count,samples,share,low,high"]
    for value, row in zip(u, counts, strict=True):
        for name, count in zip(OUTCOMES, row, strict=True):
            low, high = wilson(int(count), samples)
            share = count / samples
            lines.append(f"{value:g},{name},{count},{samples},{share:.4f},{low:.4f},{high:.4f}")
    write_text(out / "basins.csv", "\n".join(lines) + "\n")
