"""Whether a step counts, and for which reason not."""

from types import SimpleNamespace

import numpy as np
import pytest

from racs_bif.continuation.checking import CONTRACTION, judge
from racs_bif.continuation.counting import hides_others, unexplained
from racs_bif.continuation.scaling import Scaling

FLAT = np.array([0.0, 1.0])


def turned(angle):
    return np.array([np.sin(angle), np.cos(angle)])


def judged(chord=FLAT, angle=0.0, iterations=2, contraction=0.0):
    scaling = Scaling(1.0, np.ones(1))
    tangents = (turned(0.0), turned(angle))
    return judge(scaling, (np.zeros(2), 0.1 * chord), tangents, (iterations, contraction), 0.3)


@pytest.mark.parametrize(
    ("step", "reason"),
    [
        ({"chord": turned(0.2), "angle": 0.4}, "the tangent turned too much"),
        ({"chord": turned(0.1)}, "the step does not lie along the branch"),
        ({"contraction": 0.3}, "Newton's method contracts too slowly"),
        ({"angle": 2.0}, "the tangent turned back"),
        ({"chord": 0.0 * FLAT}, "the step has no length"),
    ],
)
def test_each_reason_refuses_a_step_and_shortens_it(step, reason):
    verdict = judged(**step)
    assert not verdict.accepted
    assert verdict.reason == reason
    assert 0.5 <= verdict.factor < 1.0


@pytest.mark.parametrize(
    ("step", "factor"),
    [
        ({}, 2.0),
        ({"chord": turned(0.1), "angle": 0.2}, 0.7 * 0.3 / 0.2),
        ({"contraction": CONTRACTION}, 0.7),
        ({"iterations": 8}, 0.5),
        ({"iterations": 5}, 0.8),
        ({"iterations": 4}, 2.0),
    ],
)
def test_a_good_step_says_how_long_the_next_may_be(step, factor):
    verdict = judged(**step)
    assert verdict.accepted
    assert verdict.length == pytest.approx(0.1)
    assert verdict.factor == pytest.approx(factor)


class Spectra:
    """As of equilibria."""

    def on_axis(self, spectrum, count):
        mask = np.zeros(len(spectrum), dtype=bool)
        mask[np.argsort(np.abs(spectrum.real))[:count]] = True
        return mask

    def unstable(self, spectrum):
        return int(np.count_nonzero(self.sides(spectrum)))

    def sides(self, spectrum):
        return spectrum.real > 0.0


@pytest.mark.parametrize(
    ("ends", "events", "hides"),
    [
        ((0, 1), [([0.0, -1.0, -2.0], 1)], False),
        ((1, 0), [([0.0, -1.0, -2.0], 1)], False),
        ((0, 1), [([0.0, 1.0, -2.0], 1)], True),  # another one has crossed before
        ((0, 1), [([0.0, 1.0, 2.0], 1)], True),
        ((2, 1), [([0.0, 1.0, -2.0], 1)], False),
        ((0, 2), [([0.0, -1.0], 1), ([1.0, 0.0], 1)], False),
        ((0, 2), [([0.0, -1.0], 1), ([-1.0, 0.0], 1)], True),
        ((0, 3), [([1e-9, -1e-9, -1.0], 2), ([1.0, 1.0, 0.0], 1)], False),
        ((0, 1), [([5.0, 5.0], 0), ([0.0, -1.0], 1)], False),  # it explains nothing
        ((1, 1), [([0.0, 1.0], 1)], True),  # it would have touched only
        ((0, 1), [([0.0, -1.0], 1), ([1.0, 1e-9, -1e-9], 2)], True),  # and a second pair, back
        ((0, 3), [([0.0, -1.0], 1), ([1.0, 1e-9, -1e-9], 2)], False),
        ((2, 3), [([0.0, 1.0, 1.0], 1), ([1.0, 1e-9, -1e-9], 2)], True),
        ((2, 1), [([0.0, 1.0, 1.0], 1), ([1.0, 1e-9, -1e-9], 2)], False),
        ((3, 3), [], False),
        ((0, 2), [([0.0, 1.0], 1)], True),
        ((0, 3), [([0.0, 1.0], 1)], True),
    ],
)
def test_spectra_at_events_show_what_else_is_there(ends, events, hides):
    a, b = (SimpleNamespace(unstable=count, stable=False, spectrum=np.zeros(0)) for count in ends)
    found = [(SimpleNamespace(spectrum=np.array(spectrum)), n) for spectrum, n in events]
    assert hides_others(Spectra(), a, b, found) is hides


def pairs(*upper):
    return np.array([s for one in upper for s in (complex(one), complex(one).conjugate())])


@pytest.mark.parametrize(
    ("end", "hides"),
    [
        (pairs(0.1 + 0.2j, 0.1 + 9j), True),  # the second crosses, and a third one back
        (pairs(0.1 + 0.2j, -0.1 + 9j), False),
        (pairs(0.1 + 0.2j, 0.1 + 14j), False),  # it may be another one
        (pairs(0.1 + 0.2j, 0.1 + 9j, -0.1 + 9.1j), False),  # it may be the other one
        (pairs(0.1 + 0.2j, 0.1 + 9.4j, 0.8 + 9.4j), False),  # the other one is too near
        (pairs(0.1 + 0.2j, 0.1 + 9.4j, -0.8 + 9.4j), True),  # it is not, on the other side
        (pairs(0.1 + 0.2j), False),
        (np.append(pairs(0.1 + 0.2j, 0.1 + 9j), -np.inf), False),  # too poor to follow any
    ],
)
def test_a_pair_that_crosses_beside_an_event_is_seen(end, hides):
    a = SimpleNamespace(unstable=0, stable=True, spectrum=pairs(-0.1 + 0.2j, -0.3 + 10j))
    b = SimpleNamespace(unstable=2, stable=False, spectrum=end)
    event = SimpleNamespace(spectrum=pairs(1e-12 + 0.2j, -0.1 + 9.4j))
    assert hides_others(Spectra(), a, b, [(event, 2)]) is hides
    # and the other way
    assert hides_others(Spectra(), b, a, [(event, 2)]) is hides


def test_nothing_is_hidden_where_the_spectra_are_not_known():
    a, b = (SimpleNamespace(unstable=count, stable=False, spectrum=np.zeros(2)) for count in (0, 5))
    problem = SimpleNamespace(on_axis=lambda _spectrum, _count: None)
    assert not hides_others(problem, a, b, [(SimpleNamespace(spectrum=np.zeros(2)), 1)])


def test_spectra_that_are_too_poor_to_tell_stability_are_not_counted_by():
    problem = Spectra()
    a, b = (SimpleNamespace(unstable=k, stable=None, spectrum=np.ones(3)) for k in (0, 2))
    assert unexplained(problem, a, b, []) == ""
    assert not hides_others(problem, a, b, [])
    a.stable = b.stable = False
    assert "from 0 to 2" in unexplained(problem, a, b, [])
    assert hides_others(problem, a, b, [])


def test_one_spectrum_that_is_too_poor_is_enough_to_count_by_none():
    rich, poor = (SimpleNamespace(unstable=k, stable=k, spectrum=np.ones(3)) for k in (0, 2))
    rich.stable, poor.stable = True, None
    for a, b in ((rich, poor), (poor, rich)):
        assert unexplained(Spectra(), a, b, []) == ""
        assert not hides_others(Spectra(), a, b, [])


@pytest.mark.parametrize(
    ("further", "reason"),
    [
        (((), ()), "3 eigenvalues cross, some each way"),
        (((), (-5.0,)), ""),  # which of them is new?
        (((-5.0,), (-np.inf,)), ""),
        (((-np.inf,), (-5.0,)), ""),
    ],
)
def test_eigenvalues_are_followed_where_that_tells(further, reason):
    # A real eigenvalue crosses, which is known, and a pair crosses the other way.
    spectra = np.append(0.1, pairs(-0.1 + 9j)), np.append(-0.1, pairs(0.1 + 9j))
    a, b = (
        SimpleNamespace(unstable=count, stable=False, spectrum=np.append(spectrum, more))
        for count, spectrum, more in zip((1, 2), spectra, further, strict=True)
    )
    assert unexplained(Spectra(), a, b, [1]) == reason
    assert unexplained(Spectra(), b, a, [1]) == reason
