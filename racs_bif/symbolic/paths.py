"""Active parameters: the line or plane in parameter space along which a branch is followed."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from racs_bif.symbolic.field import Array


class ParameterPath(ABC):
    """A map from the active parameters to the full vector of base parameters.

    Attributes
    ----------
    names : tuple of str
        Names of the active parameters, one or two of them.
    """

    names: tuple[str, ...]

    @abstractmethod
    def vector(self, active: ArrayLike) -> Array:
        """Return the base parameters (np,) at the active values, a number or (k,)."""

    @abstractmethod
    def direction(self, active: ArrayLike, index: int = 0) -> Array:
        """Return the derivative (np,) of `vector` with respect to one active parameter."""

    def bend(self, active: ArrayLike, first: int, second: int) -> Array:
        """Return the second derivative (np,) of `vector` by two active parameters.

        By default zero: paths along base parameters are straight.
        """
        del first, second
        return np.zeros(len(self.vector(active)))


@dataclass(frozen=True)
class BasePath(ParameterPath):
    """A path along base parameters, all others held.

    Parameters
    ----------
    names : tuple of str
        Active parameters.
    indices : tuple of int
        Their places in the vector of base parameters.
    values : array (np,)
        The base parameters where they do not move.
    """

    names: tuple[str, ...]
    indices: tuple[int, ...]
    values: Array

    def vector(self, active: ArrayLike) -> Array:
        """Return the base parameters with the active ones put in."""
        p = np.array(self.values, dtype=float)
        p[list(self.indices)] = np.atleast_1d(np.asarray(active, dtype=float))
        return p

    def direction(self, active: ArrayLike, index: int = 0) -> Array:
        """Return the unit vector of one active parameter."""
        del active
        dp = np.zeros(len(self.values))
        dp[self.indices[index]] = 1.0
        return dp
