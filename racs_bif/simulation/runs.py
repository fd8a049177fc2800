"""Runs that are compared: at a step and at twice the step, or at two tolerances."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.errors import ConvergenceError
from racs_bif.simulation.exact import INTERRUPTED, ExactStepper, March
from racs_bif.simulation.memory import order_of
from racs_bif.simulation.realised import RealisedStepper

if TYPE_CHECKING:
    from racs_bif.fractional.system import System
    from racs_bif.simulation.inputs import Inputs
    from racs_bif.simulation.start import Start
    from racs_bif.symbolic.field import Array

_FEWEST, _MOST = 256, 131_072
_SAMPLES = 2000
_SETTLED: Final = 0.1
"""Share of the duration after which errors are judged: near a jump they are larger, and decay."""


@dataclass(frozen=True)
class Task:
    """What is to be integrated, and how.

    Parameters
    ----------
    system : System
        The model.
    start : Start
        Where it begins.
    inputs : Inputs
        Its parameters as functions of time.
    method : str
        Of the exact operator or of the realised one.
    progress : callable, optional
        Called with the time now and then.
    """

    system: System
    start: Start
    inputs: Inputs
    method: str
    progress: Callable[[float], None] | None = None

    def exact(self, count: int) -> March:
        """Integrate the exact model with a number of steps."""
        stepper = ExactStepper(self.system, self.start, self.inputs, count, self.method)
        return stepper.run(self.progress)

    def realised(self, count: int, tolerance: float) -> March:
        """Integrate the realised model with a tolerance."""
        stepper = RealisedStepper(
            self.system, self.start, self.inputs, count, self.method, tolerance=tolerance
        )
        return stepper.run(self.progress)

    def columns(self, march: March) -> tuple[Array, dict[str, Array]]:
        """Return states (nt, n), and outputs of elements and of the model."""
        compiled, ny = self.system.compiled, len(self.system.states)
        outputs = dict(zip(compiled.elements, march.X[ny:], strict=True))
        if compiled.outputs:
            p = self.system.values
            if self.inputs.signals:
                rows = [self.inputs.values(float(t), before=bool(t > 0.0)) for t in march.times]
                p = np.stack(rows, axis=1)
            values = compiled.output_values(march.X, compiled.padded(p))
            full = march.times.shape
            outputs |= {k: np.broadcast_to(v, full).copy() for k, v in values.items()}
        return march.X[:ny].T.copy(), outputs


@dataclass(frozen=True)
class Done:
    """A run and the rougher one that it is compared with.

    Parameters
    ----------
    march : March
        The run.
    rough : March, optional
        The rougher one.
    step, order : float
        Size of its steps [s] and order of convergence; NaN where the method chose them.
    sentence : str
        Why it is not what was asked for; empty where it is.
    """

    march: March
    rough: March | None
    step: float
    order: float
    sentence: str = ""


def run_exact(task: Task, step: float | None, tolerance: float) -> Done:
    """Run the exact model at a step and twice the step, or at ever smaller ones.

    Parameters
    ----------
    task : Task
        What is to be integrated.
    step : float, optional
        Largest step [s].
    tolerance : float
        Where no step is given: largest error of a state relative to its range.

    Raises
    ------
    ConvergenceError
        If the first step cannot be made.
    """
    if step is not None:
        count = _whole(task.inputs, task.inputs.duration / step)
        rough = _attempt(task, count // 2)
        if rough is not None and rough.stopped == INTERRUPTED:
            return _done(task, rough, None)
        return _done(task, task.exact(count), rough)
    count = _whole(task.inputs, _FEWEST)
    rough = _attempt(task, count // 2)
    while True:
        if rough is not None and rough.stopped == INTERRUPTED:
            return _done(task, rough, None)
        last = 2 * count > _MOST
        march = task.exact(count) if last else _attempt(task, count)
        done = None if march is None else _done(task, march, rough)
        if done is not None and (last or done.sentence == INTERRUPTED):
            return _judged(task, done, tolerance)
        if done is not None and not done.sentence and _relative_error(task, done) <= tolerance:
            return done
        rough, count = march, 2 * count


def _whole(inputs: Inputs, count: float) -> int:
    """Return an even number of steps, at least `count`, between which jumps fall."""
    unit = 2 * inputs.divisor
    return unit * max(1, math.ceil(count / unit * (1.0 - 1e-12)))


def _attempt(task: Task, count: int) -> March | None:
    try:
        return task.exact(count)
    except ConvergenceError:
        return None


def _done(task: Task, march: March, rough: March | None) -> Done:
    laws = task.system.exact.laws(task.system.values)
    step = float(march.times[1] - march.times[0]) if len(march.times) > 1 else math.nan
    return Done(march, rough, step, order_of(task.method, laws), march.stopped)


def _judged(task: Task, done: Done, tolerance: float) -> Done:
    """Say where the tolerance was not reached."""
    error = _relative_error(task, done)
    if done.sentence or error <= tolerance:
        return done
    sentence = (
        f"The tolerance {tolerance:g} was not reached with {len(done.march.times) - 1} steps, the "
        f"error is about {error:.1g}; give a step, or a shorter duration."
    )
    return replace(done, sentence=sentence)


def run_realised(task: Task, step: float | None, tolerance: float) -> Done:
    """Run the realised model at a tolerance and at ten times that; `step` parts its samples.

    Raises
    ------
    ConvergenceError
        If nothing can be integrated.
    """
    count = _SAMPLES if step is None else task.inputs.duration / step
    whole = _whole(task.inputs, count)
    march = task.realised(whole, tolerance)
    rough = None
    if march.stopped != INTERRUPTED:
        rough = task.realised(whole, min(10.0 * tolerance, 0.5))
    return Done(march, rough, math.nan, math.nan, march.stopped)


def _differences(task: Task, done: Done) -> dict[str, tuple[Array, Array]]:
    """Return for each column its estimated errors, and its values there."""
    names = task.system.states
    states, outputs = task.columns(done.march)
    columns = dict(zip(names, states.T, strict=True)) | outputs
    if done.rough is None:
        return {name: (np.full(1, math.nan), column) for name, column in columns.items()}
    other_states, other_outputs = task.columns(done.rough)
    others = dict(zip(names, other_states.T, strict=True)) | other_outputs
    every = 1 if math.isnan(done.order) else 2
    shared = min(len(done.rough.times), (len(done.march.times) - 1) // every + 1)
    settled = done.rough.times[:shared] >= _SETTLED * task.inputs.duration
    share = 1.0 if math.isnan(done.order) else 2.0**done.order - 1.0
    found = {}
    for name, column in columns.items():
        fine = column[::every][:shared][settled]
        found[name] = (fine - others[name][:shared][settled]) / share, fine
    return found


def errors_of(task: Task, done: Done) -> dict[str, float]:
    """Return the largest estimated error of each column, NaN where none was made."""
    found = {}
    for name, (error, _) in _differences(task, done).items():
        found[name] = float(np.max(np.abs(error), initial=-1.0))
    return {name: error if error >= 0.0 else math.nan for name, error in found.items()}


def _relative_error(task: Task, done: Done) -> float:
    """Return the largest error of any state relative to its range, infinite if unknown."""
    judged = task.system.states or task.system.compiled.elements
    largest = 0.0
    differences = _differences(task, done)
    for name in judged:
        error, values = differences[name]
        if not len(error) or not np.all(np.isfinite(error)):
            return math.inf
        size = float(np.ptp(values)) or float(np.abs(values).max())
        largest = max(largest, float(np.abs(error).max()) / size if size else 0.0)
    return largest


def extrapolated(done: Done, rough: March) -> March:
    """Return Richardson's combination of both runs at their common times."""
    fine = done.march
    shared = min(len(rough.times), (len(fine.times) - 1) // 2 + 1)
    X = fine.X[:, ::2][:, :shared]
    X = X + (X - rough.X[:, :shared]) / (2.0**done.order - 1.0)
    return March(rough.times[:shared], X, fine.stopped)
