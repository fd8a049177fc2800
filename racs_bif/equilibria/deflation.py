"""Deflated Newton's method: equilibria that no known branch leads to.

P. E. Farrell, A. Birkisson, S. W. Funke, *SIAM J. Sci. Comput.* 37 (2015) A2026-A2045:
multiplying the equations by ``prod (1/|X - X_k|^2 + 1)`` keeps Newton's method from every solution
X_k that is known, so that it goes on to another from the same start.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import ConvergenceError

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from racs_bif.fractional.exact import ExactModel
    from racs_bif.symbolic.field import Array

_ITERATIONS = 60
_SAME = 1e-6
_REACH = 1e8


def same_state(a: Array, b: Array, scale: Array) -> bool:
    """Say whether two equilibria are one, in units of `scale`."""
    return bool(np.max(np.abs(a - b) / scale) < _SAME)


def other_equilibria(
    model: ExactModel, p: Array, known: Sequence[Array], starts: Iterable[Array], scale: Array
) -> list[Array]:
    """Find equilibria that differ from those known.

    Parameters
    ----------
    model : ExactModel
        The equations; states and outputs of elements are the unknowns X (size,).
    p : array (np,)
        Base parameters.
    known : sequence of array (size,)
        Equilibria to stay away from.
    starts : iterable of array (size,)
        Where Newton's method starts, besides the known equilibria themselves.
    scale : array (size,)
        Typical size of each unknown.

    Returns
    -------
    list of array (size,)
        New equilibria; that there are no more is not proved.
    """
    found = list(known)
    new: list[Array] = []
    queue = [*starts, *(X + 1e-3 * scale for X in known)]
    while queue:
        start = queue.pop(0)
        X = _deflated(model, p, start, found, scale)
        if X is None:
            continue
        found.append(X)
        new.append(X)
        queue += [start, X + 1e-3 * scale]
    return new


def _deflated(
    model: ExactModel, p: Array, start: Array, found: Sequence[Array], scale: Array
) -> Array | None:
    """Return a solution other than those found, None if the iteration leads nowhere."""
    X = np.array(start, dtype=float)
    for _ in range(_ITERATIONS):
        value = model.residual(X, p)
        if not np.all(np.isfinite(value)):
            return None
        try:
            step = -model.solver(X, p)(value)
        except np.linalg.LinAlgError:
            return None
        slope = sum(_log_slope((X - Y) / scale) for Y in found) / scale if found else 0.0 * X
        turn = 1.0 - float(slope @ step)
        if turn == 0.0 or not np.all(np.isfinite(step)):
            return None
        moved = step / turn
        X = X + moved
        if np.max(np.abs(X) / scale) > _REACH:
            return None
        if np.max(np.abs(moved) / scale) < 1e-10:
            return _confirmed(model, p, X, found, scale)
    return None


def _log_slope(distance: Array) -> Array:
    """Return the derivative of log(1/|d|^2 + 1) by d."""
    square = max(float(distance @ distance), 1e-300)
    return np.asarray(-2.0 * distance / (square * (1.0 + square)))


def _confirmed(
    model: ExactModel, p: Array, X: Array, found: Sequence[Array], scale: Array
) -> Array | None:
    """Return X polished without deflation, None if that leads back to a known solution."""
    try:
        polished = model.equilibrium(X, p)
    except ConvergenceError:
        return None
    return None if any(same_state(polished, Y, scale) for Y in found) else polished
