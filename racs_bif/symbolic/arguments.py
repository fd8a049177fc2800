"""How a plain Python right-hand side is called, and what it may return.

Its arguments are known by their names: those of states, parameters and elements' outputs are given
these numbers, ``t`` or ``time`` the time, the first other one the states as an array, the second
other one all parameters, to be had as ``p.k``, ``p["k"]`` or ``k1, k2 = p``.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from racs_bif.errors import ModelError, nearest
from racs_bif.symbolic.overload import Overloaded

TIME: Final = "t"
"""Name under which the time is given."""
_TIMES: Final = ("t", "time")
_VECTOR, _PARAMETERS = "(states)", "(parameters)"


class Values:
    """Numbers by name: ``p.k``, ``p["k"]``, ``p[0]``, ``k1, k2 = p``, ``**p``.

    Parameters
    ----------
    numbers : mapping of str to number
        The numbers, in their order.
    """

    def __init__(self, numbers: Mapping[str, Any]) -> None:
        self._numbers = dict(numbers)

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401 - a number
        if name.startswith("_") and name not in self.__dict__.get("_numbers", {}):
            raise AttributeError(name)
        try:
            return self._numbers[name]
        except KeyError:
            msg = f"there is no parameter '{name}'; {nearest(name, self._numbers)}"
            raise AttributeError(msg) from None

    def __getitem__(self, key: Any) -> Any:  # noqa: ANN401 - a name, an index or a slice
        if not isinstance(key, str):
            return list(self._numbers.values())[key]
        try:
            return self._numbers[key]
        except KeyError:
            msg = f"there is no parameter '{key}'; {nearest(key, self._numbers)}"
            raise KeyError(msg) from None

    def __iter__(self) -> Iterator[Any]:
        return iter(self._numbers.values())

    def __len__(self) -> int:
        return len(self._numbers)

    def __contains__(self, name: object) -> bool:
        return name in self._numbers

    def keys(self) -> list[str]:
        """Return the names."""
        return list(self._numbers)

    def get(self, name: str, default: Any = None) -> Any:  # noqa: ANN401 - a number
        """Return a number by name, `default` where there is none."""
        return self._numbers.get(name, default)


@dataclass(frozen=True)
class Arguments:
    """How one function is called.

    Attributes
    ----------
    model, function : str
        Names, for messages.
    states, parameters, outputs : tuple of str
        Names of states, parameters and elements' outputs.
    places : tuple of (str, str)
        Every argument's own name and the name of what it is given.
    by_name : bool
        Whether the arguments can be passed by name only.
    rest : bool
        Whether it takes all else by name too (``**values``).
    """

    model: str
    function: str
    states: tuple[str, ...]
    parameters: tuple[str, ...]
    outputs: tuple[str, ...]
    places: tuple[tuple[str, str], ...]
    keywords: tuple[str, ...]
    rest: bool

    @property
    def names(self) -> tuple[str, ...]:
        """States, parameters and outputs, in the order of the numbers that a call needs."""
        return (*self.states, *self.parameters, *self.outputs)

    def call(self, function: Callable[..., Any], given: Mapping[str, Any]) -> Any:  # noqa: ANN401
        """Call the function with numbers by name; the time is one of them where it is asked for."""
        positional, named = [], {}
        for own, source in self.places:
            if source == _VECTOR:
                value: Any = _array([given[name] for name in self.states])
            elif source == _PARAMETERS:
                value = Values({name: given[name] for name in self.parameters})
            else:
                value = given[source]
            if own in self.keywords:
                named[own] = value
            else:
                positional.append(value)
        if self.rest:
            told = {source for _, source in self.places}
            named |= {name: given[name] for name in self.names if name not in told}
        return function(*positional, **named)

    def listed(self, returned: Any) -> list[Any]:  # noqa: ANN401 - anything
        """Return the numbers of a result in the order of the states.

        Raises
        ------
        ModelError
            If it is of another length or kind.
        """
        n = len(self.states)
        if isinstance(returned, Mapping):
            return self._from_mapping(returned)
        if isinstance(returned, np.ndarray):
            if max(returned.shape, default=1) != returned.size:
                self._refuse(f"an array of shape {returned.shape}", f"return ({n},)")
            values = list(returned.ravel())
        elif isinstance(returned, Overloaded | int | float | complex | np.number):
            values = [returned]
        elif returned is None:
            self._refuse("nothing", f"end it with 'return [...]', {n} numbers")
        elif isinstance(returned, str | bytes) or not hasattr(returned, "__iter__"):
            if hasattr(returned, "choose"):
                return [returned]
            self._refuse(f"{type(returned).__name__}", f"return a list of {n} numbers")
        else:
            values = [_unboxed(value) for value in returned]
        if len(values) != n:
            wanted = f"return {n}, one for each of {', '.join(self.states)}"
            self._refuse(f"{len(values)} number{'s' if len(values) != 1 else ''}", wanted)
        return values

    def _from_mapping(self, returned: Mapping[Any, Any]) -> list[Any]:
        for name in returned:
            if name not in self.states:
                hint = nearest(str(name), self.states)
                self._refuse(f"a rate of '{name}', which is no state", hint)
        for name in self.states:
            if name not in returned:
                self._refuse(f"no rate of '{name}'", "add it")
        return [_unboxed(returned[name]) for name in self.states]

    def _refuse(self, what: str, mend: str) -> None:
        msg = f"model '{self.model}': the function '{self.function}' returns {what}; {mend}"
        raise ModelError(msg)

    def floats(self, returned: Any) -> list[float]:  # noqa: ANN401 - anything
        """Return the numbers of a result as floats.

        Raises
        ------
        ModelError
            If one is complex or no number.
        """
        numbers = []
        for name, value in zip(self.states, self.listed(returned), strict=True):
            if isinstance(value, complex | np.complexfloating):
                if value.imag != 0.0:
                    what = f"a complex number for '{name}', {complex(value):.6g}"
                    self._refuse(what, "return real numbers")
                numbers.append(float(value.real))
                continue
            try:
                if isinstance(value, str | bytes):
                    raise TypeError
                numbers.append(float(value))
            except OverflowError:
                numbers.append(math.inf)
            except (TypeError, ValueError):
                self._refuse(f"{type(value).__name__} for '{name}'", "return a number")
        return numbers


def _array(values: Sequence[Any]) -> np.ndarray:
    if all(isinstance(v, float) for v in values):
        return np.array(values, dtype=float)
    if all(isinstance(v, float | complex) for v in values):
        return np.array(values, dtype=complex)
    array = np.empty(len(values), dtype=object)
    array[:] = values
    return array


def _unboxed(value: Any) -> Any:  # noqa: ANN401 - a number
    return (
        value[()]
        if isinstance(value, np.ndarray) and value.ndim == 0
        else (value.ravel()[0] if isinstance(value, np.ndarray) and value.size == 1 else value)
    )


def read_arguments(
    model: str,
    function: Callable[..., Any],
    states: Sequence[str],
    parameters: Sequence[str],
    outputs: Sequence[str],
    *,
    vector: bool = False,
) -> Arguments:
    """Find out how a function is called.

    Parameters
    ----------
    model : str
        The model's name.
    function : callable
        The function.
    states, parameters, outputs : sequence of str
        What there is to give.
    vector : bool
        Whether an argument that is called like the only state is an array all the same.

    Raises
    ------
    ModelError
        If an argument is none that can be given.
    """
    title = str(getattr(function, "__name__", type(function).__name__))
    try:
        signature = inspect.signature(function)
    except (TypeError, ValueError):
        msg = f"model '{model}': the arguments of '{title}' cannot be read; give a Python function"
        raise ModelError(msg) from None
    known = {*states, *parameters, *outputs}
    wanted = [
        a for a in signature.parameters.values() if a.kind not in {a.VAR_POSITIONAL, a.VAR_KEYWORD}
    ]
    rest = any(a.kind == a.VAR_KEYWORD for a in signature.parameters.values())
    own = [a.name for a in wanted]
    scalar = not vector and (rest or (bool(states) and set(states) <= set(own)))
    places: list[tuple[str, str]] = []
    free = [_PARAMETERS] if scalar else [_VECTOR, _PARAMETERS]
    for argument in wanted:
        name = argument.name
        if name in known and (scalar or name not in states):
            places.append((name, name))
        elif name in _TIMES and name not in known:
            places.append((name, TIME))
        elif argument.default is not argument.empty and name not in known:
            continue
        elif free:
            places.append((name, free.pop(0)))
        else:
            msg = (
                f"model '{model}': the argument '{name}' of the function '{title}' is neither a "
                f"state nor a parameter; {nearest(name, sorted(known))}"
            )
            raise ModelError(msg)
    if not scalar and _VECTOR not in {source for _, source in places} and states:
        msg = (
            f"model '{model}': the function '{title}' takes no states; "
            f"write it as {title}(x, p) or {title}({', '.join([*states, *parameters])})"
        )
        raise ModelError(msg)
    skipped = _first_skipped(wanted, {name for name, _ in places})
    keywords = tuple(
        a.name
        for k, a in enumerate(wanted)
        if a.kind == a.KEYWORD_ONLY or (k > skipped and a.kind == a.POSITIONAL_OR_KEYWORD)
    )
    names = tuple(states), tuple(parameters), tuple(outputs)
    return Arguments(model, title, *names, tuple(places), keywords, rest)


def _first_skipped(wanted: Sequence[inspect.Parameter], given: set[str]) -> int:
    """Return the place of the first argument that keeps its default: later ones go by name."""
    for k, argument in enumerate(wanted):
        if argument.name not in given:
            return k
    return len(wanted)
