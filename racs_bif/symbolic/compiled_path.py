"""Paths in parameter space along base and derived parameters of a compiled model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import ParameterError, UsageError, ValidityError
from racs_bif.symbolic.jets import multilinear
from racs_bif.symbolic.model import find_parameter
from racs_bif.symbolic.paths import ParameterPath

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from racs_bif.symbolic.compiled import CompiledModel
    from racs_bif.symbolic.field import Array


@dataclass(frozen=True)
class CompiledPath(ParameterPath):
    """Active parameters of a compiled model, base or derived, all others held.

    A derived parameter moves the base parameter that it sets; while it is active it keeps its value
    when another active parameter moves.

    Parameters
    ----------
    compiled : CompiledModel
        The model.
    names : tuple of str
        Active parameters.
    values : array (np,)
        Base parameters where they do not move.

    Raises
    ------
    ParameterError
        If a name is unknown.
    UsageError
        If two active parameters move the same base parameter.
    """

    compiled: CompiledModel
    names: tuple[str, ...]
    values: Array

    def __post_init__(self) -> None:
        """Check the names."""
        targets = [_target(self.compiled, name) for name in self.names]
        if len(set(targets)) < len(targets):
            msg = f"{' and '.join(self.names)} move the same parameter; choose two that differ"
            raise UsageError(msg)

    def vector(self, active: ArrayLike) -> Array:
        """Return the base parameters (np,) at the active values."""
        wanted = dict(zip(self.names, np.atleast_1d(np.asarray(active, dtype=float)), strict=True))
        return assign(self.compiled, self.values, wanted)

    def direction(self, active: ArrayLike, index: int = 0) -> Array:
        """Return the derivative (np,) of `vector` with respect to one active parameter."""
        values = np.atleast_1d(np.asarray(active, dtype=float))
        base = [p.name for p in self.compiled.parameters]
        dp = np.zeros(len(base))
        if self.names[index] in base:
            dp[base.index(self.names[index])] = 1.0
        derived = [d.name for d in self.compiled.derived]
        active = [k for k, name in enumerate(self.names) if name in derived]
        p = self.vector(values)
        for k in active * len(active):  # as often as `assign` goes round
            j = derived.index(self.names[k])
            place = base.index(self.compiled.derived[j].sets)
            slope = 1.0 if k == index else 0.0
            dp[place] = self.compiled.inverse_slope(j, p, float(values[k]), dp, slope)
        return dp

    def bend(self, active: ArrayLike, first: int, second: int) -> Array:
        """Return the second derivative (np,) of `vector` by two active parameters."""
        values = np.atleast_1d(np.asarray(active, dtype=float))
        base = [p.name for p in self.compiled.parameters]
        derived = [d.name for d in self.compiled.derived]
        moved = np.zeros((len(base) + len(self.compiled.elements), 4))
        moved[: len(base), 0] = self.vector(values)
        # Coefficients of 1, t, s, t s.
        wanted = [[value, k == first, k == second, 0.0] for k, value in enumerate(values)]
        for k, name in enumerate(self.names):
            if name in base:
                moved[base.index(name)] = wanted[k]
        active = [k for k, name in enumerate(self.names) if name in derived]
        for k in active * len(active):  # as above
            j = derived.index(self.names[k])
            value = np.array([wanted[k]], dtype=float)
            row = self.compiled.expand(f"inverse{j}", multilinear(2), moved, value)[0]
            moved[base.index(self.compiled.derived[j].sets)] = row.real
        return np.asarray(moved[: len(base), 3])


def assign(compiled: CompiledModel, values: Array, wanted: dict[str, float]) -> Array:
    """Return base parameters in which `wanted`, base or derived, have the values given.

    Raises
    ------
    ParameterError
        If a name is unknown, or derived parameters cannot have these values together.
    """
    base = [p.name for p in compiled.parameters]
    derived = [d.name for d in compiled.derived]
    p = np.array(values, dtype=float)
    for name, value in wanted.items():
        find_parameter(name, [*base, *derived])
        if name in base:
            p[base.index(name)] = value
    moved = [j for j, name in enumerate(derived) if name in wanted]
    for j in moved * len(moved):  # one may depend on what another sets: n rounds settle n of them
        info = compiled.derived[j]
        p[base.index(info.sets)] = compiled.inverse(j, p, float(wanted[info.name]))
    if len(moved) > 1:
        _check_together(compiled, p, {j: wanted[derived[j]] for j in moved})
    return p


def _check_together(compiled: CompiledModel, p: Array, wanted: dict[int, float]) -> None:
    reached = compiled.derived_values(p)
    for j, value in wanted.items():
        if not abs(reached[j] - value) <= 1e-9 * abs(value):
            names = " and ".join(compiled.derived[k].name for k in wanted)
            msg = f"{names} cannot be set together, each moves what the other needs; set one"
            raise ParameterError(msg)


def check_values(compiled: CompiledModel, wanted: dict[str, float]) -> None:
    """Refuse values that are unknown, not finite, contradictory or outside the model's validity.

    Raises
    ------
    ParameterError
        With the parameter's name, what is wrong and what is allowed.
    """
    table = {p.name: p for p in compiled.parameters} | {d.name: d for d in compiled.derived}
    for name, value in wanted.items():
        find_parameter(name, table)
        low, high = table[name].valid
        unit = f" {table[name].unit}" if table[name].unit else ""
        if not np.isfinite(value):
            msg = f"parameter '{name}' is {value}; give a finite number"
            raise ParameterError(msg)
        if not low < value < high:
            msg = (
                f"parameter '{name}' = {value:g}{unit} is outside the model's validity; "
                f"choose it {_words(low, high)}"
            )
            raise ValidityError(msg)
    for info in compiled.derived:
        if info.name in wanted and info.sets in wanted:
            msg = f"'{info.name}' sets '{info.sets}': give one of the two, not both"
            raise ParameterError(msg)


def _words(low: float, high: float) -> str:
    if np.isinf(low):
        return f"below {high:g}"
    return f"above {low:g}" if np.isinf(high) else f"between {low:g} and {high:g}"


def _target(compiled: CompiledModel, name: str) -> str:
    sets = {d.name: d.sets for d in compiled.derived}
    find_parameter(name, [*(p.name for p in compiled.parameters), *sets])
    return sets.get(name, name)
