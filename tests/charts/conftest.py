"""Small models whose charts are known in closed form."""

import pytest

from racs_bif.charts.plane import Plane
from racs_bif.charts.search import search
from racs_bif.charts.settings import ChartSettings
from racs_bif.shelf.load import load_model, system_of
from racs_bif.symbolic.strings import model_from_strings

MODELS = {
    # unstable within the circle of radius r around (p, q)
    "island": (
        {"x": "y", "y": "-x - ((a - p)**2 + (b - q)**2 - r**2)*y"},
        {"a": 0.0, "b": 0.0, "p": 0.371, "q": 0.613, "r": 0.2},
        [],
    ),
    # two oscillators with a springpot each: unstable left of a vertical and of an oblique line
    "two": (
        {
            "x1": "y1",
            "y1": "-x1 - (a - 0.4)*y1 - 0.5*w1 + 0.1*x2",
            "x2": "y2",
            "y2": "-4*x2 - (a + b - 0.6)*y2 - 0.3*w2",
        },
        {"a": 0.0, "b": 0.0, "q": 0.7},
        [("w1", "x1", "s**0.5"), ("w2", "x2", "s**q")],
    ),
    # s**2 + a s**0.5 + b s**1.5 + 1: both orders of the springpots' gains are linear in (a, b)
    "springpots": (
        {"x": "y", "y": "-x - a*w1 - b*w2"},
        {"a": 0.0, "b": 0.0},
        [("w1", "x", "s**0.5"), ("w2", "y", "s**0.5")],
    ),
    # stable for k > 0 and d > 0; boundaries along the lattice, and a point where they meet
    "corner": ({"x": "y", "y": "-k*x - d*y"}, {"k": 0.5, "d": 0.5}, []),
    # an equilibrium while a > -b**2 / 4
    "fold": ({"x": "a - b*y - x**2", "y": "-y + x"}, {"a": 1.0, "b": 0.5}, []),
    # three equilibria while 27 a**2 < 4 b**3
    "cusp": ({"x": "a + b*x - x**3", "y": "-y + x"}, {"a": -1.0, "b": 0.5}, []),
    # Bautin's normal form: Hopf at a = 0, l1 of the sign of b
    "bautin": (
        {
            "x": "a*x - y + b*x*(x**2 + y**2) - x*(x**2 + y**2)**2",
            "y": "x + a*y + b*y*(x**2 + y**2) - y*(x**2 + y**2)**2",
        },
        {"a": 0.1, "b": 0.2},
        [],
    ),
}
GUESSES = {"fold": {"x": 1.0, "y": 1.0}, "cusp": {"x": -1.0, "y": -1.0}}


@pytest.fixture(scope="session")
def model_of():
    """Build one of the models by name."""

    def build(name, **parameters):
        equations, values, elements = MODELS[name]
        guess = GUESSES.get(name, dict.fromkeys(equations, 0.0))
        made = model_from_strings(
            name, equations, parameters={**values, **parameters}, elements=elements, guess=guess
        )
        return system_of(made)

    return build


@pytest.fixture(scope="session")
def searched(model_of):
    """Search a plane of one of the models."""

    def run(name, names, spans, *, coarse=4, depth=7, lyapunov=False, **parameters):
        plane = Plane(model_of(name, **parameters), names, spans)
        return search(plane, ChartSettings(coarse=coarse, depth=depth), lyapunov=lyapunov)

    return run


@pytest.fixture(scope="session")
def vehicle():
    return load_model("racs", parameters={"u": 20.0})
