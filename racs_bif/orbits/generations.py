"""The meshes and phase conditions that a branch has used, one for every point accepted."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.errors import UsageError
from racs_bif.orbits.reference import Reference

if TYPE_CHECKING:
    from racs_bif.orbits.flow import Integrator
    from racs_bif.orbits.mesh import Mesh
    from racs_bif.symbolic.field import Array

_KEPT: Final = 6
"""References kept whole; older ones are computed again when they are asked for."""


@dataclass(frozen=True, eq=False)
class _Seed:
    """What a reference can be computed from again."""

    mesh: Mesh
    scales: Array
    starts: Array
    period: float
    active: float


class Generations:
    """Keeps references by number, so that a solution can say which one it belongs to.

    Events are located, and profiles drawn, long after the mesh has moved on; what was accepted once
    must stay what it was.

    Parameters
    ----------
    integrator : Integrator
        Computes old references again.
    first : Reference
        The reference that the branch starts with, number 0; it is kept.
    """

    def __init__(self, integrator: Integrator, first: Reference) -> None:
        self._integrator = integrator
        self._seeds: list[_Seed | None] = [None]
        self._whole: dict[int, Reference] = {0: first}

    def add(self, reference: Reference, starts: Array, period: float, active: float) -> int:
        """Take in the reference that an orbit makes and return its number."""
        number = len(self._seeds)
        seed = _Seed(reference.mesh, reference.scales, np.array(starts), period, active)
        self._seeds.append(seed)
        self._keep(number, reference)
        return number

    def __getitem__(self, number: float) -> Reference:
        """Return a reference by its number.

        Raises
        ------
        UsageError
            If there is none of this number: the solution belongs to another problem.
        """
        place = round(number)
        known = self._whole.get(place)
        if known is not None:
            return known
        if not 0 < place < len(self._seeds):
            raise UsageError(
                f"this orbit was found on mesh {place} of another branch; "
                "continue from its profile instead"
            )
        seed = self._seeds[place]
        assert seed is not None
        flow = self._integrator.flow(seed.mesh, seed.starts, seed.period, seed.active)
        reference = Reference(seed.mesh, flow.stages, seed.period * flow.slopes, seed.scales)
        self._keep(place, reference)
        return reference

    def _keep(self, number: int, reference: Reference) -> None:
        self._whole[number] = reference
        if len(self._whole) > _KEPT:
            del self._whole[next(place for place in self._whole if place > 0)]
