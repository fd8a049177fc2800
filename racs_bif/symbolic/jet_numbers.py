"""Power series as the numbers that a plain Python function is run on."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any, Final

import numpy as np

from racs_bif.symbolic.jets import JETS, Jet
from racs_bif.symbolic.overload import NotTraceable, Overloaded


class JetNumber(Overloaded):
    """A power series that overloads all that `Overloaded` does.

    Comparisons are those of the constants, so that a function takes the branch it would take there.

    Parameters
    ----------
    jet : Jet
        The series.
    """

    __slots__ = ("jet",)

    def __init__(self, jet: Jet) -> None:
        self.jet = jet

    def __bool__(self) -> bool:
        return self.jet.base != 0.0

    def primitive(self, name: str, *args: Any) -> Any:  # noqa: ANN401 - numbers
        """Return an operation on series."""
        value = _OPERATIONS[name](*map(plain_jet, args))
        return JetNumber(value) if isinstance(value, Jet) else value

    def compare(self, name: str, a: Any, b: Any) -> bool:  # noqa: ANN401 - numbers
        """Compare the constants."""
        return bool(getattr(operator, name)(_constant(a), _constant(b)))


_OPERATIONS: Final[dict[str, Callable[..., Any]]] = {
    "add": operator.add,
    "sub": operator.sub,
    "mul": operator.mul,
    "div": operator.truediv,
    "neg": operator.neg,
    **{
        name: getattr(JETS, name)
        for name in (
            *("pow", "exp", "log", "sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "sinh"),
            *("cosh", "tanh", "asinh", "acosh", "atanh", "erf", "fabs", "sign"),
        )
    },
}


def plain_jet(value: Any) -> Any:  # noqa: ANN401 - a number
    """Return the jet of a number, or a float."""
    if isinstance(value, JetNumber):
        return value.jet
    if isinstance(value, bool | int | float | np.number | np.bool_) and np.isreal(value):
        return float(value.real)
    msg = f"{type(value).__name__} is no real number"
    raise NotTraceable(msg)


def _constant(value: Any) -> float:  # noqa: ANN401 - a number
    jet = plain_jet(value)
    return jet.base if isinstance(jet, Jet) else float(jet)
