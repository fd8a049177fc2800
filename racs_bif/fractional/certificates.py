"""Certificates of equilibria on the exact model: points solved again, unstable roots counted.

A point is certified where Newton's method on the exact equations ends close to it. Counts are
those of the argument principle at the exact equilibrium; between two points of a branch the count
may change only where special points are reported, and only by as many roots as these tell.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.errors import ConvergenceError
from racs_bif.fractional.argument import Count, count_unstable
from racs_bif.fractional.exact_fold import solve_fold
from racs_bif.fractional.exact_hopf import solve_hopf

if TYPE_CHECKING:
    from racs_bif.fractional.exact import ExactModel
    from racs_bif.symbolic.field import Array
    from racs_bif.symbolic.paths import ParameterPath

CROSSINGS: Final = {"H": (2,), "LP": (1,), "BP": (0, 1)}
"""By how many the number of unstable roots may change at a special point, up or down."""
ROUNDING: Final = 1e-10
"""Relative difference of the parameter from a fold that rounding makes: there equilibria are known
to half the digits only."""
_LEAST: Final = 1e-3
_NEAR: Final = 0.05
_TINY: Final = 1e-6  # states all smaller than this are compared with it
_ROUNDED: Final = 1e-8
_ITERATIONS: Final = 20
_TOLERANCE: Final = 1e-11


@dataclass(frozen=True, kw_only=True)
class Place:
    """An equilibrium, as a result reports it.

    Parameters
    ----------
    X : array (size,)
        States and outputs of the elements.
    value : float
        The active parameter.
    """

    X: Array
    value: float


@dataclass(frozen=True, kw_only=True)
class Resolved:
    """A special point solved again on the exact equations.

    Parameters
    ----------
    X : array (size,)
        States and outputs of the elements.
    value : float
        The active parameter.
    omega : float
        Frequency [rad/s]; 0 at a fold.
    shift : float
        The largest difference between what was reported and the exact point: of the parameter, of
        the frequency and of the states, each relative to its size.
    correction : float
        Largest last Newton correction, relative: what is left of the error.
    """

    X: Array
    value: float
    omega: float
    shift: float
    correction: float


def resolve(
    model: ExactModel,
    path: ParameterPath,
    place: Place,
    omega: float = 0.0,
    *,
    width: float = 0.0,
    tolerance: float = 0.01,
) -> Resolved:
    """Solve a Hopf point or a fold again on the exact equations.

    Parameters
    ----------
    model : ExactModel
        The exact model.
    path : ParameterPath
        The active parameter.
    place : Place
        Where the point was reported.
    omega : float
        Its frequency [rad/s]; 0 means a fold.
    width : float
        Width of the branch in the parameter. A tenth of it is the least size that a difference of
        the parameter is compared with.
    tolerance : float
        Largest shift that is accepted.

    Raises
    ------
    ConvergenceError
        If Newton's method does not converge, or converges elsewhere.
    """
    if omega:
        hopf = solve_hopf(model, path, place.X, place.value, omega)
        X, value, correction, exact = hopf.X, hopf.value, hopf.residual, hopf.omega
    else:
        fold = solve_fold(model, path, place.X, place.value)
        X, value, correction, exact = fold.X, fold.value, fold.residual, 0.0
    moved = abs(value - place.value) / max(abs(value), 0.1 * width, _LEAST)
    turned = abs(exact - omega) / exact if omega else 0.0
    away = float(np.abs(X - place.X).max()) / _size(X, place.X)
    shift = max(moved, turned, away)
    if not shift <= tolerance:
        name, rad = path.names[0], f", omega = {exact:.7g} rad/s" if omega else ""
        msg = (
            f"the exact point that Newton's method finds is elsewhere, at {name} = {value:.7g}"
            f"{rad} (relative shift {shift:.1e}, accepted {tolerance:g}); use a finer realisation"
        )
        raise ConvergenceError(msg)
    return Resolved(X=X, value=value, omega=exact, shift=shift, correction=correction)


def exact_count(model: ExactModel, path: ParameterPath, place: Place) -> Count:
    """Count the unstable roots of the exact equilibrium at a place.

    Raises
    ------
    ConvergenceError
        If no exact equilibrium is there, or the count cannot be trusted.
    """
    p = path.vector(place.value)
    X = model.equilibrium(place.X, p)
    if not near(X, place.X):
        raise ConvergenceError(_elsewhere(X, place.X))
    return count_unstable(model, X, p)


def beside(model: ExactModel, path: ParameterPath, start: Place, end: Place) -> Place:
    """Return the exact equilibrium a quarter of the way from one point of a branch to the next.

    It lies in the plane across the chord, so that it is found on either side of a fold too.

    Raises
    ------
    ConvergenceError
        If there is none near the chord.
    """
    z, stop = np.append(start.X, start.value), np.append(end.X, end.value)
    chord = stop - z
    size = np.maximum(np.abs(z), np.abs(stop))
    # a state that is zero but for rounding has no magnitude of its own
    weight = chord / np.maximum(size, _ROUNDED * max(float(size.max()), 1.0)) ** 2
    z = target = z + 0.25 * chord
    for _ in range(_ITERATIONS):
        p, dp = path.vector(z[-1]), path.direction(z[-1])
        J = np.column_stack([model.jacobian(z[:-1], p), model.residual_p(z[:-1], p, dp)])
        residual = np.append(model.residual(z[:-1], p), weight @ (z - target))
        try:
            step = np.linalg.solve(np.vstack([J, weight]), residual)
        except np.linalg.LinAlgError:
            break
        z = z - step
        if not np.all(np.isfinite(z)):
            break
        if np.all(np.abs(step) <= _TOLERANCE * (np.abs(z).max() + 1.0)):
            away = float(np.abs(z - target)[:-1].max())
            if away > float(np.abs(chord[:-1]).max()) and not near(z[:-1], target[:-1]):
                raise ConvergenceError(_elsewhere(z[:-1], target[:-1]))
            return Place(X=z[:-1], value=float(z[-1]))
    msg = (
        f"no exact equilibrium found beside {path.names[0]} = {start.value:.7g}; "
        "continue the branch with smaller steps"
    )
    raise ConvergenceError(msg)


def at_fold(folds: Iterable[float], *values: float) -> bool:
    """Say whether values of the parameter are those of one of some folds, but for rounding."""
    return any(max(abs(value - fold) for value in values) <= ROUNDING * abs(fold) for fold in folds)


def _size(one: Array, other: Array) -> float:
    return max(float(np.abs(one).max()), float(np.abs(other).max()), _TINY)


def near(one: Array, other: Array) -> bool:
    """Say whether two states (size,) are the same but for what a realisation may be off by."""
    return float(np.abs(one - other).max()) <= _NEAR * _size(one, other)


def _elsewhere(X: Array, reported: Array) -> str:
    away = float(np.abs(X - reported).max())
    return (
        f"the exact equilibrium is elsewhere, its states differ by {away:.1e}; "
        "use a finer realisation"
    )


def changes(labels: Iterable[str]) -> set[int]:
    """Return by how many the number of unstable roots may change over special points.

    Examples
    --------
    >>> sorted(changes(["LP"])), sorted(changes(["LP", "H"])), changes([])
    ([-1, 1], [-3, -1, 1, 3], {0})
    """
    reach = {0}
    for label in labels:
        steps: Sequence[int] = CROSSINGS[label]
        reach = {n + sign * step for n in reach for step in steps for sign in (-1, 1)}
    return reach
