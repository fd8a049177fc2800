"""Where a model is linearised: an equilibrium with its parameters."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from racs_bif.equilibria.curve_problem import CurveProblem
from racs_bif.equilibria.problem import EquilibriumProblem
from racs_bif.errors import UsageError
from racs_bif.results.special import SpecialPoint
from racs_bif.shelf.load import system_of
from racs_bif.verbs.origin import Origin

if TYPE_CHECKING:
    from racs_bif.fractional.system import System
    from racs_bif.symbolic.field import Array
    from racs_bif.symbolic.model import Model


@dataclass(frozen=True, eq=False)
class OperatingPoint:
    """An equilibrium.

    Parameters
    ----------
    system : System
        The system.
    x : array (n,)
        Its states, memory states last.
    p : array (np,)
        Its base parameters.
    """

    system: System
    x: Array
    p: Array


def operating_point(point: SpecialPoint | System | Model) -> OperatingPoint:
    """Return the equilibrium that is meant.

    Parameters
    ----------
    point : SpecialPoint, System or Model
        A point of a branch or curve of equilibria, or a model, whose equilibrium at its own
        parameter values is then found from its guess.

    Raises
    ------
    UsageError
        If the point is none of equilibria, or came from a file without its branch.
    ConvergenceError
        If no equilibrium of the model is found.
    """
    if not isinstance(point, SpecialPoint):
        system = system_of(point)
        return OperatingPoint(system, system.equilibrium(), system.values)
    origin = point.origin
    if not isinstance(origin, Origin):
        where = ", ".join(f"{name}={value!r}" for name, value in point.parameters.items())
        msg = (
            f"{point.name} came from a file without its model; take it from its branch with "
            f"branch.at({where})"
        )
        raise UsageError(msg)
    if not isinstance(origin.problem, EquilibriumProblem | CurveProblem):
        msg = f"{point.name} is no equilibrium; take a point of a branch of equilibria"
        raise UsageError(msg)
    return OperatingPoint(origin.system, origin.equilibrium, origin.parameters)
