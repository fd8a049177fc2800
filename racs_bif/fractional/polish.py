"""Newton's method on det Delta, with exact derivatives."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from racs_bif.fractional.characteristic import Characteristic
    from racs_bif.fractional.laws import Complex
    from racs_bif.symbolic.field import Array

_ITERATIONS = 30
_EPSILON = float(np.finfo(float).eps)


def polish(ch: Characteristic, t: Complex) -> tuple[Complex, Array]:
    """Polish estimates of zeros of det Delta(exp(t)).

    Parameters
    ----------
    ch : Characteristic
        The characteristic matrix.
    t : array (k,)
        Estimates of log s.

    Returns
    -------
    (array (k,), array (k,))
        Zeros and their last corrections, infinite where there was no convergence.
    """
    t = np.array(t, dtype=complex)
    errors = np.full(len(t), np.inf)
    moving = np.ones(len(t), dtype=bool)
    for _ in range(_ITERATIONS):
        if not moving.any():
            break
        rate = ch.log_det(t[moving])[1]
        with np.errstate(divide="ignore", invalid="ignore"):
            step = np.where(np.isfinite(rate), 1.0 / rate, 0.0)
        size = np.abs(step)
        lost = ~np.isfinite(step) | (size > 10.0)
        t[moving] -= np.where(lost, 0.0, step)
        before = errors[moving]
        errors[moving] = np.where(lost, np.inf, size)
        scale = 1.0 + np.abs(t[moving])
        # Down to rounding, where corrections no longer shrink.
        done = lost | (size <= 2.0 * _EPSILON * scale) | ((size < 1e-12) & (size >= 0.5 * before))
        moving[moving] = ~done
    return t, np.maximum(errors, _EPSILON)
