"""Runs that are killed or interrupted: what was finished is on disk, whole; the rest does no harm.

The processes are real, and the signal comes as soon as the run has got so far, or after a pause.
"""

import json
import os
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import pytest

import racs_bif as rb
from racs_bif.cli.continue_ import FILES
from racs_bif.cli.journal import UNFINISHED

ROOT = Path(__file__).parents[2]
BRUSSELATOR = (
    *("continue", "B", "1.5", "2.2", "--model", "brusselator"),
    *("--orbits", "collocation", "--probes", "0", "--quiet"),
)
STATUS = {signal.SIGINT: 1, signal.SIGKILL: -signal.SIGKILL}


@contextmanager
def started(*arguments):
    """Run the program in a process of its own, gone at the end whatever happens."""
    command = [sys.executable, "-m", "racs_bif", *map(str, arguments)]
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    with subprocess.Popen(
        command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as running:
        try:
            yield running
        finally:
            running.kill()


def _wait_for(running, path):
    while not path.exists():
        assert running.poll() is None, f"it ended before it wrote {path.name}"
        time.sleep(0.002)


def _whole(folder):
    """Load all that is there; return the names of what is no leftover."""
    names = []
    for path in sorted(folder.rglob("*")):
        if any(part.startswith(".") and ".part" in part for part in path.parts):
            continue  # what was being written
        if path.suffix == ".nc":
            rb.load(path)
        elif path.suffix == ".json":
            json.loads(path.read_text(encoding="utf-8"))
        elif path.suffix == ".svg":
            assert path.read_text(encoding="utf-8").rstrip().endswith("</svg>")
        elif path.suffix == ".png":
            assert path.read_bytes().endswith(b"IEND\xaeB`\x82")
        elif path.suffix in {".html", ".md"}:
            assert path.read_text(encoding="utf-8").strip()
        names += [path.name] if path.is_file() else []
    return names


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory):
    """The folder of a run that nothing happened to, and how long it took."""
    out = tmp_path_factory.mktemp("whole") / "out"
    began = time.perf_counter()
    with started(*BRUSSELATOR, "--out", out) as running:
        _, told = running.communicate()
    assert (running.returncode, told) == (0, "")
    return out, time.perf_counter() - began


def test_a_run_leaves_its_files_only(uninterrupted):
    assert _whole(uninterrupted[0]) == sorted(FILES)


def test_continue_killed_while_orbits_are_followed_leaves_the_equilibria(uninterrupted, tmp_path):
    out, whole = tmp_path / "out", rb.load(uninterrupted[0] / "branches.nc")
    with started(*BRUSSELATOR, "--out", out) as running:
        _wait_for(running, out / UNFINISHED[1])
        running.send_signal(signal.SIGKILL)
        running.wait()
    assert _whole(out) == sorted(UNFINISHED)
    kept = rb.load(out / UNFINISHED[0])
    assert kept.branches == whole.branches[:1]

    with started(*BRUSSELATOR, "--out", out) as running:  # the same again ends as if never killed
        running.communicate()
    assert running.returncode == 0
    assert _whole(out) == sorted(FILES)
    assert rb.load(out / "branches.nc") == whole


def test_continue_interrupted_while_orbits_are_followed_saves_all_it_has(uninterrupted, tmp_path):
    out, whole = tmp_path / "out", rb.load(uninterrupted[0] / "branches.nc")
    with started(*BRUSSELATOR, "--out", out) as running:
        _wait_for(running, out / UNFINISHED[1])
        running.send_signal(signal.SIGINT)
        _, told = running.communicate()
    assert running.returncode == 1
    assert told.count("\n") == 1
    assert "interrupted by the user; the same command with --resume goes on" in told
    assert _whole(out) == sorted((*FILES, *UNFINISHED))
    assert rb.load(out / "branches.nc").branches[0] == whole.branches[0]


@pytest.mark.parametrize("number", STATUS, ids=lambda number: number.name)
@pytest.mark.parametrize("share", [0.4, 0.9])
def test_continue_stopped_at_any_moment_leaves_whole_files(uninterrupted, tmp_path, number, share):
    out = tmp_path / "out"
    with started(*BRUSSELATOR, "--out", out) as running:
        time.sleep(share * uninterrupted[1])
        running.send_signal(number)
        _, told = running.communicate()
    assert running.returncode in {0, STATUS[number], -number}
    assert "Traceback" not in told or not out.exists()  # Python itself was still being started
    assert set(_whole(out)) <= {*FILES, *UNFINISHED}


@pytest.mark.parametrize("number", STATUS, ids=lambda number: number.name)
def test_a_chart_stopped_at_any_moment_leaves_whole_files(tmp_path, number):
    """Of a map the finished tiles stay and are taken up again: see test_chart."""
    out = tmp_path / "out"
    command = ("chart", "B", "A", "--span", "B", "1.5", "3.5", "--span", "A", "0.5", "1.5")
    command += ("--map", "damping", "--cells", "80", "80", "--model", "brusselator", "--quiet")
    with started(*command, "--out", out) as running:
        _wait_for(running, out / "tiles" / "map.json")
        running.send_signal(number)
        _, told = running.communicate()
    assert running.returncode in {0, STATUS[number]}
    assert "Traceback" not in told
    assert set(_whole(out)) >= {"map.json"} or running.returncode == 0
    with started(*command, "--out", out, "--resume") as running:
        running.communicate()
    assert running.returncode == 0
    assert {"chart.nc", "chart.png", "chart.svg", "summary.json"} == set(_whole(out))


@pytest.mark.parametrize("number", STATUS, ids=lambda number: number.name)
def test_the_claims_stopped_at_any_moment_leave_whole_files(tmp_path, number):
    out = tmp_path / "out"
    with started("run", "claims", "--set", "resolution=8", "--out", out) as running:
        time.sleep(1.5)
        running.send_signal(number)
        _, told = running.communicate()
    assert running.returncode in {0, STATUS[number], -number}
    assert "Traceback" not in told or not out.exists()
    assert set(_whole(out)) <= {"claims.md", "claims.html"}
