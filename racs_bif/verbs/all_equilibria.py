"""Every branch of equilibria that can be found, also those that nothing leads to."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.continuation.settings import StepSettings
from racs_bif.equilibria.deflation import other_equilibria, same_state
from racs_bif.errors import ConvergenceError
from racs_bif.numerics.threads import single_threaded
from racs_bif.results.diagram import Diagram
from racs_bif.shelf.load import system_of
from racs_bif.verbs.bands import on_a_band_that_holds
from racs_bif.verbs.equilibria import (
    as_branch,
    check_span,
    equilibrium_problem,
    follow,
    starting_point,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from racs_bif.continuation.points import Point, Trace
    from racs_bif.equilibria.problem import EquilibriumProblem
    from racs_bif.fractional.system import System
    from racs_bif.symbolic.field import Array
    from racs_bif.symbolic.model import Model

_PROBES = 6
_SPREADS = (1.0, 10.0, 100.0)
_STRAY = 1e4


@dataclass
class _Search:
    """What has been found so far."""

    system: System
    parameter: str
    span: tuple[float, float]
    settings: StepSettings
    at: tuple[float, ...]
    progress: Callable[[Point], None] | None
    traces: list[Trace] = field(default_factory=list)
    connected: list[bool] = field(default_factory=list)
    probing: bool = False

    def follow(self, z: Array, tangent: Array | None = None) -> None:
        """Trace the branch through z, and then every branch that crosses it."""
        problem = equilibrium_problem(self.system, self.parameter)
        found = follow(
            problem,
            z,
            self.span,
            self.settings,
            own=len(self.system.states),
            at=self.at,
            tangent=tangent,
            progress=self.progress,
        )
        if len(found.points) < 2 or self._known(found):
            return
        self.traces.append(found)
        self.connected.append(not self.probing)
        for special in found.special:
            if special.label == "BP" and "other_tangent" in special.data:
                try:
                    self.follow(special.z, np.asarray(special.data["other_tangent"]))
                except ConvergenceError as error:
                    # At the edge of the span the other branch may lie outside.
                    if special.parameter not in self.span:
                        found.message = f"{found.message}\n{error}".strip()

    def states_at(self, value: float) -> list[Array]:
        """Return the equilibria X = (y, w) that known branches pass at a value."""
        return [X for found in self.traces for X in self._crossings(found, value)]

    def _crossings(self, found: Trace, value: float) -> Iterator[Array]:
        p = self.system.path(self.parameter).vector(value)
        for a, b in zip(found.points, found.points[1:], strict=False):
            low, high = sorted((a.parameter, b.parameter))
            if not low <= value <= high:
                continue
            share = 0.0 if high == low else (value - a.parameter) / (b.parameter - a.parameter)
            x = (1.0 - share) * a.z[:-1] + share * b.z[:-1]
            try:
                yield self.system.exact.equilibrium(self.system.exact_point(x, p), p)
            except ConvergenceError:
                continue

    def _known(self, found: Trace) -> bool:
        """Say whether a branch was traced before, from two points away from its middle.

        Branches that cross have a point in common, often the one in the middle.
        """
        last = len(found.points) - 1
        return all(self._passes(found.points[k]) for k in (last // 4, last - last // 4))

    def _passes(self, point: Point) -> bool:
        """Say whether a known branch passes a point."""
        p = self.system.path(self.parameter).vector(point.parameter)
        X = self.system.exact_point(point.z[:-1], p)
        scale = _scale([X])
        return any(same_state(X, Y, scale) for Y in self.states_at(point.parameter))

    def probe(self, value: float) -> None:
        """Look for equilibria at a value that no known branch passes, and follow them."""
        self.probing = True
        p = self.system.path(self.parameter).vector(value)
        for spread in _SPREADS:
            known = self.states_at(value)
            if not known:
                return
            scale = _scale(known)
            origin = np.zeros_like(scale)
            new = other_equilibria(self.system.exact, p, known, [origin], spread * scale)
            for X in new:
                if np.max(np.abs(X) / scale) > _STRAY:
                    continue
                ny = len(self.system.states)
                x: Array = self.system.field.rest(X[:ny], X[ny:], p)
                if not any(same_state(X, Y, scale) for Y in self.states_at(value)):
                    self.follow(np.append(x, value))


def _scale(states: Sequence[Array]) -> Array:
    """Return a typical size of each unknown, none smaller than a hundredth of the largest."""
    size = np.max(np.abs(np.array(states)), axis=0)
    return np.asarray(np.maximum(size, 1e-2 * max(float(size.max()), 1e-6)))


@single_threaded
def all_equilibria(
    model: Model | System,
    parameter: str,
    span: tuple[float, float],
    *,
    at: Sequence[float] = (),
    settings: StepSettings | None = None,
    probes: int = _PROBES,
    progress: Callable[[Point], None] | None = None,
) -> Diagram:
    """Follow every branch of equilibria in a span that can be found.

    From the branch through the model's guess all branches are followed that cross it at branch
    points; then deflated Newton's method looks for further equilibria at several values of the
    parameter. That there are no others is not proved.

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
    settings : StepSettings, optional
        Step control.
    probes : int
        Number of parameter values, evenly spaced over the span, at which further equilibria are
        looked for; 0 follows only branches that are connected to the first.
    progress : callable, optional
        Called with every new point.

    Returns
    -------
    Diagram
        EQ1 is the branch through the model's guess; special points are numbered through.

    Raises
    ------
    UsageError, ParameterError, ConvergenceError
        As `continue_equilibria`.
    """
    system = system_of(model)
    low, high = check_span(system, parameter, span)
    chosen = settings or StepSettings()

    def work(system: System) -> _Search:
        search = _Search(system, parameter, (low, high), chosen, tuple(at), progress)
        search.follow(starting_point(system, parameter, (low, high)))
        if probes:
            inset = 1e-3 * (high - low)
            for value in np.linspace(low + inset, high - inset, probes):
                search.probe(float(value))
        if not search.traces:
            msg = (
                f"no branch of equilibria found between {parameter} = {low:g} and {high:g}; widen "
                "the span or give the model another guess"
            )
            raise ConvergenceError(msg)
        return search

    def traces(system: System, search: _Search) -> list[tuple[EquilibriumProblem, Trace]]:
        problem = equilibrium_problem(system, parameter)
        return [(problem, found) for found in search.traces]

    system, search, remark = on_a_band_that_holds(system, work, traces)
    problem = equilibrium_problem(system, parameter)
    remarks = [remark] + [replace(remark, text="")] * (len(search.traces) - 1)
    branches = [
        replace(as_branch(system, problem, found, (low, high), said), connected=connected)
        for found, connected, said in zip(search.traces, search.connected, remarks, strict=True)
    ]
    return Diagram(*branches)
