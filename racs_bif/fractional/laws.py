"""Transfer laws in numbers: quotients of sums of real powers of s, on the principal branch."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from racs_bif.errors import ValidityError

if TYPE_CHECKING:
    from racs_bif.symbolic.field import Array

Complex = NDArray[np.complex128]


@dataclass(frozen=True)
class PowerSum:
    """The sum of ``coefficients * s**exponents``."""

    coefficients: Array
    exponents: Array

    def __call__(self, s: complex | Complex) -> Complex:
        """Return the sum at s, shaped like s."""
        s = np.asarray(s, dtype=complex)[..., None]
        powers = np.where(self.exponents == 0.0, 1.0, s**self.exponents)
        return np.asarray((self.coefficients * powers).sum(axis=-1))

    def slope(self, s: complex | Complex) -> Complex:
        """Return the derivative by s, shaped like s."""
        s = np.asarray(s, dtype=complex)[..., None]
        terms = self.coefficients * self.exponents * s ** (self.exponents - 1.0)
        return np.asarray(terms.sum(axis=-1))

    def along(self, direction: PowerSum, s: complex | Complex) -> Complex:
        """Return the derivative by parameters; `direction` holds the numbers' derivatives."""
        s = np.asarray(s, dtype=complex)[..., None]
        powers = np.where(self.exponents == 0.0, 1.0, s**self.exponents)
        moved = direction.coefficients + self.coefficients * direction.exponents * np.log(s)
        return np.asarray((moved * powers).sum(axis=-1))

    @property
    def at_zero(self) -> float:
        """The sum at s = 0, where no exponent is negative."""
        return float(self.coefficients[self.exponents == 0.0].sum())


@dataclass(frozen=True)
class Law:
    """A transfer law Z(s) = N(s) / D(s) in numbers.

    The least exponent of both sums is zero, so that N(0) and D(0) exist: where D(0) = 0 the law
    integrates, its static gain is infinite.

    Parameters
    ----------
    numerator, denominator : PowerSum
        N and D.
    name : str
        Name of the element's output.
    feedthrough : bool
        False where Z tends to zero at high frequency: its realisation must be strictly proper.
    """

    numerator: PowerSum
    denominator: PowerSum
    name: str = "Z"
    feedthrough: bool = True

    def __call__(self, s: complex | Complex) -> Complex:
        """Return Z(s) on the principal branch."""
        return self.numerator(s) / self.denominator(s)

    def along(self, direction: Law, s: complex | Complex) -> Complex:
        """Return the derivative of Z(s) by parameters."""
        n, d = self.numerator(s), self.denominator(s)
        n_p = self.numerator.along(direction.numerator, s)
        d_p = self.denominator.along(direction.denominator, s)
        return (n_p - n / d * d_p) / d

    @property
    def integrates(self) -> bool:
        """Whether the static gain is infinite."""
        return self.denominator.at_zero == 0.0

    @property
    def static_gain(self) -> float:
        """Z(0), infinite for a law that integrates."""
        if self.integrates:
            return float("inf")
        return self.numerator.at_zero / self.denominator.at_zero

    @property
    def integer(self) -> bool:
        """Whether every exponent is a whole number."""
        exponents = np.concatenate([self.numerator.exponents, self.denominator.exponents])
        return bool(np.all(exponents == np.round(exponents)))


def read_numbers(name: str, numbers: Array, sizes: tuple[int, int], *, feedthrough: bool) -> Law:
    """Arrange the numbers that a compiled model returns for one law.

    Parameters
    ----------
    name : str
        Name of the element's output.
    numbers : array
        Coefficients and exponents of the numerator, then of the denominator.
    sizes : (int, int)
        Number of terms in each.
    feedthrough : bool
        See `Law`.

    Raises
    ------
    ParameterError
        If a number is not finite or the law differentiates more than once.
    """
    if not np.all(np.isfinite(numbers)):
        msg = f"the law of '{name}' is not finite at these parameters; check its orders and times"
        raise ValidityError(msg)
    n, d = _split(numbers, sizes)
    _check_orders(name, n, d)
    lowest = min(n.exponents.min(), d.exponents.min())
    law = Law(
        PowerSum(n.coefficients, n.exponents - lowest),
        PowerSum(d.coefficients, d.exponents - lowest),
        name,
        feedthrough,
    )
    _check(law)
    return law


def read_direction(numbers: Array, slopes: Array, sizes: tuple[int, int], like: Law) -> Law:
    """Arrange derivatives of a law's numbers like the law itself."""
    n, d = _split(numbers, sizes)
    dn, dd = _split(slopes, sizes)
    exponents = np.concatenate([n.exponents, d.exponents])
    moved = np.concatenate([dn.exponents, dd.exponents])[int(np.argmin(exponents))]
    return Law(
        PowerSum(dn.coefficients, dn.exponents - moved),
        PowerSum(dd.coefficients, dd.exponents - moved),
        like.name,
        like.feedthrough,
    )


def _split(numbers: Array, sizes: tuple[int, int]) -> tuple[PowerSum, PowerSum]:
    a, b = sizes
    return (
        PowerSum(numbers[:a], numbers[a : 2 * a]),
        PowerSum(numbers[2 * a : 2 * a + b], numbers[2 * a + b :]),
    )


def _check_orders(name: str, *sums: PowerSum) -> None:
    """Refuse fractional orders that are not between -2 and 2."""
    for power_sum in sums:
        for order in power_sum.exponents:
            if abs(order) > 2.0 and order != round(order):
                msg = (
                    f"the law of '{name}' has the order {order:g}; fractional orders lie between "
                    "-2 and 2: use derivatives of its input, or two elements"
                )
                raise ValidityError(msg)


def _check(law: Law) -> None:
    top, bottom = law.numerator.exponents.max(), law.denominator.exponents.max()
    if top - bottom > 1.0:
        msg = (
            f"the law of '{law.name}' grows like s**{top - bottom:g}; feed it the derivative of "
            "its input and lower its order by one"
        )
        raise ValidityError(msg)
    if not law.feedthrough and top >= bottom:
        msg = (
            f"the law of '{law.name}' no longer vanishes at high frequency (orders {top:g} over "
            f"{bottom:g}); keep the order of its numerator below that of its denominator"
        )
        raise ValidityError(msg)
