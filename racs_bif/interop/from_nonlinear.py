"""Models out of nonlinear and interconnected systems of python-control.

Their functions are run on numbers that record what is done with them, see
`racs_bif.symbolic.functions`. An interconnection is taken apart: each of its systems is run by
itself, and what connects them is linear.
"""

from __future__ import annotations

from dataclasses import replace
from numbers import Real
from typing import TYPE_CHECKING, Any

import numpy as np

from racs_bif.errors import ModelError, UsageError
from racs_bif.interop.names import plain_name
from racs_bif.symbolic.functions import model_from_function
from racs_bif.symbolic.model import Parameter

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import sympy as sp
    from numpy.typing import NDArray

    from racs_bif.symbolic.model import Model

    Numbers = NDArray[Any]


def from_nonlinear(system: Any, name: str) -> Model:  # noqa: ANN401 - control has no types
    """Return the model of a `control.NonlinearIOSystem`, interconnections included.

    Parameters
    ----------
    system : control.NonlinearIOSystem
        In continuous time; its inputs become parameters, zero by default, its numeric parameters
        parameters with their values.
    name : str
        Of the model.

    Raises
    ------
    UsageError
        If the numbers of its states, inputs or outputs are not fixed.
    ModelError
        If its functions fail, depend on time, or its outputs cannot be recorded; or if an
        interconnection has an algebraic loop.
    """
    if system.nstates is None or system.ninputs is None:
        msg = f"'{system.name}' leaves open how many states or inputs it has; name them"
        raise UsageError(msg)
    _check_loops(system)
    states = tuple(map(plain_name, system.state_labels))
    inputs = tuple(map(plain_name, system.input_labels))
    outputs = tuple(map(plain_name, system.output_labels or ()))
    numbers = {k: float(v) for k, v in _parameters(system).items()}
    for taken in ("t", "time", "states_", "parameters_"):
        if taken in (*states, *inputs, *numbers):
            msg = f"a state, input or parameter of '{system.name}' is called '{taken}'; rename it"
            raise ModelError(msg)
    table = [Parameter(u, 0.0) for u in inputs]
    table += [Parameter(k, v, source="python-control") for k, v in numbers.items()]

    # Arguments are known by their names, which must not be those of states.
    def rates(t: Any, states_: Numbers, parameters_: Any) -> Numbers:  # noqa: ANN401
        u = _joined([parameters_[name] for name in inputs], states_)
        return _rates(system, t, states_, u, {k: parameters_[k] for k in numbers})

    model = model_from_function(name, rates, states=states, parameters=table)
    shown = _outputs(system, (states, outputs), (inputs, table, numbers))
    return replace(model, outputs=shown, inputs=inputs)


def _outputs(
    system: Any,  # noqa: ANN401 - control has no types
    labels: tuple[tuple[str, ...], tuple[str, ...]],
    given: tuple[tuple[str, ...], Sequence[Parameter], Mapping[str, float]],
) -> dict[str, sp.Expr]:
    """Record the outputs: as if they were rates, of as many states more."""
    (states, outputs), (inputs, table, numbers) = labels, given
    new = [k for k, o in enumerate(outputs) if o not in states]
    if not new:
        return {}
    invented = [f"output_{k}_of_system" for k in new]

    def function(t: Any, states_: Numbers, parameters_: Any) -> list[Any]:  # noqa: ANN401
        own = states_[len(invented) :]
        u = _joined([parameters_[name] for name in inputs], own)
        every = _outs(system, t, own, u, {k: parameters_[k] for k in numbers})
        return [*(every[k] for k in new), *(0.0 * value for value in own)]

    recorded = model_from_function(
        f"outputs_of_{plain_name(system.name)}",
        function,
        states=(*invented, *states),
        parameters=table,
        derivatives="recorded",
    )
    found = [recorded.equations[name] for name in invented]
    for term, meaning in reversed(list(recorded.terms.items())):
        found = [_replaced(e, term, meaning) for e in found]
    return dict(zip((outputs[k] for k in new), found, strict=True))


def _replaced(expression: sp.Expr, name: str, meaning: sp.Expr) -> sp.Expr:
    import sympy as sp

    return expression.xreplace({sp.Symbol(name): meaning})


def _parameters(system: Any) -> dict[str, Any]:  # noqa: ANN401 - control has no types
    """Return the numeric parameters of a system and of those that it connects."""
    found: dict[str, Any] = {}
    for part in getattr(system, "syslist", ()):
        found |= _parameters(part)
    return found | {k: v for k, v in system.params.items() if _is_number(v) and k.isidentifier()}


def _is_number(value: object) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool)


def _rates(system: Any, t: Any, x: Numbers, u: Numbers, p: Mapping[str, Any]) -> Numbers:  # noqa: ANN401
    if _is_linear(system):
        return np.asarray(system.A @ x + system.B @ u)
    if not hasattr(system, "syslist"):
        return _listed(system.updfcn(t, x, u, {**system.params, **p}), x)
    inner, _ = _inside(system, t, x, u, p)
    parts = [
        _rates(part, t, own, driven, _passed(system, part, p))
        for part, own, driven in _cut(system, x, inner)
        if part.nstates
    ]
    return _joined([value for part in parts for value in part], x)


def _outs(system: Any, t: Any, x: Numbers, u: Numbers, p: Mapping[str, Any]) -> Numbers:  # noqa: ANN401
    if _is_linear(system):
        return np.asarray(system.C @ x + system.D @ u)
    if hasattr(system, "syslist"):
        inner, outs = _inside(system, t, x, u, p)
        # Inputs of parts may be outputs of the whole, too.
        return np.asarray(system.output_map @ np.concatenate([outs, inner]))
    if system.outfcn is None:
        return x[: system.noutputs]
    return _listed(system.outfcn(t, x, u, {**system.params, **p}), x)


def _is_linear(system: Any) -> bool:  # noqa: ANN401 - control has no types
    return all(hasattr(system, name) for name in "ABCD")


def _passed(whole: Any, part: Any, p: Mapping[str, Any]) -> dict[str, Any]:  # noqa: ANN401
    """Return the parameters of a part: the whole's go before its own."""
    return {k: v for k, v in p.items() if k in part.params or k in whole.params}


def _inside(
    system: Any,  # noqa: ANN401 - control has no types
    t: Any,  # noqa: ANN401 - a recorded number
    x: Numbers,
    u: Numbers,
    p: Mapping[str, Any],
) -> tuple[Numbers, Numbers]:
    """Return the inputs and outputs of all parts of an interconnection.

    Without algebraic loops a signal passes each output once at most: so many rounds are enough.
    """
    driven = system.input_map @ u
    count = system.connect_map.shape[1]
    outs = np.zeros(count)
    for _ in range(count):
        inputs = system.connect_map @ outs + driven
        parts = [
            _outs(part, t, own, its, _passed(system, part, p))
            for part, own, its in _cut(system, x, inputs)
        ]
        outs = _joined([value for part in parts for value in part], x)
    return system.connect_map @ outs + driven, outs


def _cut(system: Any, x: Numbers, u: Numbers) -> list[tuple[Any, Numbers, Numbers]]:  # noqa: ANN401
    """Return each part with its states and inputs."""
    found, i, j = [], 0, 0
    for part in system.syslist:
        found.append((part, x[i : i + part.nstates], u[j : j + part.ninputs]))
        i, j = i + part.nstates, j + part.ninputs
    return found


def _joined(values: Sequence[Any], like: Numbers) -> Numbers:
    """Return numbers as an array of the kind that another one has."""
    array = np.empty(len(values), dtype=like.dtype)
    array[:] = values
    return array


def _listed(returned: Any, like: Numbers) -> Numbers:  # noqa: ANN401 - what a function returned
    if isinstance(returned, np.ndarray):
        return returned.reshape(-1)
    many = returned if hasattr(returned, "__len__") else [returned]
    return _joined(list(many), like)


def _check_loops(system: Any) -> None:  # noqa: ANN401 - control has no types
    if not hasattr(system, "syslist"):
        return
    for part in system.syslist:
        _check_loops(part)
    try:
        system.dynamics(0.0, np.full(system.nstates, 0.1), np.full(system.ninputs, 0.1))
    except RuntimeError as error:
        msg = f"'{system.name}' has an algebraic loop; put a state into it"
        raise ModelError(msg) from error
