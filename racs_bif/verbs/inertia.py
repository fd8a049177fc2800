"""Where the mass matrix becomes singular along a branch of equilibria."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.charts.members import Members

if TYPE_CHECKING:
    from racs_bif.continuation.points import Trace
    from racs_bif.equilibria.problem import EquilibriumProblem
    from racs_bif.fractional.system import System


def inertia_lost(system: System, problem: EquilibriumProblem, found: Trace) -> str:
    """Say between which points the mass matrix is singular; empty where it never is.

    The equilibria pass through, but an eigenvalue passes through infinity: the number of unstable
    ones changes with no special point.
    """
    if not system.compiled.has_inertia or not found.points:
        return ""
    members = Members(system)
    X = np.zeros((members.size, len(found.points)))  # of states only may a mass matrix depend
    for k, point in enumerate(found.points):
        X[: members.ny, k] = point.z[: members.ny]
    P = np.array([problem.path.vector(point.parameter) for point in found.points]).T
    side = members.side(X, P)
    told = [
        f"{a.parameter:.10g} and {b.parameter:.10g}"
        for (a, b), change in zip(pairwise(found.points), np.diff(side), strict=True)
        if change
    ]
    if not told:
        return ""
    return (
        f" The mass matrix is singular between {problem.parameter} = {', '.join(told)}: there an "
        "eigenvalue passes through infinity, and the equations mean another system beyond."
    )
