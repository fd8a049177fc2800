"""The vehicle, its equilibria, and a small model with everything in it."""

import pytest

import racs_bif as rb


@pytest.fixture(scope="session")
def vehicle():
    return rb.load_model("racs")


@pytest.fixture(scope="session")
def equilibria(vehicle):
    return rb.continue_equilibria(vehicle, "u", (5, 30))


@pytest.fixture(scope="session")
def two_elements():
    """Two elements, one with feedthrough and one without, the second fed by the first."""
    return rb.model_from_strings(
        "two_elements",
        {"x": "y", "y": "-k*x - x**3 - a*w - z + f"},
        parameters={"k": 2.0, "a": 0.7, "f": 0.3},
        elements=[("w", "x + 0.1*y", "s**0.5"), ("z", "x + 0.2*w", "1/(1 + s**0.6)")],
        outputs={"power": "y*(f - a*w)", "load": "f + x**2"},
    )
