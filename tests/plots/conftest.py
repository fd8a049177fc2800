import runpy
from pathlib import Path

import pytest

_KNOWN = runpy.run_path(str(Path(__file__).parents[1] / "results" / "conftest.py"))


@pytest.fixture
def diagram():
    return _KNOWN["Diagram"](_KNOWN["equilibria"](), _KNOWN["orbits"]())


@pytest.fixture
def crowded():
    return _KNOWN["many_points"]()


@pytest.fixture
def steep():
    return _KNOWN["steep"]()
