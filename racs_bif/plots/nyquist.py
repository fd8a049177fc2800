"""Nyquist curves of a loop: the exact operator against its realisation."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from racs_bif.plots.bode import values_of
from racs_bif.plots.style import BLACK, COLUMN, VERMILION, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

_SIZE: Final = (COLUMN, COLUMN)
_FAR: Final = 3.0
"""How far from the origin is shown, unless the curve ends earlier or the user says otherwise."""


def draw(
    exact: Any,  # noqa: ANN401 - control has no types
    realised: Any = None,  # noqa: ANN401
    *,
    limit: float | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw a loop's Nyquist curve with the critical point and the unit circle.

    Negative frequencies are drawn thin; an arrow shows the sense of rising frequency where the
    curve is nearest to the critical point.

    Parameters
    ----------
    exact : control.FrequencyResponseData
        The exact loop, from `racs_bif.loop_response`.
    realised : control system, optional
        The same loop realised, from `racs_bif.loop_transfer`.
    limit : float, optional
        How far both axes reach.
    ax : Axes, optional
        Where to draw; a new figure by default.

    Returns
    -------
    Axes
        What was drawn on.

    Raises
    ------
    UsageError
        If the system has several inputs or outputs.
    """
    with style():
        if ax is None:
            from matplotlib import pyplot as plt

            ax = plt.subplots(figsize=_SIZE, layout="constrained")[1]
        _draw(exact, realised, limit, ax)
    return ax


def picture(
    exact: Any,  # noqa: ANN401 - control has no types
    realised: Any = None,  # noqa: ANN401
    *,
    limit: float | None = None,
) -> Figure:
    """Return the curve as a figure of its own, for a file."""
    from matplotlib.figure import Figure

    with style():
        figure = Figure(figsize=_SIZE, layout="constrained")
        _draw(exact, realised, limit, figure.add_subplot())
        figure.draw_without_rendering()
    figure.set_layout_engine("none")
    return figure


def _draw(
    exact: Any,  # noqa: ANN401 - control has no types
    realised: Any,  # noqa: ANN401
    limit: float | None,
    ax: Axes,
) -> None:
    responses = values_of(exact, realised, None)
    angle = np.linspace(0.0, 2.0 * np.pi, 361)
    ax.axhline(0.0, color="0.8", lw=0.6, zorder=0)
    ax.axvline(0.0, color="0.8", lw=0.6, zorder=0)
    ax.plot(np.cos(angle), np.sin(angle), color="0.6", ls=":", lw=0.8)
    looks = ((BLACK, "-", 1.6, "exact"), (VERMILION, "--", 0.9, "realised"))
    for response, (colour, line, width, label) in zip(responses, looks, strict=False):
        ax.plot(response.real, response.imag, color=colour, ls=line, lw=width, label=label)
        ax.plot(response.real, -response.imag, color=colour, ls=line, lw=0.4 * width)
    ax.plot([-1.0], [0.0], "+", color=BLACK, ms=8.0, mew=1.2)
    _arrow(responses[0], ax)
    reach = limit or min(_FAR, 1.1 * max(1.0, float(np.abs(responses[0]).max())))
    ax.set_xlim(-reach, reach)
    ax.set_ylim(-reach, reach)
    ax.set_aspect("equal")
    ax.set_xlabel(r"Re $L(\mathrm{i}\omega)$")
    ax.set_ylabel(r"Im $L(\mathrm{i}\omega)$")
    if len(responses) > 1:
        ax.legend(loc="best")


def _arrow(response: NDArray[np.complex128], ax: Axes) -> None:
    k = min(max(int(np.argmin(np.abs(response + 1.0))), 1), len(response) - 1)
    tail, head = response[k - 1], response[k]
    if tail == head:
        return
    ax.annotate(
        "",
        (head.real, head.imag),
        xytext=(tail.real, tail.imag),
        arrowprops={"arrowstyle": "-|>", "color": BLACK, "linewidth": 0.0, "mutation_scale": 9.0},
    )
