"""Exact roots against the numbers of the problems with known answers, and against each other."""

import math

import numpy as np
import pytest

from racs_bif.fractional.argument import count_right, count_unstable
from racs_bif.fractional.characteristic import Characteristic
from racs_bif.fractional.laws import PowerSum
from racs_bif.fractional.mikhailov import mikhailov, mikhailov_count
from racs_bif.fractional.mittag_leffler import mittag_leffler
from racs_bif.fractional.roots import characteristic_roots, roots_right
from racs_bif.shelf.load import load_model, system_of
from racs_bif.symbolic.strings import model_from_strings


def powers(coefficients, exponents):
    return PowerSum(np.array(coefficients, dtype=float), np.array(exponents, dtype=float))


@pytest.mark.parametrize(
    ("u", "root"), [(12.0, 0.49290598 + 8.93656849j), (20.0, 1.80501519 + 7.66054698j)]
)
def test_leading_roots_of_the_vehicle(u, root):
    found = characteristic_roots(load_model("racs", parameters={"u": u}))
    assert abs(found.roots[0] - root) < 1.5e-8
    assert found.roots[1] == found.roots[0].conjugate()
    assert found.unstable == found.count_checked == 2
    assert found.errors.max() < 1e-13 * abs(root)


@pytest.mark.parametrize(
    ("changed", "u", "omega"),
    [
        ({}, 10.2, 9.5200832),
        ({"C_s": 20000.0}, 4.5672697, 10.414023),
        ({"alpha": 0.2}, 14.23821, 7.7314068),
        ({"gamma": 0.8}, 15.266725, 7.2073304),
        ({"delta_f": 0.08}, 10.308432, 9.4531972),
    ],
)
def test_a_pair_crosses_the_axis_at_the_exact_hopf_points(changed, u, omega):
    for shift, unstable in ((-1e-4, 0), (1e-4, 2)):
        system = load_model("racs", parameters=changed | {"u": u * (1.0 + shift)})
        found = characteristic_roots(system)
        assert abs(found.roots[0].imag - omega) < 1e-3 * omega
        assert found.unstable == unstable
        x = system.exact_point(system.equilibrium(), system.values)
        assert count_unstable(system.exact, x, system.values).unstable == unstable
        assert mikhailov_count(system.exact, x, system.values).unstable == unstable


def test_no_pair_crosses_with_alpha_0_6():
    counts = [
        characteristic_roots(load_model("racs", parameters={"alpha": 0.6, "u": u})).unstable
        for u in np.linspace(1.0, 60.0, 13)
    ]
    assert len(set(counts)) == 1


@pytest.mark.parametrize("u", [5.0, 10.2, 15.0, 22.0, 30.0])
def test_the_printed_signs_leave_one_unstable_real_root(u):
    found = characteristic_roots(load_model("racs", variant="printed", parameters={"u": u}))
    assert found.unstable == 1
    assert found.roots[0].real > 0.0
    assert found.roots[0].imag == 0.0


@pytest.mark.parametrize(
    ("coefficients", "orders", "root"),
    [
        ([1.0, 0.5, 0.5], [2.0, 1.5, 0.0], -0.0973132111 + 0.5668651135j),
        ([1.0, 0.2, 1.0], [2.0, 0.5, 0.0], -0.0706227832 + 1.0707870668j),
        ([1.0, 0.5, 1.0], [2.0, 0.5, 0.0], -0.1754419826631 + 1.1777194119858j),
    ],
)
def test_poles_of_scalar_equations(coefficients, orders, root):
    ch = Characteristic([powers(coefficients, orders)], [powers([0.0], [0.0])], np.zeros((1, 1)))
    found = roots_right(ch, -5.0)
    assert len(found.roots) == 2
    digits = 1e-13 if root.imag == 1.1777194119858 else 1e-10
    assert abs(found.roots[0] - root) < digits


def test_bagley_torvik_as_a_model():
    model = model_from_strings(
        "bagley_torvik",
        {"y": "v", "v": "-0.5*w - 0.5*y"},
        parameters={},
        elements=[("w", "v", "s**0.5")],
    )
    found = characteristic_roots(system_of(model))
    assert abs(found.roots[0] - (-0.0973132111 + 0.5668651135j)) < 1e-10
    assert found.unstable == 0


def test_van_der_pol_with_springpot_has_its_pair_on_the_axis():
    model = model_from_strings(
        "springpot",
        {"x": "v", "v": "mu*(1 - x**2)*v - c*w - x"},
        parameters={"mu": 0.3259981216, "c": 0.5},
        elements=[("w", "x", "s**0.5")],
    )
    found = characteristic_roots(system_of(model))
    assert abs(found.roots[0] - 1.1761963238j) < 2e-10


@pytest.mark.parametrize("epsilon", [0.5, 1.0, 1.5])
def test_van_der_pol_of_equal_orders(epsilon):
    q = 2.0 / math.pi * math.acos(epsilon / 2.0)
    row = powers([1.0], [q])
    ch = Characteristic([row] * 2, [powers([1.0], [0.0])] * 2, [[0.0, 1.0], [-1.0, epsilon]])
    assert mikhailov(ch).on_axis == pytest.approx([1.0], abs=1e-12)
    assert count_right(ch).on_line == pytest.approx([1j], abs=1e-12)
    assert roots_right(ch).on_axis == pytest.approx([1.0], abs=1e-12)


@pytest.mark.parametrize(
    ("a", "z", "value"),
    [(0.5, -1.0, 0.4275835762), (0.7, -2.0, 0.2137867270), (1.5, -3.0, -0.1755653738)],
)
def test_mittag_leffler(a, z, value):
    assert abs(mittag_leffler(a, 1.0, z) - value) < 6e-11


def scalar(rng):
    terms = rng.integers(2, 6)
    orders = np.concatenate([[0.0], np.sort(rng.uniform(0.05, 3.0, terms))])
    coefficients = rng.normal(size=terms + 1) * 10 ** rng.uniform(-2, 2, size=terms + 1)
    zero = powers([0.0], [0.0])
    return Characteristic([powers(coefficients, orders)], [zero], np.zeros((1, 1)))


def with_elements(rng):
    ny, ne = int(rng.integers(1, 4)), int(rng.integers(1, 3))
    n = ny + ne
    core = rng.normal(size=(n, n)) * 10 ** rng.uniform(-1.5, 1.5, size=(n, n))
    core[ny:, ny:] = 0.0  # no loops among elements
    one = powers([1.0], [0.0])
    left, right = [powers([1.0], [1.0])] * ny, [one] * ny
    for _ in range(ne):
        alpha, gamma = rng.uniform(0.05, 0.95, 2)
        k = 10 ** rng.uniform(-1, 1)
        laws = (
            (powers([k], [alpha]), one),
            (powers([1.0, k], [0.0, alpha]), powers([1.0, 0.5 * k], [0.0, gamma])),
            (powers([k], [0.0]), powers([1.0], [alpha])),
        )
        above, below = laws[rng.integers(3)]
        left.append(below)
        right.append(above)
    return Characteristic(left, right, core)


@pytest.mark.parametrize("seed", range(4))
def test_three_counts_agree_on_random_systems_of_irrational_orders(seed):
    rng = np.random.default_rng(seed)
    roots = 0
    for k in range(100):
        ch = scalar(rng) if k % 3 == 0 else with_elements(rng)
        found = roots_right(ch, -(10 ** rng.uniform(-2, 2)))
        beyn = int(found.multiplicities[found.roots.real > 0.0].sum())
        assert beyn == found.unstable == count_right(ch).unstable == mikhailov(ch).unstable
        residual = np.abs(1.0 / ch.log_det(np.log(found.roots))[1])
        assert residual.max(initial=0.0) < 1e-10
        roots += len(found.roots)
    assert roots > 100
