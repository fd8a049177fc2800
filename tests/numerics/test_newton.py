"""Newton's method across a hyperplane."""

import math

import numpy as np
import pytest

from racs_bif.errors import ConvergenceError
from racs_bif.numerics.bordered import factorise
from racs_bif.numerics.newton import damped_newton, newton


class Circle:
    chord = False

    def __init__(self):
        self.trail = []
        self.matrices = 0

    def residual(self, z):
        self.trail.append(z.copy())
        return np.array([z @ z - 1])

    def jacobian(self, z):
        return 2 * z[None, :]

    def terms(self, z):
        return abs(self.jacobian(z)) @ abs(z)

    def bordered(self, z, row):
        self.matrices += 1
        return factorise(np.vstack([self.jacobian(z), row]))


ROW = np.array([1.0, 0.0])
WEIGHTS = np.ones(2)


def test_convergence_is_quadratic():
    circle = Circle()
    solved = newton(circle, np.array([0.6, 1.1]), ROW, WEIGHTS, tolerance=1e-10, iterations=9)
    errors = [abs(z[1] - 0.8) for z in circle.trail] + [abs(solved.z[1] - 0.8)]
    errors = [error for error in errors if error > 1e-14]
    orders = [
        math.log(c / b) / math.log(b / a)
        for a, b, c in zip(errors, errors[1:], errors[2:], strict=False)
    ]
    assert orders[-1] == pytest.approx(2, abs=0.1)
    assert solved.z == pytest.approx([0.6, 0.8], abs=1e-14)
    assert solved.iterations == len(circle.trail)


def test_tangent_comes_along():
    solved = newton(Circle(), np.array([0.6, 0.81]), ROW, WEIGHTS, tolerance=1e-10, iterations=9)
    assert solved.tangent == pytest.approx([1, -0.75], rel=1e-9)


class Chord(Circle):
    chord = True


def test_a_chord_takes_two_matrices_and_the_tangent_is_the_solutions():
    near, far = Chord(), Chord()
    solved = newton(near, np.array([0.6, 0.83]), ROW, WEIGHTS, tolerance=1e-10, iterations=9)
    assert near.matrices == solved.iterations == 2
    assert solved.z == pytest.approx([0.6, 0.8], abs=1e-15)
    assert solved.tangent == pytest.approx([1, -0.75], rel=1e-11)
    # it contracts as slowly as Newton's own second correction says
    assert solved.contraction == pytest.approx(0.019, abs=0.002)
    # where it does not contract tenfold it is renewed, and is Newton's method again
    newton(far, np.array([0.6, 1.1]), ROW, WEIGHTS, tolerance=1e-10, iterations=9)
    assert 2 < far.matrices < len(far.trail)


def test_a_chord_does_not_diverge_unseen():
    chord = Chord()
    with pytest.raises(ConvergenceError, match="contract"):
        newton(chord, np.array([1.5, 0.1]), ROW, WEIGHTS, tolerance=1e-10, iterations=50)
    assert len(chord.trail) <= 4


def test_divergence_is_seen_at_once():
    circle = Circle()
    with pytest.raises(ConvergenceError, match="contract"):
        newton(circle, np.array([1.5, 0.1]), ROW, WEIGHTS, tolerance=1e-10, iterations=50)
    assert len(circle.trail) <= 4


def test_too_few_iterations():
    with pytest.raises(ConvergenceError, match="2 iterations"):
        newton(Circle(), np.array([0.6, 1.1]), ROW, WEIGHTS, tolerance=1e-10, iterations=2)


def test_nan_is_seen_at_once():
    circle = Circle()
    with pytest.raises(ConvergenceError, match="not finite"):
        newton(circle, np.array([math.nan, 1]), ROW, WEIGHTS, tolerance=1e-10, iterations=9)
    assert len(circle.trail) == 1


def test_tolerance_below_rounding_is_met_as_far_as_rounding_lets():
    solved = newton(Circle(), np.array([0.6, 0.9]), ROW, WEIGHTS, tolerance=1e-19, iterations=20)
    assert solved.z[1] == pytest.approx(0.8, abs=1e-15)


def test_damping_widens_convergence():
    class Arctan(Circle):
        def residual(self, z):
            self.trail.append(z.copy())
            return np.arctan(z[1:])

        def jacobian(self, z):
            return np.array([[0, 1 / (1 + z[1] ** 2)]])

    start = np.array([0.0, 30.0])
    with pytest.raises(ConvergenceError):
        newton(Arctan(), start, ROW, WEIGHTS, tolerance=1e-10, iterations=50)
    solved = damped_newton(Arctan(), start, ROW, WEIGHTS, tolerance=1e-10, iterations=50)
    assert solved.z[1] == pytest.approx(0, abs=1e-12)


def test_damping_gives_up_where_there_is_no_solution():
    with pytest.raises(ConvergenceError):
        damped_newton(Circle(), np.array([1.5, 0.7]), ROW, WEIGHTS, tolerance=1e-10, iterations=50)


class Steep(Circle):
    def residual(self, z):
        return np.array([1e150])

    def jacobian(self, z):
        return np.array([[0.0, 1e-200]])


def test_a_correction_that_is_not_finite_is_refused():
    start = np.array([0.6, 1.1])
    with pytest.raises(ConvergenceError, match="Newton's correction is not finite"):
        newton(Steep(), start, ROW, WEIGHTS, tolerance=1e-10, iterations=9)


def test_too_few_iterations_with_damping():
    with pytest.raises(ConvergenceError, match="did not converge in 1 iterations"):
        damped_newton(Circle(), np.array([0.6, 1.1]), ROW, WEIGHTS, tolerance=1e-10, iterations=1)


class Logarithm(Circle):
    """A function that is defined on the right only."""

    def __init__(self):
        super().__init__()
        self.refused = 0

    def residual(self, z):
        if z[1] <= 0.0:
            self.refused += 1
            raise ZeroDivisionError
        return np.log(z[1:])

    def jacobian(self, z):
        return np.array([[0.0, 1.0 / z[1]]])


def test_corrections_that_leave_the_domain_are_shortened():
    logarithm, start = Logarithm(), np.array([0.6, 30.0])
    solved = damped_newton(logarithm, start, ROW, WEIGHTS, tolerance=1e-10, iterations=50)
    assert solved.z == pytest.approx([0.6, 1.0], abs=1e-12)
    assert logarithm.refused > 0
