"""The exact model on intervals: balls of real and complex numbers that enclose every true value.

The text of a compiled model names its elementary functions, so that it runs on balls as it runs on
floats; the arithmetic is Arb's (F. Johansson, *Arb: efficient arbitrary-precision midpoint-radius
interval arithmetic*, IEEE Transactions on Computers 66, 2017), from the package python-flint. What
is enclosed are the model's own equations at parameters that are exact doubles. Constants in the
text that are no short binary fractions were rounded when the model was compiled; they count as
balls of relative radius 2**-50.
"""

from __future__ import annotations

import math
from contextlib import contextmanager
from functools import lru_cache
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, NoReturn, cast

from racs_bif.errors import ConvergenceError, UsageError
from racs_bif.symbolic.graph import UNARY

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from types import ModuleType

    from flint import acb, arb

    Number = arb | acb

BITS = 128
"""Working precision."""
_SHORT = 2.0**30
_ROUNDED = 2.0**-50


class UnboundedError(ConvergenceError):
    """A quantity that has no enclosure over a box: the box has to be smaller."""


def flint() -> ModuleType:
    """Return the package python-flint.

    Raises
    ------
    UsageError
        If it is not installed.
    """
    try:
        import flint as package
    except ImportError as error:
        msg = "proofs need the package python-flint: pip install 'racs-bif[proof]'"
        raise UsageError(msg) from error
    return package


@contextmanager
def working_precision() -> Iterator[None]:
    """Compute with `BITS` bits in the block, and with what there was before after it."""
    context = flint().ctx
    before = context.prec
    context.prec = BITS
    try:
        yield
    finally:
        context.prec = before


@lru_cache(maxsize=4096)
def _constant(value: float) -> arb:
    """Return a number of the compiled text with its rounding; short ones have none."""
    ball: arb = flint().arb(value)
    mantissa = math.frexp(value)[0] * _SHORT
    if mantissa != int(mantissa):
        ball = flint().arb(value, abs(value) * _ROUNDED)
    return ball


class Ball:
    """A real or complex ball as the compiled text wants it: what is undecided is an error.

    A comparison of balls that overlap would be true at some points and false at others.

    Parameters
    ----------
    ball : arb or acb
        The number.
    """

    __slots__ = ("ball",)

    def __init__(self, ball: Number) -> None:
        self.ball = ball

    def __add__(self, other: Ball | float) -> Ball:
        """Return the sum."""
        return Ball(self.ball + _raw(other))

    __radd__ = __add__

    def __sub__(self, other: Ball | float) -> Ball:
        """Return the difference."""
        return Ball(self.ball - _raw(other))

    def __rsub__(self, other: float) -> Ball:
        """Return the difference."""
        return Ball(_raw(other) - self.ball)

    def __mul__(self, other: Ball | float) -> Ball:
        """Return the product."""
        return Ball(self.ball * _raw(other))

    __rmul__ = __mul__

    def __truediv__(self, other: Ball | float) -> Ball:
        """Return the quotient."""
        return Ball(self.ball / _raw(other))

    def __rtruediv__(self, other: float) -> Ball:
        """Return the quotient."""
        return Ball(_raw(other) / self.ball)

    def __neg__(self) -> Ball:
        """Return the negative."""
        return Ball(-self.ball)

    def __lt__(self, other: Ball | float) -> bool:
        """Decide whether all of it is less."""
        one, two = _real(self), _real(other)
        return _decided(one < two, one >= two)

    def __le__(self, other: Ball | float) -> bool:
        """Decide whether all of it is at most the other."""
        one, two = _real(self), _real(other)
        return _decided(one <= two, one > two)

    def __gt__(self, other: Ball | float) -> bool:
        """Decide whether all of it is greater."""
        return not self <= other

    def __ge__(self, other: Ball | float) -> bool:
        """Decide whether all of it is at least the other."""
        return not self < other

    def __eq__(self, other: object) -> bool:
        """Decide whether both are the same single number."""
        if not isinstance(other, Ball | float | int):
            return NotImplemented
        one, two = _real(self), _real(other)
        return _decided(one == two, not one.overlaps(two))

    def __ne__(self, other: object) -> bool:
        """Decide whether they have nothing in common."""
        return not self == other

    __hash__ = None  # type: ignore[assignment]


def _raw(value: Ball | float) -> Number:
    return value.ball if isinstance(value, Ball) else _constant(float(value))


def _real(value: Ball | float) -> arb:
    return cast("arb", _raw(value))


def _decided(yes: object, no: object) -> bool:
    if bool(yes) == bool(no):
        msg = "a condition in the equations holds in one part of the box only"
        raise UnboundedError(msg)
    return bool(yes)


def _unary(name: str) -> Callable[[Ball | float], Ball]:
    method = {"fabs": "__abs__", "sign": "sgn"}.get(name, name)

    def function(x: Ball | float) -> Ball:
        raw = _real(x)
        if name == "sign":
            _decided(raw == 0 or raw > 0 or raw < 0, no=False)
        return Ball(getattr(raw, method)())

    return function


def _pow(a: Ball | float, b: Ball | float) -> Ball:
    return Ball(_raw(a) ** _raw(b))


def _absorb(a: Ball | float, b: Ball | float) -> Ball:
    raw = _raw(b)
    return Ball(raw if raw == 0 else _raw(a) * raw)


def _not_enclosed(*_: object) -> NoReturn:
    msg = "nothing can be proved of equations that call a Python function; write them as strings"
    raise UsageError(msg)


BALLS = SimpleNamespace(
    **{name: _unary(name) for name in UNARY},
    pow=_pow,
    where=lambda condition, a, b: a if condition else b,
    absorb=_absorb,
    both=lambda a, b: a and b,
    either=lambda a, b: a or b,
    negated=lambda a: not a,
    call=_not_enclosed,
)
"""Elementary functions of balls."""


class BallFunctions:
    """The functions of compiled modules on balls.

    Parameters
    ----------
    *texts : str
        The modules.
    """

    def __init__(self, *texts: str) -> None:
        self._functions: dict[str, Callable[..., Any]] = {}
        for text in texts:
            namespace: dict[str, Any] = {}
            exec(compile(text, "<racs_bif balls>", "exec"), namespace)  # our own text
            self._functions |= namespace["make"](BALLS)

    def __call__(self, name: str, p: Sequence[Number], *groups: Sequence[Number]) -> list[Number]:
        """Evaluate a function.

        Parameters
        ----------
        name : str
            Which.
        p : sequence of arb
            Parameters.
        *groups : sequences of arb or acb
            The other arguments.

        Returns
        -------
        list of arb or acb
            Enclosures of the values at all points of the arguments.

        Raises
        ------
        UnboundedError
            If one is not finite, or a condition in the equations is undecided.
        """
        constants = self._functions[f"{name}_prepare"]([Ball(x) for x in p])
        results = self._functions[name](constants, *([Ball(x) for x in g] for g in groups))
        return [finite(_raw(x)) for x in results]


def finite(ball: Number) -> Number:
    """Return a ball as it is.

    Raises
    ------
    UnboundedError
        If it is not finite.
    """
    if not ball.is_finite():
        msg = "the equations are not finite everywhere in the box"
        raise UnboundedError(msg)
    return ball
