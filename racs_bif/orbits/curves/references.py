"""What the points of a curve of cycles refer to: mesh, phase, normalisation, directions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from racs_bif.errors import UsageError
from racs_bif.orbits.history import reference_of
from racs_bif.orbits.piecewise import Piecewise

if TYPE_CHECKING:
    from racs_bif.orbits.reference import Reference
    from racs_bif.symbolic.field import Array

_KEPT: Final = 4


@dataclass(frozen=True, eq=False)
class CycleReference:
    """One accepted point of the curve.

    Attributes
    ----------
    curve : Piecewise
        Its orbit.
    scales : array (n,)
        Of the states.
    functions : array (k, N, m, n)
        Its eigenfunctions at the Gauss points, in units of the scales: the first of length 1, the
        others orthonormal to it.
    directions : array (2, N m n + 3)
        Two directions of orbit, period and parameters; the rows of their products with others
        complete the equations of the orbit.
    dual : array (k, n) or None
        Left null vector at the start of the period, which gives the pairing its sign.
    """

    curve: Piecewise
    scales: Array
    functions: Array
    directions: Array
    dual: Array | None = None


class CycleReferences:
    """The references of a curve by number, so that a solution can say which one it belongs to."""

    def __init__(self, first: CycleReference) -> None:
        self._entries = [first]
        self._phases: dict[int, Reference] = {}

    def add(self, reference: CycleReference) -> int:
        """Take in a reference and return its number."""
        self._entries.append(reference)
        return len(self._entries) - 1

    def __getitem__(self, number: float) -> CycleReference:
        """Return a reference by its number.

        Raises
        ------
        UsageError
            If there is none: the solution belongs to another curve.
        """
        return self._entries[self._place(number)]

    def phase(self, number: float) -> Reference:
        """Return the phase condition against the orbit of a reference."""
        place = self._place(number)
        if place not in self._phases:
            entry = self._entries[place]
            curve = Piecewise(entry.curve.mesh, entry.curve.nodes)
            self._phases[place] = reference_of(curve, entry.scales)
            if len(self._phases) > _KEPT:
                del self._phases[next(iter(self._phases))]
        return self._phases[place]

    def _place(self, number: float) -> int:
        place = round(number)
        if not 0 <= place < len(self._entries):
            msg = f"this cycle was found on mesh {place} of another curve; start from it anew"
            raise UsageError(msg)
        return place
