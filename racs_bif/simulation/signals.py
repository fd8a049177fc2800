"""Extremes, crossings and period of a sampled signal, by a cubic spline through its samples."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from racs_bif.errors import UsageError

if TYPE_CHECKING:
    from racs_bif.symbolic.field import Array

_FEWEST = 8


def extremes(times: Array, values: Array) -> tuple[float, float]:
    """Return the least and the greatest value, between samples too.

    Raises
    ------
    UsageError
        If there are fewer than eight samples.
    """
    spline = _spline(times, values)
    turning = spline.derivative().roots(extrapolate=False)
    candidates = np.concatenate([values, spline(turning[np.isfinite(turning)])])
    return float(candidates.min()), float(candidates.max())


def crossings(times: Array, values: Array, level: float = 0.0, direction: int = 1) -> Array:
    """Return when a signal crosses a level.

    Parameters
    ----------
    times, values : array (nt,)
        The signal.
    level : float
        The level.
    direction : int
        1 for upward crossings, -1 for downward ones, 0 for both.

    Raises
    ------
    UsageError
        If there are fewer than eight samples.
    """
    spline = _spline(times, values - level)
    found = spline.roots(extrapolate=False)
    found = found[np.isfinite(found)]
    slopes = spline(found, 1)
    return np.asarray(found[(slopes * direction > 0.0) if direction else (slopes != 0.0)])


def period(times: Array, values: Array) -> float:
    """Return the mean period: time between upward crossings of the middle of the range.

    NaN where there are not two of them.

    Raises
    ------
    UsageError
        If there are fewer than eight samples.

    Examples
    --------
    >>> t = np.linspace(0.0, 10.0, 2001)
    >>> print(round(period(t, np.cos(7.0 * t) + 0.3) * 7.0 / np.pi, 9))
    2.0
    """
    low, high = extremes(times, values)
    found = crossings(times, values, 0.5 * (low + high))
    return float((found[-1] - found[0]) / (len(found) - 1)) if len(found) > 1 else float("nan")


def _spline(times: Array, values: Array) -> Any:  # noqa: ANN401 - scipy brings no types
    if len(times) < _FEWEST:
        msg = f"{len(times)} samples are too few; keep at least {_FEWEST}"
        raise UsageError(msg)
    from scipy.interpolate import CubicSpline

    return CubicSpline(times, values)
