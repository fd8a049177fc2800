"""Models from plain Python functions.

The function is run once on numbers that record what is done with them; what comes out is the same
straight-line program that strings give. Only a function that cannot be recorded is called when the
model is evaluated, and the model says so.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from racs_bif.errors import ModelError, UsageError, nearest
from racs_bif.symbolic.arguments import read_arguments
from racs_bif.symbolic.called import called, check_constant, equations
from racs_bif.symbolic.external import DIFFERENCES, SERIES, External
from racs_bif.symbolic.model import FractionalElement, Model, Parameter
from racs_bif.symbolic.recorded import RefusedError, recorded
from racs_bif.symbolic.strings import check_name, number, read_element, read_inputs, read_table
from racs_bif.units import SECONDS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

RECORDED: Final = "recorded"
CHOICES: Final = ("auto", RECORDED, SERIES, DIFFERENCES)


def model_from_function(  # noqa: PLR0913 - the parts of a model, by their names
    name: str,
    function: Callable[..., Any],
    *,
    states: Sequence[str] | str,
    parameters: Mapping[str, float] | Iterable[Parameter] = (),
    guess: Mapping[str, float] | Sequence[float] | None = None,
    elements: Iterable[tuple[str, str, str] | FractionalElement] = (),
    outputs: Mapping[str, str] | None = None,
    inputs: Iterable[str] = (),
    time_unit: str = SECONDS,
    derivatives: str = "auto",
) -> Model:
    """Build a model from a plain Python right-hand side.

    The arguments of the function are known by their names. Those of states, parameters and outputs
    of elements are given these numbers; ``t`` or ``time`` the time, on which nothing may depend;
    the first other argument the states as an array, and the second other one the parameters, as
    ``p.k``, ``p["k"]`` or ``k1, k2 = p``. So ``f(x, p)``, ``f(t, x, p)``, ``f(x, k1, k2)`` and
    ``f(position, speed, k1, k2)`` are all understood. It returns the rates of the states: a list,
    tuple or array in their order, a dict by their names, or a number where there is one state.

    It is recorded once, as a straight-line program with exact derivatives that runs as fast as one
    made from strings: arithmetic, loops, ``if`` on states and parameters, `math`, numpy functions,
    arrays and products with constant matrices, ``scipy.special.expit`` and ``erf``. What cannot be
    recorded (more than 64 paths, loops that end when something has converged) is called at every
    evaluation, with derivatives by power series, exact too; what not even a power series passes
    through (`scipy` solvers and interpolation, rounding, conversion to ``float``) with a complex
    step or differences. The model's notes then say so, and how good they are.

    Parameters
    ----------
    name : str
        Name of the model.
    function : callable
        The right-hand side.
    states : sequence of str
        Names of the states, in their order; or one string with blanks or commas between them.
    parameters : mapping of str to float, or iterable of Parameter
        Parameter names and default values.
    guess : mapping of str to float or sequence of float, optional
        Where to look for an equilibrium.
    elements : iterable of (output, input, law)
        Fractional elements, for example ``[("w", "x", "s**0.5")]``; the function takes ``w`` as an
        argument.
    outputs : mapping of str to str, optional
        Further quantities, as expressions.
    inputs : iterable of str
        Parameters that act on the model from outside: the inputs of its linearisations.
    time_unit : str
        Unit of the time; ``""`` where it has none.
    derivatives : {"auto", "recorded", "series", "differences"}
        The best that is possible, or this one and no other.

    Returns
    -------
    Model

    Raises
    ------
    ModelError
        If the function fails, depends on the time, or returns what it must not.
    UsageError
        If `derivatives` is unknown.

    Examples
    --------
    >>> def predator(x, p):
    ...     return [x[0] * (p.a - x[1]), x[1] * (x[0] - 1)]
    >>> model = model_from_function("prey", predator, states="n m", parameters={"a": 2.0})
    >>> model.equations["n"]
    n*(a - m)
    """
    if derivatives not in CHOICES:
        msg = f"unknown derivatives '{derivatives}'; {nearest(derivatives, CHOICES)}"
        raise UsageError(msg)
    source = _Source(
        name,
        _parameters(name, parameters),
        tuple(e if isinstance(e, FractionalElement) else read_element(name, e) for e in elements),
        _states(name, states),
    )
    numbers = _guess(source, guess)
    model = partial(
        Model,
        name=name,
        parameters=source.parameters,
        guess=numbers,
        elements=source.elements,
        outputs=read_table(outputs or {}),
        inputs=read_inputs(name, inputs),
        time_unit=time_unit,
    )
    model(equations=dict.fromkeys(source.states, 0))  # refuses names and numbers before any call
    start = _start(source, numbers)
    external = _callable(source, function, start)
    check_constant(external, start)
    why = ""
    if derivatives in {"auto", RECORDED}:
        try:
            found = recorded(external, start)
            rates = dict(zip(source.states, found.results, strict=True))
            return model(equations=rates, terms=found.terms)
        except RefusedError as refused:
            why = str(refused)
            if derivatives == RECORDED:
                msg = (
                    f"model '{name}': '{external.arguments.function}' cannot be recorded ({why}); "
                    "leave derivatives='auto'"
                )
                raise ModelError(msg) from refused
    external, note = called(external, start, derivatives, why)
    return model(equations=equations(external), external=external, notes=(note,))


@dataclass(frozen=True)
class _Source:
    name: str
    parameters: tuple[Parameter, ...]
    elements: tuple[FractionalElement, ...]
    states: tuple[str, ...]


def _states(name: str, states: object) -> tuple[str, ...]:
    if isinstance(states, str):
        states = states.replace(",", " ").split()
    if not isinstance(states, Iterable):
        msg = f"model '{name}': give the names of the states as a list, not as {states!r}"
        raise ModelError(msg)
    found = tuple(states)
    for state in found:
        check_name(name, state)
        if not state.isidentifier():
            msg = f"model '{name}': '{state}' cannot be a name; use letters, digits and _"
            raise ModelError(msg)
        if found.count(state) > 1:
            msg = f"model '{name}': the name '{state}' is used twice; rename one of them"
            raise ModelError(msg)
    return found


def _parameters(name: str, given: object) -> tuple[Parameter, ...]:
    if isinstance(given, Mapping):
        for key in given:
            check_name(name, key)
        return tuple(Parameter(key, number(name, key, value)) for key, value in given.items())
    found = tuple(given) if isinstance(given, Iterable) else (given,)
    if not all(isinstance(p, Parameter) for p in found):
        msg = f"model '{name}': give parameters as a dict, not as {type(given).__name__}"
        raise ModelError(msg)
    return found


def _guess(source: _Source, guess: object) -> dict[str, float]:
    if guess is None:
        return {}
    if isinstance(guess, Mapping):
        return {key: number(source.name, key, value) for key, value in guess.items()}
    values = np.ravel(np.asarray(guess, dtype=object)).tolist()
    if len(values) != len(source.states):
        msg = (
            f"model '{source.name}': the guess has {len(values)} numbers; give "
            f"{len(source.states)}, one for each of {', '.join(source.states)}"
        )
        raise ModelError(msg)
    pairs = zip(source.states, values, strict=True)
    return {key: number(source.name, key, value) for key, value in pairs}


def _callable(source: _Source, function: object, start: Array) -> External:
    """Return the function with the way in which it is called."""
    if not callable(function):
        msg = f"model '{source.name}': {type(function).__name__} is no function; give one"
        raise ModelError(msg)
    names = tuple(p.name for p in source.parameters)
    outputs = tuple(e.output for e in source.elements)
    known = (source.name, function, source.states, names, outputs)
    found = External(function, read_arguments(*known))
    if len(source.states) > 1:
        return found
    try:  # f(x, p) with the only state x: a number or an array?
        found.floats(start)
    except ModelError as error:
        if not isinstance(error.__cause__, TypeError | IndexError):
            raise
        other = External(function, read_arguments(*known, vector=True))
        if other.arguments == found.arguments:
            raise
        with contextlib.suppress(ModelError):
            other.floats(start)
            return other
        raise
    return found


def _start(source: _Source, guess: Mapping[str, float]) -> Array:
    """Return the numbers of a first call: the guess and the defaults."""
    defaults = [p.default if isinstance(p.default, int | float) else 1.0 for p in source.parameters]
    inner = [guess.get(name, 0.0) for name in source.states]
    return np.array([*inner, *defaults, *(guess.get(e.output, 0.0) for e in source.elements)])
