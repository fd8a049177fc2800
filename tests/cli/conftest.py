import runpy
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from racs_bif.cli import continue_
from racs_bif.cli.main import main
from racs_bif.results.diagram import Diagram

_KNOWN = runpy.run_path(str(Path(__file__).parents[1] / "results" / "conftest.py"))

NORMAL_FORM = '''"""Hopf's normal form.

x' = mu x - y - x (x**2 + y**2), y' = x + mu y - y (x**2 + y**2): cycle of radius sqrt(mu), period
2 pi, l1 = -1 / 1.
"""

import sympy as sp

from racs_bif import Model, Parameter


def model(variant="super"):
    x, y, mu, k = sp.symbols("x y mu k")
    r = k * (x**2 + y**2) * (1 if variant == "super" else -1)
    return Model(
        name="hopf",
        title="Hopf's normal form",
        equations={"x": mu * x - y - r * x, "y": x + mu * y - r * y},
        parameters=(
            Parameter("mu", -0.5, unit="1/s", description="growth", valid=(-10.0, 10.0)),
            Parameter("k", 1.0, unit="1", description="softening"),
        ),
        guess={"x": 0.0, "y": 0.0},
        units={"x": "m", "y": "m"},
        variants={"super": "supercritical", "sub": "subcritical"},
        variant=variant,
        notes=("nothing here is a vehicle",),
    )
'''


@pytest.fixture
def known():
    return SimpleNamespace(**{name: _KNOWN[name] for name in ("equilibria", "orbits")})


@pytest.fixture
def normal_form(tmp_path):
    path = tmp_path / "hopf.py"
    path.write_text(NORMAL_FORM)
    return path


@pytest.fixture
def cli(capsys):
    """Run the program in this process; returns status, stdout, stderr."""

    def run(*arguments):
        status = main([str(argument) for argument in arguments])
        captured = capsys.readouterr()
        return SimpleNamespace(status=status, out=captured.out, err=captured.err)

    return run


@pytest.fixture
def computed(monkeypatch, known):
    """Put known branches in place of computing; what is called may be changed by the test."""
    system = SimpleNamespace(states=("v", "delta_c"), own=("v", "delta_c"), outputs=())
    calls = SimpleNamespace(
        equilibria=lambda *_a, **_k: known.equilibria(),
        orbits=lambda *_a, **_k: known.orbits(),
    )
    monkeypatch.setattr(continue_, "open_system", lambda _: system)
    equilibria = SimpleNamespace(
        all_equilibria=lambda *a, **k: Diagram(calls.equilibria(*a, **k)),
    )
    orbits = SimpleNamespace(
        continue_orbits=lambda *a, **k: calls.orbits(*a, **k),  # noqa: PLW0108 - a test may change it
    )
    monkeypatch.setitem(sys.modules, "racs_bif.verbs.all_equilibria", equilibria)
    monkeypatch.setitem(sys.modules, "racs_bif.verbs.orbits", orbits)
    return calls
