"""Going on with a run of ``continue`` that was killed or interrupted."""

import json
import shutil

import pytest

import racs_bif as rb
from racs_bif.cli import following
from racs_bif.cli.journal import UNFINISHED
from racs_bif.cli.main import main

# Orbits of radius sqrt(s) where s > 0: from 1 to 2 and from 3 to 4.
TWO_BRANCHES = """
name = "two-branches"
title = "Orbits from four Hopf points"

[parameters]
a = 0.5

[equations]
x = "(a - 1)*(2 - a)*(a - 3)*(a - 4)*x - y - (x**2 + y**2)*x"
y = "x + (a - 1)*(2 - a)*(a - 3)*(a - 4)*y - (x**2 + y**2)*y"
"""


class Killed(BaseException):
    """As SIGKILL: nothing else is done."""


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    path = tmp_path_factory.mktemp("model") / "two.toml"
    path.write_text(TWO_BRANCHES)
    return path


def _command(model, out, *more):
    line = f"continue a 0.5 4.5 --model {model} --orbits collocation --probes 0 --quiet --out {out}"
    return [*line.split(), *more]


@pytest.fixture(scope="module")
def whole(model, tmp_path_factory):
    out = tmp_path_factory.mktemp("whole") / "out"
    assert main(_command(model, out)) == 0
    return rb.load(out / "branches.nc")


@pytest.fixture(scope="module")
def killed(model, tmp_path_factory):
    """The folder of a run that was killed when it came to H3."""
    out = tmp_path_factory.mktemp("killed") / "out"
    with pytest.MonkeyPatch.context() as patch:
        _, stops = _watched(patch)
        stops["H3"] = Killed()
        with pytest.raises(Killed):
            main(_command(model, out))
    return out


@pytest.fixture
def out(killed, tmp_path):
    """A copy of it."""
    shutil.copytree(killed, tmp_path / "out")
    return tmp_path / "out"


@pytest.fixture
def followed(monkeypatch):
    return _watched(monkeypatch)


def _watched(patch):
    """Names of the points that orbits are really followed from, and what stops the run where."""
    names, stops = [], {}
    real = following._follow_orbits

    def follow(point, *rest):
        if point.name in stops:
            raise stops[point.name]
        names.append(point.name)
        real(point, *rest)

    patch.setattr(following, "_follow_orbits", follow)
    return names, stops


def test_a_run_that_goes_on_ends_as_if_never_killed(model, whole, out, followed):
    names, _ = followed
    assert main(_command(model, out, "--resume")) == 0
    assert names == ["H3", "H4"]
    assert rb.load(out / "branches.nc") == whole
    assert [branch.name for branch in whole.branches] == ["EQ1", "PO1", "PO2"]
    assert not any((out / name).exists() for name in UNFINISHED)


def test_a_run_that_goes_on_ends_as_if_never_interrupted(model, whole, tmp_path, followed):
    names, stops = followed
    stops["H3"] = KeyboardInterrupt()
    assert main(_command(model, tmp_path)) == 1
    assert names == ["H1", "H2"]
    names.clear()
    stops.clear()
    assert main(_command(model, tmp_path, "--resume")) == 0
    assert names == ["H3", "H4"]
    assert rb.load(tmp_path / "branches.nc") == whole


def test_a_run_that_is_killed_again_loses_nothing(model, out, followed):
    names, stops = followed
    steps = json.loads((out / UNFINISHED[1]).read_text())["steps"]
    assert [step["name"] for step in steps] == ["equilibria", "orbits from H1", "orbits from H2"]
    assert "those of PO1" in steps[2]["notes"][0]
    kept = rb.load(out / UNFINISHED[0])
    stops["H3"] = Killed()
    with pytest.raises(Killed):
        main(_command(model, out, "--resume"))
    assert names == []
    assert json.loads((out / UNFINISHED[1]).read_text())["steps"] == steps
    assert rb.load(out / UNFINISHED[0]) == kept


def test_nothing_is_lost_before_the_first_step_is_taken(model, out, followed, monkeypatch):
    """All is on disk after the equilibria, too, which are computed again."""
    kept, take = (out / UNFINISHED[1]).read_text(), Killed()

    def killed(*_arguments, **_options):
        raise take

    monkeypatch.setattr(following.Run, "take", killed)
    with pytest.raises(Killed):
        main(_command(model, out, "--resume"))
    assert (out / UNFINISHED[1]).read_text() == kept
    assert len(rb.load(out / UNFINISHED[0]).branches) == 2
    assert followed[0] == []


def test_steps_that_others_start_from_are_done_again(model, out, followed, monkeypatch):
    """Where branches begin is not on disk."""
    names, stops = followed
    steps = out / UNFINISHED[1]
    steps.write_text(steps.read_text().replace('"branches": "0"', '"branches": "1"'))

    class Everything(frozenset):
        def isdisjoint(self, _labels):
            return False  # as if there were a period doubling

    monkeypatch.setattr(following, "SWITCHED", Everything())
    stops["H3"] = Killed()
    with pytest.raises(Killed):
        main(_command(model, out, "--branches", "1", "--resume"))
    assert names == ["H1", "H2"]


def test_nothing_to_go_on_with(model, capsys, tmp_path):
    assert main(_command(model, tmp_path / "none", "--resume")) == 2
    told = capsys.readouterr().err
    assert "holds no unfinished run to go on with; leave out --resume" in told
    assert not (tmp_path / "none").exists()


def test_another_run_is_not_gone_on_with(model, capsys, out):
    assert main([*_command(model, out, "--resume"), "--probes", "3", "--at", "1.5"]) == 2
    told = capsys.readouterr().err
    assert "differs in at, probes; give the same, or leave out --resume to begin again" in told


@pytest.mark.parametrize(
    ("spoil", "why"),
    [
        (lambda text: text[:40], "it cannot be read"),
        (lambda text: text.replace('"format": 1', '"format": 2'), "its format is 2, not 1"),
        (lambda text: text.replace('"branches": 1', '"branches": 3'), "it lacks branches"),
        (lambda _: "[]", "it cannot be read"),
    ],
)
def test_spoilt_steps_are_refused(model, capsys, out, spoil, why):
    steps = out / UNFINISHED[1]
    steps.write_text(spoil(steps.read_text()))
    assert main(_command(model, out, "--resume")) != 0
    told = capsys.readouterr().err
    assert why in told
    assert told.count("\n") == 1


def test_there_is_nothing_to_resume_without_orbits(model, capsys, out):
    line = _command(model, out, "--resume")
    line[line.index("collocation")] = "none"
    assert main(line) == 2
    assert (
        "--orbits none leaves nothing to go on with; leave out --resume" in capsys.readouterr().err
    )
