"""Fifty random vehicles, the same in every run; ``RACS_BIF_VEHICLES=500`` examines five hundred.

`benchmarks/random_vehicles.py` says what is done with each, and does ten thousand.
"""

import os
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st

import racs_bif as rb
from racs_bif.errors import UsageError
from racs_bif.results.branch import Profile
from racs_bif.shelf.load import system_of

PARTS = 10
EACH = int(os.environ.get("RACS_BIF_VEHICLES", "50")) // PARTS
PHASES = (Phase.explicit, Phase.generate)
"""What went wrong is said of the vehicle drawn: to look for a smaller one takes minutes."""


@pytest.fixture(scope="module")
def bench(benchmark_module):
    return benchmark_module("random_vehicles")


@pytest.fixture
def repeatable(monkeypatch):
    """Keep Hypothesis from drawing constants of whatever modules this process has imported."""
    provider = "hypothesis.internal.conjecture.providers.HypothesisProvider._local_constants"
    none = SimpleNamespace(set_for_type=lambda _: ())
    monkeypatch.setattr(provider, none, raising=False)


class Drawn:
    """Draws numbers from Hypothesis, which likes the ends of spans and round values."""

    def __init__(self, draw):
        self.draw = draw

    def choice(self, names, likely):
        assert len(likely) == len(names)
        return self.draw(st.sampled_from(names))

    def between(self, low, high):
        return self.draw(st.floats(low, high))


def unexpected(row):
    return {k: told for k, (outcome, told) in row["parts"].items() if outcome == "UNEXPECTED"}


@pytest.mark.parametrize("part", range(PARTS))
@pytest.mark.usefixtures("repeatable")
def test_nothing_unexpected_happens(bench, part):
    vehicles = st.composite(lambda draw: bench.vehicle(Drawn(draw)))()

    @seed(part)
    @settings(max_examples=EACH, phases=PHASES, suppress_health_check=list(HealthCheck))
    @given(vehicles)
    def examine(vehicle):
        row = bench.done_with(*vehicle, places=part, seconds=600.0)
        assert {"certify", "chart"} <= set(row["parts"])
        assert not unexpected(row), row.get("tracebacks")

    examine()


@pytest.mark.parametrize(("index", "method"), [(128, "collocation"), (5072, "harmonic-balance")])
def test_orbits_of_vehicles_satisfy_their_equations(bench, index, method):
    row = bench.examine(index, share=16, seconds=600.0)
    assert row["parts"][f"orbits by {method}"][0] == "ok"
    assert not unexpected(row), row.get("tracebacks")


def test_a_vehicle_is_the_same_in_every_run(bench):
    assert bench.draw(7) == bench.draw(7)
    assert bench.draw(7) != bench.draw(8)
    variants = {bench.draw(k)[0] for k in range(60)}
    assert variants == set(bench.VARIANTS)
    orders = np.array([[bench.draw(k)[1][n] for n in ("alpha", "gamma")] for k in range(60)])
    assert orders.min() > 0.05
    assert orders.max() < 0.95
    for k in range(20):
        variant, values = bench.draw(k)
        system = rb.load_model("racs", parameters=values, variant=variant)  # all are valid
        assert system.parameters["C_s"] == pytest.approx(values["C_s"], rel=1e-12)


def test_what_is_unexpected_is_told(bench):
    def raising():
        return {}["x"]

    def warning():
        with np.errstate(invalid="warn"):
            return np.array([0.0]) / 0.0, "ok", ""

    def refusing():
        raise UsageError("not so; do otherwise")

    def endless():
        while True:
            pass

    guarded = bench._guarded
    assert guarded(raising, 60.0)[1:3] == ("UNEXPECTED", "KeyError: 'x'")
    assert "KeyError" in guarded(raising, 60.0)[3]
    assert guarded(warning, 60.0)[1] == "UNEXPECTED"
    assert "invalid value" in guarded(warning, 60.0)[2]
    assert guarded(refusing, 60.0)[1:3] == ("error", "not so; do otherwise")
    assert guarded(endless, 0.05)[1] == "too long"
    assert guarded(lambda: (1, "early", "why"), 60.0) == (1, "early", "why", "")


def test_the_residual_of_an_orbit_is_seen(bench):
    """Of the linear oscillator with a spring pot the exact orbit is known, another is refused."""
    # x'' + D^alpha x + k x = damping x' with both parts of (i w)^alpha balanced at w = 1
    alpha = 0.5
    k = 1.0 - np.cos(alpha * np.pi / 2)
    damping = np.sin(alpha * np.pi / 2)
    model = rb.model_from_strings(
        "springpot",
        {"x": "y", "y": "damping*y - k*x - z"},
        parameters={"k": k, "damping": damping},
        elements=[("z", "x", f"s**{alpha}")],
    )
    system = system_of(model)
    times = np.linspace(0.0, 2.0 * np.pi, 201)

    def residual(rate):
        states = np.column_stack([np.cos(times), -rate * np.sin(times)])
        return bench.exact_residual(system, Profile(times=times, names=("x", "y"), states=states))

    assert residual(1.0) < 1e-6
    # the second equation misses 0.01 sin t + 0.01 damping cos t of a rate of 1.01
    assert residual(1.01) == pytest.approx(0.01 * np.hypot(1.0, damping) / 1.01, rel=1e-3)


def test_the_orbits_of_the_paper_s_vehicle_satisfy_the_exact_equations(bench):
    system = rb.load_model("racs")
    branch = rb.continue_equilibria(system, "u", (9.0, 11.0))
    orbits, outcome, told = bench._orbits(system, branch, "harmonic-balance")
    assert outcome == "ok", told
    assert orbits.profiles


def test_a_run_goes_on_where_it_was_cut_off(bench, tmp_path):
    path = tmp_path / "rows.jsonl"
    row = '{"index": 0, "parts": {"continue": ["ok", ""], "chart": ["early", "at u = 3.5|e"]}}'
    path.write_text(f'{row}\n{row.replace("0", "1", 1)}\n{{"index": 2, "par')
    rows = bench.read([path])
    assert [r["index"] for r in rows] == [0, 1]
    assert bench.table(rows).splitlines()[2:] == [
        "| chart | early | 2 | at u = #/e | 0 |",
        "| continue | ok | 2 |  | 0 |",
    ]


def test_a_tongue_beside_another_boundary_is_found_on_the_cells_of_the_default(bench):
    """Half a metre per second wide, in a plane of 37: few cells miss it, and a count tells."""
    variant, values = bench.draw(4492)
    system = rb.load_model("racs", parameters=values, variant=variant)
    chart, outcome, told = bench._chart(system, 4492)
    assert (outcome, len(chart.boundaries)) == ("early", 1)
    assert told.endswith(
        "the chart says 1 unstable roots, counted are {3}; not on the default's cells"
    )
