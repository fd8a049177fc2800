"""Plain functions that are called: where their derivatives come from, and how good they are."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from racs_bif.errors import ModelError
from racs_bif.symbolic.arguments import TIME
from racs_bif.symbolic.differences import derivative
from racs_bif.symbolic.external import COMPLEX_STEP, DIFFERENCES, SERIES, External
from racs_bif.symbolic.recorded import nearby

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

_SMOOTH: Final = 1e-5


def check_constant(external: External, start: Array) -> None:
    """Refuse a function that remembers its calls, or depends on the time.

    Raises
    ------
    ModelError
        If it does, or fails.
    """
    arguments = external.arguments
    first, second = external.floats(start), external.floats(start)
    title = f"model '{arguments.model}': the function '{arguments.function}'"
    if not np.array_equal(first, second, equal_nan=True):
        msg = f"{title} returns other numbers when it is called again; make it depend on its "
        raise ModelError(msg + "arguments alone")
    if TIME not in {source for _, source in arguments.places} or TIME in arguments.names:
        return
    if not np.array_equal(first, external.floats(start, time=0.7390851), equal_nan=True):
        msg = (
            f"{title} depends on the time; make it autonomous: a forcing cos(omega t) is the state "
            "c of c' = c - omega s - c (c**2 + s**2), s' = s + omega c - s (c**2 + s**2)"
        )
        raise ModelError(msg)


def equations(external: External) -> dict[str, Any]:
    """Return equations that call a function, state by state."""
    import sympy as sp

    symbols = [sp.Symbol(name) for name in external.arguments.names]
    states = external.arguments.states
    return {
        state: sp.Function(result)(*symbols)
        for state, result in zip(states, external.calls, strict=True)
    }


def called(external: External, start: Array, derivatives: str, why: str) -> tuple[External, str]:
    """Choose where the derivatives of a function come from, and say so.

    Parameters
    ----------
    external : External
        The function.
    start : array
        Where it is tried first.
    derivatives : {"auto", "series", "differences"}
        What the user asked for.
    why : str
        Why it is called.

    Returns
    -------
    (External, str)
        The function with its derivatives, and a note on them.

    Raises
    ------
    ModelError
        If series were asked for and cannot be had, or the function is defined nowhere near.
    """
    if not any(np.all(np.isfinite(external.floats(point))) for point in nearby(start)):
        raise ModelError(_undefined(external))
    title = f"'{external.arguments.function}' is called at every evaluation, which is slow"
    title += f" ({why})." if derivatives == "auto" else "."
    if derivatives != DIFFERENCES:
        refused = _series_refused(external, start)
        if not refused:
            return external, f"{title} Its derivatives are exact, by power series."
        if derivatives == SERIES:
            msg = (
                f"model '{external.arguments.model}': '{external.arguments.function}' has no "
                f"series ({refused}); give derivatives='differences', or write it otherwise"
            )
            raise ModelError(msg)
    error = _difference_error(external, start, complex_step=True)
    if error <= _SMOOTH:
        chosen = External(external.function, external.arguments, COMPLEX_STEP, 0.0)
        return chosen, (
            f"{title} Its first derivatives are by a complex step, exact but for rounding, second "
            "and third ones by differences of these."
        )
    error = _difference_error(external, start, complex_step=False)
    if not np.isfinite(error):
        raise ModelError(_undefined(external))
    chosen = External(external.function, external.arguments, DIFFERENCES, error)
    return chosen, (
        f"{title} Its derivatives are by differences; the first have an estimated relative error "
        f"of {error:.1g}, second and third ones are worse, and so are normal forms."
    )


def _undefined(external: External) -> str:
    return (
        f"model '{external.arguments.model}': '{external.arguments.function}' is not finite around "
        "the guess, so that its derivatives cannot be checked; give another guess"
    )


def _series_refused(external: External, start: Array) -> str:
    """Say why power series cannot be used; nothing where they can."""
    trouble = ""
    for point in nearby(start):
        value = external.floats(point)
        if not np.all(np.isfinite(value)):
            continue
        direction = _direction(point)
        try:
            exact = np.array(
                [external(k, tuple(point), tuple(direction)) for k in range(len(value))]
            )
        except ModelError as error:
            return str(error)
        close = derivative(external.floats, point, [direction], complex_step=False)
        if np.all(np.abs(exact - close) <= 1e-3 * (np.abs(exact) + np.abs(close) + 1e-3)):
            return ""
        # One point may lie on a kink, which spoils differences; not all of them do.
        trouble = "its series are not its derivatives"
    return trouble


def _direction(point: Array) -> Array:
    return np.linspace(0.5, 1.0, len(point)) * (0.1 + np.abs(point))


def _other_slope(
    external: External, point: Array, direction: Array, *, complex_step: bool
) -> Array:
    """Return a derivative by a complex step, or by differences of fewer points."""
    if not complex_step:
        return derivative(external.floats, point, [direction], complex_step=False, reach=3)
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # of numpy, which says that it drops an imaginary part
        return derivative(external.complexes, point, [direction], complex_step=True)


def _difference_error(external: External, start: Array, *, complex_step: bool) -> float:
    """Return the relative error of first derivatives, from two ways of taking them.

    It is infinite where the function is defined nowhere around.
    """
    worst, compared = 0.0, False
    for point in nearby(start)[:3]:
        direction = _direction(point)
        close = derivative(external.floats, point, [direction], complex_step=False)
        try:
            other = _other_slope(external, point, direction, complex_step=complex_step)
        except Exception:  # noqa: BLE001 - it is asked whether the function takes such numbers
            return np.inf
        size = np.maximum(np.abs(close).max(initial=0.0), 1e-12)
        if np.all(np.isfinite(close)):
            compared = True
            worst = max(worst, float(np.abs(other - close).max(initial=0.0) / size))
    return worst if compared and np.isfinite(worst) else np.inf
