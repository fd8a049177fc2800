"""What every file of the shelf owes its reader."""

import ast
import re

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.shelf import folders, names
from racs_bif.shelf.modules import load_module
from racs_bif.symbolic.model import Calibration

OURS = {name: path for name, path in names("models").items() if path.parent in folders("models")}
TEXTBOOK = sorted(set(OURS) - {"racs"})


@pytest.fixture(params=TEXTBOOK)
def entry(request):
    path = OURS[request.param]
    return request.param, path, load_module(path).model()


def test_there_is_a_shelf():
    assert len(TEXTBOOK) >= 20


def test_a_model_says_what_it_is(entry):
    name, path, model = entry
    assert model.name == name
    assert model.title
    assert model.source
    text = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8")))
    for heading in ("Source", "Known result"):
        assert re.search(rf"^{heading}\n-+$", text, re.MULTILINE), heading
    (tried, *_) = re.findall(r"racs-bif [^`]*--model (\w+)", text)
    assert tried == name
    assert len(path.read_text(encoding="utf-8").splitlines()) <= 100


def test_a_model_describes_its_states_and_parameters(entry):
    _, _, model = entry
    own = [*model.states, *(e.output for e in model.elements), *model.outputs]
    assert [name for name in own if not model.descriptions.get(name)] == []
    assert [p.name for p in model.parameters if not p.description] == []
    assert not any(isinstance(p.default, Calibration) for p in model.parameters)


def test_a_model_rests_near_its_guess_and_differentiates(entry):
    name, _, _ = entry
    system = rb.load_model(name)
    x, p, field = system.equilibrium(), system.values, system.field
    assert np.abs(field.f(x, p)).max() < 1e-9
    away = x + 0.05 * np.cos(np.arange(len(x)))
    step = 1e-6
    columns = [
        (field.f(away + step * e, p) - field.f(away - step * e, p)) / (2.0 * step)
        for e in np.eye(len(x))
    ]
    exact = field.f_x(away, p)
    assert np.abs(exact - np.transpose(columns)).max() < 1e-6 * np.abs(exact).max()
