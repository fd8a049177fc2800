"""Characteristic roots in the complex plane."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from racs_bif.markup import with_unit
from racs_bif.plots.style import SIZE, VERMILION, style
from racs_bif.units import rate_unit

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from racs_bif.verbs.spectrum import Spectrum


def draw(spectrum: Spectrum, *, ax: Axes | None = None) -> Axes:
    """Draw exact roots and the realisation's eigenvalues; the unstable half plane is shaded.

    Parameters
    ----------
    spectrum : Spectrum
        What to draw.
    ax : Axes, optional
        Where to draw; a new figure by default.

    Returns
    -------
    Axes
        What was drawn on.
    """
    with style():
        if ax is None:
            from matplotlib import pyplot as plt

            ax = plt.subplots(figsize=SIZE, layout="constrained")[1]
        _draw(spectrum, ax)
    return ax


def picture(spectrum: Spectrum) -> Figure:
    """Return the roots as a figure of its own, for a file."""
    from matplotlib.figure import Figure

    with style():
        figure = Figure(figsize=SIZE, layout="constrained")
        _draw(spectrum, figure.add_subplot())
        figure.draw_without_rendering()
    figure.set_layout_engine("none")
    return figure


def _draw(spectrum: Spectrum, ax: Axes) -> None:
    roots, above = spectrum.roots.roots, spectrum.roots.above
    every = [*roots, *(v for v in spectrum.eigenvalues if v.real > above)]
    low = min([above, *(v.real for v in every)])
    high = max([0.0, *(v.real for v in every)])
    width = high - low or 1.0
    right = high + 0.15 * width
    height = 1.2 * max([1.0, *(abs(v.imag) for v in every)])
    ax.axvspan(0.0, right, color="0.93", lw=0)
    ax.axvline(0.0, color="0.6", lw=0.6)
    ax.axhline(0.0, color="0.6", lw=0.6)
    ax.plot(roots.real, roots.imag, "ko", ms=5.0, mfc="none", mew=0.9, label="exact roots")
    cut = np.asarray(spectrum.roots.on_cut, dtype=complex)
    if len(cut):
        ax.plot(cut.real, cut.imag, "ks", ms=4.0, mfc="none", label="on the branch cut")
    values = spectrum.eigenvalues
    ax.plot(values.real, values.imag, "x", ms=3.5, mec=VERMILION, mew=0.9, label="realisation")
    ax.set_xlim(low - 0.05 * width, right)
    ax.set_ylim(-height, height)
    ax.set_xlabel(with_unit("Re s", rate_unit(spectrum.system.time_unit)))
    ax.set_ylabel(with_unit("Im s", spectrum.system.frequency_unit))
    ax.legend(loc="best")
