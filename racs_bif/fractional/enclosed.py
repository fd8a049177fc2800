"""The exact model's equations, enclosed over boxes of states, one parameter and frequency."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, cast

from racs_bif.fractional.intervals import BallFunctions, UnboundedError, finite, flint

if TYPE_CHECKING:
    from collections.abc import Sequence

    from flint import acb, arb

    from racs_bif.fractional.exact import ExactModel
    from racs_bif.fractional.intervals import Number
    from racs_bif.symbolic.compiled_path import CompiledPath

    Matrix = list[list[arb]]


@dataclass(frozen=True)
class _Term:
    """One term c s**e of a law, and its derivative by the active parameter."""

    c: arb
    e: arb
    c_p: arb
    e_p: arb


@dataclass(frozen=True)
class EnclosedSum:
    """A sum of real powers of s, enclosed."""

    terms: tuple[_Term, ...]

    def __call__(self, log_s: acb) -> acb:
        """Return the sum."""
        return sum((t.c * _power(t.e, log_s) for t in self.terms), flint().acb(0))

    def slope(self, log_s: acb) -> acb:
        """Return the derivative by s."""
        total = sum((t.c * t.e * _power(t.e, log_s) for t in self.terms), flint().acb(0))
        return cast("acb", total * (-log_s).exp())

    def along(self, log_s: acb) -> acb:
        """Return the derivative by the active parameter."""
        parts = ((t.c_p + t.c * t.e_p * log_s) * _power(t.e, log_s) for t in self.terms)
        return sum(parts, flint().acb(0))

    @cached_property
    def at_zero(self) -> arb:
        """The sum at s = 0."""
        return sum((t.c for t in self.terms if _static(t)), flint().arb(0))

    @cached_property
    def at_zero_along(self) -> arb:
        """Derivative of `at_zero` by the active parameter."""
        return sum((t.c_p for t in self.terms if _static(t)), flint().arb(0))


def _power(e: arb, log_s: acb) -> acb:
    return flint().acb(1) if e == 0 else (e * log_s).exp()


def _static(term: _Term) -> bool:
    if term.e == 0:
        return True
    if term.e > 0:
        return False
    msg = "an order of a law passes zero in the box"
    raise UnboundedError(msg)


@dataclass(frozen=True)
class Laws:
    """Numerators and denominators of all elements' laws, enclosed."""

    n: tuple[EnclosedSum, ...]
    d: tuple[EnclosedSum, ...]


class EnclosedModel:
    """The exact model as functions of balls; see `racs_bif.fractional.exact` for the equations.

    Parameters
    ----------
    model : ExactModel
        The exact model.
    path : CompiledPath
        One active parameter; the others are the doubles that they are.
    """

    def __init__(self, model: ExactModel, path: CompiledPath) -> None:
        compiled = model.compiled
        self.ny, self.size = model.ny, model.size
        self._path, self._compiled = path, compiled
        self._call = BallFunctions(compiled.sources.main, compiled.sources.forms)
        self._floats = [float(x) for x in path.values] + [0.0] * len(compiled.elements)

    def at(self, x: Sequence[arb], value: arb) -> EnclosedPoint:
        """Return the equations at states and outputs `x` (size,) and a value of the parameter."""
        return EnclosedPoint(self, list(x), *self._parameters(value))

    def _parameters(self, value: arb) -> tuple[list[arb], list[arb]]:
        """Return base parameters, padded like the compiled core's, and their derivative."""
        arb, name = flint().arb, self._path.names[0]
        p, dp = [arb(x) for x in self._floats], [arb(0) for _ in self._floats]
        base = [q.name for q in self._compiled.parameters]
        if name in base:
            p[base.index(name)], dp[base.index(name)] = value, arb(1)
            return p, dp
        j = [d.name for d in self._compiled.derived].index(name)
        place = base.index(self._compiled.derived[j].sets)
        slope = self._call(f"inverse{j}_p", p, [value], dp, [arb(1)])[0]
        p[place] = self._call(f"inverse{j}", p, [value])[0]
        dp[place] = slope
        return p, dp

    def call(self, name: str, p: Sequence[arb], *groups: Sequence[Number]) -> list[Number]:
        """Evaluate a function of the compiled model."""
        return self._call(name, p, *groups)

    def jacobian(self, x: Sequence[arb], p: Sequence[arb]) -> Matrix:
        """Return the derivative (size, size) of the compiled core by `x`."""
        zero = flint().arb(0)
        matrix = [[zero] * self.size for _ in range(self.size)]
        meta = self._compiled.meta
        fixed, varying = self._call("jacobian_fixed", p), self._call("jacobian_varying", p, x)
        for places, values in ((meta["fixed"], fixed), (meta["varying"], varying)):
            for (i, j), entry in zip(places, values, strict=True):
                matrix[i][j] = entry
        return matrix

    def laws(self, p: Sequence[arb], dp: Sequence[arb]) -> Laws:
        """Return the laws of all elements."""
        if self.ny == self.size:
            return Laws((), ())
        numbers = cast("list[arb]", self._call("laws", p))
        slopes = cast("list[arb]", self._call("laws_p", p, dp))
        n, d, start = [], [], 0
        for a, b in self._compiled.meta["law_sizes"]:
            stop = start + 2 * (a + b)
            top, bottom = _sums(numbers[start:stop], slopes[start:stop], a, b)
            n.append(top)
            d.append(bottom)
            start = stop
        return Laws(tuple(n), tuple(d))


def _sums(numbers: list[arb], slopes: list[arb], a: int, b: int) -> tuple[EnclosedSum, EnclosedSum]:
    """Arrange one law's numbers; the least order is taken from all, so that it is exactly zero."""
    coefficients = [*range(a), *range(2 * a, 2 * a + b)]
    orders = [*range(a, 2 * a), *range(2 * a + b, 2 * a + 2 * b)]
    least = min(orders, key=lambda k: float(numbers[k].mid()))
    zero = flint().arb(0)
    terms = []
    for c, e in zip(coefficients, orders, strict=True):
        same = e == least
        order = zero if same else numbers[e] - numbers[least]
        moved = zero if same else slopes[e] - slopes[least]
        terms.append(_Term(numbers[c], order, slopes[c], moved))
    return EnclosedSum(tuple(terms[:a])), EnclosedSum(tuple(terms[a:]))


class EnclosedPoint:
    """The equations and their derivatives over one box.

    Parameters
    ----------
    model : EnclosedModel
        The model.
    x, p, dp : lists of arb
        States and outputs, parameters and their derivative by the active one.
    """

    def __init__(self, model: EnclosedModel, x: list[arb], p: list[arb], dp: list[arb]) -> None:
        self.model, self.x, self.p, self.dp = model, x, p, dp
        self.laws = model.laws(p, dp)
        self._units = [
            [flint().arb(int(i == j)) for i in range(model.size)] for j in range(model.size)
        ]

    @cached_property
    def core_x(self) -> Matrix:
        """Derivative (size, size) of the compiled core."""
        return self.model.jacobian(self.x, self.p)

    @cached_property
    def gains(self) -> tuple[list[arb], list[arb]]:
        """Static factors of each row: of the core, and of the unknown itself."""
        one, zero = flint().arb(1), flint().arb(0)
        ny = self.model.ny
        right = [one] * ny + [n.at_zero for n in self.laws.n]
        return right, [zero] * ny + [d.at_zero for d in self.laws.d]

    @cached_property
    def gain_slopes(self) -> tuple[list[arb], list[arb]]:
        """Derivatives of `gains` by the active parameter."""
        zeros = [flint().arb(0)] * self.model.ny
        right = zeros + [n.at_zero_along for n in self.laws.n]
        return right, zeros + [d.at_zero_along for d in self.laws.d]

    @cached_property
    def core(self) -> list[arb]:
        """The compiled core (size,)."""
        return cast("list[arb]", self.model.call("core", self.p, self.x))

    def equilibrium(self) -> list[arb]:
        """Return the equilibrium equations (size,)."""
        right, left = self.gains
        parts = zip(right, self.core, left, self.x, strict=True)
        return [n * f - d * x for n, f, d, x in parts]

    def equilibrium_x(self) -> Matrix:
        """Return the derivative (size, size) of the equilibrium equations."""
        right, left = self.gains
        rows = [[n * entry for entry in row] for n, row in zip(right, self.core_x, strict=True)]
        for k, d in enumerate(left):
            rows[k][k] = rows[k][k] - d
        return rows

    def equilibrium_p(self) -> list[arb]:
        """Return the derivative (size,) of the equilibrium equations by the active parameter."""
        moved = self.model.call("core_p", self.p, self.x, self.dp)
        right, (n_p, d_p) = self.gains[0], self.gain_slopes
        columns = zip(right, moved, n_p, self.core, d_p, self.x, strict=True)
        return [n * f_p + a * f - b * x for n, f_p, a, f, b, x in columns]

    def turned(self, v: Sequence[Number]) -> list[Number]:
        """Return core_x v (size,)."""
        return [_dot(row, v) for row in self.core_x]

    def bent(self, v: Sequence[Number]) -> list[list[Number]]:
        """Return the derivatives of core_x v by each state, (size of them, size)."""
        return [self.model.call("core_xx", self.p, self.x, v, unit) for unit in self._units]

    def shifted(self, v: Sequence[Number]) -> list[Number]:
        """Return the derivative of core_x v by the active parameter, (size,)."""
        return self.model.call("core_xp", self.p, self.x, v, self.dp)


def _dot(one: Sequence[Number], two: Sequence[Number]) -> Number:
    return sum((a * b for a, b in zip(one, two, strict=True)), flint().arb(0))


def solve_bordered(
    matrix: Sequence[Sequence[Number]], below: Sequence[complex], beside: Sequence[complex]
) -> tuple[list[acb], list[acb], acb]:
    """Solve ``[M b; c 0] [v; g] = [0; 1]`` and the transposed system over a box.

    Parameters
    ----------
    matrix : (n, n)
        M.
    below, beside : (n,)
        c and b, exact numbers.

    Returns
    -------
    (list, list, acb)
        v, the transposed system's w, and g. M is singular exactly where g is zero, and g's
        derivative is ``-w . (dM v)`` (W. Govaerts, *Numerical Methods for Bifurcations of Dynamical
        Equilibria*, SIAM 2000, section 3.2).

    Raises
    ------
    UnboundedError
        If the bordered matrix may be singular in the box.
    """
    package, n = flint(), len(matrix)
    rows = [[*row, package.acb(b)] for row, b in zip(matrix, beside, strict=True)]
    rows.append([*(package.acb(c) for c in below), package.acb(0)])
    last = package.acb_mat(n + 1, 1, [0] * n + [1])
    whole = package.acb_mat(rows)
    try:
        # Preconditioned: plain elimination widens the boxes a thousand times as much.
        right = whole.solve(last, algorithm="precond")
        left = whole.transpose().solve(last, algorithm="precond")
    except ZeroDivisionError:
        msg = "the bordered characteristic matrix may be singular in the box"
        raise UnboundedError(msg) from None
    v = [right[k, 0] for k in range(n)]
    return v, [left[k, 0] for k in range(n)], cast("acb", finite(right[n, 0]))
