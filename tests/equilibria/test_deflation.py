"""Other equilibria, and where the search for them leads nowhere."""

import numpy as np
import pytest

from racs_bif.equilibria.deflation import other_equilibria, same_state
from racs_bif.errors import ConvergenceError

SCALE = np.ones(1)


class Cubic:
    """x**3 - x = 0, undefined below -5, with what goes wrong on demand."""

    polishes = True

    def residual(self, X, p):
        return np.where(X < -5.0, np.nan, X**3 - p[0] * X)

    def solver(self, X, p):
        slope = 3.0 * X[0] ** 2 - p[0]
        if slope == 0.0:
            raise np.linalg.LinAlgError("singular")
        return lambda value: value / slope

    def equilibrium(self, X, p):
        if not self.polishes:
            raise ConvergenceError("does not converge")
        for _ in range(20):
            X = X - self.solver(X, p)(self.residual(X, p))
        return X


def found_from(start, known=(0.0,), model=None):
    known = [np.array([x]) for x in known]
    starts = [np.array([start])]
    found = other_equilibria(model or Cubic(), np.array([1.0]), known, starts, SCALE)
    return sorted(float(X[0]) for X in found)


def test_all_others_are_found_from_anywhere():
    assert found_from(0.3) == pytest.approx([-1.0, 1.0], abs=1e-12)


def test_starts_that_lead_nowhere_are_passed_over():
    # The known equilibrium starts its own search, which finds the same.
    assert found_from(-7.0) == found_from(1.0 / 3.0**0.5) == pytest.approx([-1.0, 1.0])


def test_nothing_is_new_where_all_are_known():
    assert found_from(0.3, known=(-1.0, 0.0, 1.0)) == []


def test_what_cannot_be_polished_is_no_equilibrium():
    model = Cubic()
    model.polishes = False
    assert found_from(0.3, model=model) == []


def test_a_step_that_is_not_finite_ends_the_search():
    class Flat(Cubic):
        def solver(self, X, p):
            return lambda value: value * np.inf

    with np.errstate(invalid="ignore"):
        assert found_from(0.3, model=Flat()) == []


def test_states_are_the_same_in_units_of_their_scale():
    a, b = np.array([1.0, 1e-8]), np.array([1.0, 2e-8])
    assert same_state(a, b, np.array([1.0, 1.0]))
    assert not same_state(a, b, np.array([1.0, 1e-8]))
