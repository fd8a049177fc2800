"""A diagram in one parameter: the equilibria, and the orbits that their Hopf points shed."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

from racs_bif.continuation.settings import StepSettings
from racs_bif.errors import RacsBifError
from racs_bif.orbits.balance_settings import BalanceSettings
from racs_bif.results.diagram import Diagram
from racs_bif.verbs.all_equilibria import all_equilibria
from racs_bif.verbs.orbits import continue_orbits

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from racs_bif.continuation.points import Point
    from racs_bif.fractional.system import System
    from racs_bif.results.branch import Branch
    from racs_bif.results.special import SpecialPoint
    from racs_bif.symbolic.model import Model

_TAIL, _MULTIPLIERS = 1e-6, 1e-5
"""Errors of harmonic balance: six digits are more than a picture shows."""
_STEPS: Final = StepSettings(maximum=0.05, tolerance=1e-8, location=1e-7)


def shed_diagram(
    model: Model | System,
    parameter: str,
    span: tuple[float, float],
    *,
    at: Sequence[float] = (),
    longest: float = 3.5,
    points: int = 400,
    progress: Callable[[Point], None] | None = None,
) -> tuple[Diagram, tuple[str, ...]]:
    """Follow all equilibria that can be found, and orbits from those that the first leads to.

    Orbits are those of the exact operator, by harmonic balance.

    Parameters
    ----------
    model : Model or System
        What is followed.
    parameter : str
        Active parameter.
    span : (float, float)
        Its interval, SI.
    at : sequence of float
        Values at which points are wanted exactly.
    longest : float
        Period at which a branch of orbits is left, relative to its first one. Near a homoclinic
        orbit the branch hardly moves while every further orbit costs more.
    points : int
        Most points of a branch of orbits.
    progress : callable, optional
        Called with every new point.

    Returns
    -------
    diagram : Diagram
        Equilibria first.
    troubles : tuple of str
        Hopf points from which no orbits could be followed, and why.

    Raises
    ------
    UsageError, ParameterError, ConvergenceError
        As `all_equilibria`.
    """
    found = all_equilibria(model, parameter, span, at=at, progress=progress)
    steps = replace(_STEPS, points=points)
    balance = BalanceSettings(tail=_TAIL, multipliers=_MULTIPLIERS, longest=longest)
    orbits: list[Branch] = []
    troubles: list[str] = []
    hopf = [p for branch in found if branch.connected for p in branch.special if p.label == "H"]
    for point in hopf:
        if any(_arrives(branch, point.parameters[parameter], span) for branch in orbits):
            continue
        try:
            orbits.append(
                continue_orbits(
                    point,
                    span,
                    method="harmonic-balance",
                    at=tuple(at),
                    settings=steps,
                    orbit_settings=balance,
                    progress=progress,
                )
            )
        except RacsBifError as error:
            troubles.append(f"{point.name}: {error}")
    return Diagram(*found, *orbits), tuple(troubles)


def through(
    point: SpecialPoint,
    parameter: str,
    span: tuple[float, float],
    *,
    longest: float = 1.5,
    points: int = 400,
    progress: Callable[[Point], None] | None = None,
) -> Branch:
    """Follow the orbits of the exact operator through one of them, in another parameter.

    Parameters
    ----------
    point : SpecialPoint
        Of a branch of orbits.
    parameter, span
        What is varied, and over what.
    longest, points, progress
        As in `shed_diagram`; the period is relative to that of the point.

    Raises
    ------
    UsageError, ConvergenceError
        As `continue_orbits`.
    """
    return continue_orbits(
        point,
        span,
        parameter=parameter,
        method="harmonic-balance",
        settings=replace(_STEPS, points=points),
        orbit_settings=BalanceSettings(tail=_TAIL, multipliers=_MULTIPLIERS, longest=longest),
        progress=progress,
    )


def _arrives(branch: Branch, value: float, span: tuple[float, float]) -> bool:
    """Say whether a branch of orbits has shrunk to a point at a value of the parameter."""
    near = abs(float(branch.parameter[-1]) - value) < 1e-3 * (span[1] - span[0])
    name = next(key[4:] for key in branch.measures if key.startswith("max "))
    size = branch.measures[f"max {name}"] - branch.measures[f"min {name}"]
    return near and len(branch) > 2 and bool(size[-1] < 0.05 * size.max())
