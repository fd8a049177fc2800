"""Circles and regions that hold all roots."""

import math

import numpy as np
import pytest

from racs_bif.errors import ConvergenceError
from racs_bif.fractional import radii, roots
from racs_bif.fractional.characteristic import Characteristic
from racs_bif.fractional.laws import PowerSum
from racs_bif.fractional.mikhailov import mikhailov
from racs_bif.fractional.roots import characteristic_roots, roots_right


def powers(coefficients, exponents):
    return PowerSum(np.array(coefficients, dtype=float), np.array(exponents, dtype=float))


def scalar(coefficients, exponents):
    return Characteristic([powers(coefficients, exponents)], [powers([0.0], [0.0])], [[0.0]])


def ordinary(matrix):
    n = len(matrix)
    return Characteristic([powers([1.0], [1.0])] * n, [powers([1.0], [0.0])] * n, matrix)


def pairs(*zeros):
    matrix = np.zeros((2 * len(zeros), 2 * len(zeros)))
    for k, s in enumerate(zeros):
        matrix[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] = [[s.real, s.imag], [-s.imag, s.real]]
    return ordinary(matrix)


def test_zero_is_a_root_where_the_static_matrix_is_singular():
    ring = np.roll(np.eye(4), 1, axis=1) - np.eye(4)
    found = roots_right(ordinary(ring), -3.0)
    assert found.zero_order == pytest.approx(1.0, abs=0.02)
    assert found.roots == pytest.approx([-1.0 + 1.0j, -1.0 - 1.0j, -2.0])


@pytest.mark.parametrize("order", [1.1, 1.2, 1.4])
def test_a_root_of_two_powers_is_in_the_ring(order):
    found = roots_right(scalar([1.0, 1.0], [order, 0.0]), -2.0)
    assert found.roots[0] == pytest.approx(np.exp(1j * math.pi / order))


def test_leading_and_lowest_powers_of_different_signs():
    ch = scalar([1.0, 0.5, -1.0], [2.0, 1.0, 0.0])
    assert radii.annulus(ch).degree == 2.0
    assert mikhailov(ch).unstable == 1
    assert roots_right(ch, -2.0).roots == pytest.approx([0.78077640640, -1.28077640640])


def test_roots_far_beyond_where_a_lower_power_leads():
    """s + 100 s**0.6 + 1 - 25 s**0.8 = 0: near s = 1 it is 100 s**0.6 that dominates the row."""
    weight = powers([25.0, -1.0], [0.8, 0.0])
    ch = Characteristic([powers([1.0, 100.0], [1.0, 0.6])], [weight], [[1.0]])
    z = np.roots([1.0, -25.0, 100.0, 0.0, 0.0, 1.0])
    expected = np.sort(z[np.abs(np.angle(z)) < math.pi / 5].real ** 5)[::-1]
    assert expected == pytest.approx([20.0**5, 5.0**5], rel=1e-3)
    assert roots_right(ch, 0.0).roots == pytest.approx(expected, rel=1e-9)


def test_rows_and_columns_of_different_sizes_are_not_singular():
    sizes, matrix = np.diag([1.0, 1e-20]), np.array([[1.0, 2.0], [3.0, 4.0]])
    for scaled in (sizes @ matrix, matrix @ sizes, sizes @ matrix @ sizes):
        assert not radii._is_singular(scaled)


@pytest.mark.parametrize("number", [1, 2, 4])
def test_roots_on_the_boundary_of_the_region(number):
    """The region is made another one, that holds all roots right of the line."""
    angles = 0.5 * math.pi + np.array(roots._MARGINS[:number])
    found = roots_right(pairs(np.exp(1.2j), *np.exp(1j * angles)), 0.0)
    assert found.roots == pytest.approx(np.exp([1.2j, -1.2j]))


def test_roots_right_of_minus_one_unless_told(system_of):
    system = system_of({"x": "-0.5*x", "y": "-1.5*y"})
    assert characteristic_roots(system).roots == pytest.approx([-0.5])


@pytest.mark.parametrize("above", [-1.0, 0.0, 0.5])
def test_a_root_just_left_of_the_line_is_left_out(above):
    for left in (above - 0.01, above - 0.5):
        found = roots_right(pairs(above + 0.1 + 1.0j, left + 1.0j), above)
        assert found.roots == pytest.approx([above + 0.1 + 1.0j, above + 0.1 - 1.0j])


@pytest.mark.parametrize("others", [[0.5], [0.5, 1.0, 2.0]])
def test_roots_and_their_count_must_agree(monkeypatch, others):
    count = roots.count_right(ordinary(np.diag(others)))
    monkeypatch.setattr(roots, "count_right", lambda *_, **__: count)
    with pytest.raises(ConvergenceError, match=f"principle counts {len(others)}"):
        roots_right(ordinary(np.diag([0.5, 1.0, -1.0])), 0.0)


def test_without_a_cut_no_root_is_on_it():
    assert len(roots_right(ordinary(-np.eye(2)), -2.0).on_cut) == 0
