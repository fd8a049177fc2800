from types import SimpleNamespace

import pytest

from racs_bif.shelf.load import load_model, system_of
from racs_bif.simulation.exact import ExactStepper
from racs_bif.simulation.inputs import Inputs
from racs_bif.simulation.realised import RealisedStepper
from racs_bif.simulation.start import begin
from racs_bif.symbolic.strings import model_from_strings


@pytest.fixture(scope="session")
def relaxation():
    """Return systems D^q x = -k x, whose solution is E_q(-k t^q)."""

    def build(q, k=1.0):
        model = model_from_strings(
            "relaxation", {}, parameters={"q": q, "k": k}, elements=[("x", "-k*x", "s**(-q)")]
        )
        return system_of(model)

    return build


@pytest.fixture(scope="session")
def torvik():
    """y'' + D^1.5 y / 2 + y / 2 = f."""
    model = model_from_strings(
        "torvik",
        {"y": "z", "z": "f - w/2 - y/2"},
        parameters={"f": 0.0},
        elements=[("w", "z", "s**0.5")],
        outputs={"force": "f - w/2"},
    )
    return system_of(model)


@pytest.fixture(scope="session")
def two_orders():
    """Two elements of different orders, one with feedthrough, one that grows."""
    model = model_from_strings(
        "two",
        {"x": "v", "v": "-x - a*w - b*r + f"},
        parameters={"a": 0.4, "b": 0.3, "f": 0.0},
        elements=[("w", "x", "(1 + 2*s**0.6)/(1 + s**0.6)"), ("r", "v + 0.1*w", "s**0.3")],
    )
    return system_of(model)


@pytest.fixture(scope="session")
def vehicle():
    return load_model("racs", parameters={"u": 12.0})


@pytest.fixture
def march():
    """Integrate; returns times and a row for each state and element."""

    def run(system, duration, count, method="bdf2", **options):
        history = options.pop("history", "rest")
        start = begin(system, options.pop("initial", {}), history)
        signals, jumps = options.pop("signals", {}), options.pop("jumps", ())
        inputs = Inputs(system=system, duration=duration, signals=signals, jumps=jumps)
        kind = RealisedStepper if method in {"lsoda", "radau"} else ExactStepper
        done = kind(system, start, inputs, count, method, **options).run()
        assert done.stopped == ""
        return SimpleNamespace(times=done.times, X=done.X)

    return run
