import math

import numpy as np
import pytest

from racs_bif.errors import ConvergenceError, ParameterError
from racs_bif.fractional import search
from racs_bif.fractional.argument import OnContourError, count_rectangle
from racs_bif.fractional.beyn import roots_in_disc
from racs_bif.fractional.characteristic import Characteristic
from racs_bif.fractional.laws import PowerSum
from racs_bif.fractional.polish import polish
from racs_bif.fractional.radii import annulus
from racs_bif.fractional.roots import characteristic_roots, roots_right
from racs_bif.fractional.search import zeros_in_rectangle
from racs_bif.shelf.load import load_model


def powers(coefficients, exponents):
    return PowerSum(np.array(coefficients, dtype=float), np.array(exponents, dtype=float))


def scalar(coefficients, exponents):
    zero = powers([0.0], [0.0])
    return Characteristic([powers(coefficients, exponents)], [zero], np.zeros((1, 1)))


def ordinary(matrix):
    n = len(matrix)
    return Characteristic([powers([1.0], [1.0])] * n, [powers([1.0], [0.0])] * n, matrix)


def commensurate(coefficients, q):
    """Roots on the principal sheet of a polynomial in s**(1/q), lowest power first."""
    z = np.roots(np.array(coefficients, dtype=float)[::-1])
    return z[np.abs(np.angle(z)) < math.pi / q] ** q


@pytest.mark.parametrize("seed", range(20))
def test_commensurate_orders_against_a_polynomial(seed):
    rng = np.random.default_rng(seed)
    q = int(rng.integers(2, 5))
    coefficients = rng.normal(size=int(rng.integers(3, 3 * q + 1)))
    found = roots_right(scalar(coefficients, np.arange(len(coefficients)) / q), -1e6)
    expected = commensurate(coefficients, q)
    assert len(found.roots) == len(expected)
    for root in found.roots:
        assert np.abs(expected - root).min() < 1e-11 * abs(root)


@pytest.mark.parametrize("n", [3, 8, 20])
def test_an_ordinary_system_has_its_eigenvalues(n):
    rng = np.random.default_rng(n)
    scale = 10 ** rng.uniform(-3, 3, n)
    matrix = rng.normal(size=(n, n)) * scale[:, None] / scale
    found = roots_right(ordinary(matrix), -1e9)
    eigenvalues = np.linalg.eigvals(matrix)
    assert len(found.roots) == n
    for root in found.roots:
        assert np.abs(eigenvalues - root).min() < 1e-12 * abs(root)
    assert found.unstable == (eigenvalues.real > 0.0).sum()


def test_entries_of_very_different_sizes():
    rng = np.random.default_rng(0)
    matrix = rng.normal(size=(6, 6)) * 10 ** rng.uniform(-3, 6, (6, 6))
    found = roots_right(ordinary(matrix), -1e9)
    eigenvalues = np.linalg.eigvals(matrix)
    assert len(found.roots) == 6
    for root in found.roots:
        assert np.abs(eigenvalues - root).min() < 1e-9 * abs(root)


def test_only_roots_right_of_the_line_rightmost_first():
    matrix = np.diag([-3.0, 2.0, -0.5, 0.5])
    assert roots_right(ordinary(matrix), -1.0).roots == pytest.approx([2.0, 0.5, -0.5])
    assert roots_right(ordinary(matrix), 1.0).roots == pytest.approx([2.0])
    assert len(roots_right(ordinary(matrix), 3.0).roots) == 0
    assert len(roots_right(ordinary(matrix), 1e3).roots) == 0


def test_multiple_roots_of_both_kinds():
    defective = roots_right(ordinary(np.array([[-1.0, 1.0], [0.0, -1.0]])), -2.0)
    assert defective.roots == pytest.approx([-1.0], abs=1e-12)
    assert defective.multiplicities.tolist() == [2]
    semisimple = roots_right(ordinary(-np.eye(3)), -2.0)
    assert semisimple.roots == pytest.approx([-1.0], abs=1e-12)
    assert semisimple.multiplicities.tolist() == [3]


def test_double_complex_root_of_a_fractional_equation():
    row = powers([1.0, 0.5, 1.0], [2.0, 0.5, 0.0])
    coupled = np.array([[0.0, 0.0], [1.0, 0.0]])
    found = roots_right(Characteristic([row, row], [powers([1.0], [0.0])] * 2, coupled))
    assert found.multiplicities.tolist() == [2, 2]
    assert abs(found.roots[0] - (-0.1754419826631 + 1.1777194119858j)) < 1e-11


def test_two_close_roots_are_two():
    found = roots_right(ordinary(np.diag([-1.0, -1.0 - 1e-5])), -2.0)
    assert found.roots == pytest.approx([-1.0, -1.0 - 1e-5], abs=1e-10)
    assert found.multiplicities.tolist() == [1, 1]


def test_a_root_on_the_branch_cut_is_told_apart():
    zero = powers([0.0], [0.0])
    rows = [powers([1.0], [1.0]), powers([1.0, 0.5, 1.0], [2.0, 0.5, 0.0])]
    found = roots_right(Characteristic(rows, [powers([1.0], [0.0]), zero], np.diag([-0.3, 0.0])))
    assert found.on_cut == pytest.approx([-0.3])
    assert len(found.roots) == found.count_checked == 2


def test_roots_on_the_axis_and_at_zero_are_reported():
    pairs = np.zeros((4, 4))
    pairs[:2, :2], pairs[2:, 2:] = [[0.0, 1.0], [-1.0, 0.0]], [[0.0, 1.0], [-9.0, 0.0]]
    found = roots_right(ordinary(pairs))
    assert sorted(found.on_axis) == pytest.approx([1.0, 3.0])
    assert found.unstable == 0
    found = roots_right(ordinary(np.array([[0.0, 1.0], [0.0, -1.0]])), -2.0)
    assert found.at_zero
    assert found.zero_order == pytest.approx(1.0, abs=0.02)
    assert found.roots == pytest.approx([-1.0])
    found = roots_right(scalar([1.0, 0.5], [2.0, 0.5]), -2.0)
    assert found.zero_order == pytest.approx(0.5, abs=0.02)
    assert found.unstable == 0


def test_roots_near_the_axis_are_on_their_side():
    for shift in (1e-7, -1e-7):
        found = roots_right(ordinary(np.array([[shift, 1.0], [-1.0, shift]])))
        assert found.unstable == (2 if shift > 0.0 else 0)
        assert found.on_axis == ()


def test_all_roots_lie_in_the_annulus():
    rng = np.random.default_rng(5)
    for _ in range(30):
        n = int(rng.integers(2, 6))
        matrix = rng.normal(size=(n, n)) * 10 ** rng.uniform(-3, 3, (n, n))
        ring = annulus(ordinary(matrix))
        sizes = np.log(np.abs(np.linalg.eigvals(matrix)))
        assert ring.inner < sizes.min()
        assert sizes.max() < ring.outer
        assert ring.degree == n


def test_nearly_equal_leading_orders_can_be_bounded():
    found = roots_right(scalar([1.0, 10.0, 0.004], [0.0, 2.51, 2.5175]))
    assert found.count_checked == len(found.roots)
    with pytest.raises(ConvergenceError, match="scale the model"):
        roots_right(scalar([1.0, 10.0, -0.004], [0.0, 2.51, 2.5175]))


def test_a_derivative_in_a_loop_is_refused():
    rows = [powers([1.0], [1.0]), powers([1.0], [0.0])]
    weights = [powers([1.0], [0.0]), powers([1.0], [1.5])]
    ch = Characteristic(rows, weights, np.array([[0.0, 1.0], [1.0, 0.0]]))
    with pytest.raises(ConvergenceError, match="closes a loop"):
        roots_right(ch)


def test_beyn_finds_more_roots_than_rows():
    ch = scalar([1.0, 0.5, 1.0, 0.3], [2.0, 0.5, 0.0, 1.7])
    number, _ = count_rectangle(ch, complex(-3.0, -4.0), complex(3.0, 4.0))
    assert number > 1
    estimates = roots_in_disc(ch, 0.0, 5.0, number + 2, nodes=256)
    zeros, errors = polish(ch, estimates)
    inside = (np.abs(zeros.real) < 3.0) & (np.abs(zeros.imag) < 4.0) & (errors < 1e-10)
    assert len(np.unique(zeros[inside].round(8))) == number


def test_a_rectangle_through_a_root_is_refused():
    with pytest.raises(OnContourError) as caught:
        count_rectangle(ordinary(np.array([[2.0]])), complex(-1.0, 0.0), complex(3.0, 1.0))
    assert np.exp(caught.value.places) == pytest.approx([2.0])


def test_derivative_of_the_determinant():
    system = load_model("racs", parameters={"u": 12.0})
    p = system.values
    x = system.exact_point(system.equilibrium(), p)
    ch = Characteristic.of_model(system.exact, x, p)
    t = np.log(np.array([3.0 + 4.0j, -1.0 + 9.0j, 0.01 + 0.001j]))
    step = 1e-5
    after, before = ch.log_det(t + step)[0], ch.log_det(t - step)[0]
    assert ch.log_det(t)[1] == pytest.approx((after - before) / (2.0 * step), rel=1e-7)
    direct = [np.linalg.det(system.exact.delta(s, x, p)) for s in np.exp(t)]
    assert np.exp(ch.log_det(t)[0]) == pytest.approx(direct, rel=1e-12)
    assert np.linalg.det(ch.matrix(t)) == pytest.approx(direct, rel=1e-12)


def test_the_determinant_where_a_row_is_exactly_zero():
    ch = ordinary(np.diag([1.0, 4.0]))
    log_det, rate = ch.log_det(np.log([1.0, 3.0]))
    assert log_det[0].real == -math.inf
    assert rate[0] == math.inf
    assert np.exp(log_det[1]) == pytest.approx(-2.0)
    assert rate[1] == pytest.approx(3.0 * (1.0 / 2.0 - 1.0))
    assert [len(part) for part in ch.log_det(np.zeros(0))] == [0, 0]


def test_the_determinant_where_a_coefficient_is_large():
    t = np.array([5.0 + 1.0j])
    found = scalar([1.0, 1e4], [0.0, 0.5]).log_det(t)[0]
    assert np.exp(found) == pytest.approx(1.0 + 1e4 * np.exp(0.5 * t))


def test_a_matrix_that_is_not_square_is_refused():
    one = [powers([1.0], [1.0])] * 2
    with pytest.raises(ParameterError, match=r"2 rows of powers do not fit a matrix \(2, 3\)"):
        Characteristic(one, one, np.ones((2, 3)))


def test_at_the_hopf_point_the_pair_is_on_the_axis():
    found = characteristic_roots(load_model("racs", parameters={"u": 10.2}))
    assert found.on_axis == pytest.approx([9.5200832], rel=1e-8)
    assert found.unstable == 0


@pytest.mark.parametrize(
    ("left", "core"),
    [
        (powers([1.0], [-0.5]), [[1.0]]),
        (powers([0.0], [1.0]), [[1.0]]),
        (powers([1.0], [1.0]), [[math.nan]]),
        (powers([1.0], [1.0]), [[1.0, 0.0], [0.0, 1.0]]),
    ],
)
def test_matrices_that_cannot_be_used(left, core):
    with pytest.raises(ParameterError):
        Characteristic([left], [powers([1.0], [0.0])], core)


def test_a_line_that_is_not_finite_is_refused():
    with pytest.raises(ConvergenceError, match="not finite"):
        roots_right(ordinary(np.eye(2)), math.nan)


def test_the_ring_of_all_roots_is_narrow():
    for largest, smallest in ((1e-3, 1e-5), (1e5, 1e3), (1e3, 1e-3)):
        ring = annulus(ordinary(np.diag([-largest, -smallest])))
        assert math.log(largest) <= ring.outer < math.log(largest) + 0.2
        assert math.log(smallest) - 0.2 < ring.inner <= math.log(smallest)


def test_a_double_root_is_as_sharp_as_a_simple_one():
    """Its two estimates are apart by the root of rounding; their mean is not."""
    A = np.array([[0.3, 1.0, 0.2, 0.7], [-2.0, 0.3, 0.4, 0.1], [0, 0, 0.3, 1.0], [0, 0, -2.0, 0.3]])
    found = roots_right(ordinary(A), 0.0)
    assert found.multiplicities.tolist() == [2, 2]
    assert abs(found.roots[0] - (0.3 + 2.0**0.5 * 1j)) < 1e-13
    assert found.errors.max() < 1e-12


def test_errors_are_those_of_the_roots():
    """The zeros are found over log s: a root's error is as large as the root."""
    small, large = (roots_right(ordinary(np.diag([-r])), -1e9) for r in (1e-4, 1e4))
    assert small.errors.max() < 1e-17
    assert large.errors.min() > 1e-13


def test_at_zero_only_where_a_root_is():
    assert not roots_right(ordinary(-np.eye(2)), -2.0).at_zero


def test_close_roots_beside_a_double_one_are_two():
    A = np.diag([-1.0, -1.0 - 1e-5, -2.0, -2.0])
    A[2, 3] = 1.0
    found = roots_right(ordinary(A), -3.0)
    assert found.roots == pytest.approx([-1.0, -1.0 - 1e-5, -2.0], abs=1e-10)
    assert found.multiplicities.tolist() == [1, 1, 2]


def test_the_order_of_a_root_at_zero_below_roots_of_very_different_sizes():
    found = roots_right(ordinary(np.diag([0.0, -1e-3, -1e6])), -1e9)
    assert found.zero_order == pytest.approx(1.0, abs=0.02)
    assert found.roots == pytest.approx([-1e-3, -1e6], rel=1e-9)


def test_a_box_is_cut_across_its_longer_side():
    low = 1.0 - 2.0j
    wide, tall = (1.2 - 1.9j, 1.08 - 1.9j, 1.08 - 2.0j), (1.1 - 1.8j, 1.1 - 1.92j, 1.0 - 1.92j)
    for high, top, bottom in (wide, tall):
        first, second = search._Box(low, high).halves(0.4)
        assert (first.low, second.high) == (low, high)
        assert (first.high, second.low) == pytest.approx((top, bottom))


def test_a_cut_through_a_root_is_made_elsewhere():
    for fraction in search._CUTS[:2]:
        found = zeros_in_rectangle(ordinary(np.array([[math.exp(fraction)]])), -0.1j, 1.0 + 0.1j)
        assert found.t == pytest.approx([fraction], abs=1e-12)


def test_a_circle_through_a_root_beside_a_double_one_is_made_smaller():
    A = np.diag(np.exp([0.3, 0.3, 0.3 + 3.0 * search._CLOSE]))
    A[0, 1] = 1.0
    found = zeros_in_rectangle(ordinary(A), -0.2 - 0.5j, 0.9 + 0.6j)
    assert found.t == pytest.approx([0.3, 0.3 + 3.0 * search._CLOSE], abs=1e-12)
    assert found.multiplicities.tolist() == [2, 1]


@pytest.mark.parametrize("poor", [lambda t: t[:1], None], ids=["a root is missed", "singular"])
def test_a_box_whose_roots_cannot_be_estimated_is_cut(monkeypatch, poor):
    calls = []

    def estimates(*of):
        calls.append(of)
        if len(calls) > 1:
            return roots_in_disc(*of)
        if poor is None:
            raise np.linalg.LinAlgError
        return poor(roots_in_disc(*of))

    monkeypatch.setattr(search, "roots_in_disc", estimates)
    ch = ordinary(np.diag(np.exp([0.3, 0.6])))
    found = zeros_in_rectangle(ch, -0.2 - 0.5j, 0.9 + 0.6j)
    assert sorted(found.t.real) == pytest.approx([0.3, 0.6], abs=1e-12)
    assert len(calls) > 1


@pytest.mark.parametrize("omega", [1e-3, 1.0, 1e4])
def test_roots_within_rounding_of_the_axis_are_on_it(omega):
    """The count leaves them out, though they are found to be right of it."""
    found = roots_right(ordinary(omega * np.array([[1e-10, 1.0], [-1.0, 1e-10]])), 0.0)
    assert found.roots == pytest.approx(omega * np.array([1j, -1j]))
    assert found.on_axis == pytest.approx([omega])
    assert found.count_checked == found.unstable == 0


@pytest.mark.parametrize("above", [0.0, -0.6, 0.4])
def test_a_root_on_the_line_is_not_right_of_it(above):
    matrix = np.array([[above, 1.0], [-1.0, above]])
    assert len(roots_right(ordinary(matrix), above).roots) == 0


def test_a_real_root_just_right_of_the_line_is_found():
    assert roots_right(ordinary(np.array([[2.0]])), 1.98).roots == pytest.approx([2.0])


def test_roots_on_the_branch_cut_are_told_from_the_right():
    half = powers([1.0, 0.5, 1.0], [2.0, 0.5, 0.0])
    rows, zero = [powers([1.0], [1.0])] * 3 + [half], powers([0.0], [0.0])
    weights = [powers([1.0], [0.0])] * 3 + [zero]
    found = roots_right(Characteristic(rows, weights, np.diag([-0.3, -0.1, -0.7, 0.0])))
    assert found.on_cut == pytest.approx([-0.1, -0.3, -0.7])


def test_the_ring_is_narrow_where_zero_is_a_root():
    """Of det Delta = s (s**2 + 1): s det'/det leaves 1 by 1 % at |s| = 0.05."""
    matrix = np.zeros((3, 3))
    matrix[1:, 1:] = [[0.0, 1.0], [-1.0, 0.0]]
    ring = annulus(ordinary(matrix))
    assert math.log(0.05) - 0.25 < ring.inner <= math.log(0.05) + 1e-3
    assert ring.zero_order == pytest.approx(1.0, abs=0.01)


def test_nothing_but_a_root_at_zero():
    ring = annulus(ordinary(np.zeros((1, 1))))
    assert ring.zero_order == pytest.approx(1.0)
    assert ring.inner == ring.outer - 1.0
    assert len(roots_right(ordinary(np.zeros((1, 1)))).roots) == 0


@pytest.mark.parametrize("apart", [1e-6, 1e-5, 1e-4, 2e-4, 1e-3])
def test_a_double_root_with_a_simple_one_close_by(apart):
    """They are one of multiplicity 3 whose error covers them, or they are told apart."""
    exact = -np.exp([0.3, 0.3, 0.3 + apart])
    A = np.diag(exact)
    A[0, 1] = 1.0
    found = roots_right(ordinary(A), -9.0)
    assert found.multiplicities.sum() == 3
    if apart > 1e-4:
        assert found.multiplicities.tolist() == [2, 1]
        assert found.roots == pytest.approx(exact[1:], rel=1e-10)
        assert found.errors.max() < 1e-10
    else:
        assert found.roots == pytest.approx([exact.mean()], rel=1e-8)
        away = np.abs(exact - exact.mean()).max()
        assert away < found.errors[0] < 2.0 * away


def test_three_roots_around_their_mean_are_felt_though_their_variance_vanishes():
    size, turned = 1e-5, np.exp(2j * np.pi / 3.0 * np.arange(3))
    zeros = np.exp(0.3 + 0.8j + size * turned)
    A = np.zeros((6, 6))
    for k, zero in enumerate(zeros):
        rows = slice(2 * k, 2 * k + 2)
        A[rows, rows] = [[zero.real, zero.imag], [-zero.imag, zero.real]]
    found = roots_right(ordinary(A), -9.0)
    if 3 in found.multiplicities:
        assert size * np.exp(0.3) < found.errors[0] < 3.0 * size * np.exp(0.3)
    else:
        upper = found.roots[found.roots.imag > 0.0]
        assert np.sort_complex(upper) == pytest.approx(np.sort_complex(zeros), rel=1e-8)
