"""A map on a real Dask cluster of worker processes, one of which is killed."""

import os
import signal
import sys

import numpy as np
import pytest

from racs_bif.charts.cluster import DaskCluster
from racs_bif.charts.maps import MapJob
from racs_bif.charts.plane import Plane
from racs_bif.charts.running import run_map
from racs_bif.charts.search import search
from racs_bif.charts.settings import ChartSettings
from racs_bif.errors import UsageError

pytestmark = pytest.mark.filterwarnings("ignore")  # those of a cluster that loses a worker


@pytest.fixture(scope="module")
def job(model_of):
    plane = Plane(model_of("two"), ("a", "b"), ((-0.5, 0.5), (-0.5, 0.5)))
    found = search(plane, ChartSettings(coarse=3, depth=3))
    return MapJob.over(found.lattice, (192, 100), "damping")  # 6 tiles


def test_a_cluster_that_loses_a_worker_gives_the_same_map(job, tmp_path):
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
    ) as cluster:
        killed = []

        def kill(done, _of):
            if done == 1 and not killed:
                killed.append(next(iter(cluster.workers.values())).pid)
                os.kill(killed[0], signal.SIGKILL)

        address = cluster.scheduler_address
        found = run_map(job, DaskCluster(address), folder=tmp_path, progress=kill)
    assert killed
    assert len(list(tmp_path.glob("tile_*.npz"))) == 6
    here = run_map(job)
    assert all(np.array_equal(found[k], here[k], equal_nan=k in {"sigma", "omega"}) for k in here)


def test_no_scheduler_there(job, monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr("racs_bif.charts.cluster._PATIENCE", 0.5)
    with pytest.raises(UsageError, match="no Dask scheduler answers at"):
        run_map(job, DaskCluster("tcp://127.0.0.1:9"))


def test_without_the_extra_a_user_is_told(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(UsageError, match=r"pip install 'racs-bif\[cluster\]'"):
        DaskCluster("tcp://127.0.0.1:9")
