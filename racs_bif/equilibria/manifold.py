"""Centre manifolds and normal forms by power series, to any degree, for any number of modes.

On the centre manifold ``x = x0 + sum_a H_a w**a`` the amplitudes obey ``w_i' = lambda_i w_i +
sum_a g_ia w**a``. Degree by degree (Yu. A. Kuznetsov, *SIAM J. Numer. Anal.* 36 (1999)
1104-1124)::

    (<a, lambda> - A) H_a = F_a - sum_i g_ia q_i - (terms of lower degree)

where F_a is the coefficient of w**a in f. A monomial is kept in the equation of mode i, the only
way to solve this, where it turns at the same frequency as w_i. Coefficients are those of the
powers: no factorials. Complex amplitudes come with their conjugates as modes of their own.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.symbolic.jets import Algebra, Monomial, total_degree

if TYPE_CHECKING:
    from racs_bif.equilibria.hopf_form import Complex
    from racs_bif.fractional.realised import RealisedField
    from racs_bif.symbolic.field import Array


@dataclass(frozen=True)
class Mode:
    """A critical direction.

    Parameters
    ----------
    turns : tuple of int
        Its frequency in units of the basic ones: () or zeros for a zero eigenvalue, (1,) and (-1,)
        for a pair, (0, 1) and (0, -1) for a second pair.
    q, p : array (n,)
        Right and left eigenvectors, conj(p) . q = 1.
    """

    turns: tuple[int, ...]
    q: Complex
    p: Complex


@dataclass(frozen=True)
class NormalForm:
    """Coefficients on a centre manifold.

    Parameters
    ----------
    g : dict of tuple of int to array (modes,)
        Coefficients of resonant monomials in each mode's equation.
    H : dict of tuple of int to array (n,)
        Coefficients of the manifold.
    """

    g: dict[Monomial, Complex]
    H: dict[Monomial, Complex]


def normal_form(
    field: RealisedField,
    point: tuple[Array, Array, Array],
    frequencies: tuple[float, ...],
    modes: tuple[Mode, ...],
    degree: int,
) -> NormalForm:
    """Compute the normal form on the centre manifold of an equilibrium.

    Parameters
    ----------
    field : RealisedField
        The vector field.
    point : tuple of array
        The equilibrium (n,), the base parameters (np,) and f_x (n, n) there.
    frequencies : tuple of float
        The basic frequencies [rad/s].
    modes : tuple of Mode
        The critical directions, conjugates too.
    degree : int
        Up to which degree.

    Raises
    ------
    numpy.linalg.LinAlgError
        If frequencies are in a resonance of low order, so that there are further terms.
    """
    x, p, A = point
    algebra = total_degree(len(modes), degree)
    manifold = np.zeros((len(x), len(algebra)), dtype=complex)
    manifold[:, 0] = x
    for i, mode in enumerate(modes):
        manifold[:, algebra.index[_unit(len(modes), i)]] = mode.q
    g: dict[Monomial, Complex] = {}
    for total in range(2, degree + 1):
        F = field.series(manifold, p, algebra)
        for place, monomial in enumerate(algebra.monomials):
            if sum(monomial) != total:
                continue
            right = F[:, place] - _lower(g, manifold, algebra, monomial)
            turns = tuple(
                sum(a * mode.turns[j] for a, mode in zip(monomial, modes, strict=True))
                for j in range(len(frequencies))
            )
            resonant = [i for i, mode in enumerate(modes) if mode.turns == turns]
            rate = 1j * float(np.dot(turns, frequencies))
            H, found = _solve(A, rate, right, [modes[i] for i in resonant])
            manifold[:, place] = H
            if resonant:
                g[monomial] = np.zeros(len(modes), dtype=complex)
                g[monomial][resonant] = found
    return NormalForm(g, {m: manifold[:, k] for k, m in enumerate(algebra.monomials)})


def _unit(count: int, i: int) -> Monomial:
    return tuple(int(j == i) for j in range(count))


def _lower(
    g: dict[Monomial, Complex], manifold: Complex, algebra: Algebra, wanted: Monomial
) -> Complex:
    """Return the coefficient of a monomial in the manifold's motion by lower resonant terms."""
    total = np.zeros(len(manifold), dtype=complex)
    for term, coefficients in g.items():
        for i, coefficient in enumerate(coefficients):
            factor = [a - b for a, b in zip(wanted, term, strict=True)]
            factor[i] += 1
            if coefficient == 0.0 or min(factor) < 0 or sum(factor) < 2 or factor[i] == 0:
                continue
            total += coefficient * factor[i] * manifold[:, algebra.index[tuple(factor)]]
    return total


def _solve(
    A: Array, rate: complex, right: Complex, resonant: list[Mode]
) -> tuple[Complex, Complex]:
    """Return H and the coefficients of resonant modes, H without components along them."""
    n, k = len(right), len(resonant)
    matrix = np.zeros((n + k, n + k), dtype=complex)
    matrix[:n, :n] = rate * np.eye(n) - A
    for j, mode in enumerate(resonant):
        matrix[:n, n + j] = mode.q
        matrix[n + j, :n] = mode.p.conj()
    solution = np.linalg.solve(matrix, np.concatenate([right, np.zeros(k)]))
    return solution[:n], solution[n:]
