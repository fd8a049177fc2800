"""Many simulations at once: as accurate as one at a time, and none stops the others."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.errors import ParameterError, UsageError
from racs_bif.fractional.bank import Bank
from racs_bif.fractional.diffusive import Diffusive
from racs_bif.fractional.filter import Filter, Realisation
from racs_bif.fractional.realisations import choose_realisation
from racs_bif.shelf.load import system_of
from racs_bif.simulation import march, rosenbrock
from racs_bif.simulation.batch import BatchSettings, initial, members, run_batch
from racs_bif.simulation.batch_field import BatchField
from racs_bif.simulation.batch_filters import _modal
from racs_bif.simulation.pieces import Piece
from racs_bif.simulation.watchers import Extremes, Section

PAIR = {"x": "y", "y": "mu*(1 - x**2)*y - x - c*w"}


@pytest.fixture(scope="module")
def springpot():
    """Van der Pol's oscillator with a springpot, its order a parameter."""

    def build(name):
        parameters = {"mu": 1.0, "c": 0.5, "a": 0.5}
        elements = [("w", "x", "s**a")]
        made = rb.model_from_strings("springpot", PAIR, parameters=parameters, elements=elements)
        return replace(system_of(made), settings=choose_realisation(name, (0.01, 100.0)))

    return build


@pytest.fixture(scope="module")
def linear():
    return system_of(
        rb.model_from_strings(
            "linear", {"x": "y", "y": "-k*x - d*y"}, parameters={"k": 1.0, "d": 0.0}
        )
    )


class Scalar:
    """x' = rate(x) of one member, for orders of convergence."""

    def __init__(self, rate, slope):
        self.rate, self._slope = rate, slope

    def linear(self, x, shift):
        slope = self._slope(x)

        class Solver:
            def solve(self, right):
                return right / (shift - slope)

        return Solver()


def logistic(h, until=2.0):
    equations = Scalar(lambda x: x * (1.0 - x), lambda x: 1.0 - 2.0 * x)
    x, worst = np.array([[0.1]]), 0.0
    for k in range(round(until / h)):
        tried = rosenbrock.step(equations, x, np.array([h]))
        middle = Piece.of(np.array([k * h]), np.array([h]), x, tried, 1).at(np.array([0.4]))
        t = (k + 0.4) * h
        worst = max(worst, abs(float(middle[0, 0]) - 1.0 / (1.0 + 9.0 * np.exp(-t))))
        x = tried.x
    return abs(float(x[0, 0]) - 1.0 / (1.0 + 9.0 * np.exp(-until))), worst


def test_the_steps_are_of_order_5_and_of_order_4_between():
    ends, between = zip(*(logistic(h) for h in (0.4, 0.2, 0.1)), strict=True)
    assert np.log2(np.divide(ends[:-1], ends[1:])) == pytest.approx([5.0, 5.0], abs=0.5)
    assert np.log2(np.divide(between[:-1], between[1:])).min() > 3.8


def test_stiff_equations_take_no_more_steps():
    system = system_of(
        rb.model_from_strings("stiff", {"x": "-k*(x - cos(y))", "y": "1"}, parameters={"k": 1.0})
    )
    done = run_batch(
        system,
        values={"k": np.array([1.0, 1e3, 1e6])},
        starts=np.array([[1.0, 0.0]] * 3),
        duration=10.0,
    )
    worst = np.abs(done.states[2, :, 0] - np.cos(done.times)).max()
    # Between steps so stiff a state is known less well, and the estimate says so.
    assert worst < 4.0 * done.error[2] < 0.05
    assert done.states[2, -1, 0] == pytest.approx(np.cos(10.0), abs=1e-5)
    assert done.steps[2] < 2 * done.steps[0]


def test_members_are_what_they_are_alone(linear):
    k, d = np.array([1.0, 4.0, 9.0]), np.array([0.0, 0.4, 0.0])
    done = run_batch(
        linear, values={"k": k, "d": d}, starts=np.array([[1.0, 0.0]] * 3), duration=5.0
    )
    t = done.times
    w = np.sqrt(4.0 - 0.04)
    damped = np.exp(-0.2 * t) * (np.cos(w * t) + 0.2 / w * np.sin(w * t))
    truth = np.array([np.cos(t), damped, np.cos(3.0 * t)])
    worst = np.abs(done.column("x") - truth).max(axis=1)
    assert worst.max() < 1e-5
    assert np.all(worst <= 2.0 * done.error)
    assert done.final[0] == pytest.approx([np.cos(5.0), -np.sin(5.0)], abs=1e-5)
    assert not done.failed.any()


@pytest.mark.parametrize("name", ["diffusive", "oustaloup", "matsuda"])
def test_members_are_as_one_simulation_of_each(springpot, name):
    system = springpot(name)
    start = {"x": 1.0, "y": 0.3}
    values = {"a": np.array([0.3, 0.5]), "mu": np.array([0.5, 1.0])}
    done = rb.simulate_batch(
        system, 6.0, values=values, initial=start, settings=BatchSettings(samples=61)
    )
    for k in range(2):
        alone = rb.simulate(
            system.with_parameters({key: v[k] for key, v in values.items()}),
            6.0,
            operator="realised",
            initial=start,
            history="constant",
            step=0.1,
        )
        assert done.states[k] == pytest.approx(alone.states, abs=2e-5)
    assert done.error.max() < 1e-4


def test_all_states_can_be_given_and_go_on_where_others_ended(springpot):
    system = springpot("oustaloup")
    first = run_batch(system, values={}, starts=np.array([[1.0, 0.3]]), duration=3.0)
    second = run_batch(system, values={}, starts=first.final, duration=3.0)
    whole = run_batch(system, values={}, starts=np.array([[1.0, 0.3]]), duration=6.0)
    assert second.final == pytest.approx(whole.final, rel=1e-4, abs=1e-4)


def test_one_that_blows_up_is_marked_and_the_others_go_on():
    system = system_of(rb.model_from_strings("square", {"x": "k*x**2"}, parameters={"k": 1.0}))
    done = run_batch(
        system,
        values={"k": np.array([1.0, -1.0, 2.0])},
        starts=np.ones((3, 1)),
        duration=3.0,
        settings=BatchSettings(samples=31),
    )
    assert done.failed.tolist() == [True, False, True]
    assert done.reached == pytest.approx([1.0, 3.0, 0.5], rel=1e-4)
    assert "without bound" in done.stopped[0]
    assert done.stopped[1] == ""
    assert done.states[1, -1, 0] == pytest.approx(0.25, rel=1e-5)
    assert np.isnan(done.states[0, -1, 0])
    assert np.isfinite(done.states[0, :9, 0]).all()
    assert "2 failed" in repr(done)


def test_a_start_where_the_equations_are_not_defined():
    system = system_of(rb.model_from_strings("root", {"x": "-sqrt(x)"}, parameters={"k": 1.0}))
    done = run_batch(system, values={}, starts=np.array([[-1.0], [4.0]]), duration=1.0)
    assert done.failed.tolist() == [True, False]
    assert done.stopped[0] == march.UNDEFINED
    assert done.states[1, -1, 0] == pytest.approx(2.25, rel=1e-5)


def test_one_that_takes_too_many_steps_is_given_up(linear):
    done = run_batch(
        linear,
        values={"k": np.array([1.0, 1e6])},
        starts=np.array([[1.0, 0.0]] * 2),
        duration=5.0,
        settings=BatchSettings(most=200, estimate=False),
    )
    assert done.failed.tolist() == [False, True]
    assert "more steps than allowed" in done.stopped[1]
    assert np.isnan(done.error).all()


def test_extremes_and_crossings_between_steps(linear):
    count, duration = 2, 20.0
    field = BatchField(linear, members(linear, {"k": np.array([1.0, 9.0])}))
    extremes = Extremes(duration, count, 2)
    section = Section(extremes, 0, 4)
    start = np.array([[1.0, 1.0], [0.5, 0.5]])
    march.march(
        field, start, duration, march.Limits(tolerance=1e-9, rows=2), watchers=(extremes, section)
    )
    amplitude = np.hypot(1.0, 0.5 / np.array([1.0, 3.0]))
    assert extremes.half[3, 0] == pytest.approx(amplitude, rel=1e-6)
    # Through the middle, upwards: y is greatest there.
    assert section.last(0)[:, 1] == pytest.approx(amplitude[0], rel=1e-6)
    assert section.last(1)[:, 1] == pytest.approx(3.0 * amplitude[1], rel=1e-6)
    assert section.last(1).shape == (4, 2)
    assert section.seen[1] > 4


def test_progress_is_told(linear):
    told = []
    run_batch(
        linear,
        values={"k": np.array([1.0, 400.0])},
        starts=np.array([[1.0, 0.0]] * 2),
        duration=10.0,
        progress=told.append,
    )
    assert told
    assert told == sorted(told)
    assert told[-1] <= 10.0


@pytest.mark.parametrize(
    ("values", "starts", "duration", "message"),
    [
        ({"k": [1.0, 2.0], "d": [0.0]}, None, 1.0, "of one length"),
        ({"k": [1.0, 2.0]}, np.ones((3, 2)), 1.0, "of one length"),
        ({"k": []}, None, 1.0, "at least one member"),
        ({"k": [1.0]}, np.ones((1, 5)), 1.0, r"shape \(N, 2\)"),
        ({"k": [1.0]}, None, -1.0, "the duration is -1 s"),
    ],
)
def test_what_cannot_be_run(linear, values, starts, duration, message):
    columns = {name: np.array(v) for name, v in values.items()}
    with pytest.raises(UsageError, match=message):
        run_batch(linear, values=columns, starts=starts, duration=duration)


def test_unknown_names(linear):
    with pytest.raises(ParameterError, match="kk"):
        rb.simulate_batch(linear, 1.0, values={"kk": [1.0]})
    with pytest.raises(UsageError, match="unknown state 'z'"):
        rb.simulate_batch(linear, 1.0, initial={"z": 1.0})
    with pytest.raises(UsageError, match="single numbers or of one length"):
        rb.simulate_batch(linear, 1.0, values={"k": [1.0, 2.0]}, initial={"x": [1.0, 2.0, 3.0]})
    with pytest.raises(UsageError, match="no 'z'"):
        rb.simulate_batch(linear, 1.0).column("z")


@pytest.mark.parametrize(
    "bad", [{"tolerance": 0.0}, {"samples": 1}, {"after": -1.0}, {"tolerance": 0.1}]
)
def test_settings_out_of_range(bad):
    with pytest.raises(UsageError, match="batch"):
        BatchSettings(**bad)


@dataclass(frozen=True, kw_only=True)
class Turned(Diffusive):
    """The same filter in other coordinates."""

    bend: float = 1.0

    def realise(self, law):
        plain = super().realise(law)
        n = len(plain.A)
        T = np.eye(n) + self.bend * np.triu(np.ones((n, n)), 1)
        back = np.linalg.inv(T)
        return Filter(T @ plain.A @ back, T @ plain.B, plain.C @ back, plain.D)


@dataclass(frozen=True, kw_only=True)
class Companion(Realisation):
    """The law k / (s**2 + d s + 1) as it is."""

    damping: float

    @property
    def name(self):
        return "companion"

    def realise(self, law):
        A = np.array([[0.0, 1.0], [-1.0, -self.damping]])
        return Filter(A, np.array([0.0, 1.0]), np.array([1.0, 0.0]), 0.0)

    def derivative(self, law, direction):
        return Filter(np.zeros((2, 2)), np.zeros(2), np.zeros(2), 0.0)


def test_filters_in_other_coordinates_are_the_same_filters(springpot):
    plain = Diffusive(band=(0.1, 10.0), order=4)
    system = replace(springpot("diffusive"), settings=plain)
    turned = replace(system, settings=Turned(band=(0.1, 10.0), order=4))
    values = {"a": np.array([0.3, 0.5])}
    start = np.array([[1.0, 0.3], [0.5, 0.0]])
    wanted = run_batch(system, values=values, starts=start, duration=3.0)
    found = run_batch(turned, values=values, starts=start, duration=3.0)
    np.testing.assert_allclose(found.final[:, :2], wanted.final[:, :2], rtol=1e-6)
    # The memory is told in the realisation's own coordinates, and taken in them.
    T = np.eye(4) + np.triu(np.ones((4, 4)), 1)
    np.testing.assert_allclose(found.final[:, 2:], wanted.final[:, 2:] @ T.T, rtol=1e-5, atol=1e-8)
    further = run_batch(turned, values=values, starts=found.final, duration=1.0)
    expected = run_batch(system, values=values, starts=wanted.final, duration=1.0)
    np.testing.assert_allclose(further.final[:, :2], expected.final[:, :2], rtol=1e-5)


@pytest.mark.parametrize("damping", [0.2, 2.0])
def test_filters_whose_poles_do_not_stand_alone(damping):
    model = rb.model_from_strings(
        "resonant",
        {"x": "y", "y": "-x - y + c*w"},
        parameters={"c": 0.5, "d": damping},
        elements=[("w", "x", "1/(s**2 + d*s + 1)")],
    )
    settings = Companion(band=(0.1, 10.0), damping=damping)
    system = replace(system_of(model), settings=settings)
    start = np.array([[1.0, 0.3], [0.5, 0.0]])
    found = run_batch(system, values={}, starts=start, duration=4.0)
    whole = rb.model_from_strings(
        "ordinary",
        {"x": "y", "y": "-x - y + c*z", "z": "v", "v": "x - z - d*v"},
        parameters={"c": 0.5, "d": damping},
    )
    rest = np.column_stack([start, start[:, 0], np.zeros(2)])  # w = x: the filter is at rest
    wanted = run_batch(system_of(whole), values={}, starts=rest, duration=4.0)
    np.testing.assert_allclose(found.final, wanted.final, atol=1e-5)


def test_coordinates_that_would_cost_digits_are_left_as_they_are():
    # Eigenvectors that differ by 1e-13 give gains of 1e13, which cancel.
    near = np.array([[-1.0, 1.0], [0.0, -1.0 - 1e-13]])
    bent = Filter(near, np.array([0.0, 1.0]), np.array([1.0, 0.0]), 0.0)
    assert _modal(Bank.of((bent,), 0)) is None
    apart = replace(bent, A=np.array([[-1.0, 1.0], [0.0, -2.0]]))
    poles, coupling, *_ = _modal(Bank.of((apart,), 0))
    np.testing.assert_allclose(sorted(poles), [-2.0, -1.0])
    assert not coupling.any()


def test_a_batch_begins_at_rest_where_nothing_else_is_said(linear):
    field = BatchField(linear, members(linear, {"k": np.array([1.0, 4.0, 9.0])}))
    np.testing.assert_array_equal(initial(field, None), np.zeros((2, 3)))
