"""Where curves of special equilibria start."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.equilibria.branch_point_curve import BranchPointCurve
from racs_bif.equilibria.exact_fold_curve import ExactFoldCurve
from racs_bif.equilibria.exact_hopf_curve import ExactHopfCurve
from racs_bif.equilibria.fold_curve import FoldCurve
from racs_bif.equilibria.hopf_curve import HopfCurve
from racs_bif.errors import UsageError
from racs_bif.fractional.static import StaticField
from racs_bif.verbs.equilibria import outputs_of
from racs_bif.verbs.origin import origin_of

if TYPE_CHECKING:
    from racs_bif.equilibria.curve_problem import CurveProblem, Span
    from racs_bif.fractional.system import System
    from racs_bif.results.special import SpecialPoint
    from racs_bif.symbolic.field import Array

_REACH: Final = 1e-3


def frequency_of(point: SpecialPoint, kind: str | None) -> float:
    """Return the frequency of the pair to follow; zero at BT and where there is none.

    From a double Hopf point the default is the pair of the other curve.
    """
    if point.label == "HH" and kind in {None, "hopf2"}:
        return float(point.omega2)  # type: ignore[arg-type] # a number
    return point.omega if "omega" in point.data else 0.0


@dataclass(frozen=True)
class CurveStart:
    """Where a curve starts."""

    system: System
    x: Array
    parameters: tuple[str, str]
    span: Span
    omega: float

    def problem(self, kind: str, operator: str) -> tuple[CurveProblem, Array]:
        """Return the problem and its first point."""
        system, omega = self.system, self.omega
        path = system.path(*self.parameters)
        values = [system.parameters[name] for name in self.parameters]
        field = system.field
        # made of elements only, a model has nothing but memory to measure vectors by
        own = len(system.states) or len(field.states)
        common = (path, self.span)
        if kind == "hopf" and operator == "realised":
            z = np.concatenate([self.x, [omega**2], values])
            return HopfCurve(field, *common, own, _outputs(system)), z
        if kind == "fold" and operator == "realised":
            z = np.concatenate([self.x, values])
            return FoldCurve(field, *common, own, _outputs(system)), z
        static, X = StaticField(system.exact), system.exact_point(self.x, system.values)
        if kind == "hopf":
            if not omega > 0.0:
                msg = "the exact Hopf curve ends at omega = 0; follow the realised one from there"
                raise UsageError(msg)
            z = np.concatenate([X, [omega], values])
            return ExactHopfCurve(static, field, *common, _outputs(system)), z
        if kind == "fold":
            return ExactFoldCurve(static, field, *common, _outputs(system)), np.append(X, values)
        z = np.concatenate([X, [0.0], values])
        return BranchPointCurve(static, field, *common, _outputs(system)), z


def start_of(point: SpecialPoint, kind: str) -> tuple[CurveProblem, Array]:
    """Return the problem of a curve through a point of another, and the point on it."""
    origin = origin_of(point)
    system = replace(origin.system, values=origin.parameters)
    names = origin.problem.path.names  # type: ignore[attr-defined] # as all of ours have
    value = system.parameters[names[0]]
    reach = max(abs(value), _REACH)
    span = value - reach, value + reach
    start = CurveStart(system, origin.equilibrium, names, span, frequency_of(point, None))
    return start.problem(kind, "realised")


def _outputs(system: System) -> Callable[[Array, Array], dict[str, float]] | None:
    return outputs_of(system) if system.outputs else None
