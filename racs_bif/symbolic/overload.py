"""Numbers that overload arithmetic, so that a plain Python function can be run on them.

`Overloaded` gives a class the operators and methods by which Python, `math` (see
`racs_bif.symbolic.rebinding`) and numpy reach a number; the class itself says what a few primitive
operations mean. Whatever the compiled core has no operation for is composed here, once.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from typing import Any, Final, NoReturn

import numpy as np

from racs_bif.symbolic.kernels import SCALAR

Function = Callable[..., Any]


class NotTraceable(TypeError):  # noqa: N818 - says what is the matter with an operation
    """An operation that cannot be recorded; its message says which and why."""


class Overloaded:
    """A number that is not a float: the base of such classes.

    Not made by `abc`, whose tests of instances would take most of the time. Two numbers of one
    class, or one and a float, meet in `primitive`; comparisons give what `compare` returns.
    """

    __slots__ = ()

    def primitive(self, name: str, *args: Any) -> Any:  # noqa: ANN401 - a number of this class
        """Return an operation of the core: `add` ... `pow`, or the name of a function."""
        raise NotImplementedError

    def compare(self, name: str, a: Any, b: Any) -> Any:  # noqa: ANN401 - condition or bool
        """Return ``a < b`` and its like, by the names of `racs_bif.symbolic.graph.COMPARISONS`."""
        raise NotImplementedError

    def __array_ufunc__(
        self, ufunc: np.ufunc, method: str, *inputs: object, **options: object
    ) -> object:
        """Run a numpy function on numbers of this class, also inside arrays."""
        rule = FUNCTIONS.get(ALIASES.get(ufunc.__name__, ufunc.__name__))
        if rule is None or method != "__call__" or options:
            what = f"numpy.{ufunc.__name__}" + (f".{method}" if method != "__call__" else "")
            what += " into an array of floats" if "out" in options else ""
            msg = f"{what} cannot be differentiated here"
            raise NotTraceable(msg)
        return elementwise(rule, *inputs)

    def __float__(self) -> NoReturn:
        """Refuse: what follows would not be recorded."""
        msg = "a state or parameter is turned into a plain number"
        raise NotTraceable(msg)

    __int__ = __index__ = __complex__ = __round__ = __trunc__ = __floor__ = __ceil__ = __float__

    def __pos__(self) -> Overloaded:
        return self

    def __neg__(self) -> Any:  # noqa: ANN401
        return self.primitive("neg", self)

    def __abs__(self) -> Any:  # noqa: ANN401
        return self.primitive("fabs", self)

    def conjugate(self) -> Overloaded:
        """Return the number: it is real."""
        return self

    def item(self) -> Overloaded:
        """Return the number, as numpy's own numbers do."""
        return self


def _forward(name: str) -> Function:
    rule = FUNCTIONS[name]

    def method(self: Overloaded, other: object) -> object:
        if isinstance(other, _SINGLE):
            return rule(self, other)
        return elementwise(rule, self, other) if isinstance(other, np.ndarray) else NotImplemented

    return method


def _backward(name: str) -> Function:
    rule = FUNCTIONS[name]

    def method(self: Overloaded, other: object) -> object:
        if isinstance(other, _SINGLE):
            return rule(other, self)
        return elementwise(rule, other, self) if isinstance(other, np.ndarray) else NotImplemented

    return method


def _method(name: str) -> Function:
    rule = FUNCTIONS[name]

    def method(self: Overloaded) -> object:
        return rule(self)

    return method


_SINGLE: Final = (Overloaded, float, int, np.number, np.bool_)
"""Numbers that are no arrays."""


def elementwise(rule: Function, *inputs: Any) -> Any:  # noqa: ANN401 - numbers or arrays
    """Return a function of numbers, applied to every element where there are arrays."""
    if not any(isinstance(a, np.ndarray | list | tuple) for a in inputs):
        return rule(*inputs)
    boxes = []
    for a in inputs:
        box = np.empty((), dtype=object)
        if isinstance(a, Overloaded):
            box[()] = a
        else:
            box = np.asarray(a, dtype=object)
        boxes.append(box)
    return np.frompyfunc(rule, len(boxes), 1)(*boxes)


def _core(name: str, plain: Function) -> Function:
    """Return a primitive as a function of numbers of which some may be floats."""

    def function(*args: Any) -> Any:  # noqa: ANN401
        for a in args:
            if isinstance(a, Overloaded):
                return a.primitive(name, *args)
        return plain(*args)

    return function


def _comparison(name: str, plain: Function) -> Function:
    def function(a: Any, b: Any) -> Any:  # noqa: ANN401
        owner = a if isinstance(a, Overloaded) else b
        return owner.compare(name, a, b) if isinstance(owner, Overloaded) else plain(a, b)

    return function


def where(condition: Any, a: Any, b: Any) -> Any:  # noqa: ANN401
    """Return `a` where the condition holds and `b` elsewhere."""
    chosen = getattr(condition, "choose", None)
    if chosen is not None:
        return chosen(a, b)
    return a if condition else b


def _sign(x: Any) -> Any:  # noqa: ANN401
    return _CORE["sign"](x)


def _greatest(a: Any, b: Any) -> Any:  # noqa: ANN401
    return where(_COMPARED["ge"](a, b), a, b)


def _least(a: Any, b: Any) -> Any:  # noqa: ANN401
    return where(_COMPARED["le"](a, b), a, b)


def _log(x: Any, base: float | None = None) -> Any:  # noqa: ANN401
    value = _CORE["log"](x)
    return value if base is None else value / _CORE["log"](base)


def _arctan2(y: Any, x: Any) -> Any:  # noqa: ANN401
    above, below = _COMPARED["gt"](y, 0.0), _COMPARED["lt"](y, 0.0)
    on_axis = where(_COMPARED["lt"](x, 0.0), math.pi, 0.0)
    atan = _CORE["atan"]
    beside = where(
        above,
        0.5 * math.pi - atan(_quotient(x, y)),
        where(below, -0.5 * math.pi - atan(_quotient(x, y)), on_axis),
    )
    return where(_COMPARED["gt"](x, 0.0), atan(_quotient(y, x)), beside)


def _quotient(a: Any, b: Any) -> Any:  # noqa: ANN401
    """Return a / b; infinite where b vanishes, for a branch that is not taken there."""
    if isinstance(a, Overloaded) or isinstance(b, Overloaded) or b != 0.0:
        return _CORE["div"](a, b)
    return math.inf


def _heaviside(x: Any, at_zero: Any) -> Any:  # noqa: ANN401
    beyond = where(_COMPARED["gt"](x, 0.0), 1.0, at_zero)
    return where(_COMPARED["lt"](x, 0.0), 0.0, beyond)


def _log_sum(a: Any, b: Any) -> Any:  # noqa: ANN401
    return _greatest(a, b) + _log(1.0 + _CORE["exp"](-_CORE["fabs"](a - b)))


_CORE: Final[dict[str, Function]] = {
    "add": _core("add", operator.add),
    "sub": _core("sub", operator.sub),
    "mul": _core("mul", operator.mul),
    "div": _core("div", operator.truediv),
    "pow": _core("pow", operator.pow),
    "neg": _core("neg", operator.neg),
} | {
    name: _core(name, getattr(SCALAR, name))
    for name in (
        *("exp", "log", "sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh"),
        *("tanh", "asinh", "acosh", "atanh", "erf", "fabs", "sign"),
    )
}
_COMPARED: Final = {
    name: _comparison(name, getattr(operator, name)) for name in ("lt", "le", "gt", "ge")
} | {"eq": _comparison("eq", operator.eq), "ne": _comparison("ne", operator.ne)}
FUNCTIONS: Final[dict[str, Function]] = (
    _CORE
    | _COMPARED
    | {
        "log": _log,
        "positive": lambda x: x,
        "square": lambda x: x * x,
        "reciprocal": lambda x: 1.0 / x,
        "cbrt": lambda x: _sign(x) * _CORE["fabs"](x) ** (1.0 / 3.0),
        "exp2": lambda x: _CORE["exp"](x * math.log(2.0)),
        "expm1": lambda x: _CORE["exp"](x) - 1.0,
        "log1p": lambda x: _log(1.0 + x),
        "log2": lambda x: _log(x) * (1.0 / math.log(2.0)),
        "log10": lambda x: _log(x) * (1.0 / math.log(10.0)),
        "logaddexp": _log_sum,
        "expit": lambda x: 1.0 / (1.0 + _CORE["exp"](-x)),
        "hypot": lambda x, y: _CORE["sqrt"](x * x + y * y),
        "atan2": _arctan2,
        "maximum": _greatest,
        "minimum": _least,
        "heaviside": _heaviside,
        "radians": lambda x: x * (math.pi / 180.0),
        "degrees": lambda x: x * (180.0 / math.pi),
        "conjugate": lambda x: x,
        "where": where,
        "clip": lambda x, low, high: _least(_greatest(x, low), high),
    }
)
"""Functions of numbers of which any may be overloaded."""
ALIASES: Final = {
    **{"subtract": "sub", "multiply": "mul", "divide": "div", "true_divide": "div"},
    **{"power": "pow", "float_power": "pow", "negative": "neg", "absolute": "fabs", "abs": "fabs"},
    **{"arcsin": "asin", "arccos": "acos", "arctan": "atan", "arctan2": "atan2"},
    **{"arcsinh": "asinh", "arccosh": "acosh", "arctanh": "atanh", "conj": "conjugate"},
    **{"less": "lt", "less_equal": "le", "greater": "gt", "greater_equal": "ge"},
    **{"equal": "eq", "not_equal": "ne", "fmax": "maximum", "fmin": "minimum"},
    **{"deg2rad": "radians", "rad2deg": "degrees"},
}
"""What numpy, `math` and scipy call them."""

for _name in ("add", "sub", "mul", "pow"):
    setattr(Overloaded, f"__{_name}__", _forward(_name))
    setattr(Overloaded, f"__r{_name}__", _backward(_name))
for _name, _made in (("__truediv__", _forward("div")), ("__rtruediv__", _backward("div"))):
    setattr(Overloaded, _name, _made)
for _name in _COMPARED:
    setattr(Overloaded, f"__{_name}__", _forward(_name))
# numpy reaches the elements of arrays of objects through methods of its own names.
_UNARY = [name for name in _CORE if name not in {"add", "sub", "mul", "div", "pow", "neg"}]
_UNARY += ["cbrt", "exp2", "expm1", "log1p", "log2", "log10", "degrees", "radians"]
for _name in _UNARY:
    setattr(Overloaded, _name, _method(_name))
for _alias in ("arcsin", "arccos", "arctan", "arcsinh", "arccosh", "arctanh", "deg2rad", "rad2deg"):
    setattr(Overloaded, _alias, _method(ALIASES[_alias]))
