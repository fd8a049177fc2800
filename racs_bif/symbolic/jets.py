"""Compiled models on truncated power series: exact derivatives of any order.

The text of a compiled model names its elementary functions, so that it runs on any numbers that
have them. Here these are polynomials in several small quantities, cut off at a degree: their
coefficients are the Taylor coefficients of the model (A. Griewank and A. Walther, *Evaluating
Derivatives*, SIAM 2008, chapter 13). Slower than the compiled forms, for what is needed rarely.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import product
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from racs_bif.errors import ConvergenceError
from racs_bif.symbolic.kernels import SCALAR
from racs_bif.symbolic.series import ELEMENTARY, power

if TYPE_CHECKING:
    from collections.abc import Callable

Coefficients = NDArray[np.float64] | NDArray[np.complex128]
Monomial = tuple[int, ...]


class Algebra:
    """Polynomials over a set of monomials that holds every divisor of its members.

    Parameters
    ----------
    monomials : tuple of tuple of int
        Exponents, by rising total degree: the first is the constant.
    """

    def __init__(self, monomials: tuple[Monomial, ...]) -> None:
        self.monomials = monomials
        self.index = {m: k for k, m in enumerate(monomials)}
        self.degree = sum(monomials[-1])
        triples = sorted(
            (self.index[total], i, j)
            for i, a in enumerate(monomials)
            for j, b in enumerate(monomials)
            if (total := tuple(map(sum, zip(a, b, strict=True)))) in self.index
        )
        out, left, right = (np.array(column) for column in zip(*triples, strict=True))
        self._left, self._right = left, right
        self._starts = np.searchsorted(out, np.arange(len(monomials)))

    def __len__(self) -> int:
        """Return the number of monomials."""
        return len(self.monomials)

    def multiply(self, a: Coefficients, b: Coefficients) -> Coefficients:
        """Return the coefficients of a product."""
        if self.degree == 1:  # first derivatives, which are asked for most often
            product = a[0] * b + b[0] * a
            product[0] = a[0] * b[0]
            return np.asarray(product)
        terms = a[self._left] * b[self._right]
        return np.asarray(np.add.reduceat(terms, self._starts))


@lru_cache(maxsize=32)
def total_degree(variables: int, degree: int) -> Algebra:
    """Return the polynomials of so many variables up to a total degree."""
    every = product(range(degree + 1), repeat=variables)
    return Algebra(tuple(sorted((m for m in every if sum(m) <= degree), key=_by_degree)))


@lru_cache(maxsize=8)
def multilinear(variables: int) -> Algebra:
    """Return the polynomials of degree one in each variable: their last coefficient is a form."""
    return Algebra(tuple(sorted(product((0, 1), repeat=variables), key=_by_degree)))


def _by_degree(monomial: Monomial) -> tuple[int, Monomial]:
    return sum(monomial), tuple(-m for m in monomial)


class Jet:
    """A polynomial as a number.

    Parameters
    ----------
    algebra : Algebra
        Its monomials.
    c : array
        Its coefficients; the constant is real.
    """

    __array_ufunc__ = None
    __slots__ = ("algebra", "c")

    def __init__(self, algebra: Algebra, c: Coefficients) -> None:
        self.algebra, self.c = algebra, c

    @property
    def base(self) -> float:
        """The constant."""
        return float(self.c[0].real)

    def _coefficients(self, other: Jet | float) -> Coefficients:
        if isinstance(other, Jet):
            return other.c
        constant = np.zeros(len(self.c))
        constant[0] = other
        return constant

    def __neg__(self) -> Jet:
        return Jet(self.algebra, -self.c)

    def __add__(self, other: Jet | float) -> Jet:
        return Jet(self.algebra, self.c + self._coefficients(other))

    __radd__ = __add__

    def __sub__(self, other: Jet | float) -> Jet:
        return Jet(self.algebra, self.c - self._coefficients(other))

    def __rsub__(self, other: float) -> Jet:
        return Jet(self.algebra, self._coefficients(other) - self.c)

    def __mul__(self, other: Jet | float) -> Jet:
        if isinstance(other, Jet):
            return Jet(self.algebra, self.algebra.multiply(self.c, other.c))
        return Jet(self.algebra, self.c * other)

    __rmul__ = __mul__

    def __truediv__(self, other: Jet | float) -> Jet:
        if isinstance(other, Jet):
            return self * other.composed(power(other.base, -1.0, self.algebra.degree))
        return Jet(self.algebra, self.c / other)

    def __rtruediv__(self, other: float) -> Jet:
        return self.composed(power(self.base, -1.0, self.algebra.degree)) * other

    def __lt__(self, other: Jet | float) -> bool:
        return self.base < _base(other)

    def __le__(self, other: Jet | float) -> bool:
        return self.base <= _base(other)

    def __gt__(self, other: Jet | float) -> bool:
        return self.base > _base(other)

    def __ge__(self, other: Jet | float) -> bool:
        return self.base >= _base(other)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Jet | float) and self.base == _base(other)

    __hash__ = None  # type: ignore[assignment]

    def composed(self, series: list[float]) -> Jet:
        """Return a function of this jet from its Taylor coefficients at the constant."""
        if self.algebra.degree == 1:
            result = series[1] * self.c
            result[0] = series[0]
            return Jet(self.algebra, result)
        small = self.c.copy()
        small[0] = 0.0
        result = np.zeros_like(small)
        for coefficient in reversed(series):
            result = self.algebra.multiply(result, small)
            result[0] += coefficient
        return Jet(self.algebra, result)


Number = Jet | float


def _base(number: Number) -> float:
    return number.base if isinstance(number, Jet) else number


def _elementary(name: str) -> Callable[[Number], Number]:
    series, plain = ELEMENTARY[name], getattr(SCALAR, name)

    def function(x: Number) -> Number:
        if not isinstance(x, Jet):
            return float(plain(x))
        return x.composed(series(x.base, x.algebra.degree))

    return function


_FUNCTIONS: Final = {name: _elementary(name) for name in ELEMENTARY}


def _pow(a: Number, b: Number) -> Number:
    if isinstance(b, Jet):
        if np.any(b.c[1:]):
            return _FUNCTIONS["exp"](b * _FUNCTIONS["log"](a))
        b = b.base
    if isinstance(a, Jet):
        return a.composed(power(a.base, b, a.algebra.degree))
    return float(SCALAR.pow(a, b))


def _absorb(a: Number, b: Number) -> Number:
    zero = not np.any(b.c) if isinstance(b, Jet) else b == 0.0
    return 0.0 if zero else a * b


JETS: Final = SimpleNamespace(**(vars(SCALAR) | _FUNCTIONS | {"pow": _pow, "absorb": _absorb}))
"""Elementary functions of jets and of floats."""


class JetFunctions:
    """The functions of a compiled module on jets.

    Parameters
    ----------
    text : str
        The module.
    call : callable, optional
        The external function that it calls.
    """

    def __init__(self, text: str, call: Callable[..., Any] | None = None) -> None:
        namespace: dict[str, Any] = {}
        exec(compile(text, "<racs_bif jets>", "exec"), namespace)  # our own text
        self._functions: dict[str, Callable[..., Any]] = namespace["make"](
            SimpleNamespace(**{**vars(JETS), "call": call})
        )

    def __call__(self, name: str, algebra: Algebra, *groups: Coefficients) -> Coefficients:
        """Evaluate a function.

        Parameters
        ----------
        name : str
            Which.
        algebra : Algebra
            The monomials.
        *groups : arrays (k,) or (k, len(algebra))
            Its arguments, parameters first: constants, or the coefficients of polynomials.

        Returns
        -------
        array (outputs, len(algebra))

        Raises
        ------
        ConvergenceError
            If the function is not smooth here.
        """
        p, *rest = (_numbers(algebra, group) for group in groups)
        try:
            constants = self._functions[f"{name}_prepare"](p)
            results = self._functions[name](constants, *rest)
        except (ArithmeticError, ValueError) as error:
            msg = f"the equations have no series, not being smooth here ({error}); start elsewhere"
            raise ConvergenceError(msg) from None
        kind = complex if any(np.iscomplexobj(g) for g in groups) else float
        out = np.zeros((len(results), len(algebra)), dtype=kind)
        for row, result in zip(out, results, strict=True):
            if isinstance(result, Jet):
                row[:] = result.c
            else:
                row[0] = result
        return out


def _numbers(algebra: Algebra, group: Coefficients) -> list[Any]:
    if group.ndim == 1:
        return list(group.tolist())
    return [Jet(algebra, row) for row in group]
