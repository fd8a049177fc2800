"""Normal forms in disguise: seen through a nonlinear change of coordinates."""

from __future__ import annotations

import pytest
import sympy as sp

import racs_bif as rb
from racs_bif.symbolic.model import Model, Parameter


@pytest.fixture(scope="session")
def disguise():
    """Return a function that turns u' = F(u) into x' = f(x), x = L (u + quadratic + cubic in u).

    The linear part L is a rotation times a scale, so that eigenvectors keep the length they have in
    u up to that scale: coefficients of degree d change by scale**(1 - d).
    """

    def make(name, equations, parameters, *, angle=0.7, scale=1.0, bend=0.3):
        old = [sp.Symbol(n) for n in equations]
        new = [sp.Symbol(f"{n}_") for n in equations]
        count = len(old)
        values = {n: sp.sympify(e, locals={s.name: s for s in old}) for n, e in equations.items()}
        rotation = sp.eye(count)
        for k in range(count - 1):
            turn = sp.eye(count)
            c, s = sp.Float(sp.cos(angle + k), 17), sp.Float(sp.sin(angle + k), 17)
            turn[k, k], turn[k, k + 1], turn[k + 1, k], turn[k + 1, k + 1] = c, -s, s, c
            rotation = rotation * turn
        L = scale * rotation
        # u_k = y_k + bend * (terms in earlier y): triangular, with a Jacobian of determinant 1.
        y = L.inv() * sp.Matrix(new)
        u = []
        for k in range(count):
            bent = sum(bend * y[j] ** 2 * (1 + (j + k) / 7) for j in range(k))
            bent += sum(bend / 2 * y[j] * y[i] ** 2 for j in range(k) for i in range(j + 1))
            u.append(y[k] + bent)
        ys = [sp.Symbol(f"y{k}") for k in range(count)]
        exact = []
        for k in range(count):
            bent = sum(bend * ys[j] ** 2 * (1 + (j + k) / 7) for j in range(k))
            bent += sum(bend / 2 * ys[j] * ys[i] ** 2 for j in range(k) for i in range(j + 1))
            exact.append(ys[k] + bent)
        jacobian = sp.Matrix(exact).jacobian(ys).subs(dict(zip(ys, y, strict=True)))
        rates = sp.Matrix(
            [e.subs(dict(zip(old, u, strict=True)), simultaneous=True) for e in values.values()]
        )
        change = jacobian.LUsolve(rates)
        field = L * change
        return Model(
            name,
            {n.name: e for n, e in zip(new, field, strict=True)},
            tuple(Parameter(k, v) for k, v in parameters.items()),
            {n.name: 0.01 for n in new},
        )

    return make


@pytest.fixture(scope="session")
def curve_through():
    """Return a function that continues equilibria, then a curve from one of their points."""
    from racs_bif.verbs.curves import continue_curve

    def run(model, parameters, spans, start):
        branch = rb.continue_equilibria(model, parameters[0], spans[0])
        return continue_curve(branch[start], parameters, spans)

    return run
