"""Laws of realisations as quotients of polynomials."""

import pickle

import numpy as np
import pytest

from racs_bif.errors import UsageError
from racs_bif.fractional.diffusive import Diffusive
from racs_bif.fractional.filter import Filter
from racs_bif.fractional.rational import RationalSystem, _slope, rational


@pytest.mark.parametrize(
    ("text", "parameters"),
    [("k + 1/s**q", {"q": 0.4, "k": 2.0}), ("1/(1 + s**q)", {"q": 0.5}), ("2/s", {})],
)
def test_a_filter_of_any_kind_as_a_quotient(law_of, text, parameters):
    law = law_of(text, **parameters)[0]
    done = Diffusive(band=(0.1, 10.0), order=5).realise(law)
    made = rational(law, done)
    s = 1j * np.geomspace(1e-3, 1e3, 30)
    np.testing.assert_allclose(made(s), done(s), rtol=1e-8)
    assert made.integer
    assert made.integrates == law.integrates
    assert made.name == law.name


def test_a_filter_whose_states_are_coupled(law_of):
    law = law_of("1/(1 + s**q)", q=0.5)[0]
    A = np.array([[-1.0, 2.0, 0.0], [0.0, -3.0, 1.0], [0.5, 0.0, -5.0]])
    done = Filter(A, np.array([1.0, 0.5, 2.0]), np.array([0.3, 1.0, -0.4]), 0.7)
    s = 1j * np.geomspace(1e-2, 1e2, 30)
    np.testing.assert_allclose(rational(law, done)(s), done(s), rtol=1e-10)


def test_derivatives_of_the_quotient(system_of, differences):
    realisation = Diffusive(band=(0.1, 10.0), order=5)
    elements, parameters = [("Z", "0", "k + 1/s**q")], {"q": 0.4, "k": 2.0}
    system = system_of({}, elements=elements, parameters=parameters, realisation=realisation)
    field, p = RationalSystem.of(system).exact.field, system.values
    s = np.array([0.4 + 1.3j, 3.0j])
    for dp in np.eye(2):
        moved = field.law_directions(p, dp)[0]
        slope = field.laws(p)[0].along(moved, s)
        expected = differences(lambda h, dp=dp: field.laws(p + h * dp)[0](s), 0.0, 1e-4)
        np.testing.assert_allclose(slope, expected, rtol=1e-7)


def test_a_rational_system_is_pickled_as_what_makes_it(system_of):
    realisation = Diffusive(band=(0.1, 10.0), order=5)
    elements, parameters = [("Z", "0", "k + 1/s**q")], {"q": 0.4, "k": 2.0}
    system = system_of({}, elements=elements, parameters=parameters, realisation=realisation)
    field = RationalSystem.of(system).exact.field
    again = pickle.loads(pickle.dumps(field))
    s = np.array([0.4 + 1.3j, 3.0j])
    np.testing.assert_array_equal(again.laws(system.values)[0](s), field.laws(system.values)[0](s))


def lag(rate, *, moved=0.0, gain=1.0):
    """Return the filter gain / (s + rate), or its derivative where the rate moves."""
    A = np.array([[-rate, 0.0], [0.0, -2.0 * rate]]) if not moved else np.diag([-moved, -3.0])
    ends = np.array([1.0, 0.5]) if not moved else np.zeros(2)
    return Filter(A, ends, gain * np.ones(2) if not moved else np.zeros(2), 0.0)


def test_derivatives_where_poles_move():
    done, moved = lag(1.5), lag(1.5, moved=0.7)
    slope = _slope("law", done, moved)
    s = 1j * np.geomspace(0.1, 10.0, 7)
    # d/dp of b c / (s - a) is b c a' / (s - a)**2; b c is (1, 1/2), a' (-0.7, -3).
    wanted = -0.7 / (s + 1.5) ** 2 - 3.0 * 0.5 / (s + 3.0) ** 2
    bottom = (s + 1.5) * (s + 3.0)
    parts = slope.numerator, slope.denominator
    top, below = (np.polyval(part.coefficients[::-1], s) for part in parts)
    found = (top - below * done(s)) / bottom
    np.testing.assert_allclose(found, wanted, rtol=1e-10)


def test_derivatives_where_some_of_many_poles_move():
    poles, speeds = np.array([-1.5, -3.0, -4.0, -7.0]), np.array([-0.7, 0.0, 0.9, 0.4])
    gains, drifts = np.array([1.0, 0.5, -2.0, 3.0]), np.array([0.3, 0.0, 0.1, -0.2])
    done = Filter(np.diag(poles), np.ones(4), gains, 0.5)
    slope = _slope("law", done, Filter(np.diag(speeds), np.zeros(4), drifts, 0.1))
    s = 1j * np.geomspace(0.1, 10.0, 7)
    apart = s[:, None] - poles
    wanted = 0.1 + (drifts / apart + gains * speeds / apart**2).sum(axis=1)
    parts = slope.numerator, slope.denominator
    top, below = (np.polyval(part.coefficients[::-1], s) for part in parts)
    found = (top - below * done(s)) / apart.prod(axis=1)
    np.testing.assert_allclose(found, wanted, rtol=1e-10)


def test_filters_that_are_no_quotients_of_ours_are_refused():
    bent = Filter(np.array([[-1.0, 1.0], [0.0, -2.0]]), np.ones(2), np.ones(2), 0.0)
    with pytest.raises(UsageError, match="bent"):
        _slope("bent", bent, bent)


def test_a_filter_without_memory_is_its_gain(law_of):
    law = law_of("1/(1 + s**q)", q=0.5)[0]
    made = rational(law, Filter(np.zeros((0, 0)), np.zeros(0), np.zeros(0), 2.5))
    np.testing.assert_array_equal(made(np.array([0.1j, 1j, 10j])), 2.5)


def test_the_unit_of_a_filter_does_not_matter(law_of):
    law = law_of("1/(1 + s**q)", q=0.5)[0]
    s = 1j * np.geomspace(1e-2, 1e2, 30)
    for unit in (1e-9, 1e9):
        done = Filter(np.diag([-1.0, -5.0]), np.ones(2), unit * np.array([0.3, 1.0]), 0.7 * unit)
        np.testing.assert_allclose(rational(law, done)(s), done(s), rtol=1e-10)


@pytest.mark.parametrize("gain", [1.0, 1e-9])
def test_poles_that_polynomials_do_not_keep_apart_are_refused(law_of, gain):
    law = law_of("1/(1 + s**q)", q=0.5)[0]
    rates = np.geomspace(30.0, 100.0, 100)
    with pytest.raises(UsageError, match="poles apart"):
        rational(law, Filter(np.diag(-rates), rates, gain * np.ones(100), gain))


def test_derivatives_where_inputs_move():
    done = Filter(np.diag([-1.5, -3.0]), np.array([2.0, 0.5]), np.array([1.0, -4.0]), 0.0)
    moved = Filter(np.zeros((2, 2)), np.array([0.3, 0.7]), np.array([-0.2, 0.9]), 0.0)
    slope, s = _slope("law", done, moved), 1j * np.geomspace(0.1, 10.0, 7)
    # c b moves by c' b + c b'
    wanted = -0.1 / (s + 1.5) - 2.35 / (s + 3.0)
    found = np.polyval(slope.numerator.coefficients[::-1], s) / ((s + 1.5) * (s + 3.0))
    np.testing.assert_allclose(found, wanted, rtol=1e-12)


def test_a_rational_system_is_itself_only(system_of):
    system = system_of({"x": "-x"})
    one, other = RationalSystem.of(system), RationalSystem.of(system)
    assert len({one, other, one}) == 2


def test_filters_that_cease_to_be_quotients_of_ours_are_refused():
    straight = Filter(np.diag([-1.0, -2.0]), np.ones(2), np.ones(2), 0.0)
    bent = Filter(np.array([[-1.0, 1.0], [0.0, -2.0]]), np.ones(2), np.ones(2), 0.0)
    for pair in ((bent, straight), (straight, bent)):
        with pytest.raises(UsageError, match="bent"):
            _slope("bent", *pair)
