"""What every solver asks of a dynamical system: a vector field and its exact derivatives."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from racs_bif.symbolic.structure import Structure

Array = NDArray[np.float64]
"""Real array."""
Vectors = NDArray[np.inexact[Any]]
"""Directions, which may be complex where they are eigenvectors."""


class VectorField(ABC):
    """An autonomous ordinary differential equation x' = f(x, p) with exact derivatives.

    ``x`` has shape (n,), or (n, N) for N points at once; ``p`` is the full vector (np,) of base
    parameters in the order of `parameters`. Directions ``u, v, w`` have shape (n,) or (n, k) and
    may be complex; ``dp`` is a direction (np,) in parameter space.

    Attributes
    ----------
    states : tuple of str
        The n names of the states.
    parameters : tuple of str
        The names of the base parameters.
    """

    states: tuple[str, ...]
    parameters: tuple[str, ...]

    @abstractmethod
    def f(self, x: Array, p: Array) -> Array:
        """Return the right-hand side, shaped like `x`."""

    @abstractmethod
    def f_x(self, x: Array, p: Array) -> Array:
        """Return the Jacobian, (n, n) for one point or (N, n, n) for N points."""

    @abstractmethod
    def f_p(self, x: Array, p: Array, dp: Array) -> Array:
        """Return the derivative of f in the parameter direction `dp`, shaped like `x`."""

    @abstractmethod
    def f_xx(self, x: Array, p: Array, u: Vectors, v: Vectors) -> Vectors:
        """Return the bilinear form B(u, v) at one point, shaped like the directions."""

    def f_xx_matrices(self, x: Array, p: Array, v: Vectors) -> Vectors:
        """Return the derivatives of f_x v by x for directions v (n, k), as (k, n, n)."""
        n, count = v.shape
        directions = np.tile(np.eye(n), (1, count))
        forms = self.f_xx(x, p, np.repeat(v, n, axis=1), directions)
        return np.asarray(forms.reshape(n, count, n).transpose(1, 0, 2))

    def f_x_sparse(self, x: Array, p: Array) -> Any:  # noqa: ANN401 - scipy has no types
        """Return the Jacobian (n, n) at one point as a scipy.sparse.csc_array, None where unknown.

        Solvers of large systems use it where it makes them faster; they need nothing but `f_x`.
        """
        del x, p

    def structure(self, p: Array) -> Structure | None:
        """Return which entries of the Jacobian vary with the state; None where that is not known.

        Solvers use it where it makes them faster; they need nothing but `f_x`.
        """
        del p
        return None

    stateless: bool = False
    """Whether the model has no states of its own: outputs of its elements stand for them."""

    def own_outputs(self, x: Array, p: Array) -> dict[str, Array]:
        """Return what stands for states at N points x (n, N), each (N,), by name; by default none.

        Called of a field that is `stateless` only.
        """
        del x, p
        return {}

    def telling(self, x: Array, p: Array, v: Vectors, own: int) -> Vectors:
        """Return the part of a direction (n,) at one point whose length counts: `own` states."""
        del x, p
        return v[:own]

    @abstractmethod
    def f_xxx(self, x: Array, p: Array, u: Vectors, v: Vectors, w: Vectors) -> Vectors:
        """Return the trilinear form C(u, v, w) at one point, shaped like the directions."""

    @abstractmethod
    def f_xp(self, x: Array, p: Array, v: Vectors, dp: Array) -> Vectors:
        """Return the derivative of f_x v in the parameter direction `dp` at one point."""

    def f_xx_along(self, x: Array, p: Array, u: Vectors, v: Vectors) -> Vectors:
        """Return B(u, v) at N points x (n, N), one pair of directions (n, N) for each, (n, N)."""
        columns = zip(x.T, u.T, v.T, strict=True)
        return np.stack([self.f_xx(a, p, b, c) for a, b, c in columns], axis=1)

    def f_xxx_along(self, x: Array, p: Array, u: Vectors, v: Vectors, w: Vectors) -> Vectors:
        """Return C(u, v, w) at N points x (n, N), three directions (n, N) for each, (n, N)."""
        columns = zip(x.T, u.T, v.T, w.T, strict=True)
        return np.stack([self.f_xxx(a, p, b, c, d) for a, b, c, d in columns], axis=1)

    def f_xp_along(self, x: Array, p: Array, v: Vectors, dp: Array) -> Vectors:
        """Return `f_xp` at N points x (n, N), one direction v (n, N) for each, as (n, N)."""
        columns = zip(x.T, v.T, strict=True)
        return np.stack([self.f_xp(a, p, b, dp) for a, b in columns], axis=1)
