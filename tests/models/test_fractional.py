"""Fractional models of the shelf against their known results."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar, root

import racs_bif as rb
from racs_bif.continuation.settings import StepSettings

POINT = 1e-8
CYCLE = 1e-6


def growth(name, parameter, values):
    """Return the greatest real part of the exact roots as a function of one parameter."""

    def of(value):
        system = rb.load_model(name, parameters={**values, parameter: value})
        return float(rb.spectrum(system, above=-0.5).roots.roots.real.max())

    return of


@pytest.mark.parametrize(
    ("epsilon", "q"), [(0.5, 0.8391387535), (1.0, 2.0 / 3.0), (1.5, 0.4601069123)]
)
def test_van_der_pol_of_equal_orders(epsilon, q):
    real = growth("fractional_van_der_pol_orders", "q", {"epsilon": epsilon})
    found = brentq(real, q - 0.01, q + 0.01, xtol=1e-13)
    assert found == pytest.approx(2.0 / math.pi * math.acos(epsilon / 2.0), rel=POINT)
    assert found == pytest.approx(q, rel=POINT)
    system = rb.load_model(
        "fractional_van_der_pol_orders", parameters={"epsilon": epsilon, "q": found}
    )
    roots = rb.spectrum(system, above=-0.5).roots.roots
    assert abs(roots[0].imag) == pytest.approx(1.0, rel=POINT)


@pytest.mark.parametrize(
    ("A", "alpha", "beta", "B", "omega"),
    [
        (1.0, 0.9, 0.9, 2.3128689301, 1.0),
        (2.0, 0.95, 0.95, 5.3138363829, 2.0743100889),
        (1.0, 0.8, 0.9, 2.456314723, 1.123584120),
    ],
)
def test_fractional_brusselator(A, alpha, beta, B, omega):
    orders = {"A": A, "alpha": alpha, "beta": beta}
    found = brentq(growth("fractional_brusselator", "B", orders), B - 0.1, B + 0.1, xtol=1e-13)
    assert found == pytest.approx(B, rel=POINT)
    system = rb.load_model("fractional_brusselator", parameters=orders | {"B": found})
    roots = rb.spectrum(system, above=-0.5).roots.roots
    assert abs(roots[0].imag) == pytest.approx(omega, rel=POINT)
    if alpha == beta:
        closed = 1.0 + A**2 + 2.0 * A * math.cos(alpha * math.pi / 2.0)
        assert found == pytest.approx(closed, rel=POINT)
        assert omega == pytest.approx(A ** (1.0 / alpha), rel=1e-9)


def test_van_der_pol_with_a_springpot():
    branch = rb.continue_equilibria(rb.load_model("fractional_van_der_pol"), "mu", (0.1, 1.0))
    exact = branch["H1"].exact
    assert exact.parameters["mu"] == pytest.approx(0.3259981216, rel=POINT)
    assert exact.omega == pytest.approx(1.1761963238, rel=POINT)
    omega, turn = exact.omega, math.pi / 4.0
    assert omega**2 == pytest.approx(1.0 + 0.5 * math.sqrt(omega) * math.cos(turn), rel=POINT)
    damping = 0.5 / math.sqrt(omega) * math.sin(turn)
    assert exact.parameters["mu"] == pytest.approx(damping, rel=POINT)
    orbits = rb.continue_orbits(branch["H1"], method="harmonic-balance", at=(0.4, 1.0))
    for mu, frequency, highest in (
        (0.4, 1.1758762053, 0.8601611934),
        (1.0, 1.1503136123, 1.6432206301),
    ):
        orbit = orbits.at(mu=mu)
        assert 2.0 * math.pi / orbit.period == pytest.approx(frequency, rel=CYCLE)
        assert orbits.column("max x")[orbit.index] == pytest.approx(highest, rel=CYCLE)


def test_bagley_and_torvik():
    system = rb.load_model("bagley_torvik")
    leading = rb.spectrum(system).roots.roots[0]
    assert abs(leading - (-0.0973132111 + 0.5668651135j)) < 1e-10
    done = rb.simulate(
        system, 20.0, inputs={"f": {0.0: 8.0, 1.0: 0.0}}, step=1.0 / 256.0, extrapolate=True
    )
    at = [int(np.argmin(np.abs(done.times - t))) for t in (1.0, 5.0, 10.0, 20.0)]
    exact = [2.952583880, 2.943935664, -2.848380869, -1.484329464]
    assert done.column("y")[at] == pytest.approx(exact, abs=1.5e-7)


@pytest.mark.parametrize(("c", "a"), [(0.1, 0.5), (0.3, 0.8), (1e-3, 0.2), (0.05, 0.999)])
def test_damping_destabilises_zieglers_pendulum(c, a):
    def excess(omega):
        return 7.0 * omega**2 / 2.0 - 1.0 - c * omega**a * math.cos(a * math.pi / 2.0)

    omega = brentq(excess, 0.1, 3.0, xtol=1e-15)
    real = 1.0 + c * omega**a * math.cos(a * math.pi / 2.0)
    imaginary = c * omega**a * math.sin(a * math.pi / 2.0)
    load = 41.0 * real / 28.0 + 7.0 * imaginary**2 / (4.0 * real)
    system = rb.load_model("zieglers_pendulum", parameters={"c": c, "a": a})
    hopf = rb.continue_equilibria(system, "P", (1.0, 2.0))["H1"]
    assert hopf.exact.parameters["P"] == pytest.approx(load, rel=POINT)
    assert hopf.exact.omega == pytest.approx(omega, rel=POINT)
    assert load < 3.5 - math.sqrt(2.0)
    if c == 1e-3:
        assert load == pytest.approx(41.0 / 28.0, rel=2e-3)


def test_free_duffing():
    system = rb.load_model("fractional_duffing")
    leading = rb.spectrum(system).roots.roots[0]
    assert abs(leading - (-0.0706227832 + 1.0707870668j)) < 1e-10
    fork = rb.continue_equilibria(system, "k", (-1.0, 1.0))["BP1"]
    assert fork.kind == "pitchfork"
    assert fork.parameters["k"] == pytest.approx(0.0, abs=1e-10)


def force(first, c=0.2, a=0.5, drive=1.5, highest=15):
    """Return f of x'' + c D^a x + x + x^3 = f cos(drive t + phase), where x has a first harmonic.

    Harmonic balance written independently of the project: the first harmonic X_1 of x is given,
    real, the others are solved for, and the force is what is left over.
    """
    odd = np.arange(1, highest + 1, 2)
    s = 1j * drive * odd
    linear = 1.0 + s**2 + c * s**a
    waves = np.exp(2j * np.pi * np.outer(np.arange(8 * highest) / (8 * highest), odd))

    def left_over(upper):
        X = np.concatenate([[first], upper[: len(upper) // 2] + 1j * upper[len(upper) // 2 :]])
        return linear * X + waves.conj().T @ (2.0 * (waves @ X).real) ** 3 / len(waves)

    def others(upper):
        out = left_over(upper)[1:]
        return np.concatenate([out.real, out.imag])

    found = root(others, np.zeros(2 * len(odd) - 2), tol=1e-14)
    return 2.0 * abs(left_over(found.x)[0])


def test_driven_duffing_jumps():
    # A coarse realisation and long steps: folds are found on the exact operator all the same.
    system = rb.load_model("fractional_duffing", variant="driven", band=(0.5, 20.0), order=4)
    hopf = rb.continue_equilibria(system, "mu", (-0.1, 0.27))["H1"]
    assert hopf.parameters["mu"] == pytest.approx(0.0, abs=1e-9)
    steps = StepSettings(maximum=0.2)
    orbits = rb.continue_orbits(hopf, method="harmonic-balance", settings=steps)
    folds = [p.parameters["mu"] for p in orbits.special if p.label == "LPC"]
    exact = {"bounds": (0.2, 0.45), "method": "bounded", "options": {"xatol": 1e-9}}
    upper = -minimize_scalar(lambda X: -force(X), **exact).fun
    lower = minimize_scalar(force, **exact | {"bounds": (0.45, 0.7)}).fun
    assert folds == pytest.approx([upper**2, lower**2], rel=CYCLE)
    assert folds == pytest.approx([0.2594901223924743, 0.0420747731813], rel=CYCLE)


def test_an_unknown_variant_of_duffing_gets_the_nearest():
    with pytest.raises(rb.errors.UsageError, match="did you mean 'driven'"):
        rb.load_model("fractional_duffing", variant="drivn")
