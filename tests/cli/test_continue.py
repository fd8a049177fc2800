import json
import os
import signal
import stat
from dataclasses import replace

import pytest

from racs_bif import load
from racs_bif.cli.continue_ import FILES
from racs_bif.errors import ConvergenceError
from racs_bif.results import files
from racs_bif.results.special import SpecialPoint

RUN = ("continue", "u", "5", "30")


@pytest.fixture
def out(tmp_path):
    return tmp_path / "deep" / "out"


@pytest.fixture
def complete(computed, known):
    """Orbits that reach the end of the span."""
    computed.orbits = lambda *_a, **_k: replace(known.orbits(), early=False, stopped="the end")
    return computed


def _names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_the_files_are_all_there_and_readable(cli, complete, out):
    told = cli(*RUN, "--out", out)
    assert told.status == 0
    assert told.err == ""
    assert _names(out) == sorted(FILES)
    diagram = load(out / "branches.nc")
    assert [branch.name for branch in diagram] == ["EQ1", "PO1"]
    summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    assert summary["command"] == [*RUN, "--out", str(out)]
    assert (out / "diagram.png").read_bytes().startswith(b"\x89PNG")
    assert b"<svg" in (out / "diagram.svg").read_bytes()
    umask = os.umask(0)
    os.umask(umask)
    assert {stat.S_IMODE(p.stat().st_mode) for p in out.iterdir()} == {0o666 & ~umask}


def test_the_default_folder_is_told(cli, complete, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    told = cli(*RUN)
    assert str(tmp_path / "racs_bif_out") in told.out
    assert _names(tmp_path / "racs_bif_out") == sorted(FILES)


def test_what_is_told_fits_80_columns(cli, complete, out):
    text = cli(*RUN, "--out", out).out
    lines = [line for line in text.splitlines() if not line.startswith("Wrote")]
    assert max(map(len, lines)) <= 80
    assert "synthetic, variant paper: Hopf's normal form" in text
    assert "oustaloup, 1 states, 0.1 to 1000 rad/s, largest error there 1 %" in text
    assert "stable 5 to 10, unstable (2) 10 to 30" in text
    assert "Note: the sign in print is inconsistent" in text
    hopf = next(line for line in lines if line.startswith("H1")).split()
    assert hopf[:4] == ["H1", "EQ1", "10", "10.001"]
    assert hopf[4:] == ["-1.0e-04", "9.5", "1.512", "-1.25", "supercritical"]


def test_a_branch_that_ends_early_is_saved_and_told(cli, computed, out):
    told = cli(*RUN, "--out", out)
    assert told.status == 1
    assert told.err.count("\n") == 1
    assert "ended early" in told.err
    assert "PO1: the period is too long for shooting; continue by collocation" in told.err
    assert _names(out) == sorted(FILES)


def test_orbits_that_do_not_start_leave_the_equilibria(cli, computed, out):
    def fail(*_a, **_k):
        msg = "Newton's method did not converge; raise its iterations"
        raise ConvergenceError(msg)

    computed.orbits = fail
    told = cli(*RUN, "--out", out)
    assert told.status == 1
    assert "no orbits from H1: Newton's method did not converge" in told.err
    assert [branch.name for branch in load(out / "branches.nc")] == ["EQ1"]


def test_equilibria_that_are_not_found_leave_nothing(cli, computed, out, tmp_path):
    def fail(*_a, **_k):
        msg = "no equilibrium near the guess"
        raise ConvergenceError(msg)

    computed.equilibria = fail
    told = cli(*RUN, "--out", out)
    assert (told.status, told.out) == (1, "")
    assert told.err == "racs-bif: no equilibrium near the guess\n"
    assert _names(tmp_path) == []


def test_a_mistake_of_ours_in_the_orbits_leaves_the_equilibria(cli, computed, out):
    computed.orbits = lambda *_a, **_k: 1 / 0
    told = cli(*RUN, "--out", out)
    assert told.status == 1
    assert "internal error, ZeroDivisionError" in told.err
    assert "Traceback" not in told.err
    assert [branch.name for branch in load(out / "branches.nc")] == ["EQ1"]


def test_orbits_can_be_left_out(cli, computed, out):
    told = cli(*RUN, "--orbits", "none", "--out", out)
    assert told.status == 0
    assert [branch.name for branch in load(out / "branches.nc")] == ["EQ1"]


def test_a_second_hopf_point_gives_a_second_branch_of_orbits(cli, complete, known, out):
    branch = known.equilibria()
    second = SpecialPoint(
        label="H", name="H2", branch="EQ1", index=20, parameters={"u": branch.parameter[20]}
    )
    labels = [*branch.labels[:20], "H", *branch.labels[21:]]
    two = replace(branch, special=(*branch.special, second), labels=labels)
    complete.equilibria = lambda *_a, **_k: two
    assert cli(*RUN, "--out", out).status == 0
    assert [b.name for b in load(out / "branches.nc")] == ["EQ1", "PO1", "PO2"]


def test_arguments_reach_the_computation(cli, computed, known, out):
    seen = {}

    def equilibria(system, parameter, span, *, at, probes, progress):
        seen["equilibria"] = (parameter, span, at, probes, progress)
        return known.equilibria()

    def orbits(point, span, *, method, at, known, progress):
        seen["orbits"] = (point.name, span, method, at, progress)
        seen["known"] = [branch.name for branch in known]
        return known.orbits()

    computed.equilibria, computed.orbits = equilibria, orbits
    cli(*RUN, "--at", "12", "18", "--at", "20", "--probes", "3", "--out", out)
    assert seen["equilibria"] == ("u", (5.0, 30.0), (12.0, 18.0, 20.0), 3, None)
    assert seen["orbits"] == ("H1", (5.0, 30.0), "shooting", (12.0, 18.0, 20.0), None)
    assert seen["known"] == ["EQ1"]


def test_json_is_the_summary_alone(cli, complete, out):
    told = cli(*RUN, "--json", "--out", out)
    assert json.loads(told.out) == json.loads((out / "summary.json").read_text(encoding="utf-8"))
    assert "Special points" in told.err


def test_quiet_prints_only_errors(cli, complete, computed, known, out):
    told = cli(*RUN, "--quiet", "--out", out)
    assert (told.status, told.out, told.err) == (0, "", "")
    computed.orbits = lambda *_a, **_k: known.orbits()
    told = cli(*RUN, "--quiet", "--out", out)
    assert told.out == ""
    assert "ended early" in told.err
    told = cli(*RUN, "--quiet", "--json", "--out", out)
    assert json.loads(told.out)["schema"] == 1


def test_interrupted_between_branches_keeps_what_is_there(cli, computed, out):
    def interrupt(*_a, **_k):
        signal.raise_signal(signal.SIGINT)

    before = signal.getsignal(signal.SIGINT)
    computed.orbits = interrupt
    told = cli(*RUN, "--out", out)
    assert told.status == 1
    assert "interrupted by the user" in told.err
    assert [branch.name for branch in load(out / "branches.nc")] == ["EQ1"]
    assert signal.getsignal(signal.SIGINT) is before


def test_an_interrupted_branch_is_kept_and_no_other_is_begun(cli, computed, known, out):
    def cut_short(*_a, **_k):
        try:
            signal.raise_signal(signal.SIGINT)
        except KeyboardInterrupt:
            return replace(known.equilibria(), early=True, stopped="The run was interrupted.")

    def never(*_a, **_k):
        raise AssertionError

    computed.equilibria, computed.orbits = cut_short, never
    told = cli(*RUN, "--out", out)
    assert told.status == 1
    assert "interrupted by the user | EQ1: The run was interrupted." in told.err
    assert _names(out) == sorted(FILES)


def test_interrupted_before_anything_leaves_nothing(cli, computed, out, tmp_path):
    computed.equilibria = lambda *_a, **_k: signal.raise_signal(signal.SIGINT)
    told = cli(*RUN, "--out", out)
    assert told.status == 1
    assert told.err == "racs-bif: interrupted before there was anything to save\n"
    assert _names(tmp_path) == []


def test_a_disk_that_fills_up_leaves_the_old_results(cli, complete, out, monkeypatch):
    cli(*RUN, "--out", out)
    before = {path.name: path.read_bytes() for path in out.iterdir()}

    def full(part, _node):
        part.write_bytes(b"half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(files, "write_tree", full)
    told = cli(*RUN, "--orbits", "none", "--out", out)
    assert told.status == 2
    assert "no space left on device" in told.err
    assert {path.name: path.read_bytes() for path in out.iterdir()} == before
