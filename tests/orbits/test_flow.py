import numpy as np
import pytest
import scipy.linalg

from racs_bif.errors import ConvergenceError, ModelError
from racs_bif.orbits.flow import Integrator
from racs_bif.orbits.mesh import Mesh


def test_order_five(van_der_pol):
    integrator = Integrator(*van_der_pol)
    start = np.array([[2.0, 0.3]])
    exact = integrator.flow(Mesh.uniform(1024, 1), start, 3.0, 1.0).ends[0]
    errors = [
        np.abs(integrator.flow(Mesh.uniform(n, 1), start, 3.0, 1.0).ends[0] - exact).max()
        for n in (16, 32, 64)
    ]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert np.all(np.abs(orders - 5.0) < 0.35), orders


def test_stiff_linear_flow_and_monodromy(stiff_linear):
    field, path, a = stiff_linear
    integrator = Integrator(field, path)
    flow = integrator.flow(Mesh.uniform(64, 1), np.array([[1.0, -0.5, 0.2, 0.7]]), 2.0, 1.0)
    transition = integrator.derivative(flow).ends[0, :, :4]
    np.testing.assert_allclose(transition, scipy.linalg.expm(2.0 * a), atol=1e-7)
    np.testing.assert_allclose(flow.ends[0], transition @ flow.starts[0], atol=1e-13)
    # the derivative with respect to time scale and parameter is A x t at the end for both
    by_period, by_rate = integrator.derivative(flow).ends[0, :, 4:].T
    np.testing.assert_allclose(by_period, a @ flow.ends[0], atol=1e-5)
    np.testing.assert_allclose(by_rate, 2.0 * a @ flow.ends[0], atol=1e-5)


@pytest.mark.parametrize("segments", [1, 4])
def test_derivative_against_differences(van_der_pol, segments):
    integrator = Integrator(*van_der_pol)
    mesh = Mesh(np.array([0.0, 0.1, 0.22, 0.3, 0.45, 0.6, 0.7, 0.86, 1.0]), segments)
    starts = np.array([[2.0, 0.1], [0.5, -1.5], [-1.9, 0.2], [-0.3, 1.0]])[:segments]
    derivative = integrator.derivative(integrator.flow(mesh, starts, 2.0, 0.8))

    def ends(starts, period, active):
        return integrator.flow(mesh, starts, period, active).ends

    step = 1e-6
    for j in range(2):
        shift = np.zeros(2)
        shift[j] = step
        column = (ends(starts + shift, 2.0, 0.8) - ends(starts - shift, 2.0, 0.8)) / (2 * step)
        np.testing.assert_allclose(derivative.ends[:, :, j], column, atol=2e-8)
    column = (ends(starts, 2.0 + step, 0.8) - ends(starts, 2.0 - step, 0.8)) / (2 * step)
    np.testing.assert_allclose(derivative.ends[:, :, 2], column, atol=2e-8)
    column = (ends(starts, 2.0, 0.8 + step) - ends(starts, 2.0, 0.8 - step)) / (2 * step)
    np.testing.assert_allclose(derivative.ends[:, :, 3], column, atol=2e-8)


def test_guess_and_march_agree_and_the_guess_saves_work(van_der_pol):
    integrator = Integrator(*van_der_pol)
    mesh = Mesh.uniform(64, 4)
    starts = np.array([[2.0, 0.1], [0.5, -1.5], [-1.9, 0.2], [-0.3, 1.0]])
    flow = integrator.flow(mesh, starts, 6.6, 1.0)
    derivative = integrator.derivative(flow)
    change = 1e-3 * np.ones_like(starts)
    guess = flow.stages + derivative.changes(change, 0.01, 0.001)[1]
    moved = (mesh, starts + change, 6.61, 1.001)
    integrator.checked.count = 0
    warm = integrator.flow(*moved, guess, derivative)
    spent, integrator.checked.count = integrator.checked.count, 0
    cold = integrator.flow(*moved)
    np.testing.assert_allclose(warm.stages, cold.stages, atol=1e-12)
    assert spent <= 6
    assert spent < integrator.checked.count / 5


def test_dense_output_is_of_order_four(van_der_pol):
    integrator = Integrator(*van_der_pol)
    start, times = np.array([[2.0, 0.3]]), np.linspace(0.0, 1.0, 777)
    exact = integrator.flow(Mesh.uniform(1024, 1), start, 3.0, 1.0).profile(times)
    profiles = [integrator.flow(Mesh.uniform(n, 1), start, 3.0, 1.0).profile for n in (24, 48, 96)]
    errors = [np.abs(profile(times) - exact).max() for profile in profiles]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert np.all(orders > 3.6), orders


def test_a_right_hand_side_that_is_not_finite_names_the_time(written):
    field, path = written({"x": "lam + 1e-30*log(1 - x)"}, lam=1.0)  # NaN beyond t = 1
    with pytest.raises(ConvergenceError, match=r"not finite near t = (0\.9|1)"):
        Integrator(field, path).flow(Mesh.uniform(40, 1), np.array([[0.0]]), 2.0, 1.0)


def test_starts_that_are_not_finite(van_der_pol):
    with pytest.raises(ConvergenceError, match="not finite"):
        Integrator(*van_der_pol).flow(Mesh.uniform(4, 1), np.array([[np.nan, 0.0]]), 2.0, 1.0)


def test_blow_up_names_the_time(written):
    field, path = written({"x": "lam + x**2"}, lam=1.0)  # tan(t): gone at pi/2
    with pytest.raises(ConvergenceError, match=r"t = 1\.[3-6]"):
        Integrator(field, path).flow(Mesh.uniform(40, 1), np.array([[0.0]]), 2.0, 1.0)


@pytest.mark.parametrize(
    ("broken", "message"),
    [
        (lambda _x, _p: 1 / 0, "raised ZeroDivisionError"),
        (lambda x, _p: x[:1], r"shaped \(1, 3\)"),
        (lambda x, _p: x + 0j, "complex128"),
    ],
)
def test_a_broken_right_hand_side_is_the_users_error(van_der_pol, monkeypatch, broken, message):
    field, path = van_der_pol
    monkeypatch.setattr(field, "f", broken)
    with pytest.raises(ModelError, match=message):
        Integrator(field, path).flow(Mesh.uniform(4, 1), np.array([[1.0, 0.0]]), 2.0, 1.0)
