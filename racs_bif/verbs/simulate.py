"""A time history: of the exact fractional operator, or of its realisation."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from racs_bif.errors import UsageError, nearest
from racs_bif.numerics.threads import single_threaded
from racs_bif.results.history import TimeHistory
from racs_bif.results.provenance import describe
from racs_bif.shelf.load import system_of
from racs_bif.simulation.inputs import Inputs, Signal
from racs_bif.simulation.memory import METHODS, check_laws
from racs_bif.simulation.realised import SOLVERS
from racs_bif.simulation.runs import Task, errors_of, extrapolated, run_exact, run_realised
from racs_bif.simulation.start import begin

if TYPE_CHECKING:
    from racs_bif.fractional.system import System
    from racs_bif.symbolic.model import Model

OPERATORS: Final = ("exact", "realised")
_TOLERANCE: Final = {"exact": 1e-3, "realised": 1e-8}
"""Unless another is asked for: of the history, relative to its range; of a step."""
_ENDLESS = 4_000_000


@single_threaded
def simulate(  # noqa: PLR0913 - each is one choice of the user's
    model: Model | System,
    duration: float,
    *,
    operator: str = "exact",
    method: str | None = None,
    initial: Mapping[str, float] | None = None,
    history: str = "rest",
    inputs: Mapping[str, Signal] | None = None,
    jumps: Sequence[float] = (),
    step: float | None = None,
    tolerance: float | None = None,
    extrapolate: bool = False,
    progress: Callable[[float], None] | None = None,
) -> TimeHistory:
    """Integrate a model in time.

    Parameters
    ----------
    model : Model or System
        What is integrated.
    duration : float
        For how long [s].
    operator : {"exact", "realised"}
        The fractional operators themselves, or the filters that realise them. A model without
        fractional elements has one operator; unless a method of the exact one is asked for, it is
        integrated like a realised model.
    method : str, optional
        For the exact operator ``bdf2`` (convolution quadrature, second order; the default), ``l1``
        (order 2 - q for an element that grows like s**q) or ``fast`` (as bdf2, the distant past
        as a sum of exponentials: the cost of a step does not grow). For the realised one ``lsoda``
        (default) or ``radau``.
    initial : mapping of str to float, optional
        States at t = 0, and outputs of elements that integrate (s**-q). What is left out is zero
        after ``rest``, and at equilibrium otherwise.
    history : {"rest", "constant", "equilibrium"}
        What was before t = 0: the inputs of all elements were zero; the model had for ever been in
        its initial state; or at its equilibrium. Parameters had the model's own values.
    inputs : mapping of str to callable or mapping, optional
        Parameters that move: a smooth function of time, or times and the values from then on, as in
        ``{"f": {0.0: 8.0, 1.0: 0.0}}``.
    jumps : sequence of float, optional
        Times at which callables jump.
    step : float, optional
        Largest step of the exact operator, or distance of the samples of the realised one [s]. It
        is rounded down so that an even number of steps fits in the duration and between jumps.
    tolerance : float, optional
        Where no step is given, the exact operator's is halved until the estimated error is below
        this share of every state's range, 1e-3 by default. For the realised one the tolerance of
        a step, 1e-8 by default.
    extrapolate : bool
        Combine the exact operator's runs at the step and twice the step (Richardson), at the
        latter's times: one order more for smooth histories.
    progress : callable, optional
        Called with the time now and then; several runs may be made.

    Returns
    -------
    TimeHistory
        Its `errors` are largest differences to a run with twice the step over ``2**order - 1``, or
        with ten times the tolerance; the first tenth of the duration is left out.

    Raises
    ------
    UsageError
        If an option or a name is unknown, or duration, step or tolerance cannot be used.
    ParameterError
        If an order of a law is above 2, an input is no parameter or part of a law.
    ConvergenceError
        If the first step fails, or no equilibrium is found where one is needed.

    Examples
    --------
    >>> import racs_bif as rb
    >>> relaxation = rb.model_from_strings(
    ...     "relaxation", {}, parameters={"q": 0.5}, elements=[("x", "-x", "s**(-q)")]
    ... )
    >>> done = rb.simulate(relaxation, 1.0, initial={"x": 1.0}, step=1 / 256, extrapolate=True)
    >>> print(f"{done.column('x')[-1]:.6f}")  # E_0.5(-1)
    0.427584
    """
    system = system_of(model)
    _check_numbers(duration, step, tolerance)
    operator, method = _choose(system, operator, method)
    exact = method in METHODS
    if exact:
        check_laws(system.exact.laws(system.values))
    moving = Inputs(
        system=system, duration=float(duration), signals=dict(inputs or {}), jumps=tuple(jumps)
    )
    start = begin(system, dict(initial or {}), history)
    task = Task(system, start, moving, method, progress)
    wanted = tolerance or _TOLERANCE["exact" if exact else "realised"]
    if extrapolate and not exact:
        msg = "only the exact operator's methods of constant step extrapolate; leave it out"
        raise UsageError(msg)
    done = run_exact(task, step, wanted) if exact else run_realised(task, step, wanted)
    errors = errors_of(task, done)
    if extrapolate and done.rough is not None:
        done = replace(done, march=extrapolated(done, done.rough))
    states, outputs = task.columns(done.march)
    about = describe(system)
    if operator != "realised":
        about = replace(about, realisation=None)
    return TimeHistory(
        times=done.march.times,
        state_names=system.states,
        states=states,
        outputs=outputs,
        inputs={name: moving.column(name, done.march.times) for name in moving.signals},
        system=about,
        operator=operator,
        method=method,
        history=history,
        step=done.step,
        order=done.order,
        errors=errors,
        extrapolated=extrapolate and done.rough is not None,
        stopped=done.sentence or "The duration is over.",
        early=bool(done.sentence),
    )


def _check_numbers(duration: float, step: float | None, tolerance: float | None) -> None:
    if not 0.0 < duration < math.inf:
        msg = f"the duration is {duration:g} s; give a positive, finite one"
        raise UsageError(msg)
    if step is not None and not 0.0 < step <= duration:
        msg = f"the step is {step:g} s; give one between 0 and the duration, {duration:g} s"
        raise UsageError(msg)
    if step is not None and duration / step > _ENDLESS:
        msg = f"a step of {step:g} s makes over {_ENDLESS:g} steps; give a larger one"
        raise UsageError(msg)
    if tolerance is not None and not 0.0 < tolerance < 1.0:
        msg = f"the tolerance is {tolerance:g}; give one between 0 and 1"
        raise UsageError(msg)


def _choose(system: System, operator: str, method: str | None) -> tuple[str, str]:
    """Return the operator's and the method's name."""
    if operator not in OPERATORS:
        msg = f"unknown operator '{operator}'; {nearest(operator, OPERATORS)}"
        raise UsageError(msg)
    known: tuple[str, ...] = tuple(METHODS) if operator == "exact" else tuple(SOLVERS)
    if not system.fractional:
        operator, known = "ordinary", (*SOLVERS, *METHODS)
    if method is not None and method not in known:
        msg = f"unknown method '{method}' of the {operator} operator; {nearest(method, known)}"
        raise UsageError(msg)
    return operator, method or known[0]
