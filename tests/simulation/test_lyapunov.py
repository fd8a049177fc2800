import numpy as np
import pytest

from racs_bif.errors import ConvergenceError, UsageError
from racs_bif.shelf.load import system_of
from racs_bif.simulation.lyapunov import LyapunovExponents, lyapunov_exponents
from racs_bif.symbolic.strings import model_from_strings


@pytest.fixture(scope="module")
def lorenz():
    return system_of(
        model_from_strings(
            "lorenz",
            {"x": "10*(y - x)", "y": "x*(r - z) - y", "z": "x*y - 8/3*z"},
            parameters={"r": 28.0},
        )
    )


def test_the_lorenz_attractor(lorenz):
    # J. C. Sprott, Chaos and Time-Series Analysis (2003): 0.9056, 0, -14.5723
    found = lyapunov_exponents(
        lorenz.field, np.array([1.0, 1.0, 20.0]), lorenz.values, 48.0, count=3, transient=4.0
    )
    largest, none, least = found.exponents
    assert abs(largest - 0.9056) < 4.0 * found.errors[0]
    assert found.errors[0] < 0.15
    assert none == pytest.approx(0.0, abs=0.02)
    # Volumes shrink at the same rate everywhere.
    assert largest + none + least == pytest.approx(-41.0 / 3.0, abs=1e-4)
    assert found.dimension == pytest.approx(2.06, abs=0.02)
    assert found.running[-1] == pytest.approx(found.exponents)


def test_a_limit_cycle_has_a_zero_and_its_multiplier():
    model = model_from_strings(
        "cycle",
        {"x": "x - 2*y - x*(x**2 + y**2)", "y": "2*x + y - y*(x**2 + y**2)"},
        parameters={},
    )
    system = system_of(model)
    found = lyapunov_exponents(
        system.field, np.array([1.0, 0.3]), system.values, 8.0, count=2, transient=8.0
    )
    assert found.exponents == pytest.approx([0.0, -2.0], abs=1e-5)
    assert np.all(found.errors < 1e-4)


def test_the_vehicle_at_rest_has_the_exponents_of_its_eigenvalues(vehicle):
    x = vehicle.equilibrium()
    eigenvalues = np.linalg.eigvals(vehicle.field.f_x(x, vehicle.values))
    found = lyapunov_exponents(
        vehicle.field, x, vehicle.values, 5.0, count=2, transient=12.0, tolerance=1e-6
    )
    # The pair of the root turns; over a few turns its growth is seen.
    assert found.exponents.mean() == pytest.approx(eigenvalues.real.max(), abs=2e-3)


def test_dimensions():
    def dimension(*exponents):
        k = len(exponents)
        values = np.array(exponents)
        return LyapunovExponents(values, np.zeros(k), np.zeros(1), values[None, :]).dimension

    assert dimension(-0.1, -1.0) == 0.0
    assert dimension(0.0, -1.0) == 1.0
    assert np.isnan(dimension(0.5))


def test_what_is_refused(lorenz):
    x, p = np.ones(3), lorenz.values
    with pytest.raises(UsageError, match="4 exponents were asked for, the equation has 3; give"):
        lyapunov_exponents(lorenz.field, x, p, 1.0, count=4)
    with pytest.raises(UsageError, match="interval up to a 16th"):
        lyapunov_exponents(lorenz.field, x, p, 1.0, interval=0.5)
    with pytest.raises(ConvergenceError, match="cannot be continued"):
        lyapunov_exponents(lorenz.field, np.full(3, 1e200), p, 1.0)
