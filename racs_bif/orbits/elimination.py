"""Linear unknowns of harmonic balance, given by the others harmonic by harmonic.

Of the exact model left X - right core(X) = 0 some rows are affine in X: a state whose rate is
another state, an element whose input is affine. Each of them gives one unknown by the others, and
the balance is left with the unknowns that the nonlinearities need.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from racs_bif.fractional.laws import Law
    from racs_bif.orbits.fourier import Complex
    from racs_bif.symbolic.field import Array

    Places = NDArray[np.intp]
    Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Elimination:
    """Which unknowns the affine rows give.

    Attributes
    ----------
    rows, given : int array (e,)
        Rows that are used up, and the unknowns that they give.
    left, kept : int array (n - e,)
        The other rows and the other unknowns.
    """

    rows: Places
    given: Places
    left: Places
    kept: Places

    def maps(self, diagonals: tuple[Complex, Complex], fixed: Array) -> Complex:
        """Return X as linear functions of the unknowns kept, (m, n, n - e).

        Parameters
        ----------
        diagonals : pair of array (m, n)
            Left and right sides at m frequencies.
        fixed : array (n, n)
            Jacobian of the core where it does not vary.
        """
        left, right = diagonals
        count, size = left.shape
        result = np.zeros((count, size, len(self.kept)), dtype=complex)
        result[:, self.kept, np.arange(len(self.kept))] = 1.0
        if len(self.rows):
            matrix = -right[:, self.rows, None] * fixed[self.rows]
            matrix[:, np.arange(len(self.rows)), self.rows] += left[:, self.rows]
            solved = np.linalg.solve(matrix[:, :, self.given], matrix[:, :, self.kept])
            result[:, self.given] = -solved
        return result

    def given_by(self, rhs: Complex, diagonals: tuple[Complex, Complex], fixed: Array) -> Complex:
        """Return X (m, n) that balances the affine rows against `rhs` (m, e), none kept."""
        left, right = diagonals
        result = np.zeros(left.shape, dtype=complex)
        if len(self.rows):
            matrix = -right[:, self.rows, None] * fixed[self.rows]
            matrix[:, np.arange(len(self.rows)), self.rows] += left[:, self.rows]
            result[:, self.given] = np.linalg.solve(matrix[:, :, self.given], rhs[..., None])[
                ..., 0
            ]
        return result


def choose(
    fixed: tuple[Places, Places], varying: tuple[Places, Places], laws: tuple[Law, ...], size: int
) -> Elimination:
    """Choose the unknowns that affine rows give, so that they can always be solved for in turn.

    Parameters
    ----------
    fixed, varying : pair of int array
        Rows and columns of the entries of the core's Jacobian that are not zero: those that do not
        depend on the state, and those that do.
    laws : tuple of Law
        Of the elements, the last unknowns.
    size : int
        Number n of unknowns.

    Returns
    -------
    Elimination
        A state y_i with y_i' = a y_j + b gives y_j; an element whose law does not integrate and
        whose input is affine in the states gives its output.
    """
    states = size - len(laws)
    affine = np.ones(size, dtype=bool)
    affine[varying[0]] = False
    felt = np.zeros((size, size), dtype=bool)
    felt[fixed] = True
    pairs = _rates(felt, affine, states)
    for k, law in enumerate(laws):
        row = states + k
        if affine[row] and not law.integrates and not np.any(felt[row, states:]):
            pairs.append((row, row))
    rows = np.array([row for row, _ in pairs], dtype=np.intp)
    given = np.array([unknown for _, unknown in pairs], dtype=np.intp)
    every = np.arange(size)
    return Elimination(rows, given, np.setdiff1d(every, rows), np.setdiff1d(every, given))


def _rates(felt: Mask, affine: Mask, states: int) -> list[tuple[int, int]]:
    """Return pairs of a state and the state that its rate gives; no chain of them is closed."""
    parent: dict[int, int] = {}
    for i in np.flatnonzero(affine[:states]):
        columns = np.flatnonzero(felt[i])
        if len(columns) != 1:
            continue
        j = int(columns[0])
        root = int(i)
        while root in parent:
            root = parent[root]
        if j < states and j not in parent and j != root:
            parent[j] = int(i)
    return [(i, j) for j, i in parent.items()]
