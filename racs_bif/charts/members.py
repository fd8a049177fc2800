"""Exact equilibria of one system at many parameter sets at once, and what they are counted by."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.fractional.rational import RationalSystem

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from racs_bif.fractional.system import System
    from racs_bif.symbolic.field import Array

_ITERATIONS = 8
_CONTRACTION = 0.25
_TOLERANCE = 1e-11
_SMALL = 1e-7


@dataclass(frozen=True)
class Laws:
    """Numbers of one transfer law at N parameter sets.

    Parameters
    ----------
    numerator, denominator : (array (a, N), array (a, N))
        Coefficients and exponents, the least exponent of both being zero.
    """

    numerator: tuple[Array, Array]
    denominator: tuple[Array, Array]


class Members:
    """A system at many parameter sets.

    Parameters
    ----------
    system : System
        The system.
    """

    def __init__(self, system: System) -> None:
        self.system = system
        self.compiled = system.compiled
        self.ny, self.size = len(self.compiled.states), self.compiled.size
        fixed = np.array(self.compiled.meta["fixed"], dtype=int).reshape(-1, 2)
        self._fixed = fixed[:, 0], fixed[:, 1]

    def laws(self, P: Array) -> tuple[Laws, ...]:
        """Return the laws of all elements at base parameters P (np, N)."""
        if not self.compiled.elements:
            return ()
        if isinstance(self.system, RationalSystem):
            return self._rational(P)
        numbers = self.compiled.kernel("laws")(self.compiled.padded(P))
        if numbers.ndim == 1:
            numbers = np.repeat(numbers[:, None], P.shape[1], axis=1)
        laws, start = [], 0
        for a, b in self.compiled.meta["law_sizes"]:
            part = numbers[start : start + 2 * (a + b)]
            start += 2 * (a + b)
            n, n_at, d, d_at = np.split(part, [a, 2 * a, 2 * a + b])
            lowest = np.minimum(n_at.min(axis=0), d_at.min(axis=0))
            laws.append(Laws((n, n_at - lowest), (d, d_at - lowest)))
        return tuple(laws)

    def _rational(self, P: Array) -> tuple[Laws, ...]:
        """Return the laws of filters, which may differ from member to member."""
        each = [self.system.exact.field.laws(np.ascontiguousarray(p)) for p in P.T]
        columns = []
        for laws in zip(*each, strict=True):
            parts = [
                tuple(
                    np.array([getattr(getattr(law, part), numbers) for law in laws]).T
                    for numbers in ("coefficients", "exponents")
                )
                for part in ("numerator", "denominator")
            ]
            columns.append(Laws((parts[0][0], parts[0][1]), (parts[1][0], parts[1][1])))
        return tuple(columns)

    def core(self, X: Array, P: Array) -> Array:
        """Return the core's Jacobian (N, size, size) at states X (size, N)."""
        compiled, padded = self.compiled, self.compiled.padded(P)
        core = np.zeros((X.shape[1], self.size, self.size))
        core[:, *self._fixed] = _wide(compiled.kernel("jacobian_fixed")(padded), X).T
        rows, columns = compiled.varying_at
        if len(rows):
            core[:, rows, columns] = _wide(compiled.varying_jacobian(X, padded), X).T
        return core

    def inertia(self, X: Array, P: Array) -> Array:
        """Return what the determinants (N,) of the mass matrix are proportional to."""
        if not self.compiled.has_inertia:
            return np.ones(X.shape[1])
        return self.compiled.inertia(X, self.compiled.padded(P))

    def side(self, X: Array, P: Array) -> Array:
        """Return the signs (N,) of the determinants of the mass matrix."""
        with np.errstate(all="ignore"):
            return np.sign(self.inertia(X, P))

    def equations(self, P: Array) -> Callable[[Array], tuple[Array, Array]]:
        """Return the equilibrium equations at parameters P (np, N).

        Returns
        -------
        callable
            Gives residual (size, N) and Jacobian (N, size, size) at states (size, N).
        """
        compiled, padded = self.compiled, self.compiled.padded(P)
        rows, columns = compiled.varying_at
        core = compiled.kernel("core").bind(padded)
        varying = compiled.kernel("jacobian_varying").bind(padded) if len(rows) else None
        fixed = np.zeros((P.shape[1], self.size, self.size))
        fixed[:, *self._fixed] = compiled.kernel("jacobian_fixed").bind(padded)().T
        gains = _gains(self.laws(P))

        def at(X: Array) -> tuple[Array, Array]:
            value, jacobian = core(X), fixed.copy()
            if varying is not None:
                jacobian[:, rows, columns] = varying(X).T
            for row, (n, d) in enumerate(gains, start=self.ny):
                value[row] = n * value[row] - d * X[row]
            return value, self._at_rest(jacobian, gains)

        return at

    def static(self, core: Array, laws: tuple[Laws, ...]) -> Array:
        """Return the Jacobian (N, size, size) of `equations` from that of the core and the laws."""
        return self._at_rest(core.copy(), _gains(laws))

    def _at_rest(self, core: Array, gains: list[tuple[Array, Array]]) -> Array:
        for row, (n, d) in enumerate(gains, start=self.ny):
            core[:, row] *= n[:, None]
            core[:, row, row] -= d
        return core

    def newton(self, X: Array, P: Array) -> tuple[Array, NDArray[np.bool_], Array]:
        """Solve near X (size, N), where Newton's method contracts at once.

        Returns
        -------
        (array (size, N), bool array (N,), array (N,))
            Equilibria, where they were found - elsewhere the numbers mean nothing - and the sign
            of the Jacobian's determinant there.
        """
        X = np.array(X, dtype=float)
        found, parity = np.zeros(X.shape[1], dtype=bool), np.zeros(X.shape[1])
        moving, last = np.arange(X.shape[1]), np.full(X.shape[1], np.inf)
        with np.errstate(all="ignore"):
            held, equations = moving, self.equations(P)
            for _ in range(_ITERATIONS):
                if 2 * len(moving) < len(held):
                    held, equations = moving, self.equations(P[:, moving])
                value, jacobian = equations(X[:, held])
                if len(moving) < len(held):
                    at = np.searchsorted(held, moving)
                    value, jacobian = value[:, at], jacobian[at]
                step = self._step(value, jacobian)
                X[:, moving] -= step
                scale = 1.0 + np.abs(X[:, moving]).max(axis=0)
                size = np.abs(step).max(axis=0) / scale
                good = size <= _TOLERANCE
                found[moving[good]] = True
                parity[moving[good]] = np.linalg.slogdet(jacobian[good])[0]
                contracts = (size <= _CONTRACTION * last[moving]) | (size <= _SMALL)
                last[moving] = size
                moving = moving[~good & contracts & np.isfinite(size)]
                if not len(moving):
                    break
        return X, found, parity

    def _step(self, value: Array, jacobian: Array) -> Array:
        bad = ~(np.isfinite(value).all(axis=0) & np.isfinite(jacobian).all(axis=(1, 2)))
        jacobian[bad] = np.eye(self.size)
        # A matrix singular to the last digit stops the whole batch: nudge it, Newton rejects it.
        try:
            step = np.linalg.solve(jacobian, value.T[:, :, None])[:, :, 0].T
        except np.linalg.LinAlgError:
            pivots = np.abs(np.linalg.det(jacobian)) == 0.0
            jacobian[pivots] = np.eye(self.size)
            bad |= pivots
            step = np.linalg.solve(jacobian, value.T[:, :, None])[:, :, 0].T
        step[:, bad] = np.nan
        return np.asarray(step)


def _gains(laws: tuple[Laws, ...]) -> list[tuple[Array, Array]]:
    """Return N(0) and D(0) of each law."""
    return [(_static(*law.numerator), _static(*law.denominator)) for law in laws]


def _static(coefficients: Array, exponents: Array) -> Array:
    return np.asarray(np.where(exponents == 0.0, coefficients, 0.0).sum(axis=0))


def _wide(values: Array, X: Array) -> Array:
    """Return rows with a column for each point, also where they are the same at all."""
    return values if values.ndim == 2 else np.repeat(values[:, None], X.shape[1], axis=1)
