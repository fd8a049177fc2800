"""A compiled model with parameter values and a realisation: what every verb works on."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import ConvergenceError, ModelError
from racs_bif.fractional.exact import ExactModel
from racs_bif.fractional.filter import Realisation, RealisationInfo
from racs_bif.fractional.realised import RealisedField
from racs_bif.symbolic.compiled_path import CompiledPath, assign, check_values

if TYPE_CHECKING:
    from collections.abc import Mapping

    from racs_bif.symbolic.compiled import CompiledModel, DerivedInfo
    from racs_bif.symbolic.field import Array
    from racs_bif.symbolic.model import Parameter


@dataclass(frozen=True, eq=False)
class System:
    """A dynamical system ready for numbers.

    Parameters
    ----------
    compiled : CompiledModel
        The model.
    values : array (np,)
        Its base parameters.
    settings : Realisation
        How its fractional elements are realised.
    loaded : str
        Where `load_model` finds the model again: a name on the shelf, or the path of its file;
        empty for one that was made in Python.
    """

    compiled: CompiledModel
    values: Array
    settings: Realisation
    loaded: str = ""

    @property
    def name(self) -> str:
        """Name of the model."""
        return self.compiled.name

    @property
    def title(self) -> str:
        """Title of the model."""
        return str(self.compiled.meta["title"])

    @property
    def variant(self) -> str:
        """Variant of the model."""
        return str(self.compiled.meta["variant"])

    @property
    def notes(self) -> tuple[str, ...]:
        """What a user must be told with every result."""
        return tuple(self.compiled.meta["notes"])

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the model's own states, without memory states."""
        return self.compiled.states

    @property
    def own(self) -> tuple[str, ...]:
        """Names of what results show as the model's state.

        Its states; the outputs of its elements where it is made of elements only.
        """
        return self.states or self.compiled.elements

    @property
    def state_units(self) -> dict[str, str]:
        """Units of states and outputs."""
        return dict(self.compiled.meta["units"])

    @property
    def time_unit(self) -> str:
        """Unit of the time; empty where it has none."""
        return str(self.compiled.meta["time_unit"])

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the model's outputs."""
        return self.compiled.outputs

    @property
    def parameter_table(self) -> tuple[Parameter | DerivedInfo, ...]:
        """Base and derived parameters with units, descriptions and sources."""
        return (*self.compiled.parameters, *self.compiled.derived)

    @cached_property
    def parameters(self) -> dict[str, float]:
        """Values of base and derived parameters by name."""
        names = [p.name for p in self.compiled.parameters]
        known = dict(zip(names, map(float, self.values), strict=True))
        derived = self.compiled.derived_values(self.values) if self.compiled.derived else ()
        return known | {
            d.name: float(v) for d, v in zip(self.compiled.derived, derived, strict=True)
        }

    @property
    def fractional(self) -> bool:
        """Whether the model has fractional elements."""
        return bool(self.compiled.elements)

    @cached_property
    def field(self) -> RealisedField:
        """The realised vector field."""
        return RealisedField(self.compiled, self.settings)

    @cached_property
    def exact(self) -> ExactModel:
        """The exact model."""
        return ExactModel(self.field)

    @cached_property
    def realisation(self) -> RealisationInfo:
        """What results say of the realisation."""
        if not self.fractional:
            return RealisationInfo(name="none", states=0, band=self.settings.band, error=0.0)
        frame = self.field.frame(self.values)
        error = max(self.settings.error(law) for law in frame.laws)
        return RealisationInfo(
            name=self.settings.name, states=len(frame.bank.A), band=self.settings.band, error=error
        )

    def _repr_html_(self) -> str:
        """Return what a notebook shows."""
        from racs_bif.symbolic.shown import model_card

        return model_card(self.compiled.meta, self.parameters)

    def path(self, *names: str) -> CompiledPath:
        """Return the path along active parameters."""
        return CompiledPath(self.compiled, names, self.values)

    def with_parameters(self, values: Mapping[str, float]) -> System:
        """Return the system with other parameter values.

        Raises
        ------
        ParameterError
            If a name is unknown or a value outside the model's validity.
        """
        wanted = {name: float(value) for name, value in values.items()}
        check_values(self.compiled, wanted)
        return replace(self, values=assign(self.compiled, self.values, wanted))

    def equilibrium(self, p: Array | None = None) -> Array:
        """Return states (n,) of the exact equilibrium found from the model's guess.

        Parameters
        ----------
        p : array (np,), optional
            Base parameters; the system's own where left out.

        Raises
        ------
        ConvergenceError
            If Newton's method finds none.
        ModelError
            If the equations are not finite at the guess.
        """
        p = self.values if p is None else p
        guess = self.compiled.meta["guess"]
        X = np.array(
            [guess.get(name, 0.0) for name in (*self.states, *self.compiled.elements)], dtype=float
        )
        if not np.all(np.isfinite(self.exact.residual(X, p))):
            names = ", ".join(f"{n} = {x:g}" for n, x in zip(self.states, X, strict=False))
            told = f"the equations are not finite at the guess {names}"
            msg = f"model '{self.name}': {told}; give another guess"
            raise ModelError(msg)
        try:
            return self.polish(X, p)
        except ConvergenceError:
            if self._degenerate(X, p):
                raise
            with suppress(ConvergenceError):
                return self.polish(self.exact.nearest(X, p), p)
            raise

    def polish(self, X: Array, p: Array) -> Array:
        """Return states (n,) of the exact equilibrium near X = (y, w)."""
        try:
            X = self.exact.equilibrium(X, p)
        except ConvergenceError as inner:
            msg = f"model '{self.name}': {self._degenerate(X, p) or inner}"
            raise ConvergenceError(msg) from None
        ny = len(self.states)
        return self.field.rest(X[:ny], X[ny:], p)

    def _degenerate(self, X: Array, p: Array) -> str:
        """Say what is wrong with a guess at which Newton's method has no direction, if it is so."""
        jacobian = self.exact.jacobian(X, p)
        if not np.all(np.isfinite(jacobian)) or np.linalg.matrix_rank(jacobian) == len(X):
            return ""
        if not np.any(jacobian):
            what = "the equations do not change with the states at the guess (their Jacobian is 0)"
        elif not np.any(self.exact.residual(X, p)):
            what = "the guess is an equilibrium with a singular Jacobian, so maybe not isolated"
        else:
            return ""
        return f"{what}; give another guess or value, or remove what is conserved"

    def own_state(self, x: Array, p: Array) -> Array:
        """Return what `own` names, of realised states x (n,), or (n, N) for N points."""
        return x[: len(self.states)] if self.states else self.field.outputs(x, p)

    def exact_point(self, x: Array, p: Array) -> Array:
        """Return X = (y, w) of realised states x (n,) at rest."""
        ny = len(self.states)
        frame = self.field.frame(p)
        X = self.field.core_point(x, p).copy()
        if self.fractional:
            e = self.compiled.core(X, frame.P)[ny:]
            X[ny:] += frame.P[len(p) :] * e
        return X
