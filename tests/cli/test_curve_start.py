"""Where `curve` looks for the point that it starts from, on known branches."""

import sys
from dataclasses import replace
from types import SimpleNamespace

import pytest

from racs_bif.cli.curve_start import starting_point
from racs_bif.errors import ConvergenceError, UsageError
from racs_bif.results.diagram import Diagram
from racs_bif.results.special import SpecialPoint

SPAN = (5.0, 30.0)


@pytest.fixture
def search(monkeypatch, known):
    """Search among known branches; tell what was asked for, and what was continued."""
    told = SimpleNamespace(tasks=[], probes=[], starts=[], orbits=lambda _point: known.orbits())

    def all_equilibria(*_args, probes, **_options):
        told.probes.append(probes)
        return Diagram(known.equilibria())

    def continue_orbits(point, span, *, method, progress):
        assert (span, method, progress) == (SPAN, "collocation", None)
        told.starts.append(point.name)
        return told.orbits(point)

    equilibria = SimpleNamespace(all_equilibria=all_equilibria)
    monkeypatch.setitem(sys.modules, "racs_bif.verbs.all_equilibria", equilibria)
    orbits = SimpleNamespace(continue_orbits=continue_orbits)
    monkeypatch.setitem(sys.modules, "racs_bif.verbs.orbits", orbits)

    def run(label, *, point=None, branches=1):
        arguments = SimpleNamespace(first="u", point=point, branches=branches)
        told.tasks.clear()

        def task(title, span):
            assert span == SPAN
            told.tasks.append(title)

        return starting_point(object(), arguments, label, SPAN, task)

    told.run = run
    return told


def with_point(branch, label, name, **data):
    """Return a branch with one more special point."""
    point = SpecialPoint(
        label=label, name=name, branch=branch.name, index=3, parameters={"u": 12.5}, data=data
    )
    return replace(branch, special=(*branch.special, point))


def test_a_hopf_point_is_found_without_orbits(search):
    assert search.run("H").name == "H1"
    assert search.starts == []
    assert search.tasks == ["equilibria"]


def test_a_point_on_orbits_is_found_from_the_hopf_point(search):
    assert search.run("NS").name == "NS1"
    assert search.tasks == ["equilibria", "orbits from H1"]
    assert search.probes == [0]


def test_points_of_another_name_are_passed_over_and_told(search):
    with pytest.raises(UsageError, match="no point 'NS7'; there are: NS1"):
        search.run("NS", point="NS7")
    # The second search, with probes, finds the same branch: its orbits are not computed again.
    assert search.probes == [0, 6]
    assert search.starts == ["H1"]


def test_doubled_orbits_are_followed_as_far_as_is_asked_for(search, known):
    def orbits(point):
        found = known.orbits()
        if point.name == "H1":
            return with_point(found, "PD", "PD1")
        if point.name == "PD1":
            return replace(with_point(found, "PD", "PD2"), name="PO2")
        return replace(with_point(found, "LPC", "LPC1"), name="PO3")

    search.orbits = orbits
    with pytest.raises(UsageError, match="no LPC as u goes from 5 to 30; give another --span"):
        search.run("LPC", branches=1)
    assert search.starts == ["H1", "PD1"]
    search.starts.clear()
    assert search.run("LPC", branches=2).name == "LPC1"
    assert search.starts[:2] == ["H1", "PD1"]
    assert search.starts[2].startswith("PD")


def test_what_stood_in_the_way_is_told(search):
    def fails(_point):
        raise ConvergenceError("the amplitude vanished")

    search.orbits = fails
    words = r"no PD as u .*--span \(no orbits from H1: the amplitude vanished\)"
    with pytest.raises(UsageError, match=words):
        search.run("PD")


def test_of_end_points_only_those_at_homoclinic_orbits_are_taken(search, known):
    plain = with_point(known.orbits(), "EP", "EP1", connection="heteroclinic")
    search.orbits = lambda _point: plain
    with pytest.raises(UsageError, match="no orbit that tends to a homoclinic one as u goes from"):
        search.run("EP")
    search.orbits = lambda _point: with_point(plain, "EP", "EP2", connection="homoclinic")
    assert search.run("EP").name == "EP2"


def test_a_curve_of_cycles_is_told_with_its_period_and_why_it_ended(cli, known, tmp_path, capsys):
    from racs_bif.cli.curve import _finish

    along = known.orbits()
    values = [[u, 1700.0 + (u - 15.0) ** 2] for u in along.parameter]
    curve = replace(
        along,
        name="PDC1",
        kind="curve",
        parameters=("u", "m"),
        values=values,
        measures={"period": along.measures["period"], "c": 0.5 + 0.0 * along.parameter},
        special=(
            SpecialPoint(
                label="EP", name="EP1", branch="PDC1", index=0, parameters={"u": 10.0, "m": 1725.0}
            ),
            SpecialPoint(
                label="GPD",
                name="GPD1",
                branch="PDC1",
                index=9,
                parameters={"u": 14.0, "m": 1701.0},
            ),
        ),
        labels=["EP", *[""] * 8, "GPD", *[""] * (len(along) - 10)],
        profiles={},
        early=True,
        stopped="the step became too small",
    )
    words = ["curve", "pd", "u", "m"]
    out = tmp_path / "out"
    arguments = SimpleNamespace(command=words, out=out, json=False, quiet=False)
    assert _finish([curve], arguments) == 1
    told = capsys.readouterr()
    assert "period [s]" in told.out
    assert "Re d" not in told.out
    assert "GPD1" in told.out
    assert "EP1" not in told.out
    assert "least m" in told.out
    warning = " ".join(told.err.split())
    assert "ended early, saved what there is in" in warning
    assert "PDC1: the step became too small" in warning
    assert {"branches.nc", "summary.json"} <= {path.name for path in out.iterdir()}
