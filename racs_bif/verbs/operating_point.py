"""The point of a branch of equilibria at a value of its parameter, solved for, not interpolated."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.continuation.points import SpecialPoint as RawPoint
from racs_bif.continuation.scaling import Scaling
from racs_bif.errors import ConvergenceError, UsageError
from racs_bif.numerics.newton import newton
from racs_bif.numerics.threads import single_threaded
from racs_bif.results.special import SpecialPoint
from racs_bif.verbs.equilibria import equilibrium_problem
from racs_bif.verbs.origin import Origin
from racs_bif.verbs.rebuild import rebuild

if TYPE_CHECKING:
    from racs_bif.equilibria.problem import EquilibriumProblem
    from racs_bif.fractional.system import System
    from racs_bif.results.branch import Branch
    from racs_bif.symbolic.field import Array

_TOLERANCE: Final = 1e-11
_ITERATIONS: Final = 20
_SAME: Final = 1e-6
"""Two solutions nearer than this, relative to the branch's extent, are one."""


@single_threaded
def solve_at(branch: Branch, value: float) -> SpecialPoint:
    """Return the operating point of a branch of equilibria at a value of its parameter.

    Newton's method starts from the line between the two neighbouring points of the branch.

    Parameters
    ----------
    branch : Branch
        Of kind ``equilibrium``; also one that was loaded.
    value : float
        Of its active parameter, SI.

    Returns
    -------
    SpecialPoint
        Labelled UZ, with ``eigenvalues`` and ``unstable`` in its data.

    Raises
    ------
    UsageError
        If the branch does not reach the value, passes it more than once, or its model cannot be
        found again.
    ConvergenceError
        If Newton's method does not converge.
    """
    name = branch.parameters[0]
    starts = _crossings(branch, value)
    if not starts:
        ends = f"{branch.parameter.min():g} to {branch.parameter.max():g}"
        msg = f"{branch.name} does not reach {name} = {value:g}, it lies in {ends}; continue it"
        raise UsageError(msg)
    system = rebuild(branch)
    problem = equilibrium_problem(system, name)
    found: list[tuple[int, Array, Array]] = []
    extent = np.maximum(np.ptp(branch.states, axis=0), np.abs(branch.states).max(axis=0))
    for index, start in starts:
        z, tangent = _solved(problem, branch, np.append(start, value))
        apart = [np.abs(z[:-1] - other[:-1]) / np.maximum(extent, 1e-300) for _, other, _ in found]
        if all(np.max(distance, initial=0.0) > _SAME for distance in apart):
            found.append((index, z, tangent))
    if len(found) > 1:
        msg = (
            f"{branch.name} passes {name}={value:g} more than once: ask for it with "
            f"at=({value:g},) when continuing and take one by name"
        )
        raise UsageError(msg)
    return _point(branch, system, problem, found[0])


def with_origin(branch: Branch, point: SpecialPoint) -> SpecialPoint:
    """Return a labelled equilibrium that was loaded from a file as one that others can start from.

    Raises
    ------
    UsageError
        If the model of the branch cannot be found again.
    """
    system = rebuild(branch)
    problem = equilibrium_problem(system, branch.parameters[0])
    z = np.append(branch.states[point.index], branch.parameter[point.index])
    raw = RawPoint(
        label=point.label,
        name=point.name,
        index=point.index,
        z=z,
        tangent=np.zeros(len(z)),
        spectrum=branch.spectrum[point.index],
        data=dict(point.data),
        interval=0.0,
    )
    return replace(point, origin=Origin(system, problem, raw, _span(branch)))


def _crossings(branch: Branch, value: float) -> list[tuple[int, Array]]:
    """Return where the branch passes a value: index of the point before, and states between."""
    v, found = branch.parameter, []
    for k in range(len(v) - 1):
        low, high = sorted((v[k], v[k + 1]))
        if low <= value <= high:
            share = 0.0 if high == low else (value - v[k]) / (v[k + 1] - v[k])
            states = (1.0 - share) * branch.states[k] + share * branch.states[k + 1]
            found.append((k, states))
    return found


def _solved(problem: EquilibriumProblem, branch: Branch, z: Array) -> tuple[Array, Array]:
    low, high = _span(branch)
    row = np.zeros(len(z))
    row[-1] = 1.0 / (high - low)
    weights = Scaling(high - low, problem.scales(z)).weights
    value = z[-1]
    try:
        done = newton(problem, z, row, weights, tolerance=_TOLERANCE, iterations=_ITERATIONS)
    except (ArithmeticError, np.linalg.LinAlgError) as error:
        msg = (
            f"no equilibrium found at {problem.parameter} = {value:g} between two points of "
            f"{branch.name}; continue it with smaller steps"
        )
        raise ConvergenceError(msg) from error
    done.z[-1] = value
    length = float(np.sqrt(weights @ done.tangent**2))
    return done.z, done.tangent / length


def _point(
    branch: Branch,
    system: System,
    problem: EquilibriumProblem,
    found: tuple[int, Array, Array],
) -> SpecialPoint:
    index, z, tangent = found
    spectrum = problem.spectrum(z)
    unstable = int(np.count_nonzero(problem.sides(spectrum)))
    raw = RawPoint(
        label="UZ",
        name="UZ",
        index=index,
        z=z,
        tangent=tangent,
        spectrum=spectrum,
        data={},
        interval=0.0,
    )
    return SpecialPoint(
        label="UZ",
        name="UZ",
        branch=branch.name,
        parameters={problem.parameter: float(z[-1])},
        state=dict(zip(system.states, map(float, z), strict=False)),
        data={"eigenvalues": spectrum, "unstable": unstable},
        index=index,
        origin=Origin(system, problem, raw, _span(branch)),
    )


def _span(branch: Branch) -> tuple[float, float]:
    return float(branch.parameter.min()), float(branch.parameter.max())
