"""Random expressions over everything that a model may hold, and high-precision references."""

from dataclasses import dataclass

import mpmath
import numpy as np
import pytest
import sympy as sp

from racs_bif.symbolic.compiled import compile_model
from racs_bif.symbolic.model import Model, Parameter

STATES = sp.symbols("x y z", real=True)
PARAMETERS = sp.symbols("a b q", real=True)
R = sp.Rational

# Each keeps its value and its arguments' domains within bounds, so that rounding stays small and
# every function is smooth at a random point.
SMOOTH = {
    "add": lambda f, g: f + g,
    "sub": lambda f, g: f - g,
    "mul": lambda f, g: f * g,
    "div": lambda f, g: f / (2 + g**2),
    "under": lambda f, g: 1 / (R(3, 2) + sp.sin(f)),
    "square": lambda f, g: f**2,
    "cube": lambda f, g: f**3,
    "seventh": lambda f, g: sp.cos(f) ** 7,
    "inverse": lambda f, g: (R(3, 2) + sp.cos(f)) ** -2,
    "real": lambda f, g: (R(3, 2) + sp.sin(f)) ** sp.Float("1.37"),
    "negative": lambda f, g: (R(3, 2) + sp.sin(f)) ** sp.Float("-0.6"),
    "parameter": lambda f, g: (R(3, 2) + sp.sin(f)) ** PARAMETERS[2],
    "over": lambda f, g: (R(3, 2) + sp.sin(f)) ** (-PARAMETERS[2]),
    "both": lambda f, g: (R(3, 2) + sp.sin(f)) ** sp.tanh(g),
    "exp": lambda f, g: sp.exp(sp.tanh(f)),
    "log": lambda f, g: sp.log(R(3, 2) + sp.sin(f)),
    "sqrt": lambda f, g: sp.sqrt(R(3, 2) + sp.sin(f)),
    "rsqrt": lambda f, g: f / sp.sqrt(1 + f**2),
    "sin": lambda f, g: sp.sin(f),
    "cos": lambda f, g: sp.cos(f),
    "tan": lambda f, g: sp.tan(sp.tanh(f)),
    "asin": lambda f, g: sp.asin(sp.sin(f) / 2),
    "acos": lambda f, g: sp.acos(sp.tanh(f) / 2),
    "atan": lambda f, g: sp.atan(f),
    "sinh": lambda f, g: sp.sinh(sp.sin(f)),
    "cosh": lambda f, g: sp.cosh(sp.sin(f)),
    "tanh": lambda f, g: sp.tanh(f),
    "asinh": lambda f, g: sp.asinh(f),
    "acosh": lambda f, g: sp.acosh(2 + sp.sin(f)),
    "atanh": lambda f, g: sp.atanh(sp.sin(f) / 2),
    "erf": lambda f, g: sp.erf(f),
    "minus": lambda f, g: -sp.sin(-f) + sp.tanh(-g),
}
BROKEN = {
    "abs": lambda f, g: sp.Abs(f - R(1, 3)) * g,
    "sign": lambda f, g: sp.sign(f - R(1, 3)) * g,
    "piecewise": lambda f, g: sp.Piecewise((f**2, f < g), (sp.sin(g), f < 2 * g), (f * g, True)),
    "and": lambda f, g: sp.Piecewise((f, sp.And(f > 0, g <= 1)), (g**2, True)),
    "or": lambda f, g: sp.Piecewise((f, sp.Or(f > 1, sp.Not(g >= 1))), (g**2, True)),
    "max": lambda f, g: sp.Max(f, g, R(1, 5)),
    "min": lambda f, g: sp.Min(f**2, g),
    "heaviside": lambda f, g: sp.Heaviside(f - R(1, 3)) * g,
}
RULES = SMOOTH | BROKEN


@dataclass(frozen=True)
class Sample:
    """Three random equations, compiled, with a point at which to evaluate them."""

    names: tuple
    expressions: tuple
    compiled: object
    x: np.ndarray
    p: np.ndarray

    def reference(self, expressions, x=None, p=None):
        """Evaluate sympy expressions with 40 digits."""
        x, p = self.x if x is None else x, self.p if p is None else p
        with mpmath.workdps(40):
            function = sp.lambdify([*STATES, *PARAMETERS], list(expressions), "mpmath")
            return np.array([float(v) for v in function(*map(mpmath.mpf, [*x, *p]))])

    def derivative(self, *directions):
        """Differentiate the expressions along numbers for (x, p), once for each direction."""
        result = list(self.expressions)
        for direction in directions:
            pairs = [
                (symbol, sp.Float(float(d), 40))
                for symbol, d in zip((*STATES, *PARAMETERS), direction, strict=True)
                if d
            ]
            result = [sum((d * sp.diff(e, s) for s, d in pairs), sp.Integer(0)) for e in result]
        return self.reference([off_the_kinks(e) for e in result])


def off_the_kinks(expression):
    """Drop what a derivative holds of Dirac's delta, which the points stay away from."""
    flat = expression.replace(sp.DiracDelta, lambda *_: sp.Integer(0))
    return flat.replace(
        lambda e: isinstance(e, sp.Derivative) and isinstance(e.expr, sp.sign),
        lambda _: sp.Integer(0),
    )


def grow(rng, name, depth):
    """Return a random expression with the rule `name` at its root."""
    plain = depth == 0 or name in {"max", "min"}  # sympy tries to compare what they hold

    def branch():
        if plain or rng.random() < 0.15:
            leaf = rng.choice([*STATES, *STATES, *PARAMETERS[:2]])
            return leaf * R(int(rng.integers(2, 9)), 5)
        rules = SMOOTH if name in BROKEN else RULES  # kinks of kinks: sympy takes its time
        return grow(rng, str(rng.choice(list(rules))), depth - 1)

    return RULES[name](branch(), branch())


def sample(names, seed, depth):
    """Compile a model whose equations have these rules at their roots."""
    rng = np.random.default_rng(seed)
    expressions = tuple(grow(rng, name, depth) for name in names)
    model = Model(
        name="random",
        equations={str(s): e for s, e in zip(STATES, expressions, strict=True)},
        parameters=tuple(Parameter(str(p), 1.0) for p in PARAMETERS),
    )
    x, p = rng.uniform(0.3, 1.4, 3), rng.uniform(0.4, 1.6, 3)
    return Sample(names, expressions, compile_model(model), x, p)


def triples():
    """Put all rules into groups of three."""
    names = [*RULES, "mul", "div"]
    return [tuple(names[k : k + 3]) for k in range(0, len(names) - 2, 3)]


@pytest.fixture(params=triples(), ids="-".join, scope="session")
def shallow(request):
    """Three equations of depth two; together the samples hold every rule."""
    return sample(request.param, len(str(request.param)), 1)


@pytest.fixture(params=range(6), scope="session")
def deep(request):
    """Three equations of depth four, to be evaluated but not differentiated by sympy."""
    rng = np.random.default_rng(request.param)
    return sample(tuple(map(str, rng.choice(list(RULES), 3))), 100 + request.param, 4)


@pytest.fixture
def compiled():
    """Compile a model from strings."""
    from racs_bif.symbolic.strings import model_from_strings

    def build(equations, **options):
        options.setdefault("parameters", {})
        return compile_model(model_from_strings("test", equations, **options))

    return build
