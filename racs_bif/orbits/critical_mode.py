"""Normal forms of cycles on the centre manifold: what their three kinds have in common.

G. Iooss, *Global characterization of the normal form for a vector field near a closed orbit*, J.
Differ. Equ. 76 (1988); Yu. A. Kuznetsov, W. Govaerts, E. J. Doedel and A. Dhooge, *Numerical
periodic normalization for codim 1 bifurcations of limit cycles*, SIAM J. Numer. Anal. 43 (2005).

Near the orbit x = u(tau) + xi v(tau) + ..., with tau and xi obeying the normal form. Every
coefficient is what makes a linear equation along the orbit solvable. The paper finds it by a
product with an adjoint function; here the equation is bordered by the critical function itself and
the coefficient is the border's unknown, which is the same number and needs no adjoint.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from racs_bif.errors import ConvergenceError

if TYPE_CHECKING:
    from racs_bif.orbits.variational import Function, Variational
    from racs_bif.symbolic.field import Array


@dataclass(frozen=True, eq=False)
class Mode:
    """The critical function of an orbit.

    Attributes
    ----------
    function : array (N, m, n)
        v at the Gauss points.
    starts : array (N, n)
        v at the mesh points.
    exponent : complex
        Real part: growth of v, zero at the bifurcation. Imaginary part: frequency [rad/s] that
        the closing does not account for, zero once `twist` is right.
    twist : complex
        The critical multiplier, of modulus 1: v(T) = twist v(0).
    """

    function: Function
    starts: Function
    exponent: complex
    twist: complex


@dataclass(frozen=True, eq=False)
class Coefficient:
    """A coefficient of a normal form.

    Attributes
    ----------
    value : complex
        The coefficient.
    size : float
        Sum of the magnitudes of the terms that it is the sum of: where it is much smaller, it is
        their difference.
    """

    value: complex
    size: float

    @classmethod
    def of(cls, terms: Function) -> Coefficient:
        """Add up terms (k,)."""
        if not np.isfinite(terms).all():
            raise ConvergenceError("a third derivative is not finite along the orbit")
        return cls(complex(np.sum(terms)), float(np.sum(np.abs(terms))))


class CriticalForm(ABC):
    """One kind of normal form.

    Attributes
    ----------
    name : str
        Name of the coefficient.
    """

    name: ClassVar[str]

    @abstractmethod
    def mode(self, along: Variational, near: Mode | None = None) -> Mode:
        """Return the critical function, of the length that the normal form asks for.

        Parameters
        ----------
        along : Variational
            The orbit.
        near : Mode, optional
            That of a neighbouring orbit on the same mesh.

        Raises
        ------
        ConvergenceError
            If there is none.
        """

    @abstractmethod
    def coefficient(self, along: Variational, mode: Mode) -> Coefficient:
        """Return the coefficient.

        Raises
        ------
        ConvergenceError
            If an equation on the way is singular or not finite.
        """


def unit(along: Variational, function: Function, own: int) -> tuple[Function, float]:
    """Return a function of length 1, and its length before: integral of |v|^2 over one period.

    Only the first `own` states count, so that the memory of a realisation does not.
    """
    part = function[..., :own]
    length = float(np.sqrt(np.sum(along.weights * np.abs(part) ** 2)))
    if not length > 0.0:
        raise ConvergenceError("the critical function vanishes in all of the model's own states")
    return function / length, length


def along_starts(along: Variational, starts: Array, stages: Array) -> Array:
    """Return the nodes (N, m, n) of a function from its mesh points and Gauss points."""
    g = along.gauss
    inner = starts[:, None] * g.inner_start[:, None] + g.inner @ stages
    return np.concatenate((starts[:, None], inner), axis=1)
