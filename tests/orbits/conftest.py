"""Vector fields with known orbits, and the little Newton that the tests solve with."""

from __future__ import annotations

from functools import cached_property

import numpy as np
import pytest
import sympy as sp

from racs_bif.symbolic.field import VectorField
from racs_bif.symbolic.paths import BasePath


class WrittenField(VectorField):
    """A vector field from expressions."""

    def __init__(self, equations, parameters):
        self.states = tuple(equations)
        self.parameters = tuple(parameters)
        names = sp.symbols([*self.states, *self.parameters])
        x, p = names[: len(self.states)], names[len(self.states) :]
        local = {s.name: s for s in names}
        expressions = sp.Matrix([sp.sympify(e, locals=local) for e in equations.values()])
        self._f = sp.lambdify(names, list(expressions), "numpy")
        self._fx = sp.lambdify(names, list(expressions.jacobian(x)), "numpy")
        self._fp = sp.lambdify(names, list(expressions.jacobian(p)), "numpy")
        self._symbols = x, p, expressions

    @cached_property
    def _forms(self):
        """Second and third derivatives, and the mixed one, along directions."""
        x, p, value = self._symbols
        u, v, w = (sp.Matrix(sp.symbols(f"{name}_:{len(x)}")) for name in "uvw")
        dp = sp.Matrix(sp.symbols(f"dp_:{len(p)}"))
        second = (value.jacobian(x) * u).jacobian(x) * v
        third = second.jacobian(x) * w
        mixed = (value.jacobian(x) * u).jacobian(p) * dp
        return {
            name: sp.lambdify(
                [*x, *p, *(d for group in directions for d in group)], list(form), cse=True
            )
            for name, form, directions in (
                ("xx", second, (u, v)),
                ("xxx", third, (u, v, w)),
                ("xp", mixed, (u, dp)),
            )
        }

    def _form(self, name, x, p, *directions):
        rows = self._forms[name](*x, *p, *(d for group in directions for d in group))
        return np.array([np.broadcast_to(row, directions[0].shape[1:]) for row in rows])

    def _rows(self, function, x, p):
        columns = x.shape[1:]
        return np.array([np.broadcast_to(row, columns) for row in function(*x, *p)])

    def f(self, x, p):
        return self._rows(self._f, x, p)

    def f_x(self, x, p):
        n = len(self.states)
        rows = self._rows(self._fx, x, p).reshape(n, n, *x.shape[1:])
        return rows if x.ndim == 1 else np.moveaxis(rows, -1, 0)

    def f_p(self, x, p, dp):
        rows = self._rows(self._fp, x, p).reshape(len(x), len(p), *x.shape[1:])
        return np.einsum("ij...,j->i...", rows, dp)

    def f_xx(self, x, p, u, v):
        return self._form("xx", x, p, u, v)

    def f_xxx(self, x, p, u, v, w):
        return self._form("xxx", x, p, u, v, w)

    def f_xp(self, x, p, v, dp):
        return self._form("xp", x, p, v, dp)


@pytest.fixture(scope="session")
def written():
    """Build (field, path) from equations and parameter values; the first parameter is active."""

    def build(equations, **parameters):
        field = WrittenField(equations, parameters)
        active = next(iter(parameters))
        return field, BasePath((active,), (0,), np.array(list(parameters.values()), dtype=float))

    return build


@pytest.fixture(scope="session")
def hopf(written):
    """A circle of radius sqrt(lam), period 2 pi / w, multipliers 1 and exp(-2 lam T)."""
    return written(
        {"x": "lam*x - w*y - x*(x**2 + y**2)", "y": "w*x + lam*y - y*(x**2 + y**2)"},
        lam=0.25,
        w=1.7,
    )


@pytest.fixture(scope="session")
def bent_hopf(written):
    """The same in bent coordinates: a = x, b = y + x^2/2, and a contracting third state c."""
    r2 = "(a**2 + (b - a**2/2)**2)"
    da = f"(lam*a - w*(b - a**2/2) - a*{r2})"
    dy = f"(w*a + lam*(b - a**2/2) - (b - a**2/2)*{r2})"
    return written(
        {"a": da, "b": f"{dy} + a*{da}", "c": "-3*c + a*b"},
        lam=0.25,
        w=1.7,
    )


@pytest.fixture(scope="session")
def van_der_pol(written):
    return written({"x": "y", "y": "mu*(1 - x**2)*y - x"}, mu=1.0)


@pytest.fixture(scope="session")
def langford(written):
    return written(
        {
            "x": "(z - 0.7)*x - om*y",
            "y": "om*x + (z - 0.7)*y",
            "z": "0.6 + al*z - z**3/3 - (x**2 + y**2)*(1 + rho*z)",
        },
        rho=0.4,
        om=3.5,
        al=0.95,
    )


@pytest.fixture(scope="session")
def adaptive_control(written):
    return written({"x": "y", "y": "z", "z": "-al*z - be*y - x + x**2"}, al=0.9, be=1.0)


@pytest.fixture(scope="session")
def stiff_linear(written):
    """x' = A x with rates from 1 to 1e4 per second, mixed by a fixed matrix."""
    rng = np.random.default_rng(3)
    mix = np.eye(4) + 0.2 * rng.standard_normal((4, 4))
    core = np.array(
        [
            [-0.5, 3.0, 0.0, 0.0],
            [-3.0, -0.5, 0.0, 0.0],
            [0.0, 0.0, -1e2, 0.0],
            [0.0, 0.0, 0.0, -1e4],
        ]
    )
    a = mix @ core @ np.linalg.inv(mix)
    names = ["x1", "x2", "x3", "x4"]
    equations = {
        name: " + ".join(f"({a[i, j]!r})*s*{names[j]}".replace("np.float64", "") for j in range(4))
        for i, name in enumerate(names)
    }
    return (*written(equations, s=1.0), a)
