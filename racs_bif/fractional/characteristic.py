"""The characteristic matrix ``Delta(s) = diag(left) - diag(right) core`` over the logarithm of s.

Every entry is a sum of real powers of s. With ``s = exp(t)`` a power ``s**a`` is ``exp(a t)``: an
entire function of t. The principal sheet is the strip ``|Im t| < pi`` and the branch cut is gone,
so that contours may cross it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import ParameterError
from racs_bif.fractional.laws import Complex, PowerSum
from racs_bif.fractional.power_sums import merged

if TYPE_CHECKING:
    from collections.abc import Sequence

    from racs_bif.fractional.exact import ExactModel
    from racs_bif.symbolic.field import Array

_FEW = 4096  # matrices handled at once


class Characteristic:
    """A characteristic matrix in numbers.

    Parameters
    ----------
    left, right : sequences of PowerSum, one for each row
        The diagonals; no exponent is negative and no left one is zero throughout.
    core : array (n, n)
        The constant matrix.

    Attributes
    ----------
    left_powers, right_powers : (array (n, k), array (n, k))
        The diagonals' coefficients and exponents, a row each, filled up with zeros.

    Raises
    ------
    ParameterError
        If shapes do not fit, numbers are not finite, or an exponent is negative.
    """

    def __init__(self, left: Sequence[PowerSum], right: Sequence[PowerSum], core: Array) -> None:
        core = np.atleast_2d(np.asarray(core, dtype=float))
        self.size = len(core)
        if not self.size == core.shape[1] == len(left) == len(right):
            msg = (
                f"{len(left)} and {len(right)} rows of powers do not fit a matrix {core.shape}; "
                "give a square one and a row on either side for each of its rows"
            )
            raise ParameterError(msg)
        self.left = tuple(merged(row) for row in left)
        self.right = tuple(merged(row) for row in right)
        numbers = [
            core.ravel(),
            *(x for r in (*left, *right) for x in (r.coefficients, r.exponents)),
        ]
        if not all(np.all(np.isfinite(x)) for x in numbers):
            msg = "the characteristic matrix is not finite at this point; check the parameters"
            raise ParameterError(msg)
        self.core = _balanced(core)
        if any(len(r.coefficients) == 0 for r in self.left):
            msg = "a law's denominator vanishes at these parameters; check its coefficients"
            raise ParameterError(msg)
        if any(np.any(r.exponents < 0.0) for r in (*self.left, *self.right)):
            msg = "an exponent is negative; multiply the row by a power of s"
            raise ParameterError(msg)
        self.left_powers, self.right_powers = _packed(self.left), _packed(self.right)

    @classmethod
    def of_model(cls, model: ExactModel, X: Array, p: Array) -> Characteristic:
        """Return the characteristic matrix of a model at an equilibrium.

        Parameters
        ----------
        model : ExactModel
            The model.
        X : array (size,)
            States and outputs of its elements.
        p : array (np,)
            Base parameters.
        """
        s, one = PowerSum(np.ones(1), np.ones(1)), PowerSum(np.ones(1), np.zeros(1))
        laws = model.laws(p)
        core = model.compiled.core_jacobian(X, model.compiled.padded(p))
        left = [*[s] * model.ny, *(law.denominator for law in laws)]
        right = [*[one] * model.ny, *(law.numerator for law in laws)]
        return cls(left, right, core)

    @property
    def integer(self) -> bool:
        """Whether every exponent is a whole number: there is no branch cut."""
        rows = (*self.left, *self.right)
        return all(bool(np.all(r.exponents == np.round(r.exponents))) for r in rows)

    def matrix(self, t: Complex, shift: Array | None = None) -> Complex:
        """Return Delta(exp(t)), (m, n, n) for t (m,), its rows divided by exp(shift)."""
        return self._assemble(t, self.left_powers[0], self.right_powers[0], shift)

    def slope(self, t: Complex, shift: Array | None = None) -> Complex:
        """Return the derivative of `matrix` by t."""
        left, right = self.left_powers, self.right_powers
        return self._assemble(t, left[0] * left[1], right[0] * right[1], shift)

    def shift(self, t: Complex) -> Array:
        """Return logarithms (m, n) of the rows' largest powers, against overflow."""
        exponents = np.concatenate([self.left_powers[1], self.right_powers[1]], axis=1)
        return np.asarray((exponents * np.real(t)[:, None, None]).max(axis=2))

    def _assemble(self, t: Complex, left: Array, right: Array, shift: Array | None) -> Complex:
        t = np.asarray(t, dtype=complex)[:, None, None]
        off = 0.0 if shift is None else shift[..., None]
        diagonal = (left * np.exp(self.left_powers[1] * t - off)).sum(axis=2)
        weight = (right * np.exp(self.right_powers[1] * t - off)).sum(axis=2)
        matrix = -weight[:, :, None] * self.core
        index = np.arange(self.size)
        matrix[:, index, index] += diagonal
        return np.asarray(matrix)

    def log_det(self, t: Complex) -> tuple[Complex, Complex]:
        """Return log det Delta and its derivative by t.

        Parameters
        ----------
        t : array (m,)
            Logarithms of s.

        Returns
        -------
        (array (m,), array (m,))
            The imaginary part of the logarithm is the phase in (-pi, pi]. Where Delta is singular
            to the last digit the logarithm is minus infinity and the derivative infinite.
        """
        t = np.atleast_1d(np.asarray(t, dtype=complex))
        parts = [self._log_det(t[k : k + _FEW]) for k in range(0, max(len(t), 1), _FEW)]
        return np.concatenate([a for a, _ in parts]), np.concatenate([b for _, b in parts])

    def _log_det(self, t: Complex) -> tuple[Complex, Complex]:
        shift = self.shift(t)
        matrix, slope = self.matrix(t, shift), self.slope(t, shift)
        rows = np.abs(matrix).max(axis=2)
        rows[rows == 0.0] = 1.0
        matrix, slope = matrix / rows[:, :, None], slope / rows[:, :, None]
        unit, size = np.linalg.slogdet(matrix)
        singular = ~np.isfinite(size)
        matrix[singular] = np.eye(self.size)
        rate = np.trace(np.linalg.solve(matrix, slope), axis1=1, axis2=2)
        rate[singular] = np.inf
        size += (np.log(rows) + shift).sum(axis=1)
        return size + 1j * np.angle(unit), rate


def _packed(rows: tuple[PowerSum, ...]) -> tuple[Array, Array]:
    """Return coefficients and exponents (n, k), rows filled up with zeros."""
    longest = max(1, *(len(r.coefficients) for r in rows)) if rows else 1
    packed = np.zeros((2, len(rows), longest))
    for i, row in enumerate(rows):
        packed[:, i, : len(row.exponents)] = row.coefficients, row.exponents
    return packed[0], packed[1]


def _balanced(core: Array) -> Array:
    """Scale rows and inversely columns by powers of two; the determinant stays as it is."""
    from scipy.linalg import matrix_balance

    return np.asarray(matrix_balance(core, permute=False)[0], dtype=float)
