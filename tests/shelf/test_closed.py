"""Which files may be taken by their text."""

from pathlib import Path

import pytest

from racs_bif.shelf.closed import is_closed

CLOSED = {
    "import numpy as np\nx = np.sin(np.pi) + np.array([1.0]).sum()",
    "from numpy import sin, array",
    "import racs_bif as rb\nm = rb.model_from_function",
    "import sympy as sp\nx = sp.Symbol('x')",
    "import math",
}
OPEN = {
    "import numpy as np\nx = np.load('x.npy')",
    "import numpy as np\nx = np.random.rand()",
    "import numpy as np\nx = np.linalg.solve",
    "from numpy import loadtxt",
    "from numpy.random import rand",
    "import numpy.random",
    "import os",
    "import racs_bif as rb\nm = rb.load_model('racs')",
    "import racs_bif as rb\nm = rb.model_from_toml('x.toml')",
    "x = open('x')",
    "x = (",
}


@pytest.mark.parametrize("text", sorted(CLOSED))
def test_closed(text):
    assert is_closed(Path("x.py"), text)


@pytest.mark.parametrize("text", sorted(OPEN))
def test_open(text):
    assert not is_closed(Path("x.py"), text)


def test_toml_is_closed():
    assert is_closed(Path("x.toml"), "anything")
