"""Where the mass matrix becomes singular along a branch of equilibria."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from racs_bif.continuation.points import Trace
    from racs_bif.equilibria.problem import EquilibriumProblem
    from racs_bif.fractional.system import System


def inertia_lost(system: System, problem: EquilibriumProblem, found: Trace) -> str:
    """Say between which points the mass matrix is singular; empty where it never is.

    The equilibria pass through, but an eigenvalue passes through infinity: the number of unstable
    ones changes with no special point.
    """
    compiled = system.compiled
    if not compiled.has_inertia or not found.points:
        return ""
    core = []
    for point in found.points:
        p = problem.path.vector(point.z[-1])
        core.append((system.field.core_point(point.z[:-1], p), system.field.frame(p).P))
    with np.errstate(all="ignore"):
        side = np.sign(
            compiled.inertia(*(np.array(column).T for column in zip(*core, strict=True)))
        )
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
