"""Poincare sections: the states where one quantity crosses a level."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.simulation.signals import crossings

if TYPE_CHECKING:
    from racs_bif.symbolic.field import Array


@dataclass(frozen=True)
class Section:
    """Crossings of a level.

    Parameters
    ----------
    times : array (k,)
        When [s].
    points : array (k, n)
        The states there.
    """

    times: Array
    points: Array


def poincare_section(
    times: Array, states: Array, watched: Array, *, level: float = 0.0, direction: int = 1
) -> Section:
    """Return the states where a quantity crosses a level, by cubic splines through samples.

    Parameters
    ----------
    times : array (nt,)
        Equidistant or not [s].
    states : array (nt, n)
        What is wanted at the crossings, for example the states of a `TimeHistory`.
    watched : array (nt,)
        What crosses, for example one of its columns.
    level : float
        The level.
    direction : int
        1 for upward crossings, -1 for downward ones, 0 for both.

    Returns
    -------
    Section
        In the order of time; empty where nothing crosses.

    Raises
    ------
    UsageError
        If there are fewer than eight samples.

    Examples
    --------
    >>> t = np.linspace(0.0, 20.0, 2001)
    >>> circle = np.column_stack([np.cos(t), np.sin(t)])
    >>> print(poincare_section(t, circle, circle[:, 1]).points.round(6)[1:, 0])
    [1. 1. 1.]
    """
    from scipy.interpolate import CubicSpline

    found = crossings(times, watched, level, direction)
    points = np.asarray(CubicSpline(times, states, axis=0)(found))
    return Section(found, points.reshape(len(found), states.shape[1]))
