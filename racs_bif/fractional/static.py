"""The equilibrium equations of the exact model as a vector field: small, and free of any filter."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from racs_bif.symbolic.field import Array, VectorField, Vectors
from racs_bif.symbolic.jets import multilinear

if TYPE_CHECKING:
    from racs_bif.fractional.exact import ExactModel
    from racs_bif.symbolic.jets import Algebra


class StaticField(VectorField):
    """``0 = g(X)`` and ``0 = N(0) e(X) - D(0) w`` for X = (y, w), see `racs_bif.fractional.exact`.

    Its zeros, and where its Jacobian is singular, are those of the exact model and of every
    realisation with the right static gain; its eigenvalues mean nothing.

    Parameters
    ----------
    exact : ExactModel
        The exact model.
    """

    def __init__(self, exact: ExactModel) -> None:
        self.exact = exact
        self.compiled = exact.compiled
        self.states = (*self.compiled.states, *self.compiled.elements)
        self.parameters = exact.field.parameters
        self._ny = exact.ny

    def _gains(self, p: Array) -> tuple[Array, Array]:
        """Return N(0) and D(0) of each element."""
        laws = self.exact.laws(p)
        n = np.array([law.numerator.at_zero for law in laws])
        return n, np.array([law.denominator.at_zero for law in laws])

    def _gain_slopes(self, p: Array, dp: Array) -> tuple[Array, Array] | None:
        directions = self.exact.field.law_directions(p, dp)
        if directions is None:
            return None
        pairs = list(zip(self.exact.laws(p), directions, strict=True))
        n = [m.numerator.coefficients[law.numerator.exponents == 0.0].sum() for law, m in pairs]
        d = [m.denominator.coefficients[law.denominator.exponents == 0.0].sum() for law, m in pairs]
        return np.array(n), np.array(d)

    def f(self, x: Array, p: Array) -> Array:
        """Return the residual of the equilibrium equations, shaped like `x`."""
        value = self.compiled.core(x, self.compiled.padded(p))
        n, d = self._gains(p)
        value[self._ny :] = (n * value[self._ny :].T - d * x[self._ny :].T).T
        return value

    def f_x(self, x: Array, p: Array) -> Array:
        """Return the Jacobian, (n, n) for one point or (N, n, n) for N points."""
        jacobian = self.compiled.core_jacobian(x, self.compiled.padded(p))
        n, d = self._gains(p)
        jacobian[..., self._ny :, :] *= n[:, None]
        jacobian[..., self._ny :, self._ny :] -= np.diag(d)
        return jacobian

    def f_p(self, x: Array, p: Array, dp: Array) -> Array:
        """Return the derivative of f along `dp`, at one point."""
        return self.exact.residual_p(x, p, dp)

    def _scaled(self, form: Vectors, p: Array) -> Vectors:
        form = np.array(form)
        form[self._ny :] = (self._gains(p)[0] * form[self._ny :].T).T
        return form

    def f_xx(self, x: Array, p: Array, u: Vectors, v: Vectors) -> Vectors:
        """Return the bilinear form B(u, v) at one point, shaped like the directions."""
        return self._scaled(self.compiled.core_xx(x, self.compiled.padded(p), u, v), p)

    def f_xxx(self, x: Array, p: Array, u: Vectors, v: Vectors, w: Vectors) -> Vectors:
        """Return the trilinear form C(u, v, w) at one point, shaped like the directions."""
        return self._scaled(self.compiled.core_xxx(x, self.compiled.padded(p), u, v, w), p)

    def f_xp(self, x: Array, p: Array, v: Vectors, dp: Array) -> Vectors:
        """Return the derivative of f_x v along `dp` at one point, v (n,)."""
        padded, ny = self.compiled.padded, self._ny
        value = self._scaled(self.compiled.core_xp(x, padded(p), v, padded(dp)), p)
        slopes = self._gain_slopes(p, dp)
        if slopes is not None:
            turned = self.compiled.core_jacobian(x, padded(p)) @ v
            value[ny:] += slopes[0] * turned[ny:] - slopes[1] * v[ny:]
        return value

    def f_pp(self, x: Array, p: Array, dp: Array, dq: Array) -> Array:
        """Return the second derivative (n,) of f along `dp` and `dq` at one point."""
        padded, ny = self.compiled.padded, self._ny
        algebra = multilinear(2)
        moved = np.zeros((len(p), 4))
        # Monomials of degree one in each: 1, t, s, t s.
        moved[:, 0], moved[:, 1], moved[:, 2] = p, dp, dq
        full = np.concatenate([moved, np.zeros((len(self.compiled.elements), 4))])
        value = self._scaled(self.compiled.expand("core", algebra, full, x)[:, 3].real, p)
        along, across = self._gain_slopes(p, dp), self._gain_slopes(p, dq)
        if along is None and across is None:
            return np.asarray(value.real)
        e = self.compiled.core(x, padded(p))[ny:]
        for slopes, other in ((along, dq), (across, dp)):
            if slopes is not None:
                value[ny:] += slopes[0] * self.compiled.core_p(x, padded(p), padded(other))[ny:]
        n_pq, d_pq = self._gain_curvatures(p, full, algebra)
        value[ny:] += n_pq * e - d_pq * x[ny:]
        return np.asarray(value.real)

    def _gain_curvatures(self, p: Array, moved: Array, algebra: Algebra) -> tuple[Array, Array]:
        numbers = self.compiled.expand("laws", algebra, moved)[:, 3].real
        n, d, start = [], [], 0
        sizes = self.compiled.meta["law_sizes"]
        for law, (a, b) in zip(self.exact.laws(p), sizes, strict=True):
            n.append(numbers[start : start + a][law.numerator.exponents == 0.0].sum())
            start += 2 * a
            d.append(numbers[start : start + b][law.denominator.exponents == 0.0].sum())
            start += 2 * b
        return np.array(n), np.array(d)
