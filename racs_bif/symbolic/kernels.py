"""Running emitted code: on floats for one point, on arrays for many."""

from __future__ import annotations

import math
from collections.abc import Callable
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from racs_bif.symbolic.graph import UNARY

if TYPE_CHECKING:
    from numpy.typing import NDArray


SCALAR: Final = SimpleNamespace(
    **UNARY,
    pow=math.pow,
    where=lambda condition, a, b: a if condition else b,
    absorb=lambda a, b: a * b if b else 0.0,
    both=lambda a, b: a and b,
    either=lambda a, b: a or b,
    negated=lambda a: not a,
)
"""Elementary functions of floats."""


def _array_erf(x: NDArray[np.float64]) -> NDArray[np.float64]:
    from scipy.special import erf

    return np.asarray(erf(x))


_NUMPY_NAMES: Final = {
    "asin": np.arcsin,
    "acos": np.arccos,
    "atan": np.arctan,
    "asinh": np.arcsinh,
    "acosh": np.arccosh,
    "atanh": np.arctanh,
    "erf": _array_erf,
}
ARRAY: Final = SimpleNamespace(
    **{name: _NUMPY_NAMES.get(name) or getattr(np, name) for name in UNARY},
    pow=lambda a, b: np.power(np.asarray(a, dtype=float), b),
    where=np.where,
    absorb=lambda a, b: np.where(np.equal(b, 0.0), 0.0, a * b),
    both=np.logical_and,
    either=np.logical_or,
    negated=np.logical_not,
)
"""Elementary functions of arrays."""

Functions = dict[str, Callable[..., Any]]


def build(
    text: str, name: str, call: Callable[..., Any] | None = None
) -> tuple[dict[str, Any], Functions, Functions]:
    """Execute the text of a compiled module, which may call an external function.

    Returns
    -------
    (dict, dict, dict)
        Its ``META``, its functions on floats and its functions on arrays.
    """
    namespace: dict[str, Any] = {}
    exec(compile(text, f"<racs_bif {name}>", "exec"), namespace)  # our own text
    make = namespace["make"]
    if call is None:
        return namespace["META"], make(SCALAR), make(ARRAY)
    scalar, array = ({**vars(kind), "call": call} for kind in (SCALAR, ARRAY))
    return namespace["META"], make(SimpleNamespace(**scalar)), make(SimpleNamespace(**array))


class Kernel:
    """One compiled function, with what depends on parameters only kept from call to call.

    Parameters
    ----------
    name : str
        Function name in the module.
    scalar, array : dict
        The functions of the module, on floats and on arrays.
    """

    def __init__(self, name: str, scalar: Functions, array: Functions) -> None:
        self._scalar = scalar[name]
        self._array = array[name]
        self._prepare_scalar = scalar[f"{name}_prepare"]
        self._prepare_array = array[f"{name}_prepare"]
        self._key: bytes | None = None
        self._constants: tuple[Any, ...] = ()

    def __call__(self, p: NDArray[Any], *groups: NDArray[Any]) -> NDArray[Any]:
        """Evaluate.

        Parameters
        ----------
        p : array (np,) or (np, N)
            Parameters.
        *groups : arrays (k,) or (k, N)
            The other arguments; N must be the same or left out.

        Returns
        -------
        array (outputs,) or (outputs, N)
            Not finite where the equations are not defined.
        """
        p, groups = _floats(p), tuple(map(_floats, groups))
        if p.ndim == 1 and all(g.ndim == 1 for g in groups):
            try:
                return _floats(
                    np.array(self._scalar(self._prepared(p), *[g.tolist() for g in groups]))
                )
            except (ArithmeticError, ValueError):
                pass  # undefined on floats: arrays tell where, by NaN or infinity
        return self._on_arrays(p, groups)

    def bind(self, p: NDArray[np.float64]) -> Callable[..., NDArray[np.float64]]:
        """Return the function of the other arguments at parameter sets p (np, N).

        What depends on parameters only is computed once, here. Arguments have shape (k, N), and
        must be real.
        """
        with np.errstate(all="ignore"):
            constants = tuple(self._prepare_array(p))
        array, count = self._array, p.shape[1]

        def bound(*groups: NDArray[np.float64]) -> NDArray[np.float64]:
            results = array(constants, *groups)
            out = np.empty((len(results), count))
            for k, row in enumerate(results):
                out[k] = row
            return out

        return bound

    def _prepared(self, p: NDArray[Any]) -> tuple[Any, ...]:
        key = p.tobytes()
        if key != self._key:
            self._constants = self._prepare_scalar(p.tolist())
            self._key = key
        return self._constants

    def _constants_for(self, p: NDArray[Any]) -> tuple[Any, ...]:
        if p.ndim == 1:
            try:
                return self._prepared(p)
            except (ArithmeticError, ValueError):
                pass  # as above
        return tuple(self._prepare_array(p))

    def _on_arrays(self, p: NDArray[Any], groups: tuple[NDArray[Any], ...]) -> NDArray[Any]:
        with np.errstate(all="ignore"):
            results = self._array(self._constants_for(p), *groups)
        points = {a.shape[1] for a in (p, *groups) if a.ndim == 2}
        shape = (len(results), *points)
        kind = complex if any(np.iscomplexobj(g) for g in groups) else float
        out = np.empty(shape, dtype=kind)
        for k, row in enumerate(results):
            out[k] = row
        return out


def _floats(values: NDArray[Any]) -> NDArray[Any]:
    """Return whole numbers as floats, others as they are."""
    return values if values.dtype.kind in "fc" else values.astype(float)
