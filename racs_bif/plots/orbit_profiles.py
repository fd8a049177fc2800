"""Orbits in time and in the plane of two states, from the profiles of a saved branch."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from racs_bif.errors import UsageError, nearest
from racs_bif.plots.style import BLACK, BLUE, SIZE, VERMILION, style
from racs_bif.plots.text import axis_label, symbol

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from racs_bif.results.branch import Branch, Profile

_LOOKS: Final = (
    (BLACK, "-"),
    (BLUE, "--"),
    (VERMILION, ":"),
    (BLACK, "-."),
    (BLUE, (0, (5, 1, 1, 1, 1, 1))),
    (VERMILION, (0, (6, 1.5))),
)


def draw_profile(
    branch: Branch, names: tuple[str, ...] = (), state: str | None = None, *, ax: Axes | None = None
) -> Axes:
    """Draw one period of a state on several orbits of a branch against the fraction of the period.

    Parameters
    ----------
    branch : Branch
        A branch of orbits.
    names : tuple of str
        Its special points; all that have a profile by default.
    state : str, optional
        The state; what the model suggests by default.
    ax : Axes, optional
        Where to draw; a new figure by default.

    Raises
    ------
    UsageError
        If a point or state has no profile.
    """
    chosen = profiles_of(branch, names)
    shown = _state(branch, state)
    with style():
        ax = ax or new_axes()
        for k, (name, profile) in enumerate(chosen.items()):
            colour, pattern = _LOOKS[k % len(_LOOKS)]
            ax.plot(
                profile.times / profile.times[-1],
                profile.states[:, profile.names.index(shown)],
                color=colour,
                linestyle=pattern,
                linewidth=0.9,
                label=_caption(branch, name),
            )
        ax.set_xlabel(r"time / period")
        ax.set_ylabel(axis_label(shown, branch.system.unit(shown)))
        ax.margins(x=0.0, y=0.08)
        _legend(ax)
    return ax


def draw_phase(
    branch: Branch,
    names: tuple[str, ...] = (),
    states: tuple[str, str] | None = None,
    *,
    ax: Axes | None = None,
) -> Axes:
    """Draw orbits of a branch in the plane of two states.

    Parameters
    ----------
    branch : Branch
        A branch of orbits.
    names : tuple of str
        Its special points; all that have a profile by default.
    states : (str, str), optional
        Horizontal and vertical axis. By default what the model suggests, and its rate or the next
        state.
    ax : Axes, optional
        Where to draw; a new figure by default.

    Raises
    ------
    UsageError
        If a point or state has no profile.
    """
    chosen = profiles_of(branch, names)
    horizontal, vertical = states or plane_of(branch)
    for name in (horizontal, vertical):
        _state(branch, name)
    with style():
        ax = ax or new_axes()
        for k, (name, profile) in enumerate(chosen.items()):
            colour, pattern = _LOOKS[k % len(_LOOKS)]
            ax.plot(
                profile.states[:, profile.names.index(horizontal)],
                profile.states[:, profile.names.index(vertical)],
                color=colour,
                linestyle=pattern,
                linewidth=0.9,
                label=_caption(branch, name),
            )
        ax.set_xlabel(axis_label(horizontal, branch.system.unit(horizontal)))
        ax.set_ylabel(axis_label(vertical, branch.system.unit(vertical)))
        ax.margins(0.06)
        _legend(ax)
    return ax


def new_axes() -> Axes:
    """Return the axes of a new figure."""
    from matplotlib import pyplot as plt

    ax: Axes = plt.subplots(figsize=SIZE, layout="constrained")[1]
    return ax


def check_orbits(branch: Branch) -> None:
    """Refuse a branch that is none of orbits.

    Raises
    ------
    UsageError
        If it is another.
    """
    if branch.kind != "orbit":
        msg = f"{branch.name} must be a branch of orbits, not of kind '{branch.kind}'"
        raise UsageError(msg)


def profiles_of(branch: Branch, names: tuple[str, ...]) -> dict[str, Profile]:
    """Return the profiles of special points, all where none is named.

    Raises
    ------
    UsageError
        If there are none.
    """
    check_orbits(branch)
    for name in names:
        if name not in branch.profiles:
            msg = f"no orbit of {branch.name} is kept at '{name}'; {nearest(name, branch.profiles)}"
            raise UsageError(msg)
    chosen = {name: branch.profiles[name] for name in names or branch.profiles}
    if not chosen:
        msg = f"{branch.name} keeps no orbit; ask for some with at=(...) when continuing"
        raise UsageError(msg)
    return chosen


def _state(branch: Branch, state: str | None) -> str:
    known = next(iter(branch.profiles.values())).names
    if state is None:
        return branch.system.shown if branch.system.shown in known else known[0]
    if state not in known:
        msg = f"unknown state '{state}'; {nearest(state, known)}"
        raise UsageError(msg)
    return state


def plane_of(branch: Branch, state: str | None = None) -> tuple[str, str]:
    """Return the state shown and its rate, or the state after it."""
    known = next(iter(branch.profiles.values())).names
    first = _state(branch, state)
    if f"d{first}" in known:
        return first, f"d{first}"
    place = known.index(first)
    return first, known[(place + 1) % len(known)]


def _caption(branch: Branch, name: str) -> str:
    point = branch[name]
    where = ", ".join(f"{symbol(k)} = {v:.5g}" for k, v in point.parameters.items())
    return f"{name}, {where}"


def _legend(ax: Axes) -> None:
    """Place the legend; orbits leave little room for one, so that a picture has it above."""
    from matplotlib.ticker import MaxNLocator

    ax.xaxis.set_major_locator(MaxNLocator(6))
    ax.legend(loc="best")
