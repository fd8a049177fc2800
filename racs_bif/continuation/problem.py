"""What the engine asks of a problem and of the detectors of special points."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from racs_bif.continuation.points import Array, Point, SpecialPoint, Spectrum
from racs_bif.numerics.bordered import factorise

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from racs_bif.continuation.stopped import Stopped

Solver = Callable[[Array], Array]
"""Maps right-hand sides (n+1,) or (n+1, k) to solutions of the same shape."""

Bound = tuple[int, float, float]
"""Place in z, lowest and highest value."""

_FLOOR = 1e-8
_EMPTY: Spectrum = np.empty(0, dtype=complex)


class Problem(ABC):
    """n equations for n unknowns and a parameter, whose solutions form curves.

    The argument ``z`` has shape (n+1,), the parameter last. `residual` is always called before
    `jacobian` or `bordered` at the same ``z``, and `spectrum` at a ``z`` very near the last of
    those: a problem for which they share work may keep it.

    During a step ArithmeticError (with it FloatingPointError and ConvergenceError) and
    numpy.linalg.LinAlgError mean that there is no solution here and shorten the step; every other
    exception is passed on to the caller.

    Attributes
    ----------
    name : str
        What messages call the problem.
    parameter : str
        Name of the continuation parameter.
    chord : bool
        Whether Newton's method keeps a matrix while it contracts well: where `bordered` costs far
        more than `residual` and what it returns.
    """

    name: str
    parameter: str
    chord: bool = False

    @abstractmethod
    def residual(self, z: Array) -> Array:
        """Return the residual (n,)."""

    @abstractmethod
    def jacobian(self, z: Array) -> Array:
        """Return the derivatives (n, n+1) of the residual; sparse only where `bordered` is too."""

    def terms(self, z: Array) -> Array:
        """Return the sizes (n,) of the terms summed in the residual, to tell rounding from error.

        By default the absolute Jacobian times the absolute unknowns.
        """
        return np.asarray(abs(self.jacobian(z)) @ np.abs(z))  # np.abs knows no sparse arrays

    def bordered(self, z: Array, row: Array) -> Solver:
        """Return a solver of the matrix [jacobian; row], shape (n+1, n+1).

        Structured problems override it.

        Raises
        ------
        numpy.linalg.LinAlgError
            If the matrix is singular.
        """
        jacobian = self.jacobian(z)
        matrix = np.empty((len(row), len(row)), order="F")
        matrix[:-1] = jacobian
        matrix[-1] = row
        return factorise(matrix)

    def spectrum(self, z: Array) -> Spectrum:
        """Return the eigenvalues or multipliers (m,), by default none."""
        del z
        return _EMPTY

    def stable(self, spectrum: Spectrum) -> bool | None:
        """Return whether a solution of this spectrum is stable; None where that is unknown."""
        return self.unstable(spectrum) == 0 if len(spectrum) else None

    def unstable(self, spectrum: Spectrum) -> int:
        """Return how many eigenvalues are on the unstable side, by default those with Re > 0."""
        return int(np.count_nonzero(spectrum.real > 0.0))

    def sides(self, spectrum: Spectrum) -> NDArray[np.bool_]:
        """Return which eigenvalues (m,) are on the unstable side.

        The default asks `unstable` what is left without each of them; override it where that is
        slow or an eigenvalue is exempt, such as the trivial multiplier of an orbit.
        """
        count = self.unstable(spectrum)
        others = (self.unstable(np.delete(spectrum, i)) for i in range(len(spectrum)))
        return np.fromiter((other < count for other in others), dtype=bool, count=len(spectrum))

    def on_axis(self, spectrum: Spectrum, count: int) -> NDArray[np.bool_] | None:
        """Return which eigenvalues (m,) are the `count` on the axis at an event.

        By default None: that is not known, as of multipliers that are too rough beside others.
        """
        del spectrum, count
        return None

    def measures(self, z: Array) -> dict[str, float]:
        """Return what is plotted, by default nothing."""
        del z
        return {}

    def place(self, measure: str) -> int | None:
        """Return where in z, counted from its end, a measure is an unknown itself; None: nowhere.

        Where it is one, a wanted value of the measure is met exactly.
        """
        del measure
        return None

    def scales(self, z: Array) -> Array:
        """Return typical magnitudes (n,) of the unknowns without the parameter, all positive.

        By default their absolute values. The engine takes the largest that it has seen.
        """
        return np.maximum(np.abs(z[:-1]), _FLOOR)

    def bounds(self) -> tuple[Bound, ...]:
        """Return (place in z, lowest, highest) of unknowns at whose bounds a branch ends exactly.

        By default none: only the parameter's span counts.
        """
        return ()

    def adapt(self, z: Array, tangent: Array) -> tuple[Array, Array] | None:
        """Return the same solution and tangent on a better mesh, maybe of another dimension.

        Called after every accepted point; None leaves them unchanged.
        """
        del z, tangent
        return None

    def ends(self, point: Point) -> Stopped | None:
        """Return a reason of the problem's own to end the branch at `point`, or None."""
        del point
        return None


class Detector(ABC):
    """One kind of special point.

    Attributes
    ----------
    label : str
        Its letters.
    crossings : int
        How many eigenvalues change side at it: 1 at LP and BP, 2 at H; 0 where it explains none.
    """

    label: str
    crossings: int = 0

    # Each detector has its own kind of problem: hence Any.
    @abstractmethod
    def value(self, problem: Any, point: Point) -> float:  # noqa: ANN401
        """Return the test function; a change of its sign along the branch is an event.

        NaN where it is not defined: that is never an event.
        """

    @abstractmethod
    def data(self, problem: Any, point: Point) -> dict[str, Any] | None:  # noqa: ANN401
        """Return what is known about the special point; None if it is not of this kind."""

    def dismisses(self, before: Point, after: Point) -> bool:
        """Return whether a change of sign between two points is surely of another kind.

        It is then not located. By default it never is sure.
        """
        del before, after
        return False

    def explains(self, data: dict[str, Any]) -> int:
        """Return how many eigenvalues change side at the special point of this data."""
        del data
        return self.crossings

    def refine(self, problem: Any, special: SpecialPoint) -> Array | None:  # noqa: ANN401
        """Return the special point (n+1,) polished on its own defining system, or None."""
        del problem, special
        return None
