"""Plain functions recorded, and what was recorded checked against them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from racs_bif.errors import RacsBifError
from racs_bif.symbolic.arguments import TIME, Arguments
from racs_bif.symbolic.emit import Function, emit
from racs_bif.symbolic.generate import module
from racs_bif.symbolic.graph import Graph
from racs_bif.symbolic.kernels import Kernel, build
from racs_bif.symbolic.lower import Lowering
from racs_bif.symbolic.overload import NotTraceable
from racs_bif.symbolic.rebinding import rebind
from racs_bif.symbolic.tracing import Recording, record

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from racs_bif.symbolic.external import External

    Array = NDArray[np.float64]

_AGREE: Final = 1e-8


class RefusedError(Exception):
    """Why a function could not be recorded; for the other ways of treating it."""


def nearby(start: Array) -> list[Array]:
    """Return the start and a few points about it."""
    rng = np.random.default_rng(1)
    scale = 0.05 + 0.1 * np.abs(start)
    return [start, *(start + scale * rng.uniform(-1.0, 1.0, len(start)) for _ in range(4))]


def recorded(external: External, start: Array) -> Recording:
    """Record a function and check what was recorded against it at and near a first point.

    Raises
    ------
    RefusedError
        If it cannot be recorded, or what was recorded is something else.
    """
    arguments = external.arguments
    prefix = "term_"
    while any(name.startswith(prefix) for name in arguments.names):
        prefix = f"_{prefix}"
    copy = rebind(external.function)

    def call(given: Mapping[str, Any]) -> list[Any]:
        return arguments.listed(arguments.call(copy, {TIME: 0.0, **given}))

    try:
        with np.errstate(all="ignore"):
            found = record(call, arguments.names, prefix)
    except (RacsBifError, RecursionError) as error:
        raise RefusedError(str(error)) from error
    except NotTraceable as error:
        raise RefusedError(str(error)) from error
    except (
        Exception,
        SystemExit,
    ) as error:  # on floats it did not fail: it is the recording that it refuses
        what = " ".join(str(error).split())
        raise RefusedError(
            f"on numbers that record it raises {type(error).__name__}: {what}"
        ) from error
    kernel = _kernel(found, arguments)
    for point in nearby(start):
        wanted = external.floats(point)
        there = np.isfinite(wanted)
        got = kernel(point)[there]
        if not np.all(np.abs(got - wanted[there]) <= _AGREE * (1.0 + np.abs(wanted[there]))):
            msg = "what was recorded gives other values than it does"
            raise RefusedError(msg)
    return found


def _kernel(found: Recording, arguments: Arguments) -> Callable[[Array], Array]:
    """Return a recording as a function of numbers."""
    graph = Graph()
    inputs = [graph.input(name) for name in arguments.names]
    symbols = dict(zip(arguments.names, inputs, strict=True))
    lower = Lowering(graph, symbols, set())
    for name, expression in found.terms.items():
        symbols[name] = lower(expression)
    outputs = [lower(expression) for expression in found.results]
    lines = emit(graph, Function("core", {"x": inputs}, outputs), [])
    body = "\n".join(f"    {line}" for line in lines)
    _, scalar, array = build(module([body], {}), "recording")
    kernel = Kernel("core", scalar, array)
    return lambda point: np.asarray(kernel(np.zeros(0), point))
