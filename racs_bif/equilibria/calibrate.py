"""Calibration: the value of a parameter that puts an exact Hopf point where it is wanted."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.continuation.trace import trace
from racs_bif.equilibria.hopf import Hopf
from racs_bif.equilibria.problem import EquilibriumProblem
from racs_bif.errors import ConvergenceError, UsageError
from racs_bif.fractional.exact_hopf import ExactHopf, solve_hopf
from racs_bif.symbolic.model import find_parameter

if TYPE_CHECKING:
    from collections.abc import Mapping

    from racs_bif.fractional.system import System


@dataclass(frozen=True)
class CalibrationResult:
    """The value found, and how well.

    Parameters
    ----------
    parameter : str
        What was moved.
    value : float
        Where the exact Hopf point lies as wanted.
    omega : float
        Its frequency [rad/s].
    parameters : dict of str to float
        All parameters there.
    sets : dict of str to float
        The base parameter behind a derived one and its value; empty for a base parameter.
    residual : float
        Last relative Newton correction.
    state : dict of str to float
        The equilibrium.
    """

    parameter: str
    value: float
    omega: float
    parameters: Mapping[str, float]
    sets: Mapping[str, float]
    residual: float
    state: Mapping[str, float]


def calibrate(
    system: System,
    parameter: str,
    hopf: Mapping[str, float],
    *,
    span: tuple[float, float] | None = None,
) -> CalibrationResult:
    """Find the value of a parameter for which the exact model has a Hopf point at `hopf`.

    Parameters
    ----------
    system : System
        The model with its other parameters.
    parameter : str
        Parameter to choose, base or derived.
    hopf : mapping of str to float
        Where the Hopf point has to be, for example ``{"u": 10.2}``.
    span : (float, float), optional
        Interval searched; a tenth to ten times the present value where left out.

    Returns
    -------
    CalibrationResult
        The value, and the Hopf point that it gives.

    Raises
    ------
    UsageError
        If the parameter is among those of `hopf`, the interval is empty, or there is not exactly
        one such point in it.
    """
    names = [p.name for p in system.parameter_table]
    find_parameter(parameter, names)
    if parameter in hopf:
        msg = f"'{parameter}' cannot be both chosen and given; calibrate another parameter"
        raise UsageError(msg)
    placed = system.with_parameters(dict(hopf))
    low, high = _interval(placed, parameter) if span is None else span
    if not low < high:
        msg = f"the interval {low:g} .. {high:g} of '{parameter}' is empty; give LOW < HIGH"
        raise UsageError(msg)
    found = _candidates(placed, parameter, (low, high))
    where = ", ".join(f"{name} = {value:g}" for name, value in hopf.items())
    if not found:
        msg = (
            f"no Hopf point at {where} for '{parameter}' in {low:g} .. {high:g}; "
            "give another --span"
        )
        raise UsageError(msg)
    if len(found) > 1:
        values = ", ".join(f"{h.value:g}" for h in found)
        msg = f"'{parameter}' has {len(found)} such values, {values}; narrow --span to one"
        raise UsageError(msg)
    return _result(placed, parameter, found[0])


def _interval(system: System, parameter: str) -> tuple[float, float]:
    value = system.parameters[parameter]
    if not np.isfinite(value) or value == 0.0:
        msg = f"'{parameter}' is {value:g}, which gives no interval to search; give --span LOW HIGH"
        raise UsageError(msg)
    bounds = sorted((0.1 * value, 10.0 * value))
    valid = next(p.valid for p in system.parameter_table if p.name == parameter)
    margin = 1e-6 * abs(value)
    return max(bounds[0], valid[0] + margin), min(bounds[1], valid[1] - margin)


def _candidates(system: System, parameter: str, span: tuple[float, float]) -> list[ExactHopf]:
    path = system.path(parameter)
    problem = EquilibriumProblem(system.field, path)
    start = float(np.sqrt(span[0] * span[1])) if span[0] > 0.0 else 0.5 * sum(span)
    x = system.equilibrium(path.vector(start))
    branch = trace(problem, np.append(x, start), span, [Hopf(len(system.states))])
    found: list[ExactHopf] = []
    for special in branch.special:
        value, omega = special.z[-1], special.data["omega"]
        X = system.exact_point(special.z[:-1], path.vector(value))
        try:
            exact = solve_hopf(system.exact, path, X, value, omega)
        except ConvergenceError:
            continue
        known = any(abs(exact.value - other.value) < 1e-9 * abs(exact.value) for other in found)
        if span[0] <= exact.value <= span[1] and not known:
            found.append(exact)
    return found


def _result(system: System, parameter: str, exact: ExactHopf) -> CalibrationResult:
    there = system.with_parameters({parameter: exact.value})
    behind = {d.name: d.sets for d in system.compiled.derived}
    sets = {behind[parameter]: there.parameters[behind[parameter]]} if parameter in behind else {}
    return CalibrationResult(
        parameter=parameter,
        value=exact.value,
        omega=exact.omega,
        parameters=there.parameters,
        sets=sets,
        residual=exact.residual,
        state=dict(zip(system.states, map(float, exact.X), strict=False)),
    )
