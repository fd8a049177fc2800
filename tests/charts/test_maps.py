"""Maps tile by tile: the same numbers wherever they are computed, interrupted or not."""

import multiprocessing
import os
import signal

import numpy as np
import pytest

from racs_bif.charts.backends import InProcess, LocalProcesses, choose_backend
from racs_bif.charts.maps import MapJob, compute_tile
from racs_bif.charts.plane import Plane
from racs_bif.charts.running import run_map
from racs_bif.charts.search import search
from racs_bif.charts.settings import ChartSettings
from racs_bif.errors import ConvergenceError, UsageError

SHAPE = (150, 100)  # 6 tiles, the last ones smaller


@pytest.fixture(scope="module")
def lattice(model_of):
    plane = Plane(model_of("two"), ("a", "b"), ((-0.5, 0.5), (-0.5, 0.5)))
    return search(plane, ChartSettings(coarse=3, depth=3)).lattice


@pytest.fixture(scope="module")
def job(lattice):
    return MapJob.over(lattice, SHAPE, "damping")


@pytest.fixture(scope="module")
def whole(job):
    return run_map(job)


def same(one, other):
    return one.keys() == other.keys() and all(one[k].tobytes() == other[k].tobytes() for k in one)


def test_a_map_agrees_with_the_boundaries(whole):
    a, b = ((np.arange(n) + 0.5) / n - 0.5 for n in SHAPE)
    a, b = np.meshgrid(a, b, indexing="ij")
    unstable = 2 * (a < 0.07400188) + 2 * (a + b < 0.38466244)
    assert np.array_equal(whole["unstable"], unstable)
    assert np.array_equal(whole["sigma"] > 0.0, unstable > 0)
    assert np.isfinite(whole["omega"]).all()
    assert whole["evaluations"].min() > 5


def test_where_there_is_no_equilibrium_nothing_is_told(model_of):
    plane = Plane(model_of("fold"), ("a", "b"), ((-1.0, 1.03), (-0.5, 1.5)))
    found = search(plane, ChartSettings(coarse=4, depth=4))
    told = run_map(MapJob.over(found.lattice, (40, 30), "damping"))
    a = -1.0 + 2.03 * (np.arange(40) + 0.5) / 40
    b = -0.5 + 2.0 * (np.arange(30) + 0.5) / 30
    there = a[:, None] > -(b[None, :] ** 2) / 4.0
    assert np.array_equal(told["unstable"] >= 0, there)
    assert np.array_equal(told["unstable"] == -2, ~there)
    assert np.array_equal(np.isfinite(told["sigma"]), there)


def test_a_map_of_counts_has_no_roots(lattice):
    told = run_map(MapJob.over(lattice, (20, 20), "count"))
    assert told.keys() == {"unstable", "evaluations"}
    assert set(np.unique(told["unstable"])) == {0, 2, 4}


def test_a_map_that_was_interrupted_goes_on_and_is_the_same(job, whole, tmp_path):
    class Interrupted(InProcess):
        def run(self, job, tiles):
            for index in tiles[:2]:
                yield index, compute_tile(job, index)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_map(job, Interrupted(), folder=tmp_path / "tiles")
    assert len(list((tmp_path / "tiles").glob("tile_*.npz"))) == 2
    # One of them damaged, as by a full disk.
    (tmp_path / "tiles" / "tile_000001.npz").write_bytes(b"PK\x03\x04 not a tile")
    told = []
    again = run_map(
        job, folder=tmp_path / "tiles", resume=True, progress=lambda *done: told.append(done)
    )
    assert told == [(k, 6) for k in range(1, 7)]
    assert same(again, whole)


def test_tiles_of_another_map_are_refused_and_begun_anew_without_resume(job, lattice, tmp_path):
    run_map(MapJob.over(lattice, (20, 20), "count"), folder=tmp_path)
    with pytest.raises(UsageError, match=r"of another map.*leave --resume out"):
        run_map(job, folder=tmp_path, resume=True)
    run_map(MapJob.over(lattice, (30, 20), "count"), folder=tmp_path)
    assert len(list(tmp_path.glob("tile_*"))) == 1


def test_local_processes_give_the_same(job, whole):
    assert same(run_map(job, LocalProcesses(2)), whole)


def test_a_killed_process_costs_nothing(job, whole, tmp_path):
    killed = []

    def kill(done, _of):
        if done == 1 and not killed:
            killed.append(multiprocessing.active_children()[0].pid)
            os.kill(killed[0], signal.SIGKILL)

    again = run_map(job, LocalProcesses(2), folder=tmp_path / "tiles", progress=kill)
    assert len(killed) == 1
    assert same(again, whole)


def test_processes_that_keep_dying_are_given_up(job):
    backend = LocalProcesses(1)
    backend._run = _dying
    with pytest.raises(ConvergenceError, match=r"died 3 times.*--resume"):
        run_map(job, backend)


def _dying(_job, _tiles):
    from concurrent.futures.process import BrokenProcessPool

    raise BrokenProcessPool
    yield


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"workers": -1}, "number of workers is -1"),
        ({"workers": 2, "scheduler": "tcp://here:1"}, "either workers or a scheduler"),
    ],
)
def test_contradictory_backends(options, message):
    with pytest.raises(UsageError, match=message):
        choose_backend(**options)


@pytest.mark.parametrize(
    ("shape", "quantity", "message"),
    [
        ((0, 5), "count", "at least one cell"),
        ((5, 5), "colour", "unknown map 'colour'"),
        ((5, 5), "amplitude", "needs simulations"),
    ],
)
def test_maps_that_there_are_not(lattice, shape, quantity, message):
    with pytest.raises(UsageError, match=message):
        MapJob.over(lattice, shape, quantity)
