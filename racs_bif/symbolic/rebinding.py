"""A copy of a Python function in which `math` and numpy take overloaded numbers.

``math.sin`` turns its argument into a float, ``numpy.zeros`` makes arrays that hold nothing else.
The copy shares the function's code; only the names by which it finds `math`, numpy, ``min`` and
``max`` lead elsewhere. Nothing of the user's is changed.
"""

from __future__ import annotations

import builtins
import functools
import math
import sys
from collections.abc import Callable
from types import CellType, FunctionType, MethodType, ModuleType
from typing import Any, Final

import numpy as np

from racs_bif.symbolic.overload import ALIASES, FUNCTIONS, Overloaded, elementwise

_KEPT: Final = {*sys.stdlib_module_names, "numpy", "scipy", "sympy", "racs_bif"}
"""Packages whose functions are left as they are."""
_FILES: Final = tuple(f"racs_bif.shelf.{kind}." for kind in ("files", "models", "analyses"))
"""Modules that are files of users after all."""
_MAKERS: Final = ("zeros", "ones", "empty", "full", "zeros_like", "ones_like", "empty_like")
_FLOATS: Final = (float, np.float64, "float", "float64", "d", "f8")


def rebind(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a copy of a function for overloaded numbers; what is no Python function passes."""
    copy: Callable[..., Any] = _Rebinding().function(function)
    return copy


class _Rebinding:
    def __init__(self) -> None:
        self._functions: dict[int, FunctionType] = {}
        self._globals: dict[int, dict[str, Any]] = {}

    def function(self, value: Any) -> Any:  # noqa: ANN401 - anything that can be called
        """Return the copy of something callable."""
        if isinstance(value, FunctionType):
            return self._copied(value)
        if isinstance(value, MethodType):
            return MethodType(self.function(value.__func__), value.__self__)
        if isinstance(value, functools.partial):
            return functools.partial(self.function(value.func), *value.args, **value.keywords)
        own = vars(type(value)).get("__call__")
        if isinstance(own, FunctionType):
            return MethodType(self.function(own), value)
        return value

    def _copied(self, function: FunctionType) -> FunctionType:
        done = self._functions.get(id(function))
        if done is not None:
            return done
        module = function.__module__ or ""
        if module.partition(".")[0] in _KEPT and not module.startswith(_FILES):
            return function
        cells = function.__closure__
        closure = None if cells is None else tuple(CellType() for _ in cells)
        copy = FunctionType(
            function.__code__,
            self._scope(function.__globals__),
            function.__name__,
            function.__defaults__,
            closure,
        )
        copy.__kwdefaults__ = function.__kwdefaults__
        self._functions[id(function)] = copy
        for old, new in zip(cells or (), closure or (), strict=True):
            try:
                new.cell_contents = self._value(old.cell_contents)
            except ValueError:  # an empty cell stays empty
                continue
        return copy

    def _scope(self, scope: dict[str, Any]) -> dict[str, Any]:
        done = self._globals.get(id(scope))
        if done is None:
            done = self._globals[id(scope)] = dict(scope)
            for name, value in scope.items():
                done[name] = self._value(value)
            for name, shim in _BUILTINS.items():
                done.setdefault(name, shim)
        return done

    def _value(self, value: Any) -> Any:  # noqa: ANN401 - anything a name may lead to
        if value is math:
            return _MATH
        if value is np:
            return _NUMPY
        if isinstance(value, FunctionType):
            return self._copied(value)
        return _BARE.get(value, value) if type(value) in _BARE_TYPES else value


def _is_overloaded(value: object) -> bool:
    if isinstance(value, np.ndarray):
        return bool(value.dtype == object)
    if isinstance(value, list | tuple):
        return any(map(_is_overloaded, value))
    return isinstance(value, Overloaded) or hasattr(value, "choose")


def _either(rule: Callable[..., Any], plain: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function that takes overloaded numbers, and leaves all others to `plain`."""

    @functools.wraps(plain, assigned=("__name__", "__doc__"), updated=())
    def function(*args: Any, **options: Any) -> Any:  # noqa: ANN401
        if options or not any(map(_is_overloaded, args)):
            return plain(*args, **options)
        return elementwise(rule, *args)

    return function


class _Shim(ModuleType):
    """A module some of whose functions are ours.

    Parameters
    ----------
    module : module
        Where all others are found.
    own : dict of str to callable
        Ours.
    """

    def __init__(self, module: ModuleType, own: dict[str, Callable[..., Any]]) -> None:
        super().__init__(module.__name__)
        self.__dict__.update(own)
        self.__dict__["_module"] = module

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401
        return getattr(self.__dict__["_module"], name)


def _functions_of(module: ModuleType) -> dict[str, Callable[..., Any]]:
    names = [*FUNCTIONS, *ALIASES, "fabs", "pow"]
    own = {}
    for name in dict.fromkeys(names):
        plain = getattr(module, name, None)
        if callable(plain):
            own[name] = _either(FUNCTIONS[ALIASES.get(name, name)], plain)
    return own


def _made(name: str) -> Callable[..., Any]:
    plain = getattr(np, name)

    def maker(*args: Any, **options: Any) -> Any:  # noqa: ANN401
        """Make an array that may hold any number."""
        made = plain(*args, **options)
        return made.astype(object) if made.dtype == float else made

    return maker


def _array(name: str) -> Callable[..., Any]:
    plain = getattr(np, name)

    def maker(values: Any, *args: Any, **options: Any) -> Any:  # noqa: ANN401
        """Make an array; what holds overloaded numbers holds objects."""
        if not _is_overloaded(values):
            return plain(values, *args, **options)
        args = tuple(a for a in args if a not in _FLOATS)
        options = {k: v for k, v in options.items() if k != "dtype" or v not in _FLOATS}
        return plain(values, *args, **options)

    return maker


def _extreme(name: str) -> Callable[..., Any]:
    plain, rule = getattr(builtins, name), FUNCTIONS[f"{name}imum"]

    def extreme(*args: Any, **options: Any) -> Any:  # noqa: ANN401
        values = list(args[0]) if len(args) == 1 else list(args)
        if options or not any(map(_is_overloaded, values)):
            return plain(*args, **options)
        return functools.reduce(rule, values)

    return extreme


_BUILTINS: Final = {"min": _extreme("min"), "max": _extreme("max")}
_MATH: Final = _Shim(math, _functions_of(math))
_NUMPY: Final = _Shim(
    np,
    _functions_of(np)
    | {name: _made(name) for name in _MAKERS}
    | {name: _array(name) for name in ("array", "asarray")},
)
_BARE_TYPES: Final = (type(math.sin), np.ufunc, type(np.where))
_BARE: Final = {
    plain: shim.__dict__[name]
    for shim, module in ((_MATH, math), (_NUMPY, np))
    for name, plain in vars(module).items()
    if name in shim.__dict__ and isinstance(plain, _BARE_TYPES)
}
"""Functions that were imported by their own names."""
