"""A right-hand side that is called, because it cannot be recorded.

It stands in the compiled program as one operation of many results. Its derivatives come from
running it on power series, which are exact and follow the branches it takes, or, where it does
what no series can follow, from differences.
"""

from __future__ import annotations

import hashlib
import math
import pickle
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from types import CodeType, FunctionType
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from racs_bif.errors import ConvergenceError, ModelError, RacsBifError
from racs_bif.symbolic.arguments import TIME, Arguments
from racs_bif.symbolic.complaint import complaint, undefined
from racs_bif.symbolic.differences import derivative
from racs_bif.symbolic.jet_numbers import JetNumber, plain_jet
from racs_bif.symbolic.jets import Algebra, Jet, multilinear, total_degree
from racs_bif.symbolic.overload import NotTraceable
from racs_bif.symbolic.rebinding import rebind

if TYPE_CHECKING:
    from numpy.typing import NDArray

SERIES: Final = "series"
COMPLEX_STEP: Final = "complex step"
DIFFERENCES: Final = "differences"
_HIGHEST = 3
_MOST = 4096
"""Points at which results are remembered."""


@dataclass(frozen=True, eq=False)
class External:
    """A plain Python function as an operation of compiled programs.

    Parameters
    ----------
    function : callable
        The user's function.
    arguments : Arguments
        How it is called.
    derivatives : {"series", "complex step", "differences"}
        Where its derivatives come from.
    error : float
        Estimated relative error of its first derivatives; zero where they are exact.
    """

    function: Callable[..., Any]
    arguments: Arguments
    derivatives: str = SERIES
    error: float = 0.0
    _known: dict[Any, Any] = field(default_factory=dict, repr=False)

    @property
    def calls(self) -> dict[str, int]:
        """Names of its results in equations, and their places."""
        return {f"rate_of_{name}": k for k, name in enumerate(self.arguments.states)}

    @property
    def facts(self) -> dict[str, Any]:
        """What a compiled model tells of it."""
        return {
            "function": self.arguments.function,
            "derivatives": self.derivatives,
            "error": float(self.error),
            "digest": digest(self.function),
        }

    def __reduce__(self) -> tuple[type[External], tuple[Any, ...]]:
        """Pickle what makes it.

        Raises
        ------
        ModelError
            If the function cannot be found again in another process.
        """
        try:
            pickle.dumps(self.function)
        except (pickle.PicklingError, AttributeError, TypeError):
            msg = (
                f"model '{self.arguments.model}': the function '{self.arguments.function}' cannot "
                "be sent to another process; define it at the top level of a file"
            )
            raise ModelError(msg) from None
        return (External, (self.function, self.arguments, self.derivatives, self.error))

    def __call__(self, output: int, base: Sequence[Any], *directions: Sequence[Any]) -> Any:  # noqa: ANN401
        """Return one of its results, or a multilinear form of that result's derivatives.

        Parameters
        ----------
        output : int
            Which result.
        base : sequence of float, of arrays (N,) or of jets
            States, parameters and elements' outputs.
        *directions : sequences of the same length
            One for each derivative.
        """
        if any(isinstance(a, Jet) for a in base):
            return self._on_jets(base)[output]
        groups = (base, *directions)
        if all(not isinstance(a, np.ndarray) for group in groups for a in group):
            return self._known_values(base, directions)[output]
        return self._on_arrays(base, directions)[output]

    def _on_arrays(
        self, base: Sequence[Any], directions: Sequence[Sequence[Any]]
    ) -> list[NDArray[Any]]:
        """Return all results at many points; kept until other points are asked for."""
        flat = np.broadcast_arrays(*(a for group in (base, *directions) for a in group))
        table = np.array([a.ravel() for a in flat])
        key = (len(directions), table.dtype.str, table.tobytes())
        kept = self._known.get("arrays")
        if kept is None or kept[0] != key:
            size, rows = len(base), table.T.tolist()
            groups = [[tuple(r[k : k + size]) for k in range(0, len(r), size)] for r in rows]
            # Directions may be complex, points are not.
            points = [tuple(complex(a).real for a in g[0]) for g in groups]
            forms = zip(points, groups, strict=True)
            found = np.array([self._known_values(at, g[1:]) for at, g in forms])
            shape = (len(self.arguments.states), *flat[0].shape)
            kept = self._known["arrays"] = (key, list(found.T.reshape(shape)))
        results: list[NDArray[Any]] = kept[1]
        return results

    def _known_values(
        self, base: Sequence[Any], directions: Sequence[Sequence[Any]]
    ) -> NDArray[Any]:
        """Return results or forms at one point; values and gradients are kept."""
        if len(directions) == 1:
            gradient = self._remembered(("gradient", tuple(base)), lambda: self._gradient(base))
            return np.asarray(gradient @ np.array(directions[0]))
        key = (tuple(base), tuple(map(tuple, directions)))
        return self._remembered(key, lambda: self._values(base, directions))

    def _remembered(self, key: Any, compute: Callable[[], NDArray[Any]]) -> NDArray[Any]:  # noqa: ANN401
        found: NDArray[Any] | None = self._known.get(key)
        if found is None:
            if len(self._known) > _MOST:
                self._known.clear()
            found = self._known[key] = compute()
        return found

    def _gradient(self, base: Sequence[float]) -> NDArray[np.float64]:
        """Return the derivatives (outputs, arguments) by every argument."""
        n = len(base)
        if self.derivatives != SERIES:
            eye = np.eye(n)
            columns = [self._differenced(np.array(base), [eye[k]]) for k in range(n)]
            return np.array(columns).T.real
        algebra = total_degree(n, 1)
        rows = np.zeros((n, n + 1))
        rows[:, 0] = base
        for k in range(n):
            rows[k, algebra.index[_unit(k, n)]] = 1.0
        gradient = np.zeros((len(self.arguments.states), n))
        order = [algebra.index[_unit(k, n)] for k in range(n)]
        for row, result in zip(
            gradient, self._on_jets([Jet(algebra, r) for r in rows]), strict=True
        ):
            if isinstance(result, Jet):
                row[:] = result.c[order]
            elif not math.isfinite(result):
                row[:] = math.nan
        return gradient

    def _values(self, base: Sequence[float], directions: Sequence[Sequence[float]]) -> NDArray[Any]:
        if not directions:
            return self.floats(np.array(base))
        if self.derivatives != SERIES:
            return self._differenced(np.array(base), [np.array(d) for d in directions])
        algebra = multilinear(len(directions))
        last = [algebra.index[_unit(k, len(directions))] for k in range(len(directions))]
        jets = []
        for k, value in enumerate(base):
            moved = [d[k] for d in directions]
            c = np.zeros(len(algebra), dtype=complex if any(map(_imaginary, moved)) else float)
            c[0], c[last] = value, moved
            jets.append(Jet(algebra, c) if np.any(c[1:]) else value)
        results = self._on_jets(jets)
        return np.array([r.c[-1] if isinstance(r, Jet) else 0.0 * r for r in results])

    def _differenced(self, base: NDArray[Any], directions: list[NDArray[Any]]) -> NDArray[Any]:
        if len(directions) > _HIGHEST:
            msg = (
                f"derivatives of order {len(directions)} of '{self.arguments.function}' cannot be "
                "had by differences; write it so that it can be recorded"
            )
            raise ConvergenceError(msg)
        stepped = self.derivatives == COMPLEX_STEP
        plain = self.complexes if stepped else self.floats
        return derivative(plain, base, directions, complex_step=stepped)

    def floats(self, numbers: NDArray[Any], time: float = 0.0) -> NDArray[np.float64]:
        """Return the results at plain numbers, NaN where the function is undefined.

        Raises
        ------
        ModelError
            If the function fails, or returns what it must not.
        """
        with np.errstate(all="ignore"):
            try:
                return np.array(self.arguments.floats(self._called(numbers.tolist(), time=time)))
            except RacsBifError:
                raise
            except (Exception, SystemExit) as error:  # the user's: anything may come out of it
                if undefined(error):
                    return np.full(len(self.arguments.states), np.nan)
                raise ModelError(complaint(self.arguments, error, numbers)) from error

    def complexes(self, numbers: NDArray[Any]) -> NDArray[np.complex128]:
        """Return the results at complex numbers; NaN where the function is undefined."""
        with np.errstate(all="ignore"):
            try:
                listed = self.arguments.listed(self._called(numbers.tolist()))
            except ArithmeticError:
                return np.full(len(self.arguments.states), complex(math.nan, math.nan))
        return np.array([complex(value) for value in listed])

    def _called(
        self,
        numbers: Sequence[Any],
        function: Callable[..., Any] | None = None,
        time: float = 0.0,
    ) -> Any:  # noqa: ANN401 - whatever it returns
        given = {TIME: time, **dict(zip(self.arguments.names, numbers, strict=True))}
        return self.arguments.call(function or self.function, given)

    def _on_jets(self, base: Sequence[Any]) -> list[Any]:
        """Return the results as jets or floats."""
        algebra = next((a.algebra for a in base if isinstance(a, Jet)), None)
        if algebra is None:
            return list(self.floats(np.array(base)))
        if self.derivatives != SERIES:
            return self._taylor(base, algebra)
        numbers = [JetNumber(a) if isinstance(a, Jet) else a for a in base]
        if "rebound" not in self._known:
            self._known["rebound"] = rebind(self.function)
        try:
            listed = self.arguments.listed(self._called(numbers, self._known["rebound"]))
            return [plain_jet(value) for value in listed]
        except RacsBifError:
            raise
        except NotTraceable as error:
            msg = (
                f"model '{self.arguments.model}': '{self.arguments.function}' cannot be "
                f"differentiated here: {error}; give derivatives='differences'"
            )
            raise ModelError(msg) from error
        except (Exception, SystemExit) as error:  # the user's: anything may come out of it
            if undefined(error):
                return [math.nan] * len(self.arguments.states)
            at = np.array([a.base if isinstance(a, Jet) else a for a in base])
            raise ModelError(complaint(self.arguments, error, at)) from error

    def _taylor(self, base: Sequence[Any], algebra: Algebra) -> list[Any]:
        """Return the results on jets from differences: sum of F^(k)(small, ..., small) / k!."""
        if algebra.degree > _HIGHEST:
            msg = (
                f"a series of degree {algebra.degree} of '{self.arguments.function}' cannot be had "
                "by differences; write it so that it can be recorded"
            )
            raise ConvergenceError(msg)
        rows = np.array(
            [a.c if isinstance(a, Jet) else [a, *[0.0] * (len(algebra) - 1)] for a in base]
        )
        at = tuple(rows[:, 0].real.tolist())
        moving = [k for k in range(1, len(algebra)) if np.any(rows[:, k])]
        total = np.zeros((len(self.arguments.states), len(algebra)), dtype=rows.dtype)
        total[:, 0] = self._known_values(at, ())
        level: list[tuple[tuple[int, ...], int]] = [((), 0)]
        for order in range(1, algebra.degree + 1):
            level = [
                ((*chosen, k), place)
                for chosen, monomial in level
                for k in moving
                if (place := _product(algebra, monomial, k)) is not None
            ]
            for chosen, place in level:
                forms = self._known_values(at, [tuple(rows[:, k].tolist()) for k in chosen])
                total[:, place] += forms / math.factorial(order)
        return [Jet(algebra, row) for row in total]


def _product(algebra: Algebra, a: int, b: int) -> int | None:
    pair = zip(algebra.monomials[a], algebra.monomials[b], strict=True)
    return algebra.index.get(tuple(map(sum, pair)))


def _unit(k: int, n: int) -> tuple[int, ...]:
    return tuple(int(j == k) for j in range(n))


def _imaginary(number: complex) -> bool:
    return isinstance(number, complex)


def digest(function: object) -> str:
    """Return a digest of what a function computes: its code, and the values that it uses."""
    told = hashlib.sha256()
    _tell(function, told.update, set())
    return told.hexdigest()


def _tell(value: Any, say: Callable[[bytes], None], seen: set[int]) -> None:  # noqa: ANN401
    if isinstance(value, FunctionType):
        if id(value) not in seen:
            seen.add(id(value))
            _tell(_used(value), say, seen)
    elif isinstance(value, CodeType):
        say(value.co_code)
        say(repr((value.co_names, value.co_varnames)).encode())
        _tell(value.co_consts, say, seen)
    elif isinstance(value, tuple):
        for entry in value:
            _tell(entry, say, seen)
    elif isinstance(value, np.ndarray):
        say(value.tobytes())
    else:
        # What has no text of its own is told by its kind: its address would change every time.
        plain = isinstance(value, int | float | complex | str | bytes | type(None))
        say(repr(value).encode() if plain else type(value).__qualname__.encode())


def _used(function: FunctionType) -> tuple[Any, ...]:
    """Return a function's code and what it takes from around it."""
    scope, kinds = function.__globals__, FunctionType | int | float | str | tuple | np.ndarray
    around = [(n, scope[n]) for n in function.__code__.co_names if isinstance(scope.get(n), kinds)]
    inside = [cell.cell_contents for cell in function.__closure__ or ()]
    return (function.__code__, tuple(around), tuple(inside), function.__defaults__)
