"""Realisation fitted to the bifurcation: exact where a Hopf point looks.

Speed, frequency and crossing speed of a Hopf point and its first Lyapunov coefficient depend on a
law through Z(0), Z(i omega), Z'(i omega) and Z(2 i omega) alone (the characteristic matrix enters
the normal form nowhere else). These seven real numbers are conditions here, the rest of the band
is fitted by least squares with what freedom is left: order 8 with a feedthrough has nine gains.

The rates do not depend on omega or on the law. Hence the gains are smooth in the law's numbers,
and their derivatives follow from the conditions and the normal equations.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import ConvergenceError, UsageError
from racs_bif.fractional.exact_hopf import solve_hopf
from racs_bif.fractional.filter import Filter, Realisation
from racs_bif.fractional.realised_hopf import solve_realised_hopf
from racs_bif.fractional.residues import (
    ConstrainedFit,
    Relaxations,
    imaginary_axis,
    stack,
    static_condition,
    static_slope,
)

if TYPE_CHECKING:
    from racs_bif.fractional.laws import Complex, Law, PowerSum
    from racs_bif.fractional.system import System
    from racs_bif.symbolic.field import Array

_LEAST = 7
_SAMPLES = 200
_AGREE = 1e-11
_ROUNDS = 4


@dataclass(frozen=True, kw_only=True)
class Fitted(Realisation):
    """Sum of relaxations exact at 0, omega (with its slope) and 2 omega, fitted over a band.

    Parameters
    ----------
    band : (float, float)
        Fitted frequencies [rad/s].
    order : int
        Number of relaxation rates, at least 7; 0 takes 4.5 a decade, at least 8.
    omega : float
        Frequency of the Hopf point [rad/s], within the band; 0 takes the band's geometric centre.
        See `fit_to_hopf`.
    spread : float
        How far the rates reach beyond the band at either end, as a factor. For order 8 on 1 to 60
        rad/s, over 20 vehicle laws with omega in 5 to 16 rad/s, the worst error between 2 and 40
        rad/s is smallest with 6: 6e-3, median 2e-3 (1e-2 with 4 or 8, 6e-2 with 2, 4e-2 with 20).

    Raises
    ------
    UsageError
        If the order is too small, or omega outside the band.
    """

    order: int = 0
    omega: float = 0.0
    spread: float = 6.0

    def __post_init__(self) -> None:
        """Check the settings."""
        super().__post_init__()
        low, high = self.band
        if self.order == 0:
            decades = math.log10(high / low)
            object.__setattr__(self, "order", max(8, round(4.5 * decades)))
        if self.order < _LEAST:
            msg = f"order {self.order} is too small; use at least {_LEAST} relaxation rates"
            raise UsageError(msg)
        if self.omega == 0.0:
            object.__setattr__(self, "omega", float(np.sqrt(low * high)))
        if not low <= self.omega <= high:
            msg = f"omega {self.omega:g} rad/s is outside the band {low:g} .. {high:g}; widen it"
            raise UsageError(msg)
        if not 0.0 < self.spread < float("inf"):
            msg = f"spread {self.spread:g} is not usable; give a positive factor"
            raise UsageError(msg)

    @property
    def name(self) -> str:
        """Name on the command line."""
        return "fitted"

    @property
    def rates(self) -> Array:
        """Relaxation rates [rad/s] (order,)."""
        low, high = self.band
        return np.geomspace(low / self.spread, high * self.spread, self.order)

    def realise(self, law: Law) -> Filter:
        """Return the fitted filter; a law that integrates has one further state."""
        basis = Relaxations.of(law, self.rates)
        s, weight = self._samples(law)
        fit = ConstrainedFit(stack(weight * basis(s)), self._conditions(law, basis))
        return basis.filter(fit.solve(stack(weight * law(s)), self._values(law)))

    def derivative(self, law: Law, direction: Law) -> Filter:
        """Return the exact derivative of the fitted filter."""
        basis = Relaxations.of(law, self.rates)
        s, weight = self._samples(law)
        target, moved = law(s), law.along(direction, s)
        weight_p = -weight * np.real(moved / target)
        A, A_p = stack(weight * basis(s)), stack(weight_p * basis(s))
        b, b_p = stack(weight * target), stack(weight_p * target + weight * moved)
        fit = ConstrainedFit(A, self._conditions(law, basis))
        gains = fit.solve(b, self._values(law))
        values_p = self._values_slope(law, direction)
        return basis.filter_slope(fit.solve_slope(gains, b - A @ gains, b_p, values_p, A_p))

    def _samples(self, law: Law) -> tuple[Complex, Array]:
        """Return points on the imaginary axis and weights: relative, fading towards the ends."""
        s = imaginary_axis(self.band, _SAMPLES)
        fade = np.cos(0.49 * np.pi * np.linspace(-1.0, 1.0, _SAMPLES))
        return s, fade / np.abs(law(s))

    @property
    def _points(self) -> Complex:
        return 1j * self.omega * np.array([1.0, 2.0])

    def _conditions(self, law: Law, basis: Relaxations) -> Array:
        """Return the rows (6 or 7, n) of Z(i omega), Z(2 i omega), Z'(i omega) s and Z(0)."""
        points = self._points
        slope = points[:1] * basis.slope(points[:1])
        return np.concatenate([stack(basis(points)), stack(slope), static_condition(law, basis)[0]])

    def _values(self, law: Law) -> Array:
        points = self._points
        static = np.zeros(0) if law.integrates else np.array([law.static_gain])
        slope = points[:1] * _slope(law, points[:1])
        return np.concatenate([stack(law(points)), stack(slope), static])

    def _values_slope(self, law: Law, direction: Law) -> Array:
        points = self._points
        static = np.zeros(0) if law.integrates else np.array([static_slope(law, direction)])
        slope = points[:1] * _slope_along(law, direction, points[:1])
        return np.concatenate([stack(law.along(direction, points)), stack(slope), static])


def fit_to_hopf(
    system: System,
    parameter: str,
    value: float,
    omega: float,
    *,
    order: int = 0,
    X: Array | None = None,
) -> System:
    """Return the system realised so that its Hopf point is that of the exact model.

    The exact Hopf point near the estimate gives omega; that the realised system has its Hopf point
    there too is then verified on its own eigenvalues.

    Parameters
    ----------
    system : System
        Any realisation; its band is kept.
    parameter : str
        Name of the active parameter.
    value, omega : float
        Estimates of the parameter and of the frequency [rad/s] at the Hopf point.
    order : int
        Order of the realisation; 0 keeps that of a fitted one and takes its default otherwise.
    X : array (size,), optional
        Estimate of states and element outputs; the equilibrium near the model's guess where left
        out.

    Returns
    -------
    System
        The same system with a `Fitted` realisation.

    Raises
    ------
    ConvergenceError
        If there is no Hopf point near the estimate, or the realised one does not agree to 1e-11.
    UsageError
        If its frequency lies outside the band.

    Notes
    -----
    The coefficients are exact at this Hopf point. Another one at another frequency wants a fit of
    its own; until then it is as good as the fit over the band.
    """
    path = system.path(parameter)
    if X is None:
        p = path.vector(value)
        X = system.exact_point(system.equilibrium(p), p)
    settings = system.settings
    if not isinstance(settings, Fitted):
        settings = Fitted(band=settings.band)
    order = order or settings.order
    for _ in range(_ROUNDS):
        exact = solve_hopf(system.exact, path, X, value, omega)
        settings = replace(settings, order=order, omega=exact.omega)
        system = replace(system, settings=settings)
        found = solve_realised_hopf(system, path, exact.X, exact.value, exact.omega)
        shift = abs(found.value - exact.value) / max(abs(exact.value), 1e-3)
        if shift < _AGREE and abs(found.omega / exact.omega - 1.0) < _AGREE:
            return system
        X, value, omega = exact.X, exact.value, exact.omega
    msg = (
        f"the fitted realisation's Hopf point is off by {shift:.1e} in {parameter}; "
        "choose another band or order"
    )
    raise ConvergenceError(msg)


def _slope(law: Law, s: Complex) -> Complex:
    """Return Z'(s)."""
    d = law.denominator(s)
    return np.asarray((law.numerator.slope(s) - law(s) * law.denominator.slope(s)) / d)


def _slope_along(law: Law, direction: Law, s: Complex) -> Complex:
    """Return the derivative of Z'(s) by parameters."""
    d, d_p = law.denominator(s), law.denominator.along(direction.denominator, s)
    moved = _sum_slope_along(law.numerator, direction.numerator, s)
    moved = moved - law(s) * _sum_slope_along(law.denominator, direction.denominator, s)
    moved = moved - law.along(direction, s) * law.denominator.slope(s)
    return np.asarray((moved - _slope(law, s) * d_p) / d)


def _sum_slope_along(powers: PowerSum, direction: PowerSum, s: Complex) -> Complex:
    """Return the derivative by parameters of the derivative by s."""
    s = s[..., None]
    c, e = powers.coefficients, powers.exponents
    c_p, e_p = direction.coefficients, direction.exponents
    terms = (c_p * e + c * e_p + c * e * e_p * np.log(s)) * s ** (e - 1.0)
    return np.asarray(np.where(e == 0.0, 0.0, terms).sum(axis=-1))
