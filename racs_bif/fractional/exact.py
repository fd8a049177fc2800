"""The exact model: equilibria and the characteristic matrix with s**alpha on the principal branch.

With w = Z(s) e, Z = N/D, the exact model in ``X = (y, w)`` is ``y' = g(X)``,
``D(s) w = N(s) e(X)``. Its characteristic matrix is
``Delta(s) = diag(s, D(s)) - diag(1, N(s)) core_x(X)``: no denominators, hence no poles, and roots
that are exactly the characteristic roots.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from racs_bif.errors import ConvergenceError
from racs_bif.numerics import sparse

if TYPE_CHECKING:
    from collections.abc import Callable

    from racs_bif.fractional.laws import Complex, Law
    from racs_bif.fractional.realised import RealisedField
    from racs_bif.symbolic.field import Array

_TOLERANCE = 1e-12
_STALLED = 1e-9  # corrections that 40 iterations leave below this are rounding over a small slope


@dataclass(frozen=True)
class Weights:
    """Diagonals of the characteristic matrix, ``diag(left) - diag(right) core_x``, at one s."""

    left: Complex
    right: Complex


class ExactModel:
    """The fractional model without any rational approximation.

    Parameters
    ----------
    field : RealisedField
        The realised model; its laws and compiled core are used, its filters are not.
    """

    def __init__(self, field: RealisedField) -> None:
        self.field = field
        self.compiled = field.compiled
        self.ny = len(self.compiled.states)
        self.size = self.compiled.size
        self._key: bytes | None = None
        self._laws: tuple[Law, ...] = ()
        self._gains: tuple[Array, Array] = (np.zeros(0), np.zeros(0))

    def laws(self, p: Array) -> tuple[Law, ...]:
        """Return the laws at base parameters p (np,), kept from call to call."""
        key = np.ascontiguousarray(p, dtype=float).tobytes()
        if key != self._key:
            self._laws = self.field.laws(p)
            n = np.array([law.numerator.at_zero for law in self._laws])
            self._gains = n, np.array([law.denominator.at_zero for law in self._laws])
            self._key = key
        return self._laws

    def residual(self, X: Array, p: Array) -> Array:
        """Return the equilibrium equations (size,): g(X) and N(0) e - D(0) w."""
        value = self.compiled.core(X, self.compiled.padded(p))
        n, d = self._static(p)
        value[self.ny :] = n * value[self.ny :] - d * X[self.ny :]
        return value

    def jacobian(self, X: Array, p: Array) -> Array:
        """Return the derivative (size, size) of `residual` by X."""
        jacobian = self.compiled.core_jacobian(X, self.compiled.padded(p))
        n, d = self._static(p)
        jacobian[self.ny :] *= n[:, None]
        jacobian[self.ny :, self.ny :] -= np.diag(d)
        return jacobian

    def solver(self, X: Array, p: Array) -> Callable[[Array], Array]:
        """Return a solver of the linear equations whose matrix is `jacobian`.

        Raises
        ------
        numpy.linalg.LinAlgError
            If the matrix is singular, maybe only when the solver is called.
        """
        if self.size >= sparse.LARGE:
            matrix = self._sparse_jacobian(X, p)
            if sparse.worthwhile(matrix):
                return sparse.solver(matrix)
        return sparse.solver(self.jacobian(X, p))

    def _sparse_jacobian(self, X: Array, p: Array) -> Any:  # noqa: ANN401 - scipy has no types
        from scipy.sparse import diags_array

        core = self.compiled.core_jacobian_sparse(X, self.compiled.padded(p))
        n, d = self._static(p)
        own = np.ones(self.ny)
        scaled = diags_array(np.concatenate((own, n))) @ core
        return (scaled - diags_array(np.concatenate((0.0 * own, d)))).tocsc()

    def residual_p(self, X: Array, p: Array, dp: Array) -> Array:
        """Return the derivative of `residual` along `dp` (np,)."""
        padded = self.compiled.padded
        value = self.compiled.core_p(X, padded(p), padded(dp))
        n, _ = self._static(p)
        value[self.ny :] *= n
        directions = self.field.law_directions(p, dp)
        if directions is not None:
            e = self.compiled.core(X, padded(p))[self.ny :]
            for k, (law, moved) in enumerate(zip(self.laws(p), directions, strict=True)):
                n_p = moved.numerator.coefficients[law.numerator.exponents == 0.0].sum()
                d_p = moved.denominator.coefficients[law.denominator.exponents == 0.0].sum()
                value[self.ny + k] += n_p * e[k] - d_p * X[self.ny + k]
        return value

    def _static(self, p: Array) -> tuple[Array, Array]:
        """Return N(0) and D(0) of all laws."""
        self.laws(p)
        return self._gains

    def equilibrium(self, X: Array, p: Array, *, iterations: int = 40) -> Array:
        """Return the exact equilibrium near X by a damped Newton's method.

        Raises
        ------
        ConvergenceError
            If none is found.
        """
        X = np.array(X, dtype=float)
        value = self.residual(X, p)
        for _ in range(iterations):
            try:
                solve = self.solver(X, p)
                step = solve(value)
            except np.linalg.LinAlgError:
                break
            if not np.all(np.isfinite(step)):
                break
            X, value, moved = self._damped((X, p), step, solve)
            if moved <= _TOLERANCE * (1.0 + np.abs(X).max()):
                return X
        else:  # beside a fold: the state is known to the last correction, no better
            if moved <= _STALLED * (1.0 + np.abs(X).max()):
                return X
        msg = "no equilibrium found near the model's guess; give a better guess or another value"
        raise ConvergenceError(msg)

    def nearest(self, X: Array, p: Array) -> Array:
        """Return where the equilibrium equations are nearest to zero, downhill from X.

        By the method of Levenberg and Marquardt (MINPACK), which is not led astray where tyres, or
        whatever else saturates, leave Newton's method nearly no slope.
        """
        from scipy.optimize import root

        with np.errstate(all="ignore"):
            found = root(self.residual, X, args=(p,), jac=self.jacobian, method="lm").x
        return np.asarray(found) if np.all(np.isfinite(found)) else X

    def _damped(
        self,
        point: tuple[Array, Array],
        step: Array,
        solve: Callable[[Array], Array],
    ) -> tuple[Array, Array, float]:
        """Return the next iterate, by the longest halved step that lowers the next correction."""
        X, p = point
        size = float(np.abs(step).max())
        fraction = 1.0
        while fraction > 1e-4:
            trial = X - fraction * step
            after = self.residual(trial, p)
            if np.all(np.isfinite(after)):
                ahead = solve(after)
                if np.abs(ahead).max() <= (1.0 - 0.25 * fraction) * size or size < 1e-9:
                    return trial, after, fraction * size
            fraction *= 0.5
        return X - step * 1e-4, self.residual(X - step * 1e-4, p), size

    def weights(self, s: complex, p: Array) -> Weights:
        """Return the diagonals of the characteristic matrix at s."""
        laws = self.laws(p)
        left = [*[s] * self.ny, *(complex(law.denominator(s)) for law in laws)]
        right = [*[1.0] * self.ny, *(complex(law.numerator(s)) for law in laws)]
        return Weights(np.array(left, dtype=complex), np.array(right, dtype=complex))

    def weights_s(self, s: complex, p: Array) -> Weights:
        """Return the derivative of `weights` by s."""
        laws = self.laws(p)
        left = [*[1.0] * self.ny, *(complex(law.denominator.slope(s)) for law in laws)]
        right = [*[0.0] * self.ny, *(complex(law.numerator.slope(s)) for law in laws)]
        return Weights(np.array(left, dtype=complex), np.array(right, dtype=complex))

    def weights_p(self, s: complex, p: Array, dp: Array) -> Weights:
        """Return the derivative of `weights` along `dp`."""
        left, right = np.zeros(self.size, dtype=complex), np.zeros(self.size, dtype=complex)
        directions = self.field.law_directions(p, dp)
        if directions is not None:
            for k, (law, moved) in enumerate(zip(self.laws(p), directions, strict=True)):
                left[self.ny + k] = law.denominator.along(moved.denominator, s)
                right[self.ny + k] = law.numerator.along(moved.numerator, s)
        return Weights(left, right)

    def delta(self, s: complex, X: Array, p: Array) -> Complex:
        """Return the characteristic matrix (size, size) at s."""
        weights = self.weights(s, p)
        jacobian = self.compiled.core_jacobian(X, self.compiled.padded(p))
        return np.asarray(np.diag(weights.left) - weights.right[:, None] * jacobian)
