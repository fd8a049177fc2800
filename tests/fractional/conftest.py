"""The vehicle and small fractional models."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

from racs_bif.fractional.diffusive import Diffusive
from racs_bif.fractional.system import System
from racs_bif.symbolic.compiled import compile_model
from racs_bif.symbolic.strings import model_from_strings

ROOT = Path(__file__).parents[2]
C_S = 29661.065  # model.md, section 3
BAND = (1.0, 60.0)


@pytest.fixture(scope="session")
def vehicle():
    """The vehicle with the calibrated stiffness of model.md put in by hand."""
    spec = importlib.util.spec_from_file_location("vehicle_model", ROOT / "models" / "racs.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    compiled = compile_model(module.model())
    numbers = [p.default if isinstance(p.default, float) else 1.0 for p in compiled.parameters]
    system = System(compiled, np.array(numbers), Diffusive(band=BAND))
    return system.with_parameters({"C_s": C_S})


@pytest.fixture(scope="session")
def system_of():
    """Build a system from strings."""

    def build(equations, *, realisation=None, **options):
        options.setdefault("parameters", {})
        compiled = compile_model(model_from_strings("test", equations, **options))
        values = np.array([p.default for p in compiled.parameters])
        return System(compiled, values, realisation or Diffusive(band=(0.1, 100.0)))

    return build


@pytest.fixture(scope="session")
def law_of(system_of):
    """Return the law written as a string, with the field that differentiates it."""

    def build(text, **parameters):
        field = system_of({}, elements=[("Z", "0", text)], parameters=parameters).field
        p = np.array(list(parameters.values()), dtype=float)
        return field.laws(p)[0], field, p

    return build


@pytest.fixture(scope="session")
def differences():
    """Differentiate by central differences of fourth order."""

    def differentiate(function, at, step):
        terms = ((1, 8.0), (-1, -8.0), (2, -1.0), (-2, 1.0))
        return sum(weight * function(at + k * step) for k, weight in terms) / (12.0 * step)

    return differentiate
