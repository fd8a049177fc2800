"""Solving with a mass matrix inside a straight-line program.

The elimination is emitted as operations on numbers, so nothing grows symbolically. Its row order is
that of partial pivoting at the default parameters and the guess; elsewhere a pivot may vanish, so
the emitted code exchanges rows where the one below is much better.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import ModelError

if TYPE_CHECKING:
    from racs_bif.symbolic.graph import Graph
    from racs_bif.symbolic.lower import Lowering
    from racs_bif.symbolic.model import Model

_MUCH_BETTER = 4.0
"""How many times larger another pivot has to be: rows that are as good stay where they are."""


def solve_mass(model: Model, lower: Lowering, right: list[int]) -> tuple[list[int], int]:
    """Return the nodes of ``mass**-1 @ right``, and of the determinant but for a factor.

    Raises
    ------
    ModelError
        If the mass matrix is singular at the default parameters and the guess.
    """
    assert model.mass is not None  # the caller has looked
    g, n = lower.graph, len(right)
    order, scales = _pivots(model)
    mass = [[lower(model.mass[i, j]) for j in range(n)] for i in order]
    # A mass of parameters alone is inverted once for all states.
    constant = all(lower.is_fixed(entry) for row in mass for entry in row)
    if constant:
        sides = [[g.one if i == j else g.zero for j in range(n)] for i in order]
    else:
        sides = [[right[i]] for i in order]
    rows = [
        [g.mul(g.constant(scale), node) for node in (*left, *side)]
        for scale, left, side in zip(scales, mass, sides, strict=True)
    ]
    determinant = _triangular(g, rows, n)
    solution = _substituted(g, rows, n)
    if not constant:
        return [row[0] for row in solution], determinant
    return [_dot(g, row, right) for row in solution], determinant


def _triangular(g: Graph, rows: list[list[int]], n: int) -> int:
    """Eliminate below the diagonal, in place; return the determinant of the left part."""
    determinant = g.one
    for k in range(n):
        for i in range(k + 1, n):
            if rows[i][k] != g.zero:
                rows[k], rows[i], sign = _exchanged(g, rows[k], rows[i], k)
                determinant = g.mul(determinant, sign)
        determinant = g.mul(determinant, rows[k][k])
        for i in range(k + 1, n):
            if rows[i][k] == g.zero:
                continue
            factor = g.div(rows[i][k], rows[k][k])
            rows[i] = [
                g.sub(below, g.mul(factor, above)) if j > k else g.zero
                for j, (above, below) in enumerate(zip(rows[k], rows[i], strict=True))
            ]
    return determinant


def _exchanged(
    g: Graph, above: list[int], below: list[int], k: int
) -> tuple[list[int], list[int], int]:
    """Return two rows, exchanged wherever the lower one has a much better pivot, and a sign.

    The sign is -1 where they are exchanged.
    """
    minus = g.constant(-1.0)
    pivot, other = g.value(above[k]), g.value(below[k])
    if pivot is not None and other is not None:
        better = abs(other) > _MUCH_BETTER * abs(pivot)
        return (below, above, minus) if better else (above, below, g.one)
    size = g.mul(g.constant(_MUCH_BETTER), g.unary("fabs", above[k]))
    better_node = g.compare("gt", g.unary("fabs", below[k]), size)
    pairs = list(zip(above, below, strict=True))
    upper = [g.where(better_node, b, a) for a, b in pairs]
    lower = [g.where(better_node, a, b) for a, b in pairs]
    return upper, lower, g.where(better_node, minus, g.one)


def _substituted(g: Graph, rows: list[list[int]], n: int) -> list[list[int]]:
    """Return the solutions of the triangular system, one row for each unknown."""
    solution: list[list[int]] = [[] for _ in range(n)]
    for k in reversed(range(n)):
        values = rows[k][n:]
        for j in range(k + 1, n):
            values = [
                g.sub(value, g.mul(rows[k][j], known))
                for value, known in zip(values, solution[j], strict=True)
            ]
        solution[k] = [g.div(value, rows[k][k]) for value in values]
    return solution


def _dot(g: Graph, row: list[int], right: list[int]) -> int:
    total = g.zero
    for a, b in zip(row, right, strict=True):
        total = g.add(total, g.mul(a, b))
    return total


def _pivots(model: Model) -> tuple[list[int], list[float]]:
    """Return the order of the rows that partial pivoting chooses at the defaults, and their scales.

    The scales are powers of two, so that scaling does not round.
    """
    mass = _numbers(model)
    n = len(mass)
    if not np.all(np.isfinite(mass)):
        told = "the mass matrix is not finite at the default parameters"
        msg = f"model '{model.name}': {told}; give others"
        raise ModelError(msg)
    largest = np.abs(mass).max(axis=1, initial=0.0)
    if n == 0 or largest.min() == 0.0 or np.linalg.cond(mass / largest[:, None]) > 1e12:
        msg = (
            f"model '{model.name}': the mass matrix is singular at the default parameters; "
            "algebraic equations are not supported, solve them for one variable"
        )
        raise ModelError(msg)
    scales = [math.ldexp(1.0, 1 - math.frexp(size)[1]) for size in largest]
    work, order = mass * np.array(scales)[:, None], list(range(n))
    for k in range(n):
        best = k + int(np.argmax(np.abs(work[k:, k])))
        work[[k, best]] = work[[best, k]]
        order[k], order[best] = order[best], order[k]
        work[k + 1 :] -= np.outer(work[k + 1 :, k] / work[k, k], work[k])
    return order, [scales[i] for i in order]


def _numbers(model: Model) -> np.ndarray:
    assert model.mass is not None  # the caller has looked
    values = {
        p.name: float(p.default) if isinstance(p.default, (int, float)) else 1.0
        for p in model.parameters
    }
    values |= {name: float(model.guess.get(name, 0.0)) for name in model.states}
    known = {symbol: values[symbol.name] for symbol in model.mass.free_symbols}
    entries = [[complex(e.subs(known)) for e in model.mass.row(i)] for i in range(model.mass.rows)]
    if np.all(np.isfinite(entries)) and np.any(np.imag(entries)):
        msg = f"model '{model.name}': the mass matrix is complex; write it with real numbers"
        raise ModelError(msg)
    return np.asarray(entries).real
