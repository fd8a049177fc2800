import logging
import os
import pty
import re
import select
import subprocess
import sys

import pytest

import racs_bif as rb
from racs_bif.continuation.settings import StepSettings

HEAD = re.compile(r"^ +BR +PT +TY +LAB +mu +norm")
ROW = re.compile(r"^ +(\d+) +(\d+)  ([A-Z]*) +(\d*) +(\S+E[+-]\d+) .* (\d+)$")


@pytest.fixture
def told(cli, normal_form, tmp_path):
    def run(*more, orbits="none"):
        command = ("continue", "mu", "-1", "1", "--model", normal_form, "--probes", "0")
        found = cli(*command, "--out", tmp_path / "out", "--orbits", orbits, *more)
        assert found.status == 0, found.err
        return found

    return run


def test_v_shows_a_line_a_point_in_a_table(told):
    lines = told("-v", orbits="collocation").err.splitlines()
    rows = [ROW.match(line) for line in lines if ROW.match(line)]
    heads = [line for line in lines if HEAD.match(line)]
    tables = [line for line in lines if ", branch " in line]
    numbers = [int(row[1]) for row in rows]
    assert numbers == sorted(numbers)
    # a head for each walk, and again after every 20 points
    walks = [[]]
    for before, row in zip([None, *rows], rows, strict=False):
        if before is not None and int(row[2]) == 1:
            walks.append([])
        walks[-1].append(row)
    assert len(tables) == len(walks) > 1
    assert len(heads) == sum((len(walk) + 19) // 20 for walk in walks)
    # aligned: every number of the parameter ends in the same column as its title
    assert {row.end(5) for row in rows} == {lines[lines.index(heads[0])].index("mu") + 2}
    hopf = [row for row in rows if row[3] == "H"]
    assert [float(row[5]) for row in hopf] == pytest.approx([0.0], abs=1e-8)
    assert hopf[0][4] == "1"
    assert any("period" in line for line in heads)
    assert not any("trial step" in line for line in lines)
    assert lines[-1].startswith("branch ")


def test_points_of_the_table_are_those_of_the_branch(told, tmp_path):
    rows = [ROW.match(line) for line in told("-v").err.splitlines()]
    values = sorted({float(row[5]) for row in rows if row})
    branch = rb.load(tmp_path / "out" / "branches.nc").branches[0]
    assert values == pytest.approx(sorted(set(branch.parameter)), abs=1e-6)


def test_vv_shows_trial_steps(told):
    lines = told("-vv").err.splitlines()
    assert sum("trial step" in line for line in lines) > 5
    assert any(ROW.match(line) for line in lines)


@pytest.mark.parametrize("flags", [(), ("-v", "--quiet")])
def test_nothing_is_logged_unless_asked_for(told, flags):
    assert not any(ROW.match(line) for line in told(*flags).err.splitlines())


def test_the_log_is_as_before_afterwards(told):
    logger = logging.getLogger("racs_bif")
    before = logger.level, list(logger.handlers)
    told("-vv")
    assert (logger.level, logger.handlers) == before


def test_rejected_steps_say_why(caplog):
    model = rb.model_from_strings(
        "bent", {"x": "mu - x**2"}, parameters={"mu": 1.0}, guess={"x": 1.0}
    )
    long = StepSettings(initial=0.9, maximum=0.9)
    with caplog.at_level(logging.DEBUG, logger="racs_bif.continuation"):
        rb.continue_equilibria(model, "mu", (-1.0, 1.0), settings=long)
    rejected = [r.getMessage() for r in caplog.records if "rejected" in r.getMessage()]
    reasons = ("tangent turned", "along the branch", "contracts too slowly", "converge")
    assert rejected
    assert all(any(reason in line for reason in reasons) for line in rejected)
    assert any("trial step 9.000E-01 from mu = " in r.getMessage() for r in caplog.records)


def _on_a_terminal(arguments):
    """Run the program with stderr on a terminal; return what it wrote there."""
    ours, theirs = pty.openpty()
    program = subprocess.Popen(
        [sys.executable, "-m", "racs_bif", *map(str, arguments)],
        stdout=subprocess.DEVNULL,
        stderr=theirs,
        stdin=subprocess.DEVNULL,
        env={**os.environ, "TERM": "xterm"},
    )
    os.close(theirs)
    written = b""
    while True:
        ready, _, _ = select.select([ours], [], [], 0.5)
        if ready:
            try:
                piece = os.read(ours, 65536)
            except OSError:  # Linux says so at the end of a terminal
                break
            if not piece:
                break
            written += piece
        elif program.poll() is not None:
            break
    os.close(ours)
    assert program.wait(60) == 0, written.decode()
    return written.decode()


@pytest.mark.parametrize(
    ("verb", "bar"),
    [
        (["continue", "mu", "0", "1", "--probes", "0", "--orbits", "none"], "equilibria: "),
        (["spectrum"], "searching for roots"),
        (["simulate", "--time", "1"], "loading"),
    ],
)
def test_verbs_that_take_long_show_bars_on_a_terminal_alone(normal_form, tmp_path, verb, bar):
    command = [*verb, "--model", normal_form, "--out", tmp_path / "out"]
    assert bar in _on_a_terminal(command)


def test_no_bar_where_it_would_disturb(normal_form, tmp_path):
    command = ["spectrum", "--model", normal_form, "--out", tmp_path / "out"]
    assert _on_a_terminal([*command, "--quiet"]) == ""
    assert "searching" not in _on_a_terminal([*command, "-v"])
