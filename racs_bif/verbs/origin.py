"""What another branch needs to start at a special point."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from racs_bif.equilibria.curve_problem import CurveProblem
from racs_bif.errors import UsageError

if TYPE_CHECKING:
    from racs_bif.continuation.points import SpecialPoint as RawPoint
    from racs_bif.continuation.problem import Problem
    from racs_bif.fractional.system import System
    from racs_bif.results.special import SpecialPoint
    from racs_bif.symbolic.field import Array


@dataclass(frozen=True)
class Origin:
    """Where a special point came from.

    Parameters
    ----------
    system : System
        The system.
    problem : Problem
        The problem whose branch it lies on.
    raw : SpecialPoint
        The engine's record of it.
    span : (float, float)
        Span of that branch.
    """

    system: System
    problem: Problem
    raw: RawPoint
    span: tuple[float, float]

    @property
    def parameters(self) -> Array:
        """Base parameters (np,) at the point."""
        path = self.problem.path  # type: ignore[attr-defined] # as all of ours have
        vector: Array = path.vector(self.raw.z[-len(path.names) :])
        return vector

    @property
    def equilibrium(self) -> Array:
        """Realised states (n,) at the point, where it lies on a branch or curve of equilibria."""
        if isinstance(self.problem, CurveProblem):
            return self.problem.realised(self.raw.z)[1]
        return self.raw.z[:-1]


def origin_of(point: SpecialPoint) -> Origin:
    """Return where a point came from.

    Raises
    ------
    UsageError
        If it was loaded from a file, where that is not kept.
    """
    if not isinstance(point.origin, Origin):
        msg = (
            f"{point.name} was loaded from a file; compute its branch again to start a curve there"
        )
        raise UsageError(msg)
    return point.origin
