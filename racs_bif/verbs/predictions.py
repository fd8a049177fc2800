"""Predicted cycles and homoclinic orbits at points of codimension two."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from racs_bif.equilibria.predictors import (
    fold_of_cycles,
    homoclinic,
    tori_at_double_hopf,
    torus_at_zero_hopf,
)
from racs_bif.errors import UsageError
from racs_bif.verbs.curve_start import start_of
from racs_bif.verbs.origin import origin_of

if TYPE_CHECKING:
    from racs_bif.equilibria.orbit_guess import HomoclinicGuess, OrbitGuess
    from racs_bif.results.special import SpecialPoint

_KINDS: Final = {"lpc": ("GH",), "ns": ("ZH", "HH"), "homoclinic": ("BT",)}
_SIZE: Final = 0.02


def predict_orbits(
    point: SpecialPoint, kind: str, size: float | None = None
) -> tuple[OrbitGuess | HomoclinicGuess, ...]:
    """Return the orbits from which curves of cycles start at a point of codimension two.

    Parameters
    ----------
    point : SpecialPoint
        GH gives "lpc", ZH and HH give "ns" (HH two of them), BT gives "homoclinic".
    kind : {"lpc", "ns", "homoclinic"}
        Which.
    size : float, optional
        Amplitude of the cycle in the units of the states, or epsilon of `HomoclinicGuess`.

    Raises
    ------
    UsageError
        If the point gives no such orbit; the message says which points do.
    ConvergenceError
        If the unfolding of this point has no such orbit.
    """
    if kind not in _KINDS:
        msg = f"unknown kind of orbit '{kind}'; there are: {', '.join(_KINDS)}"
        raise UsageError(msg)
    if point.label not in _KINDS[kind]:
        can = ", ".join(_KINDS[kind])
        msg = f"{point.name} ({point.title}) predicts no {kind} orbit; these can: {can}"
        raise UsageError(msg)
    origin = origin_of(point)
    problem, raw = origin.problem, origin.raw
    size = _SIZE if size is None else size
    if kind == "lpc":
        return (fold_of_cycles(problem, raw, size),)  # type: ignore[arg-type] # GH is on these
    if point.label == "ZH":
        return (torus_at_zero_hopf(problem, raw, size),)  # type: ignore[arg-type] # as above
    if point.label == "HH":
        return tori_at_double_hopf(problem, raw, size)  # type: ignore[arg-type] # as above
    folds, z = start_of(point, "fold")
    return (homoclinic(folds, z, float(point.a), float(point.b), size),)  # type: ignore[arg-type] # as above
