"""Linear filters in state space, and what turns a transfer law into one."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import UsageError

if TYPE_CHECKING:
    from racs_bif.fractional.laws import Complex, Law
    from racs_bif.symbolic.field import Array


@dataclass(frozen=True)
class Filter:
    """The filter z' = A z + B e, w = C z + D e, or its derivative by a parameter.

    Parameters
    ----------
    A : array (k, k)
        State matrix.
    B : array (k,)
        Input.
    C : array (k,)
        Output.
    D : float
        Direct feedthrough.
    """

    A: Array
    B: Array
    C: Array
    D: float

    def __call__(self, s: Complex) -> Complex:
        """Return the transfer function at s (m,)."""
        s = np.atleast_1d(np.asarray(s, dtype=complex))
        eye = np.eye(len(self.B))
        if not len(self.B):
            return np.full(s.shape, self.D, dtype=complex)
        solved = np.linalg.solve(s[:, None, None] * eye - self.A, self.B[None, :, None])
        return np.asarray((self.C @ solved)[:, 0] + self.D)


@dataclass(frozen=True, kw_only=True)
class RealisationInfo:
    """What every result says of the realisation behind it.

    Parameters
    ----------
    name : str
        Name of the method, ``none`` for a model without fractional elements.
    states : int
        Number of memory states that it adds.
    band : (float, float)
        Frequencies between which it is meant to hold [rad/s].
    error : float
        Largest error of any element's frequency response over the band, relative to the exact law.
    """

    name: str
    states: int
    band: tuple[float, float]
    error: float


@dataclass(frozen=True, kw_only=True)
class Realisation(ABC):
    """A way to replace a transfer law by a filter of integer order; the base of all of them.

    Parameters
    ----------
    band : (float, float)
        Frequencies [rad/s] between which it approximates.

    Raises
    ------
    UsageError
        If the band is empty or not positive.
    """

    band: tuple[float, float]

    def __post_init__(self) -> None:
        """Check the band."""
        low, high = self.band
        if not 0.0 < low < high < float("inf"):
            msg = f"band {low:g} .. {high:g} rad/s is not usable; give 0 < LOW < HIGH"
            raise UsageError(msg)

    @property
    @abstractmethod
    def name(self) -> str:
        """Name on the command line."""

    @abstractmethod
    def realise(self, law: Law) -> Filter:
        """Return the filter of a law."""

    @abstractmethod
    def derivative(self, law: Law, direction: Law) -> Filter:
        """Return the derivative of the filter along `direction`, exactly."""

    def error(self, law: Law) -> float:
        """Return the largest error of the realised law over the band, relative to Z."""
        low, high = self.band
        s = np.asarray(1j * np.geomspace(low, high, 400), dtype=complex)
        exact = law(s)
        return float(np.max(np.abs(self.realise(law)(s) / exact - 1.0)))
