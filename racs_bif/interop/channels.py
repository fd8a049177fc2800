"""Inputs and outputs by name, and the linearised core between them.

Everything is a derivative of the compiled core (y', e)(X, P), with X = (y, zeta) and P = (p, D), at
one point; see `racs_bif.symbolic.generate`. The realisation and the exact operator differ in what
is put around it.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import ModelError, ParameterError, UsageError, nearest
from racs_bif.symbolic.jets import multilinear

if TYPE_CHECKING:
    from collections.abc import Sequence

    from racs_bif.fractional.system import System
    from racs_bif.interop.operating import OperatingPoint
    from racs_bif.symbolic.compiled import CompiledModel
    from racs_bif.symbolic.field import Array

FORCE = "force_"
"""What the name of an input that acts on the equation of a state begins with."""


@dataclass(frozen=True, eq=False)
class Channels:
    """What goes in and what comes out.

    Parameters
    ----------
    inputs, outputs : tuple of str
        Their names.
    directions : array (np, m)
        What each input changes in the base parameters; zero for forces.
    forces : array (ny, m)
        What each input adds to y'; zero for parameters.
    """

    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    directions: Array
    forces: Array


@dataclass(frozen=True, eq=False)
class Core:
    """The linearised core, (y', e) = J X + B u and outputs = G X + D u.

    Parameters
    ----------
    J : array (size, size)
        By the states and the memory of the elements.
    B : array (size, m)
        By the inputs.
    G : array (q, size)
        Outputs by states and memory.
    D : array (q, m)
        Outputs by inputs.
    """

    J: Array
    B: Array
    G: Array
    D: Array


def choose_channels(
    point: OperatingPoint,
    inputs: Sequence[str] | None,
    outputs: Sequence[str] | None,
    forces: Sequence[str] = (),
) -> Channels:
    """Find inputs and outputs by their names.

    Parameters
    ----------
    point : OperatingPoint
        Where.
    inputs : sequence of str, optional
        Parameters, base or derived. Where left out: those that the model names as its inputs, or,
        if it names none, all base parameters that are in no law.
    outputs : sequence of str, optional
        States, outputs of the model and of its elements; states and outputs of the model where
        left out.
    forces : sequence of str
        States; an input ``force_STATE`` is added to the right-hand side of the equation of each,
        before the mass matrix is inverted.

    Raises
    ------
    UsageError
        If a name is unknown or given twice, or there is no input or no output.
    ParameterError
        If a law of the model depends on a parameter.
    """
    system = point.system
    chosen = _listed(inputs, "inputs") if inputs is not None else _default_inputs(point, forces)
    pushed = _listed(forces, "forces")
    shown = _listed(outputs, "outputs") if outputs is not None else _own(system)
    known = [*_own(system), *system.compiled.elements]
    for names, there in ((pushed, system.states), (shown, known)):
        for name in names:
            if name not in there:
                what = "state" if names is pushed else "output"
                msg = f"unknown {what} '{name}'; {nearest(name, there)}"
                raise UsageError(msg)
    count = len(chosen) + len(pushed)
    if not count or not shown:
        msg = "a linear system needs an input and an output; name a parameter, or give forces="
        raise UsageError(msg)
    directions = np.zeros((len(point.p), count))
    push = np.zeros((len(system.states), count))
    for k, name in enumerate(chosen):
        directions[:, k] = _direction(point, name)
    for k, name in enumerate(pushed, len(chosen)):
        push[system.states.index(name), k] = 1.0
    if pushed:
        push = _accelerations(point, push)
    labels = (*chosen, *(f"{FORCE}{name}" for name in pushed))
    return Channels(labels, shown, directions, push)


def _own(system: System) -> tuple[str, ...]:
    return (*system.states, *system.outputs)


def _listed(names: Sequence[str], what: str) -> tuple[str, ...]:
    listed = (names,) if isinstance(names, str) else tuple(names)
    twice = [name for name, count in Counter(listed).items() if count > 1]
    if twice:
        msg = f"'{twice[0]}' is twice among the {what}; give every name once"
        raise UsageError(msg)
    return listed


def _default_inputs(point: OperatingPoint, forces: Sequence[str]) -> tuple[str, ...]:
    system = point.system
    named = tuple(system.compiled.meta["inputs"])
    if named or forces:
        return named
    free = []
    for k, parameter in enumerate(system.compiled.parameters):
        dp = np.zeros(len(point.p))
        dp[k] = 1.0
        if system.field.law_directions(point.p, dp) is None:
            free.append(parameter.name)
    return tuple(free)


def _direction(point: OperatingPoint, name: str) -> Array:
    system = replace(point.system, values=point.p)
    path = system.path(name)
    dp = path.direction(system.parameters[name])
    if system.field.law_directions(point.p, dp) is not None:
        msg = (
            f"a law of the model depends on '{name}', which therefore cannot change with time; "
            "choose another input"
        )
        raise ParameterError(msg)
    return dp


def _accelerations(point: OperatingPoint, push: Array) -> Array:
    """Return mass**-1 @ push, the mass matrix read back from what the compiled model prints."""
    system, printed = point.system, point.system.compiled.meta["mass"]
    if printed is None:
        return push
    import sympy as sp

    from racs_bif.symbolic.strings import parse

    names = [*(p.name for p in system.compiled.parameters), *system.states]
    numbers = [*point.p, *point.x[: len(system.states)]]
    values = dict(zip(map(sp.Symbol, names), map(float, numbers), strict=True))
    try:
        mass = np.array([[float(parse(e).subs(values)) for e in row] for row in printed])
    except ModelError as error:
        msg = f"forces need the mass matrix of '{system.name}', which cannot be read: {error}"
        raise ModelError(msg) from error
    return np.asarray(np.linalg.solve(mass, push))


def linearised_core(point: OperatingPoint, channels: Channels, X: Array, P: Array) -> Core:
    """Return the derivatives of the core at a point.

    Parameters
    ----------
    point : OperatingPoint
        Whose model.
    channels : Channels
        Inputs and outputs.
    X, P : array (size,), array (np + ne,)
        Where: with direct feedthroughs in P and the memory in X for the realisation, without any
        and with the outputs of the elements in X for the exact operator.
    """
    compiled, ny = point.system.compiled, len(point.system.states)
    through = np.zeros((len(compiled.elements), channels.directions.shape[1]))
    moved = np.vstack([channels.directions, through])
    J = compiled.core_jacobian(X, P)
    B = np.column_stack([compiled.core_p(X, P, column) for column in moved.T])
    B[:ny] += channels.forces
    G = np.zeros((len(channels.outputs), len(X)))
    D = np.zeros((len(channels.outputs), B.shape[1]))
    for row, name in enumerate(channels.outputs):
        if name in point.system.states:
            G[row, point.system.states.index(name)] = 1.0
        elif name in compiled.elements:
            k = compiled.elements.index(name)
            gain = P[len(point.p) + k]
            G[row], D[row] = gain * J[ny + k], gain * B[ny + k]
            G[row, ny + k] += 1.0
    rows = [k for k, name in enumerate(channels.outputs) if name in compiled.outputs]
    if rows:
        places = [compiled.outputs.index(channels.outputs[k]) for k in rows]
        along_X, along_u = _output_derivatives(compiled, X, P, moved)
        G[rows], D[rows] = along_X[places], along_u[places]
    return Core(J, B, G, D)


def _output_derivatives(
    compiled: CompiledModel, X: Array, P: Array, moved: Array
) -> tuple[Array, Array]:
    """Return the derivatives of the model's outputs by X and by the inputs."""
    algebra = multilinear(1)

    def slope(dX: Array, dP: Array) -> Array:
        groups = np.column_stack([P, dP]), np.column_stack([X, dX])
        return np.asarray(compiled.expand("outputs", algebra, *groups)[:, 1].real)

    along_X = [slope(column, np.zeros(len(P))) for column in np.eye(len(X))]
    along_u = [slope(np.zeros(len(X)), column) for column in moved.T]
    return np.column_stack(along_X), np.column_stack(along_u)
