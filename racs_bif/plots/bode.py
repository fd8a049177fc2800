"""Bode diagrams: the exact operator against its realisation."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from racs_bif.errors import UsageError
from racs_bif.plots.style import BLACK, COLUMN, VERMILION, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

_SIZE: Final = (COLUMN, 1.15 * COLUMN)
_HEIGHTS: Final = (1.0, 0.8, 0.6)
_SMALLEST: Final = 1e-16


def draw(
    exact: Any,  # noqa: ANN401 - control has no types
    realised: Any = None,  # noqa: ANN401
    *,
    channel: tuple[str, str] | None = None,
    axes: tuple[Axes, ...] | None = None,
) -> tuple[Axes, ...]:
    """Draw gain and phase over frequency, and the relative error of a realisation.

    Parameters
    ----------
    exact : control.FrequencyResponseData
        The exact response.
    realised : control system, optional
        What is compared with it at the same frequencies, with the same inputs and outputs.
    channel : (str, str), optional
        Output and input; needed where there are several.
    axes : tuple of Axes, optional
        Where to draw: gain, phase and, where there is a realisation, error; a new figure by
        default.

    Returns
    -------
    tuple of Axes
        What was drawn on.

    Raises
    ------
    UsageError
        If there are several channels and none is named, or it is unknown.
    """
    with style():
        if axes is None:
            from matplotlib import pyplot as plt

            axes = _panels(plt.figure(figsize=_SIZE, layout="constrained"), realised)
        _draw(exact, realised, channel, axes)
    return axes


def picture(
    exact: Any,  # noqa: ANN401 - control has no types
    realised: Any = None,  # noqa: ANN401
    *,
    channel: tuple[str, str] | None = None,
) -> Figure:
    """Return the diagram as a figure of its own, for a file."""
    from matplotlib.figure import Figure

    with style():
        figure = Figure(figsize=_SIZE, layout="constrained")
        _draw(exact, realised, channel, _panels(figure, realised))
        figure.draw_without_rendering()
    figure.set_layout_engine("none")
    return figure


def values_of(
    exact: Any,  # noqa: ANN401 - control has no types
    realised: Any,  # noqa: ANN401
    channel: tuple[str, str] | None,
) -> list[NDArray[np.complex128]]:
    """Return the responses (m,) of one channel: the exact one and, if there is any, the realised.

    Raises
    ------
    UsageError
        If there are several channels and none is named, or it is unknown.
    """
    if channel is None:
        if exact.frdata.shape[:2] != (1, 1):
            msg = (
                f"the system has the outputs {', '.join(exact.output_labels)} and the inputs "
                f"{', '.join(exact.input_labels)}; choose with channel=(output, input)"
            )
            raise UsageError(msg)
        i = j = 0
    else:
        for name, known in zip(channel, (exact.output_labels, exact.input_labels), strict=True):
            if name not in known:
                msg = f"the system has no '{name}'; there are: {', '.join(known)}"
                raise UsageError(msg)
        i, j = exact.output_labels.index(channel[0]), exact.input_labels.index(channel[1])
    found = [np.asarray(exact.frdata[i, j])]
    if realised is not None:
        if channel is not None:
            i = realised.output_labels.index(channel[0])
            j = realised.input_labels.index(channel[1])
        found.append(np.asarray(realised(1j * exact.omega, squeeze=False)[i, j]))
    return found


def _panels(figure: Figure, realised: object) -> tuple[Axes, ...]:
    count = 2 if realised is None else 3
    panels = figure.subplots(count, 1, sharex=True, height_ratios=_HEIGHTS[:count])
    return tuple(panels)


def _draw(
    exact: Any,  # noqa: ANN401 - control has no types
    realised: Any,  # noqa: ANN401
    channel: tuple[str, str] | None,
    axes: tuple[Axes, ...],
) -> None:
    responses = values_of(exact, realised, channel)
    looks = ((BLACK, "-", 1.6, "exact"), (VERMILION, "--", 0.9, "realised"))
    for response, (colour, line, width, label) in zip(responses, looks, strict=False):
        gain = 20.0 * np.log10(np.maximum(np.abs(response), _SMALLEST))
        phase = np.degrees(np.unwrap(np.angle(response)))
        axes[0].semilogx(exact.omega, gain, color=colour, ls=line, lw=width, label=label)
        axes[1].semilogx(exact.omega, phase, color=colour, ls=line, lw=width)
    axes[0].set_ylabel("gain [dB]")
    axes[1].set_ylabel("phase [°]")
    axes[1].yaxis.set_major_locator(_degrees())
    if len(responses) > 1:
        error = np.maximum(np.abs(responses[1] / responses[0] - 1.0), _SMALLEST)
        axes[2].loglog(exact.omega, error, color=VERMILION, lw=0.9)
        axes[2].set_ylabel("rel. error")
        axes[0].legend(loc="best")
    axes[-1].set_xlabel("frequency [rad/s]")
    axes[0].figure.align_ylabels(list(axes))
    axes[0].set_xlim(exact.omega[exact.omega > 0.0][0], exact.omega[-1])


def _degrees() -> Any:  # noqa: ANN401 - a locator of matplotlib
    from matplotlib.ticker import MaxNLocator

    return MaxNLocator(nbins=6, steps=[1, 1.5, 3, 4.5, 9, 10])
