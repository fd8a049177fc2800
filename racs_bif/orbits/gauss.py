"""Collocation at Gauss points: coefficients of one interval, whatever the degree.

On an interval the orbit is a polynomial of degree m, given by its values at m + 1 equidistant nodes
as in AUTO (the last node is the first of the next interval), and the equations hold at the m zeros
of the Legendre polynomial (C. de Boor and B. Swartz, *Collocation at Gaussian points*, SIAM J.
Numer. Anal. 10, 1973): the error at the ends of the intervals falls with the power 2 m.

For the linear algebra the same polynomial is given by its start x and its values Y at the Gauss
points; the equations then are those of the Runge-Kutta method, A^-1 (Y - x) = tau f(Y).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import factorial
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from racs_bif.symbolic.field import Array


@dataclass(frozen=True, eq=False)
class Gauss:
    """Coefficients for degree m.

    Attributes
    ----------
    degree : int
        m.
    abscissae, weights : array (m,)
        Gauss points in [0, 1] and weights of the quadrature.
    values, slopes : array (m, m + 1)
        Values and derivatives at the Gauss points from the values at the nodes.
    powers : array (m + 1, m + 1)
        Coefficients of the monomials from the values at the nodes.
    inverse : array (m, m)
        Inverse of the Runge-Kutta matrix A.
    row_sums : array (m,)
        A^-1 (1, ..., 1).
    end_start : float
        Share of x in the value at the end of the interval, ...
    end : array (m,)
        ... and those of Y.
    inner_start : array (m - 1,)
        Shares of x in the values at the inner nodes, ...
    inner : array (m - 1, m)
        ... and those of Y.
    eigenvalues, left, right
        A^-1 = right diag(eigenvalues) left, complex.
    error : array (m + 2,)
        Coefficients of E(s), the integral of (s - c1) ... (s - cm) / m! from 0 to s: to leading
        order h^(m+1) x^(m+1) E is what the polynomial misses. E vanishes at both ends.
    """

    degree: int
    abscissae: Array
    weights: Array
    values: Array
    slopes: Array
    powers: Array
    inverse: Array
    row_sums: Array
    end_start: float
    end: Array
    inner_start: Array
    inner: Array
    eigenvalues: NDArray[np.complex128]
    left: NDArray[np.complex128]
    right: NDArray[np.complex128]
    error: Array


@cache
def gauss(degree: int) -> Gauss:
    """Return the coefficients for a degree, 2 to 7."""
    points, weights = np.polynomial.legendre.leggauss(degree)
    c = 0.5 * (points + 1.0)
    nodes = np.linspace(0.0, 1.0, degree + 1)
    powers = np.asarray(np.linalg.inv(np.vander(nodes, increasing=True)), dtype=float)
    exponents = np.arange(degree + 1)
    at_gauss = np.vander(c, degree + 1, increasing=True)
    steeper = np.zeros_like(at_gauss)
    steeper[:, 1:] = at_gauss[:, :-1] * exponents[1:]
    # values at any place from (x, Y): through the monomials
    from_stages = np.linalg.inv(np.vander(np.append(0.0, c), increasing=True))
    to_slopes = steeper @ from_stages
    inner = np.vander(nodes[1:-1], degree + 1, increasing=True) @ from_stages
    end = from_stages.sum(axis=0)
    inverse = to_slopes[:, 1:]
    eigenvalues, right = np.linalg.eig(inverse)
    polynomial = np.polynomial.polynomial.polyfromroots(c) / factorial(degree)
    return Gauss(
        degree=degree,
        abscissae=c,
        weights=0.5 * weights,
        values=at_gauss @ powers,
        slopes=steeper @ powers,
        powers=powers,
        inverse=inverse,
        row_sums=inverse.sum(axis=1),
        end_start=float(end[0]),
        end=end[1:],
        inner_start=inner[:, 0],
        inner=inner[:, 1:],
        eigenvalues=np.asarray(eigenvalues, dtype=complex),
        left=np.asarray(np.linalg.inv(right), dtype=complex),
        right=np.asarray(right, dtype=complex),
        error=np.asarray(np.polynomial.polynomial.polyint(polynomial), dtype=float),
    )
