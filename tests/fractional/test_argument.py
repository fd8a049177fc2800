import numpy as np
import pytest

from racs_bif.errors import ConvergenceError
from racs_bif.fractional.argument import Change, count_right, follow, segment
from racs_bif.fractional.characteristic import Characteristic
from racs_bif.fractional.laws import PowerSum
from racs_bif.fractional.mikhailov import mikhailov
from racs_bif.fractional.radii import outer_phase
from racs_bif.fractional.roots import roots_right


def powers(coefficients, exponents):
    return PowerSum(np.array(coefficients, dtype=float), np.array(exponents, dtype=float))


def ordinary(matrix):
    n = len(matrix)
    return Characteristic([powers([1.0], [1.0])] * n, [powers([1.0], [0.0])] * n, matrix)


def oscillator(shift, omega=1.0):
    return ordinary(np.array([[shift, omega], [-omega, shift]]))


@pytest.mark.parametrize("above", [-30.0, -2.0, -0.4, -1e-3, 0.0, 1e-3, 0.4, 2.0, 30.0])
def test_count_right_of_any_line(above):
    rng = np.random.default_rng(3)
    for _ in range(10):
        matrix = rng.normal(size=(5, 5)) * 3.0
        number = int((np.linalg.eigvals(matrix).real > above).sum())
        assert count_right(ordinary(matrix), above).unstable == number


@pytest.mark.parametrize("above", [-30.0, -2.0, -0.4, -1e-3, 0.0, 0.4])
def test_the_cut_is_left_out_of_the_contour(above):
    ch = Characteristic(
        [powers([1.0], [1.0])] * 2 + [powers([1.0], [0.0])],
        [powers([1.0], [0.0])] * 2 + [powers([0.7], [0.37])],
        np.array([[0.0, 1.0, 0.0], [-4.0, -0.3, -1.0], [1.0, 0.0, 0.0]]),
    )
    everything = roots_right(ch, -1e3).roots
    assert count_right(ch, above).unstable == (everything.real > above).sum()


def test_roots_on_the_line_are_reported_not_counted():
    count = count_right(oscillator(0.0))
    assert count.unstable == 0
    assert count.on_line == pytest.approx([1j])
    count = count_right(oscillator(-0.25), -0.25)
    assert count.unstable == 0
    assert count.on_line == pytest.approx([-0.25 + 1j])
    both = np.zeros((4, 4))
    both[:2, :2], both[2:, 2:] = [[0.0, 1.0], [-1.0, 0.0]], [[0.5, 3.0], [-3.0, 0.5]]
    count = count_right(ordinary(both))
    assert count.unstable == 2
    assert count.on_line == pytest.approx([1j])


@pytest.mark.parametrize("shift", [1e-3, 1e-6, 1e-8])
def test_a_root_beside_the_axis_is_not_missed(shift):
    assert count_right(oscillator(shift)).unstable == 2
    assert count_right(oscillator(-shift)).unstable == 0
    assert mikhailov(oscillator(shift)).unstable == 2
    assert mikhailov(oscillator(-shift)).stable


def test_mikhailov_says_where_roots_are_on_the_axis():
    count = mikhailov(oscillator(0.0, 3.0))
    assert count.unstable is None
    assert not count.stable
    assert count.on_axis == pytest.approx([3.0])
    assert (count.distance, count.evaluations) == (0.0, 0)


def test_mikhailov_refuses_a_phase_that_is_no_count(monkeypatch):
    monkeypatch.setattr("racs_bif.fractional.mikhailov.outer_phase", lambda *_: 1.3)
    with pytest.raises(ConvergenceError, match="which is no count"):
        mikhailov(oscillator(-0.1))
    monkeypatch.setattr(
        "racs_bif.fractional.mikhailov.outer_phase", lambda *of: outer_phase(*of) - np.pi
    )
    with pytest.raises(ConvergenceError, match=r"gives -1\.000 unstable roots"):
        mikhailov(oscillator(-0.1))


def test_zero_is_reported_by_both_counts():
    ch = ordinary(np.array([[0.0, 1.0], [0.0, 2.0]]))
    assert count_right(ch).at_zero
    assert count_right(ch).unstable == 1
    count = mikhailov(ch)
    assert count.at_zero
    assert count.unstable == 1
    assert not mikhailov(ordinary(np.array([[0.0, 1.0], [0.0, -2.0]]))).stable


def test_a_law_that_integrates_has_no_root_at_zero_of_its_own():
    # x' = -w, w = s**-0.6 x: s**1.6 + 1 = 0
    ch = Characteristic(
        [powers([1.0], [1.0]), powers([1.0], [0.6])],
        [powers([1.0], [0.0])] * 2,
        np.array([[0.0, -1.0], [1.0, 0.0]]),
    )
    count = mikhailov(ch)
    assert not count.at_zero
    assert count.stable
    assert roots_right(ch, -2.0).roots[0] == pytest.approx(np.exp(1j * np.pi / 1.6))


def test_what_a_count_costs():
    rng = np.random.default_rng(4)
    matrix = rng.normal(size=(5, 5)) * 3.0
    assert count_right(ordinary(matrix)).evaluations < 200
    assert mikhailov(ordinary(matrix)).evaluations < 150
    assert mikhailov(ordinary(matrix)).distance < 0.01
    assert count_right(ordinary(matrix)).discrepancy < 0.26


def test_several_roots_on_the_line_at_once():
    """Each is reported, and the line is moved by little against them, however small they are."""
    for unit in (1.0, 1e-4):
        matrix = np.diag([0.0, 0.0, 0.0, 0.0, -2.0])
        matrix[:2, :2], matrix[2:4, 2:4] = [[0.0, 1.0], [-1.0, 0.0]], [[0.0, 3.0], [-3.0, 0.0]]
        count = count_right(ordinary(unit * matrix))
        assert count.unstable == 0
        assert count.on_line == pytest.approx([1j * unit, 3j * unit])


def test_a_contour_that_still_meets_a_root_is_moved_further(monkeypatch):
    monkeypatch.setattr("racs_bif.fractional.argument._SHIFTS", (0.0, 1e-7))
    assert count_right(oscillator(0.0)).on_line == pytest.approx([1j])


def alone(*rows):
    """Rows that are not coupled: det Delta is their product."""
    zero = powers([0.0], [0.0])
    return Characteristic(rows, [zero] * len(rows), np.zeros((len(rows), len(rows))))


def test_the_change_of_the_logarithm_is_all_of_it(monkeypatch):
    """Of s**16: phases of whole turns between the first points are not lost."""
    ch, quarter = alone(powers([1.0], [16.0])), 0.25j * np.pi
    determinants = []
    log_det = ch.log_det
    monkeypatch.setattr(ch, "log_det", lambda t: determinants.extend(t) or log_det(t))
    change = follow(ch, [segment(-quarter, quarter), segment(quarter, 1.0 + 2.0 * quarter)])
    assert change.log == pytest.approx(16.0 * (1.0 + 3.0 * quarter))
    assert change.evaluations == len(determinants)
    assert follow(ch, []) == Change(0.0j, 0.0, 0)


@pytest.mark.parametrize("turns", [0.3, -1.0])
def test_a_phase_that_is_no_count_is_refused(monkeypatch, turns):
    change = Change(1j * np.pi * turns, 0.0, 0)
    monkeypatch.setattr("racs_bif.fractional.argument.follow", lambda *_: change)
    with pytest.raises(ConvergenceError, match="which is no count"):
        count_right(oscillator(-0.1))


def test_the_line_is_moved_off_its_roots_by_little():
    """However small they are, and with other roots close to the branch cut."""
    beside, on_line = powers([1.0, 1.0, 0.26], [2, 1, 0]), powers([1.0, 2.0, 10.0], [2, 1, 0])
    count = count_right(alone(on_line, beside, powers([1.0, 1.0], [0.5, 0.0])), -1.0)
    assert count.unstable == 2
    assert count.on_line == pytest.approx([-1.0 + 3.0j])
    matrix = np.zeros((4, 4))
    matrix[:2, :2], matrix[2:, 2:] = [[0.0, 1.0], [-1.0, 0.0]], [[0.5, 3.0], [-3.0, 0.5]]
    count = count_right(ordinary(1e-8 * matrix))
    assert count.unstable == 2
    assert count.on_line == pytest.approx([1e-8j], rel=1e-9, abs=0.0)


def test_a_real_root_on_the_line_is_one():
    matrix = np.diag([0.5, 2.0, 0.5, 0.5])
    matrix[2:, 2:] = [[0.5, 1.0], [-1.0, 0.5]]
    for A, on_line in ((matrix[:2, :2], [0.5]), (matrix, [0.5, 0.5 + 1.0j])):
        count = count_right(ordinary(A), 0.5)
        assert count.on_line == pytest.approx(on_line)
        assert count.unstable == 1


def test_lines_beside_the_inner_circle():
    """Contours run along the branch cut outside it, and end on it inside."""
    half = powers([1.0, 1.0], [0.5, 0.0])
    small = alone(powers([1.0, -0.9], [1, 0]), powers([1.0, -0.01], [1, 0]), half)
    for above, number in ((0.5, 1), (-0.5, 2), (-0.02, 2), (-0.005, 2)):
        assert count_right(small, above).unstable == number
    large = alone(powers([1.0, 2.0], [1, 0]), half)
    assert count_right(large, -0.1).unstable == 0
