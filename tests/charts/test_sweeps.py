"""Maps by simulation, tile by tile: resumed, and in other processes, the same to the last bit."""

import numpy as np
import pytest

from racs_bif.charts.backends import InProcess, LocalProcesses
from racs_bif.charts.maps import MapJob
from racs_bif.charts.plane import Plane
from racs_bif.charts.running import run_map
from racs_bif.charts.search import search
from racs_bif.charts.settings import ChartSettings
from racs_bif.charts.sweeps import Sweep
from racs_bif.errors import UsageError

SHAPE = (20, 9)


@pytest.fixture(scope="module")
def lattice(model_of):
    plane = Plane(model_of("bautin"), ("a", "b"), ((-0.5, 0.5), (-1.0, 0.5)))
    return search(plane, ChartSettings(coarse=3, depth=3)).lattice


@pytest.fixture(scope="module")
def job(lattice):
    return MapJob.over(lattice, SHAPE, "amplitude", Sweep(duration=60.0, watch="x"))


@pytest.fixture(scope="module")
def whole(job):
    return run_map(job)


def same(one, other):
    return one.keys() == other.keys() and all(one[k].tobytes() == other[k].tobytes() for k in one)


def test_amplitudes_are_those_of_the_normal_form(whole):
    a = -0.5 + (np.arange(20) + 0.5) / 20
    b = -1.0 + 1.5 * (np.arange(9) + 0.5) / 9
    square = b + np.sqrt(np.maximum(b[None, :] ** 2 + 4.0 * a[:, None], 0.0))
    settled = whole["status"] == 0
    assert settled.mean() > 0.75
    cycles = settled & (a[:, None] > 0.05)
    truth = np.sqrt(np.maximum(0.5 * square, 0.0))
    assert whole["value"][cycles] == pytest.approx(truth[cycles], abs=2e-3)
    assert np.isnan(whole["value"][~settled]).all()
    assert (whole["unstable"][a > 0.0] == 2).all()
    assert whole["evaluations"].min() > 50


def test_tiles_of_a_run_that_was_interrupted_give_the_same(job, whole, tmp_path):
    class Interrupted(InProcess):
        def run(self, job, tiles):
            for index in tiles[:1]:
                yield index, job.compute(index)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_map(job, Interrupted(), folder=tmp_path / "tiles")
    assert len(list((tmp_path / "tiles").glob("tile_*.npz"))) == 1
    again = run_map(job, LocalProcesses(2), folder=tmp_path / "tiles", resume=True)
    assert same(again, whole)


def test_another_simulation_is_another_map(job, lattice, tmp_path):
    run_map(job, folder=tmp_path)
    longer = MapJob.over(lattice, SHAPE, "amplitude", Sweep(duration=61.0, watch="x"))
    with pytest.raises(UsageError, match="of another map"):
        run_map(longer, folder=tmp_path, resume=True)


def test_periods_and_exponents(lattice):
    sweep = Sweep(duration=150.0, watch="y", start={"x": 0.3, "y": 0.0})
    told = run_map(MapJob.over(lattice, (4, 3), "periods", sweep))
    assert np.nanmax(told["value"][2:]) == 1.0
    assert (told["value"][0] == 0.0).all()
    told = run_map(MapJob.over(lattice, (4, 3), "lyapunov", sweep))
    assert told["value"][0] == pytest.approx([-0.375] * 3, abs=1e-3)
    assert np.abs(told["value"][2:]).max() < 0.02
    assert (told["status"] == 0).all()


def test_where_there_is_no_equilibrium_nothing_is_simulated(model_of):
    plane = Plane(model_of("fold"), ("a", "b"), ((-1.0, 1.03), (-0.5, 1.5)))
    found = search(plane, ChartSettings(coarse=4, depth=4))
    told = run_map(MapJob.over(found.lattice, (6, 4), "amplitude", Sweep(duration=40.0, watch="x")))
    a = -1.0 + 2.03 * (np.arange(6) + 0.5) / 6
    b = -0.5 + 2.0 * (np.arange(4) + 0.5) / 4
    there = a[:, None] > -(b[None, :] ** 2) / 4.0
    assert (told["status"][~there] == 3).all()
    assert np.isnan(told["value"][~there]).all()
    assert (told["value"][there & (told["status"] == 0)] == 0.0).all()


@pytest.mark.parametrize("bad", [{"duration": 0.0}, {"tolerance": 0.5}])
def test_numbers_out_of_range(bad):
    with pytest.raises(UsageError, match="of a map's simulations"):
        Sweep(**{"duration": 1.0, "watch": "x", **bad})
