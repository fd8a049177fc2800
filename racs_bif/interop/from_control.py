"""Models out of systems of python-control."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from racs_bif.errors import ModelError, UsageError
from racs_bif.interop.names import plain_name
from racs_bif.symbolic.model import Model, Parameter

if TYPE_CHECKING:
    from collections.abc import Sequence

    import sympy as sp

    from racs_bif.symbolic.field import Array


def from_control(system: Any, *, name: str = "") -> Model:  # noqa: ANN401 - control has no types
    """Return the model of a system of python-control: its inputs are parameters, zero by default.

    Parameters
    ----------
    system : control.StateSpace, control.TransferFunction or control.NonlinearIOSystem
        In continuous time. A transfer function is realised in controllable form, each of its
        channels by itself. The functions of a nonlinear system, also of an interconnected one, are
        recorded as `racs_bif.model_from_function` does it: derivatives are exact wherever it can;
        where it cannot, the model's notes say so. Its numeric parameters stay parameters.
    name : str
        Of the model; the system's own where left out.

    Returns
    -------
    Model
        Characters that a name cannot have become ``_``: ``x[0]`` is state ``x_0``.

    Raises
    ------
    UsageError
        If the system is none of these, or in discrete time.
    ModelError
        If a transfer function differentiates, an interconnection has an algebraic loop, a function
        fails or depends on time, or an output cannot be recorded.

    Examples
    --------
    >>> import control
    >>> import racs_bif as rb
    >>> model = rb.from_control(control.tf([1], [1, 0.2, 4], inputs=["force"], outputs=["place"]))
    >>> model.states, model.inputs, list(model.outputs)
    (('x_0', 'x_1'), ('force',), ['place'])
    """
    import control

    if not isinstance(system, control.InputOutputSystem):
        msg = f"{type(system).__name__} is no system of control; give a StateSpace, for example"
        raise UsageError(msg)
    if not system.isctime():
        msg = f"'{system.name}' is in discrete time (dt = {system.dt}); give one in continuous time"
        raise UsageError(msg)
    called = name or plain_name(system.name)
    if isinstance(system, control.TransferFunction):
        matrices: tuple[Array, ...] = _realised(system)
        states = [f"x_{k}" for k in range(len(matrices[0]))]
    elif isinstance(system, control.StateSpace):
        matrices = tuple(
            np.asarray(m, dtype=float) for m in (system.A, system.B, system.C, system.D)
        )
        states = system.state_labels
    elif isinstance(system, control.NonlinearIOSystem):
        from racs_bif.interop.from_nonlinear import from_nonlinear

        return from_nonlinear(system, called)
    else:
        msg = f"a {type(system).__name__} has no equations; give a StateSpace or TransferFunction"
        raise UsageError(msg)
    return _linear(matrices, (states, system.input_labels, system.output_labels), called)


def _linear(
    matrices: tuple[Array, ...],
    labels: tuple[Sequence[str], Sequence[str], Sequence[str]],
    name: str,
) -> Model:
    import sympy as sp

    A, B, C, D = matrices
    states, inputs, outputs = (tuple(map(plain_name, part)) for part in labels)
    signals = [*map(sp.Symbol, states), *map(sp.Symbol, inputs)]
    rates, shown = np.hstack([A, B]), np.hstack([C, D])
    table = {o: _sum(row, signals) for o, row in zip(outputs, shown, strict=True)}
    # An output that is a state of the same name says nothing new.
    table = {o: e for o, e in table.items() if not (o in states and e == sp.Symbol(o))}
    return Model(
        name=name,
        equations={x: _sum(row, signals) for x, row in zip(states, rates, strict=True)},
        parameters=tuple(Parameter(u, 0.0) for u in inputs),
        outputs=table,
        inputs=inputs,
        source="python-control",
    )


def _sum(row: Array, signals: Sequence[sp.Symbol]) -> sp.Expr:
    import sympy as sp

    pairs = [(float(c), x) for c, x in zip(row, signals, strict=True) if c]
    return sp.Add(*[x if c == 1.0 else sp.Float(c) * x for c, x in pairs])


def _realised(system: Any) -> tuple[Array, Array, Array, Array]:  # noqa: ANN401
    """Return A, B, C, D of a transfer function, its channels side by side."""
    from scipy.linalg import block_diag
    from scipy.signal import tf2ss

    count, width = system.noutputs, system.ninputs
    blocks, columns, rows = [], [], []
    through = np.zeros((count, width))
    for i in range(count):
        for j in range(width):
            numerator, denominator = system.num_array[i, j], system.den_array[i, j]
            numerator = np.trim_zeros(np.atleast_1d(numerator), "f")
            denominator = np.trim_zeros(np.atleast_1d(denominator), "f")
            if len(numerator) > len(denominator):
                msg = (
                    f"'{system.name}' differentiates its input: the numerator's degree is above "
                    "the denominator's; divide it by a fast pole"
                )
                raise ModelError(msg)
            if not len(numerator):
                continue
            a, b, c, d = tf2ss(numerator, denominator)
            through[i, j] = d[0, 0]
            if len(denominator) == 1:
                continue
            blocks.append(a)
            columns.append(b @ np.eye(width)[[j]])
            rows.append(np.eye(count)[:, [i]] @ c)
    size = sum(map(len, blocks))
    A = block_diag(*blocks) if blocks else np.zeros((0, 0))
    B = np.vstack(columns) if columns else np.zeros((size, width))
    C = np.hstack(rows) if rows else np.zeros((count, size))
    return A, B, C, through
