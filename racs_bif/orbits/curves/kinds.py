"""What is special about the cycles of a curve: the equations of their eigenfunctions."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from racs_bif.orbits.twisted import Border

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from racs_bif.symbolic.field import Array


class CycleKind(ABC):
    """One kind of special cycle.

    Attributes
    ----------
    label : str
        Of the special points: "LPC".
    name : str
        Of the curve's kind: "lpc".
    coefficient : str
        The measure that holds the normal form's (real part); empty where there is none.
    copies : int
        Number k of real eigenfunctions.
    further : int
        Number of unknowns beside them, 0 or 1.
    """

    label: ClassVar[str]
    name: ClassVar[str]
    coefficient: ClassVar[str] = ""
    copies: ClassVar[int]
    further: ClassVar[int]

    @abstractmethod
    def twist(self, further: Array) -> Array:
        """Return the matrix C (k, k) by which the eigenfunctions meet their starts."""

    @abstractmethod
    def critical(self, further: Array) -> NDArray[np.complex128]:
        """Return the multipliers that the curve keeps on the unit circle."""

    def forced(self, further: Array) -> float:
        """Return the factor of f in the equations of the eigenfunction."""
        del further
        return 0.0

    def magnitude(self, period: float) -> float:
        """Return the typical magnitude of the further unknown."""
        del period
        return 1.0

    def settled(self, functions: Array, stages: Array, flow: tuple[Array, Array]) -> Array:
        """Return eigenfunctions (k, N, m, n) that obey the kind's own phase condition.

        Parameters
        ----------
        functions, stages : array (k, N, m, n)
            Values at the nodes and at the Gauss points.
        flow : pair of array (N, m, n)
            The orbit's velocity at the nodes, and weights at the Gauss points that give it 1.
        """
        del stages, flow
        return functions

    def rescaled(self, further: Array, factor: float) -> Array:
        """Return u when the eigenfunctions are multiplied by a factor."""
        del factor
        return further

    @abstractmethod
    def border(self, forcing: Array, starts: Array, phase: Array, norms: Array) -> Border:
        """Return the further unknowns' columns and the rows.

        Parameters
        ----------
        forcing : array (N, m, n)
            What a change of the period adds at the Gauss points.
        starts : array (k, n)
            Starts of the eigenfunctions.
        phase : array (N, m, n)
            Weights of the phase condition.
        norms : array (k, N, m, n)
            Weights of the normalisation against all reference functions, the first one first.
        """


class FoldKind(CycleKind):
    """LPC: V' = T f_x V + beta f, V(1) = V(0): a second multiplier 1 along the period's change."""

    label, name, copies, further = "LPC", "lpc", 1, 1

    def twist(self, further: Array) -> Array:
        """Return 1."""
        del further
        return np.eye(1)

    def critical(self, further: Array) -> NDArray[np.complex128]:
        """Return 1."""
        del further
        return np.ones(1, dtype=complex)

    def forced(self, further: Array) -> float:
        """Return beta."""
        return float(further[0])

    def magnitude(self, period: float) -> float:
        """Return the period: beta is a change of it."""
        return period

    def settled(self, functions: Array, stages: Array, flow: tuple[Array, Array]) -> Array:
        """Return the eigenfunction across the flow."""
        velocity, weights = flow
        return functions - float(np.sum(weights * stages[0])) * velocity

    def rescaled(self, further: Array, factor: float) -> Array:
        """Return beta, which belongs to the eigenfunction."""
        return further * factor

    def border(self, forcing: Array, starts: Array, phase: Array, norms: Array) -> Border:
        """Return the column of beta; V is orthogonal to the flow and of length 1."""
        return Border(
            columns=forcing[None, None],
            closing=np.zeros((1, *starts.shape)),
            rows=np.stack((phase, norms[0]))[:, None],
        )


class DoublingKind(CycleKind):
    """PD: V' = T f_x V, V(1) = -V(0)."""

    label, name, copies, further = "PD", "pd", 1, 0
    coefficient = "c"

    def twist(self, further: Array) -> Array:
        """Return -1."""
        del further
        return -np.eye(1)

    def critical(self, further: Array) -> NDArray[np.complex128]:
        """Return -1."""
        del further
        return -np.ones(1, dtype=complex)

    def border(self, forcing: Array, starts: Array, phase: Array, norms: Array) -> Border:
        """Return the normalisation alone."""
        return Border(
            columns=np.zeros((0, 1, *forcing.shape)),
            closing=np.zeros((0, *starts.shape)),
            rows=norms[:1][:, None],
        )


class TorusKind(CycleKind):
    """NS: V1(1) = V2(0), V2(1) = -V1(0) + 2 kappa V2(0): multipliers of product 1 and sum 2 kappa.

    Where kappa is beyond -1 or 1 the cycle is a neutral saddle; the equations stay regular there.
    """

    label, name, copies, further = "NS", "ns", 2, 1
    coefficient = "Re d"

    def twist(self, further: Array) -> Array:
        """Return the companion matrix of mu^2 - 2 kappa mu + 1."""
        return np.array([[0.0, 1.0], [-1.0, 2.0 * float(further[0])]])

    def critical(self, further: Array) -> NDArray[np.complex128]:
        """Return the two multipliers."""
        kappa = complex(further[0])
        root = np.sqrt(kappa**2 - 1.0)
        return np.array([kappa + root, kappa - root])

    def border(self, forcing: Array, starts: Array, phase: Array, norms: Array) -> Border:
        """Return the column of kappa; V1 is as long as its reference and orthogonal to V2's."""
        closing = np.zeros((1, *starts.shape))
        closing[0, 1] = 2.0 * starts[1]
        rows = np.zeros((2, 2, *norms.shape[1:]))
        rows[0, 0], rows[1, 0] = norms[1], norms[0]
        return Border(np.zeros((1, 2, *forcing.shape)), closing, rows)


KINDS: dict[str, CycleKind] = {
    kind.label: kind for kind in (FoldKind(), DoublingKind(), TorusKind())
}
"""By label."""
