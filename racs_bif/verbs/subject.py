"""A branch of equilibria together with the exact model that it is checked on."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from racs_bif.errors import ConvergenceError
from racs_bif.fractional.certificates import Place
from racs_bif.results.certificate import Check

if TYPE_CHECKING:
    from racs_bif.fractional.exact import ExactModel
    from racs_bif.fractional.system import System
    from racs_bif.results.branch import Branch
    from racs_bif.results.special import SpecialPoint
    from racs_bif.symbolic.compiled_path import CompiledPath


@dataclass(frozen=True)
class Subject:
    """What is certified.

    Parameters
    ----------
    branch : Branch
        The branch.
    system : System
        The system that it was computed from.
    """

    branch: Branch
    system: System

    @property
    def parameter(self) -> str:
        """The active parameter."""
        return self.branch.parameters[0]

    @property
    def exact(self) -> ExactModel:
        """The exact model."""
        return self.system.exact

    @cached_property
    def path(self) -> CompiledPath:
        """The path along the active parameter."""
        return self.system.path(self.parameter)

    @property
    def width(self) -> float:
        """How far the branch reaches in the parameter."""
        values = self.branch.parameter
        return float(values.max() - values.min()) if len(values) else 0.0

    def place(self, k: int) -> Place:
        """Return point k of the branch, its memory states turned into outputs of the elements."""
        value = float(self.branch.parameter[k])
        X = self.system.exact_point(self.branch.states[k], self.path.vector(value))
        return Place(X=X, value=value)

    def special_place(self, point: SpecialPoint) -> Place:
        """Return where a special point is reported: its own states and parameter.

        Raises
        ------
        ConvergenceError
            If the branch does not tell its place.
        """
        if not 0 <= point.index < len(self.branch) or self.parameter not in point.parameters:
            msg = f"where on {self.branch.name} {point.name} lies is not reported; compute it again"
            raise ConvergenceError(msg)
        X = self.place(point.index).X
        for k, name in enumerate(self.system.states):
            X[k] = point.state.get(name, X[k])
        return Place(X=np.array(X), value=point.parameters[self.parameter])

    def check(
        self,
        name: str,
        strength: str,
        interval: tuple[float, float],
        finding: str,
        *,
        holds: bool = False,
        **more: Any,  # noqa: ANN401 - fields of Check
    ) -> Check:
        """Return a check of something on the branch."""
        return Check(
            branch=self.branch.name,
            subject=name,
            strength=strength,
            holds=holds,
            finding=finding,
            interval=interval,
            **more,
        )
