"""Solving with a mass matrix inside a straight-line program.

The elimination is emitted as operations on numbers, so nothing grows symbolically; its pivots are
chosen once, by partial pivoting at the default parameters and the guess.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from racs_bif.errors import ModelError

if TYPE_CHECKING:
    from racs_bif.symbolic.lower import Lowering
    from racs_bif.symbolic.model import Model


def solve_mass(model: Model, lower: Lowering, right: list[int]) -> list[int]:
    """Return the nodes of ``mass**-1 @ right``.

    Raises
    ------
    ModelError
        If the mass matrix is singular at the default parameters and the guess.
    """
    assert model.mass is not None  # the caller has looked
    g, n = lower.graph, len(right)
    order = _pivots(model)
    rows = [[lower(model.mass[i, j]) for j in range(n)] for i in order]
    b = [right[i] for i in order]
    for k in range(n):
        for i in range(k + 1, n):
            if rows[i][k] == g.zero:
                continue
            factor = g.div(rows[i][k], rows[k][k])
            for j in range(k + 1, n):
                rows[i][j] = g.sub(rows[i][j], g.mul(factor, rows[k][j]))
            b[i] = g.sub(b[i], g.mul(factor, b[k]))
    for k in reversed(range(n)):
        for j in range(k + 1, n):
            b[k] = g.sub(b[k], g.mul(rows[k][j], b[j]))
        b[k] = g.div(b[k], rows[k][k])
    return b


def _pivots(model: Model) -> list[int]:
    """Return the order of the rows that partial pivoting chooses at the defaults."""
    mass = _numbers(model)
    n = len(mass)
    if not np.all(np.isfinite(mass)):
        msg = f"model '{model.name}': the mass matrix is not finite at the default parameters"
        raise ModelError(msg)
    scale = np.abs(mass).max(axis=1, initial=0.0)
    if n == 0 or scale.min() == 0.0 or np.linalg.cond(mass / scale[:, None]) > 1e12:
        msg = (
            f"model '{model.name}': the mass matrix is singular at the default parameters; "
            "algebraic equations are not supported, solve them for one variable"
        )
        raise ModelError(msg)
    work, order = mass / scale[:, None], list(range(n))
    for k in range(n):
        best = k + int(np.argmax(np.abs(work[k:, k])))
        work[[k, best]] = work[[best, k]]
        order[k], order[best] = order[best], order[k]
        work[k + 1 :] -= np.outer(work[k + 1 :, k] / work[k, k], work[k])
    return order


def _numbers(model: Model) -> np.ndarray:
    assert model.mass is not None  # the caller has looked
    values = {
        p.name: float(p.default) if isinstance(p.default, (int, float)) else 1.0
        for p in model.parameters
    }
    values |= {name: float(model.guess.get(name, 0.0)) for name in model.states}
    known = {symbol: values[symbol.name] for symbol in model.mass.free_symbols}
    entries = [[complex(e.subs(known)) for e in model.mass.row(i)] for i in range(model.mass.rows)]
    return np.asarray(entries).real
