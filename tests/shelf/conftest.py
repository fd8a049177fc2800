import os

import pytest

MODEL = "def model(**options):\n    return {name!r}\n"
ANALYSIS = "def run(out, *, n=2):\n    return n\n\n\ndef cube(x):\n    return x**3\n"


@pytest.fixture
def model_source():
    return MODEL


@pytest.fixture
def analysis_source():
    return ANALYSIS


@pytest.fixture
def shelve(monkeypatch):
    """Put folders on the user's path."""

    def put(*entries):
        monkeypatch.setenv("RACS_BIF_PATH", os.pathsep.join(map(str, entries)))

    return put
