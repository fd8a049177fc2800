from dataclasses import replace

import pytest

from racs_bif.errors import UsageError
from racs_bif.results.diagram import Diagram


def test_names_that_are_taken_are_renumbered(branch, orbit_branch):
    diagram = Diagram(branch, orbit_branch, orbit_branch)
    assert [b.name for b in diagram] == ["EQ1", "PO1", "PO2"]
    names = [p.name for p in diagram.special_points]
    assert names == ["H1", "UZ1", "UZ2", "NS1", "UZ3", "NS2"]
    last = diagram.branches[2]
    assert [p.branch for p in last.special] == ["PO2", "PO2"]
    assert set(last.profiles) == {"NS2"}


def test_things_are_found_by_name(diagram):
    assert diagram["EQ1"] is diagram.branches[0]
    assert diagram["NS1"].branch == "PO1"
    with pytest.raises(UsageError, match="did you mean 'NS1'"):
        diagram["NS11"]


def test_a_branch_without_collisions_is_kept_as_it_is(branch):
    assert Diagram(branch).branches[0] is branch


def test_early_if_any_branch_is(branch, orbit_branch):
    assert not Diagram(branch).early
    assert Diagram(branch, orbit_branch).early


def test_an_empty_diagram_is_refused():
    with pytest.raises(UsageError, match="at least one branch"):
        Diagram()


def test_comparison(diagram, branch):
    assert diagram == Diagram(*diagram.branches)
    assert diagram != Diagram(replace(branch, stopped="elsewhere"), diagram.branches[1])
    assert len(diagram) == 2
    assert repr(diagram).count("\n") == 1


def test_a_diagram_is_no_list_of_its_branches(diagram):
    assert diagram != list(diagram.branches)
    assert diagram == Diagram(*diagram.branches)
