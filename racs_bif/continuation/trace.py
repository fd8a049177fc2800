"""Traces a whole branch: both ways from its start, with its events in their places."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

from racs_bif.continuation.building import Builder
from racs_bif.continuation.points import Array, Point, Trace
from racs_bif.continuation.settings import StepSettings
from racs_bif.continuation.start import begin
from racs_bif.continuation.stepping import Stepper
from racs_bif.continuation.stopped import Stopped
from racs_bif.continuation.targets import Target, Targets, detectors_of
from racs_bif.continuation.told import Table, next_number, table
from racs_bif.continuation.watching import Node, Watch
from racs_bif.errors import ConvergenceError, UsageError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from racs_bif.continuation.problem import Detector, Problem


_STUCK: Final = {Stopped.STEP, Stopped.TURN, Stopped.FAILED, Stopped.VALIDITY}
Until = Callable[[Point, Point], Stopped | None]
"""Sees every step and says whether the branch ends with it, and why."""


@dataclass(slots=True)
class _Walk:
    """One direction of a branch."""

    watch: Watch
    stopped: Stopped
    message: str


def trace(  # noqa: PLR0913 - what a branch is made of
    problem: Problem,
    z: Array,
    span: tuple[float, float],
    detectors: Sequence[Detector] = (),
    settings: StepSettings | None = None,
    *,
    targets: Targets = (),
    direction: int | None = None,
    tangent: Array | None = None,
    progress: Callable[[Point], object] | None = None,
    until: Until | None = None,
) -> Trace:
    """Trace a branch of solutions through a start, over a span of the parameter.

    Parameters
    ----------
    problem : Problem
        What is solved.
    z : array (n + 1,)
        A guess of a solution, the parameter last; solved at that parameter.
    span : tuple of float
        Lowest and highest value of the parameter; the branch ends exactly there.
    detectors : sequence of Detector
        The special points looked for.
    settings : StepSettings, optional
        Of the step control.
    targets : sequence of float, or dict of str to sequence of float
        Points wanted exactly, labelled "UZ": values of the parameter, or by name of the parameter
        or a measure.
    direction : {None, 1, -1}
        +1 to set off with the parameter increasing, or along `tangent` if given; -1 the other way.
        None for both: the branch is one, ordered so that the parameter starts low.
    tangent : array (n + 1,), optional
        Direction in which to set off, where branches meet; the start is corrected across it.
    progress : callable, optional
        Called with every point accepted.
    until : callable, optional
        Called with every step, the point before and the point accepted; returns why the branch ends
        there, or None. The point before has arclength 0 where a walk begins.

    Returns
    -------
    Trace
        Points, special points and why it ended. A KeyboardInterrupt ends it with
        ``Stopped.INTERRUPTED`` and what there is.

    Raises
    ------
    UsageError
        If the span, the start, the targets or the direction cannot be used.
    ConvergenceError
        If there is no solution at the start.
    """
    settings = settings or StepSettings()
    if direction not in {None, 1, -1}:
        msg = f"the direction must be 1, -1 or None for both, not {direction!r}"
        raise UsageError(msg)
    corrected, unit, iterations, scaling = begin(problem, z, span, settings, tangent)
    wanted = detectors_of(targets, problem, span, settings, problem.measures(corrected))
    builder = Builder(problem, [*detectors, *wanted], len(detectors))
    senses = _senses(corrected, unit, span, direction)
    forward = unit * senses[0] if len(senses) == 1 else unit
    start = builder.point(corrected, forward, 0.0, iterations)
    notes: list[str] = []
    walks: list[_Walk] = []
    number = next_number()
    for sense in (1, -1)[: len(senses)]:
        own = scaling.copy()
        stepper = Stepper(builder, own, start, span, settings, sense)
        watch = Watch(builder, own, settings, notes, replace(start))
        if progress is not None and not walks:
            progress(start)
        walks.append(_walk(stepper, watch, progress, until, table(problem, number, sense)))
        if walks[-1].stopped in {Stopped.CLOSED, Stopped.INTERRUPTED}:
            break
    if tangent is not None and iterations == 0 and all(len(w.watch.nodes) == 1 for w in walks):
        _check_left(problem, walks)
    _settle_start(walks, builder, at_edge=start.parameter in span)
    return _assemble(walks, notes)


def _senses(
    z: Array, tangent: Array, span: tuple[float, float], direction: int | None
) -> list[int]:
    """Return the directions to walk in along the tangent, inwards only at an end of the span."""
    if direction is not None:
        return [direction]
    inward = {span[0]: 1, span[1]: -1}.get(float(z[-1]))
    if inward is None or tangent[-1] == 0.0:
        return [1, -1]
    return [inward if tangent[-1] > 0.0 else -inward]


def _walk(
    stepper: Stepper,
    watch: Watch,
    progress: Callable[[Point], object] | None,
    until: Until | None,
    told: Table | None,
) -> _Walk:
    """Walk in one direction to its end."""
    try:
        while True:
            before, norm = stepper.point, stepper.scaling.copy()
            point = stepper.advance()
            if point is None:
                break
            watch.feed(before, point, norm)
            if told is not None:
                told.tell(watch.nodes)
            if watch.divided:
                stepper.step *= 0.5
            if progress is not None:
                progress(point)
            if until is not None:
                # a reason of its own says more than the problem's
                stepper.stopped = until(before, point) or stepper.stopped
        watch.finish(stepper.stopped)
        walk = _Walk(watch, stepper.stopped or Stopped.STEP, stepper.message)
    except KeyboardInterrupt:
        watch.abandon()
        walk = _Walk(watch, Stopped.INTERRUPTED, "")
    if told is not None:
        told.tell(watch.nodes)
        told.end(walk.stopped)
    return walk


def _check_left(problem: Problem, walks: list[_Walk]) -> None:
    """Raise if a start that could not be corrected could not be left either."""
    if all(walk.stopped in _STUCK for walk in walks):
        point = walks[0].watch.nodes[0][0]
        msg = (
            f"{problem.name}: no branch found along the given tangent at {problem.parameter} = "
            f"{point.parameter:.10g}; give a better start or tangent"
        )
        raise ConvergenceError(msg)


def _settle_start(walks: list[_Walk], builder: Builder, *, at_edge: bool) -> None:
    """Decide about test functions that are zero at the start, by their signs around it.

    At the edge of the span there is one side only, and zero is zero but for rounding.
    """
    forward = walks[0].watch
    for place, detector in enumerate(builder.detectors):
        exact = builder.value(place, forward.nodes[0][0]) == 0.0
        after = forward.first[place]
        if walks[0].stopped is Stopped.CLOSED:
            before = forward.signs[place]
        else:
            before = walks[1].watch.first[place] if len(walks) > 1 else 0
        doubtful = any(walk.watch.doubtful[place] for walk in walks)
        crossed = doubtful and before * after < 0
        ended = (exact or (at_edge and doubtful)) and (after == 0) != (before == 0)
        touched = exact and isinstance(detector, Target)
        if crossed or ended or touched:
            forward.mark(place, 0)


def _assemble(walks: list[_Walk], notes: list[str]) -> Trace:
    """Join both directions, put the branch in order and number its special points."""
    nodes: list[Node] = list(walks[0].watch.nodes)
    stopped, stopped_backward = walks[0].stopped, None
    if len(walks) > 1:
        nodes = walks[1].watch.nodes[:0:-1] + nodes
        stopped_backward = walks[1].stopped
        if nodes[0][0].parameter > nodes[-1][0].parameter:
            nodes.reverse()
            stopped, stopped_backward = stopped_backward, stopped
            for point in {id(point): point for point, _ in nodes}.values():
                point.tangent = -point.tangent
                point.arclength = -point.arclength
    origin = nodes[0][0].arclength
    counts: Counter[str] = Counter()
    special = []
    for index, (point, event) in enumerate(nodes):
        point.arclength -= origin
        if event is not None:
            counts[event.label] += 1
            event.name = f"{event.label}{counts[event.label]}"
            event.index, event.tangent = index, point.tangent
            special.append(event)
    message = "\n".join(filter(None, [*notes, *(walk.message for walk in walks)]))
    points = [point for point, _ in nodes]
    unexplained = [interval for walk in walks for interval in walk.watch.unexplained]
    return Trace(points, special, stopped, stopped_backward, message, unexplained)
