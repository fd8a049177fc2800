"""Curves of special equilibria in two parameters: what they have in common.

Each is a minimally augmented system (W. Govaerts, *Numerical Methods for Bifurcations of Dynamical
Equilibria*, SIAM 2000, chapters 3 and 4; Yu. A. Kuznetsov, *Elements of Applied Bifurcation
Theory*, chapter 10): f = 0 with one or two scalars that vanish where a matrix is singular enough.
The scalars come from bordered solves, and so do their derivatives, exactly.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from racs_bif.continuation.points import Array, Spectrum
from racs_bif.continuation.problem import Bound, Problem
from racs_bif.errors import ValidityError
from racs_bif.fractional.bank import other_size
from racs_bif.fractional.realised import RealisedField

if TYPE_CHECKING:
    from racs_bif.symbolic.field import VectorField
    from racs_bif.symbolic.paths import ParameterPath

Span = tuple[float, float]
Matrix = NDArray[Any]
"""Real on realisations, complex on the exact model."""
Measures = Callable[[Array, Array], dict[str, float]]

_FLOOR = 1e-8
_OBLIQUE = 30.0


class CurveProblem(Problem):
    """Special equilibria in two parameters; ``z = (x, further unknowns, lambda_1, lambda_2)``.

    Parameters
    ----------
    field : VectorField
        The vector field.
    path : ParameterPath
        The two active parameters.
    span : (float, float)
        Interval of the first of them; the engine is given that of the second.
    own : int
        Number of leading states that are the model's own: those count in the length of vectors.
    measures : callable, optional
        Further quantities of a point.

    Attributes
    ----------
    kind : str
        "hopf", "fold" or "bp".
    critical : int
        How many eigenvalues are on the imaginary axis all along; they lead the spectrum.
    typical : float
        Largest value so far of the coefficient that vanishes at a cusp or a generalised Hopf point.
    """

    kind: str
    critical: int

    def __init__(
        self,
        field: VectorField,
        path: ParameterPath,
        span: Span,
        own: int,
        measures: Measures | None = None,
    ) -> None:
        self.field, self.path, self.own = field, path, own
        self.n = len(field.states)
        self.parameter = path.names[1]
        self._span = span
        self._measures = measures
        self.typical = 0.0
        self._size = 0
        self._vector: tuple[bytes, Array] = (b"", np.empty(0))

    def base(self, z: Array) -> tuple[Array, Array]:
        """Return the states (n,) and the base parameters (np,)."""
        key = z[-2:].tobytes()
        if key != self._vector[0]:
            self._vector = key, self.path.vector(z[-2:])
        return z[: self.n], self._vector[1]

    def realised(self, z: Array) -> tuple[RealisedField, Array, Array]:
        """Return the realised field, its states (n,) and the base parameters at a point."""
        assert isinstance(self.field, RealisedField)  # the others override this
        return (self.field, *self.base(z))

    def directions(self, z: Array) -> tuple[Array, Array]:
        """Return the directions (np,) of the two active parameters."""
        return self.path.direction(z[-2:], 0), self.path.direction(z[-2:], 1)

    def resting(self, field: RealisedField, X: Array, p: Array) -> Array:
        """Return the realised states (n,) at rest beside an exact point X.

        Raises
        ------
        ValidityError
            If they are not as many as at the first point.
        """
        x = field.rest(X[: self.own], X[self.own :], p)
        self._size = self._size or len(x)
        if len(x) != self._size:
            raise ValidityError(other_size(len(x), self._size))
        return x

    def bounds(self) -> tuple[Bound, ...]:
        """Return the span of the first parameter."""
        return ((-2, *self._span),)

    def scales(self, z: Array) -> Array:
        """Return magnitudes of the unknowns; the first parameter counts by its span."""
        scales = np.maximum(np.abs(z[:-1]), _FLOOR)
        scales[-1] = self._span[1] - self._span[0]
        return scales

    def sides(self, spectrum: Spectrum) -> np.ndarray:
        """Return which eigenvalues are right of the imaginary axis, the critical ones aside."""
        sides = np.asarray(spectrum.real > 0.0)
        sides[: self.critical] = False
        return sides

    def unstable(self, spectrum: Spectrum) -> int:
        """Return how many eigenvalues are right of the imaginary axis, the critical ones aside."""
        return int(np.count_nonzero(self.sides(spectrum)))

    def noncritical(self, spectrum: Spectrum) -> Spectrum:
        """Return the eigenvalues that are not on the imaginary axis all along."""
        return spectrum[self.critical :]

    def measures(self, z: Array) -> dict[str, float]:
        """Return further quantities of the point."""
        return {} if self._measures is None else self._measures(*self.base(z))

    @abstractmethod
    def frequency(self, z: Array) -> float:
        """Return the frequency of the critical pair; NaN where there is none."""


@dataclass(frozen=True)
class _Reference:
    z: Array
    left: Matrix
    right: Matrix


class Borders:
    """Rows and columns that make singular matrices regular along a curve.

    They follow the null vectors, so that a border is never far from what it has to cut. The first
    ones are kept as well: a second walk begins where the first one did.
    """

    def __init__(self) -> None:
        self._kept: list[_Reference] = []

    def at(self, z: Array, make: Callable[[], tuple[Matrix, Matrix]]) -> tuple[Matrix, Matrix]:
        """Return left and right borders (rows, k), made by `make` where there are none."""
        if not self._kept:
            self._kept.append(_Reference(z.copy(), *make()))
        sizes = np.maximum(np.abs(z), _FLOOR)
        nearest = min(self._kept, key=lambda kept: float(np.sum(((kept.z - z) / sizes) ** 2)))
        return nearest.left, nearest.right

    def follow(self, z: Array, left: Matrix, right: Matrix) -> None:
        """Take the null vectors at an accepted point as the next borders."""
        reference = _Reference(z.copy(), _orthonormal(left), _orthonormal(right))
        self._kept = [*self._kept[:1], reference]

    def restart(self, z: Array, left: Matrix, right: Matrix) -> None:
        """Take other borders at z, where the old ones have become useless."""
        self._kept.append(_Reference(z.copy(), left, right))


def oblique(*vectors: Matrix) -> bool:
    """Whether null vectors of unit projection on their borders are far from them."""
    return any(not float(np.abs(v).max()) < _OBLIQUE for v in vectors)


def _orthonormal(columns: Matrix) -> Matrix:
    """Return an orthonormal basis (rows, k) that turns continuously with the columns."""
    if columns.shape[1] == 1:
        return np.asarray(columns / np.linalg.norm(columns))
    left, _, right = np.linalg.svd(columns, full_matrices=False)
    return np.asarray(left @ right)


def critical_first(values: Spectrum, wanted: tuple[complex, ...]) -> Spectrum:
    """Return eigenvalues, those nearest to the wanted ones first and the others rightmost first."""
    rest = list(values[np.lexsort((values.imag, -values.real))])
    first = []
    for value in wanted:
        k = int(np.argmin(np.abs(np.array(rest) - value)))
        first.append(rest.pop(k))
    return np.array(first + rest)
