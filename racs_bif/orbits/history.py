"""The meshes and phase conditions that a branch by collocation has used, one for every point."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from racs_bif.errors import UsageError
from racs_bif.orbits.piecewise import Piecewise
from racs_bif.orbits.reference import Reference

if TYPE_CHECKING:
    from racs_bif.symbolic.field import Array

_KEPT: Final = 6
"""References kept whole; older ones are made again from their orbits when they are asked for."""


def reference_of(curve: Piecewise, scales: Array) -> Reference:
    """Return the phase condition against an orbit, on its own mesh."""
    return Reference(
        mesh=curve.mesh,
        stages=curve.stages(),
        velocities=curve.velocities(),
        scales=scales,
        quadrature=curve.gauss.weights,
    )


@dataclass(frozen=True, eq=False)
class _Entry:
    curve: Piecewise
    scales: Array


class History:
    """Keeps the orbits of a branch by number, so that a solution can say which one it refers to.

    Parameters
    ----------
    first : Reference
        The reference that the branch starts with, number 0.
    curve : Piecewise
        Its orbit.
    """

    def __init__(self, first: Reference, curve: Piecewise) -> None:
        self._entries = [_Entry(curve, first.scales)]
        self._whole: dict[int, Reference] = {0: first}

    def add(self, curve: Piecewise, scales: Array) -> int:
        """Take in an orbit and return its number."""
        number = len(self._entries)
        # only mesh and nodes: what else a curve computes is computed again when asked for
        self._entries.append(_Entry(Piecewise(curve.mesh, curve.nodes), scales))
        self._keep(number, reference_of(curve, scales))
        return number

    def curve(self, number: float) -> Piecewise:
        """Return an orbit by its number."""
        return self._entries[self._place(number)].curve

    def __getitem__(self, number: float) -> Reference:
        """Return the phase condition against an orbit by its number.

        Raises
        ------
        UsageError
            If there is none of this number: the solution belongs to another problem.
        """
        place = self._place(number)
        known = self._whole.get(place)
        if known is None:
            entry = self._entries[place]
            curve = Piecewise(entry.curve.mesh, entry.curve.nodes)
            known = reference_of(curve, entry.scales)
            self._keep(place, known)
        return known

    def _place(self, number: float) -> int:
        place = round(number)
        if not 0 <= place < len(self._entries):
            raise UsageError(
                f"this orbit was found on mesh {place} of another branch; "
                "continue from its profile instead"
            )
        return place

    def _keep(self, number: int, reference: Reference) -> None:
        self._whole[number] = reference
        if len(self._whole) > _KEPT:
            del self._whole[next(place for place in self._whole if place > 0)]
