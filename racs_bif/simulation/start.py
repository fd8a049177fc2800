"""Where a time history begins, and what had been before: the initial history.

A fractional element remembers everything before t = 0. Its input and output had then been constant,
``e_before`` and ``w_before``, with ``N(0) e_before = D(0) w_before``:

``rest``
    Nothing: the input was zero. Operators are then those of Riemann and Liouville, from t = 0.
``constant``
    The model's states had for ever been as they are at t = 0, held there by force.
``equilibrium``
    The model had been at its equilibrium for ever and is displaced at t = 0.

An element that integrates (s**-q) has its initial value as output before t = 0, and zero input: the
same in all three, and the operator of Caputo.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.errors import ConvergenceError, UsageError, nearest

if TYPE_CHECKING:
    from racs_bif.fractional.system import System
    from racs_bif.symbolic.field import Array

HISTORIES: Final = ("rest", "constant", "equilibrium")
_TOLERANCE = 1e-13


@dataclass(frozen=True)
class Start:
    """The beginning of a time history.

    Parameters
    ----------
    y : array (n,)
        The model's states at t = 0.
    w, e : array (ne,)
        Outputs and inputs of the elements before t = 0.
    """

    y: Array
    w: Array
    e: Array

    @property
    def X(self) -> Array:  # noqa: N802 - as everywhere
        """States and outputs together (n + ne,)."""
        return np.concatenate([self.y, self.w])


def begin(system: System, initial: Mapping[str, float], history: str) -> Start:
    """Return where a time history begins.

    Parameters
    ----------
    system : System
        The model; before t = 0 its parameters are its own.
    initial : mapping of str to float
        Values at t = 0 of states, and of outputs of elements that integrate. What is left out is
        zero after ``rest``, and at equilibrium otherwise.
    history : str
        One of `HISTORIES`.

    Raises
    ------
    UsageError
        If the history or a name is unknown, or a value is not finite.
    ConvergenceError
        If there is no equilibrium to start from.
    """
    if history not in HISTORIES:
        msg = f"unknown history '{history}'; {nearest(history, HISTORIES)}"
        raise UsageError(msg)
    _check_names(system, initial)
    compiled, ny = system.compiled, len(system.states)
    names = (*system.states, *compiled.elements)
    own = np.zeros(len(names))
    if history != "rest":
        own = system.exact_point(system.equilibrium(), system.values)
    X = np.array([initial.get(name, x) for name, x in zip(names, own, strict=True)], dtype=float)
    integrates = np.array([law.integrates for law in system.exact.laws(system.values)], dtype=bool)
    e = np.zeros(len(integrates))
    if history == "constant":
        X = _held(system, X, integrates)
    if history != "rest":
        source = X if history == "constant" else own
        e = compiled.core(source, compiled.padded(system.values))[ny:]
        e[integrates] = 0.0
    return Start(X[:ny], X[ny:], e)


def _check_names(system: System, initial: Mapping[str, float]) -> None:
    laws = system.exact.laws(system.values)
    free = [law.name for law in laws if law.integrates]
    bound = [law.name for law in laws if not law.integrates]
    known = [*system.states, *free]
    for name, value in initial.items():
        if name in bound:
            msg = f"'{name}' follows from its law and has no initial value; {nearest(name, known)}"
            raise UsageError(msg)
        if name not in known:
            msg = f"unknown state '{name}'; {nearest(name, known)}"
            raise UsageError(msg)
        if not np.isfinite(value):
            msg = f"the initial value of '{name}' is {value}; give a finite number"
            raise UsageError(msg)


def _held(system: System, X: Array, integrates: Array) -> Array:
    """Return X with the outputs of elements at rest while the states are held."""
    ny = len(system.states)
    bound = ny + np.flatnonzero(np.logical_not(integrates))
    X = X.copy()
    for _ in range(20):
        if not len(bound):
            return X
        residual = system.exact.residual(X, system.values)[bound]
        jacobian = system.exact.jacobian(X, system.values)[np.ix_(bound, bound)]
        step = np.linalg.solve(jacobian, residual)
        X[bound] -= step
        if np.all(np.abs(step) <= _TOLERANCE * (1.0 + np.abs(X[bound]))):
            return X
    told = "no state of rest of its elements at the initial values"
    msg = f"model '{system.name}': {told}; give others"
    raise ConvergenceError(msg)
