"""A user's vector field, evaluated at many points with its answers checked."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from racs_bif.errors import ConvergenceError, ModelError, RacsBifError

if TYPE_CHECKING:
    from collections.abc import Callable

    from racs_bif.symbolic.field import Array, VectorField


class CheckedField:
    """Evaluates a vector field at the stages of steps, shaped (N, s, n).

    Whatever it raises, and any wrong shape or type, is the user's error and is passed on as such; a
    value that is not finite means that there is no solution here, and names the time.

    Parameters
    ----------
    field : VectorField
        The field.

    Attributes
    ----------
    count : int
        Vectorised evaluations of the right-hand side so far.
    """

    def __init__(self, field: VectorField) -> None:
        self._field = field
        self.count = 0

    def rates(self, stages: Array, p: Array, times: Array) -> Array:
        """Return f (N, s, n); `times` (N,) are those of the steps, for messages.

        Raises
        ------
        ConvergenceError
            If a value is not finite.
        ModelError
            If the right-hand side raises or returns something else than numbers of this shape.
        """
        self.count += 1
        points = _columns(stages)
        values = _call("right-hand side", points.shape, self._field.f, points, p)
        return _rows(values, stages.shape, times)

    def jacobians(self, stages: Array, p: Array, times: Array) -> Array:
        """Return f_x (N, s, n, n); see `rates`."""
        points, size = _columns(stages), stages.shape[-1]
        shape = (points.shape[1], size, size)
        values = _call("Jacobian", shape, self._field.f_x, points, p)
        _finite(values.reshape(len(values), -1), stages.shape[1], times)
        return values.reshape(*stages.shape, size)

    def by_parameter(self, stages: Array, p: Array, dp: Array, times: Array) -> Array:
        """Return the derivative of f (N, s, n) in the parameter direction `dp`; see `rates`."""
        points = _columns(stages)
        values = _call("parameter derivative", points.shape, self._field.f_p, points, p, dp)
        return _rows(values, stages.shape, times)


def _columns(stages: Array) -> Array:
    return np.ascontiguousarray(stages.reshape(-1, stages.shape[-1]).T)


def _rows(values: Array, shape: tuple[int, ...], times: Array) -> Array:
    _finite(values.T, shape[1], times)
    return np.ascontiguousarray(values.T).reshape(shape)


def _call(
    what: str, shape: tuple[int, ...], function: Callable[..., Any], *arguments: Array
) -> Array:
    try:
        with np.errstate(all="ignore"):
            values = np.asarray(function(*arguments))
    except RacsBifError:
        raise
    except Exception as error:  # the user's code may raise anything
        raise ModelError(
            f"the {what} raised {type(error).__name__} ({error}): make it return numbers there"
        ) from error
    if values.shape != shape or values.dtype.kind not in "fiu":
        raise ModelError(
            f"the {what} returned {values.dtype} values shaped {values.shape}, "
            f"but must return real values shaped {shape}"
        )
    return values.astype(float, copy=False)


def _finite(values: Array, per_step: int, times: Array) -> None:
    with np.errstate(all="ignore"):  # inf - inf is what is looked for
        if np.isfinite(values.sum()):
            return
    good = np.isfinite(values).all(axis=1)
    if not good.all():
        time = times[int(np.argmin(good)) // per_step]
        raise ConvergenceError(
            f"the right-hand side is not finite near t = {time:.6g} of the orbit"
        )
