"""What is kept of speed and memory: that it is measured, compared and told; no seconds are asked.

Bounds on memory are asked for at a reduced size, of what Python's allocator counts.
"""

import json
import tracemalloc
from dataclasses import replace

import numpy as np
import pytest

from racs_bif.charts.backends import InProcess
from racs_bif.charts.maps import MapJob
from racs_bif.charts.plane import Plane
from racs_bif.verbs.chart_map import compute_map


@pytest.fixture
def baselines(benchmark_module):
    return benchmark_module("_baselines")


@pytest.fixture
def hot_paths(benchmark_module):
    return benchmark_module("hot_paths")


@pytest.fixture
def paths(benchmark_module):
    return benchmark_module("_paths")


@pytest.fixture
def kernel(benchmark_module):
    return benchmark_module("_kernel")


@pytest.fixture
def memory(benchmark_module):
    return benchmark_module("memory")


@pytest.fixture
def peak():
    """Return the peak memory of a call, in bytes."""

    def measured(function):
        tracemalloc.start()
        try:
            result = function()
            return result, tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()

    return measured


# -------------------------------------------------------------------------------------- speed


def test_every_hot_path_has_a_baseline_and_no_other(baselines, hot_paths):
    known = baselines.read()
    assert list(known) == list(hot_paths.TITLES)
    for stored in known.values():
        assert min(stored.cost.ratio, stored.cost.milliseconds, stored.cost.megabytes) > 0.0
        assert "numpy" in stored.on
        assert len(stored.date) == 10


@pytest.mark.parametrize("name", ["core", "core_jacobian", "eigenvalues"])
def test_a_hot_path_runs_as_often_as_one_likes(paths, name):
    run = paths.PATHS[name].begin()
    first, second = run(), run()
    assert np.all(np.isfinite(first))
    np.testing.assert_array_equal(first, second)


def test_a_path_is_measured_against_the_kernel(kernel):
    found = kernel.measured(kernel.kernel, 3)
    assert 0.2 < found.ratio < 5.0  # it is the kernel itself; a busy machine is allowed much
    assert kernel.kernel() == kernel.kernel()


def test_one_ratio_is_the_median_of_those_of_neighbours(kernel):
    times, references = iter([6.0, 1e9, 2.0]), iter([2.0, 4.0, 2.0, 2.0])
    found = kernel.in_turn(lambda: next(times), lambda: next(references), 3)
    assert (found.ratio, found.seconds, found.reference) == (2.0, 2.0, 2.0)


def test_a_process_of_its_own_is_measured(hot_paths, tmp_path):
    cost = hot_paths.program_cost(("-c", "pass"), tmp_path / "told", runs=1)
    assert cost.ratio > 0.0
    assert 1.0 < cost.megabytes < 100.0


def test_what_has_become_worse_is_named(baselines, hot_paths, monkeypatch, capsys):
    before = baselines.Cost(ratio=2.0, milliseconds=40.0, megabytes=80.0)
    stored = baselines.stored(before)
    monkeypatch.setattr(hot_paths._baselines, "read", lambda: {"load": stored, "core": stored})
    monkeypatch.setattr(hot_paths, "ours", lambda *_: None)  # nothing needs compiling

    costs = {"load": replace(before, ratio=3.1), "core": replace(before, megabytes=101.0)}
    monkeypatch.setattr(hot_paths, "cost_of", lambda name, *_: costs[name])
    assert hot_paths.main(["--only", "load", "core"]) == 1
    told = capsys.readouterr().out
    assert "x 1.55     80  x 1.00 SLOWER" in told
    assert f"load is SLOWER since {stored.date}, commit {stored.commit}: load_model" in told
    assert "core is LARGER since" in told
    assert max(map(len, told.splitlines()[:3])) < 80  # the table

    again = iter([replace(before, ratio=3.1), replace(before, ratio=2.1)])  # a busy moment
    monkeypatch.setattr(hot_paths, "cost_of", lambda *_: next(again))
    assert hot_paths.main(["--only", "load"]) == 0
    monkeypatch.setattr(hot_paths, "cost_of", lambda *_: replace(before, ratio=1.0))
    assert hot_paths.main(["--only", "load"]) == 0
    assert "x 0.50     80  x 1.00 better" in capsys.readouterr().out


def test_baselines_are_written_and_read(baselines, tmp_path):
    file = tmp_path / "baselines.json"
    assert baselines.read(file) == {}
    known = {"a": baselines.stored(baselines.Cost(0.123456, 7.0, 80.0))}
    assert known["a"].cost.ratio == 0.1235
    baselines.write(known, file)
    assert baselines.read(file) == known
    assert json.loads(file.read_text())["a"]["cost"]["megabytes"] == 80.0


# ------------------------------------------------------------------------------------- memory


def test_points_of_a_branch_are_within_their_bound(memory, peak):
    memory.followed("brusselator", "B", (1.0, 4.0), 20)  # what is kept once is kept now
    few, small = peak(lambda: memory.followed("brusselator", "B", (1.0, 4.0), 100))
    many, large = peak(lambda: memory.followed("brusselator", "B", (1.0, 4.0), 400))
    assert len(many) - len(few) > 250
    assert (large - small) / (len(many) - len(few)) < memory.LOADS["followed"].bound


def test_points_saved_and_loaded_are_within_their_bound(memory, peak):
    memory.kept(100)
    few, small = peak(lambda: memory.kept(1_000))
    many, large = peak(lambda: memory.kept(21_000))
    assert (few, many) == (1_000, 21_000)
    assert (large - small) / (many - few) < memory.LOADS["kept"].bound


def test_a_map_of_a_million_cells_is_within_its_bound(memory, paths, peak):
    """What a tile takes while it is computed does not depend on how many there are."""

    class Told(MapJob):
        def compute(self, index):
            window = self.window(index)
            return self.empty(tuple(part.stop - part.start for part in window))

    system = paths.vehicle()
    plane = Plane(system, ("c", "m_c"), paths.CHART)
    states = np.zeros((system.compiled.size, 1))
    job = Told(plane, (1000, 1000), "damping", np.full((2, 1), 0.5), states)
    ask = {"backend": InProcess(), "tiles": None, "tell": lambda *_: None, "resume": False}
    found, most = peak(lambda: compute_map(job, **ask))
    assert found.sigma.shape == (1000, 1000)
    assert most / found.sigma.size < memory.LOADS["cells"].bound
