"""Gains of given real poles, by least squares in which chosen conditions hold exactly."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import ParameterError
from racs_bif.fractional.filter import Filter

if TYPE_CHECKING:
    from racs_bif.fractional.laws import Complex, Law
    from racs_bif.symbolic.field import Array

_APART = 1e-6


@dataclass(frozen=True)
class Relaxations:
    """The functions ``r / (s + r)`` of a few rates, with 1 and ``r0 / s`` where a law needs them.

    Parameters
    ----------
    rates : array (k,)
        Relaxation rates [rad/s], positive, ascending.
    integrates : bool
        Whether ``r0 / s`` comes first.
    feedthrough : bool
        Whether 1 comes last.
    """

    rates: Array
    integrates: bool
    feedthrough: bool

    @classmethod
    def of(cls, law: Law, rates: Array) -> Relaxations:
        """Return the functions with which a law is realised."""
        return cls(rates, law.integrates, law.feedthrough)

    def __len__(self) -> int:
        return len(self.rates) + self.integrates + self.feedthrough

    def __call__(self, s: Complex) -> Complex:
        """Return the functions (len, m) at s (m,)."""
        first = [self.rates[0] / s] if self.integrates else []
        last = [np.ones_like(s)] if self.feedthrough else []
        return np.array([*first, *(r / (s + r) for r in self.rates), *last])

    def slope(self, s: Complex) -> Complex:
        """Return their derivatives (len, m) by s."""
        first = [-self.rates[0] / s**2] if self.integrates else []
        last = [np.zeros_like(s)] if self.feedthrough else []
        return np.array([*first, *(-r / (s + r) ** 2 for r in self.rates), *last])

    def filter(self, gains: Array) -> Filter:
        """Return the filter with these gains (len,); its derivative has the same C and D."""
        rates, gains = self.rates, np.array(gains, dtype=float)
        through = float(gains[-1]) if self.feedthrough else 0.0
        if self.feedthrough:
            gains = gains[:-1]
        if not self.integrates:
            return Filter(np.diag(-rates), rates.copy(), gains, through)
        gains[0] *= rates[0]
        A = np.diag(np.append(0.0, -rates))
        return Filter(A, np.append(1.0, rates), gains, through)

    def filter_slope(self, gains: Array) -> Filter:
        """Return the derivative of the filter where the gains move by `gains`."""
        moved = self.filter(gains)
        return Filter(np.zeros_like(moved.A), np.zeros_like(moved.B), moved.C, moved.D)


class ConstrainedFit:
    """Least squares ``|A t - b|`` over the t with ``E t = d``.

    The conditions are met first, by an orthogonal factor of E, and the freedom that they leave is
    fitted: they hold to rounding, whatever the fit.

    Parameters
    ----------
    A : array (m, n)
        Fitted rows.
    E : array (c, n)
        Conditions, c <= n, independent.
    """

    def __init__(self, A: Array, E: Array) -> None:
        self.A = A
        count = len(E)
        turned, triangle = np.linalg.qr(E.T, mode="complete")
        self._held, self._free = turned[:, :count], turned[:, count:]
        self._triangle: Array = triangle[:count]
        self._fitted = A @ self._free

    def solve(self, b: Array, d: Array) -> Array:
        """Return t (n,)."""
        t = self._met(d)
        rest = np.linalg.lstsq(self._fitted, b - self.A @ t, rcond=None)[0]
        return np.asarray(t + self._free @ rest)

    def solve_slope(self, t: Array, residual: Array, b_p: Array, d_p: Array, A_p: Array) -> Array:
        """Return the derivative (n,) of t.

        Parameters
        ----------
        t, residual : array (n,) and (m,)
            The solution and b - A t.
        b_p, d_p, A_p : arrays
            Derivatives of b, d and A; E does not move.
        """
        met = self._met(d_p)
        if not self._free.shape[1]:
            return met
        first = np.linalg.lstsq(self._fitted, b_p - A_p @ t - self.A @ met, rcond=None)[0]
        triangle = np.asarray(np.linalg.qr(self._fitted, mode="r"))
        pull = (A_p @ self._free).T @ residual
        second = np.linalg.solve(triangle, np.linalg.solve(triangle.T, pull))
        return np.asarray(met + self._free @ (first + second))

    def _met(self, d: Array) -> Array:
        return np.asarray(self._held @ np.linalg.solve(self._triangle.T, d))


def imaginary_axis(band: tuple[float, float], count: int) -> Complex:
    """Return points (count,) of the imaginary axis, spaced evenly in log omega over a band."""
    return np.asarray(1j * np.geomspace(*band, count), dtype=np.complex128)


def fit_gains(law: Law, rates: Array, s: Complex) -> Filter:
    """Return the filter with these rates, fitted to a law at s (m,) relative to it.

    The static gain is exact.
    """
    basis = Relaxations.of(law, rates)
    target = law(s)
    A = stack(basis(s) / np.abs(target))
    E, d = static_condition(law, basis)
    gains = ConstrainedFit(A, E).solve(stack(target / np.abs(target)), d)
    return basis.filter(gains)


def static_condition(law: Law, basis: Relaxations) -> tuple[Array, Array]:
    """Return the row (1, n) and value (1,) of Z(0); none for a law that integrates."""
    if law.integrates:
        return np.zeros((0, len(basis))), np.zeros(0)
    return np.ones((1, len(basis))), np.array([law.static_gain])


def static_slope(law: Law, direction: Law) -> float:
    """Return the derivative of Z(0) by parameters, 0 for a law that integrates."""
    if law.integrates:
        return 0.0
    fixed = law.numerator.exponents == 0.0, law.denominator.exponents == 0.0
    n_p = float(direction.numerator.coefficients[fixed[0]].sum())
    d_p = float(direction.denominator.coefficients[fixed[1]].sum())
    return (n_p - law.static_gain * d_p) / law.denominator.at_zero


def checked_rates(poles: Complex | Array, method: str, what: str) -> Array:
    """Return rates (k,), ascending, of poles (k,) that must be real, negative and distinct.

    Raises
    ------
    ParameterError
        If they are not.
    """
    values = np.asarray(poles, dtype=complex)
    bad = (values.real >= 0.0) | (np.abs(values.imag) > _APART * np.abs(values))
    bad |= ~np.isfinite(values)
    rates = np.sort(-values.real)
    same = rates[1:] <= (1.0 + _APART) * rates[:-1]
    if not np.any(bad) and not np.any(same):
        return rates
    shown = values[bad][0] if np.any(bad) else -rates[1:][same][0]
    msg = (
        f"{method} finds a pole of '{what}' at {shown:.4g} rad/s, not real, negative and simple; "
        "lower its order, or use --realisation fitted or diffusive"
    )
    raise ParameterError(msg)


def stack(values: Complex) -> Array:
    """Stack real and imaginary parts: (k, m) to (2 m, k), (m,) to (2 m,)."""
    return np.concatenate([values.real, values.imag], axis=-1).T
