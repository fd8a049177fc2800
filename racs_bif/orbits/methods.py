"""The discretisations of periodic orbits, by name: where a branch of each may begin."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Protocol

from racs_bif.orbits.balance_settings import BalanceSettings
from racs_bif.orbits.balance_start import balanced_from_hopf
from racs_bif.orbits.balance_switch import (
    balanced_doubled,
    balanced_from_samples,
    balanced_through,
)
from racs_bif.orbits.collocation import CollocationProblem
from racs_bif.orbits.collocation_settings import CollocationSettings
from racs_bif.orbits.collocation_start import (
    CollocationStart,
    collocated_from_hopf,
    collocated_from_samples,
    collocated_through,
    doubled,
)
from racs_bif.orbits.harmonic_balance import HarmonicBalanceProblem
from racs_bif.orbits.settings import OrbitSettings
from racs_bif.orbits.shooting import ShootingProblem
from racs_bif.orbits.shooting_switch import shooting_doubled, shooting_through
from racs_bif.orbits.start import from_hopf, from_samples
from racs_bif.orbits.switching import crossing

if TYPE_CHECKING:
    from racs_bif.orbits.problem import OrbitProblem
    from racs_bif.orbits.switching import Crossing
    from racs_bif.symbolic.field import Array

Settings = OrbitSettings | CollocationSettings | BalanceSettings
"""How orbits are resolved, as the method has it."""


class Begun(Protocol):
    """A branch ready to be followed: its problem, first point and, where decided, direction."""

    @property
    def problem(self) -> OrbitProblem:
        """The equations."""

    @property
    def z(self) -> Array:
        """The first point."""

    @property
    def tangent(self) -> Array | None:
        """The direction in which to set off, where the start decides it."""


@dataclass(frozen=True)
class Method:
    """A discretisation of periodic orbits.

    Attributes
    ----------
    settings, problem : type
        Classes of its settings and of its equations.
    from_hopf : callable
        (field, path, point, omega, q, *, form, settings): the branch born at a Hopf point.
    from_samples : callable
        (field, path, times, profile, value, *, settings): an orbit known by samples.
    through : callable
        (problem, z, path, value, settings, scales): an orbit of another branch by the same method.
    doubled : callable
        (problem, z, tangent): the branch of twice the period from a period doubling.
    """

    settings: type[Settings]
    problem: type[OrbitProblem]
    from_hopf: Callable[..., Begun]
    from_samples: Callable[..., Begun]
    through: Callable[..., Begun]
    doubled: Callable[..., Begun]


def _collocation_doubled(problem: CollocationProblem, z: Array, _tangent: Array) -> Begun:
    start: CollocationStart = doubled(problem, z)
    return start


METHODS: Final[dict[str, Method]] = {
    "shooting": Method(
        settings=OrbitSettings,
        problem=ShootingProblem,
        from_hopf=from_hopf,
        from_samples=from_samples,
        through=shooting_through,
        doubled=shooting_doubled,
    ),
    "collocation": Method(
        settings=CollocationSettings,
        problem=CollocationProblem,
        from_hopf=collocated_from_hopf,
        from_samples=collocated_from_samples,
        through=collocated_through,
        doubled=_collocation_doubled,
    ),
    "harmonic-balance": Method(
        settings=BalanceSettings,
        problem=HarmonicBalanceProblem,
        from_hopf=balanced_from_hopf,
        from_samples=balanced_from_samples,
        through=balanced_through,
        doubled=balanced_doubled,
    ),
}


def crossed(problem: OrbitProblem, z: Array, tangent: Array) -> Crossing:
    """Return the other branch through a branch point; see `crossing`.

    Raises
    ------
    UsageError
        If branches do not cross there.
    """
    through = METHODS[name_of(problem)].through

    def rescaled(scales: Array) -> tuple[OrbitProblem, Array]:
        start = through(problem, z, problem.path, float(z[-1]), None, scales)
        return start.problem, start.z

    return crossing(problem, z, tangent, rescaled)


def name_of(problem: Any) -> str:  # noqa: ANN401 - of any kind, that is the question
    """Return the name of the method that a problem is of; empty where it is no orbit's."""
    for name, method in METHODS.items():
        if type(problem) is method.problem:
            return name
    return ""
