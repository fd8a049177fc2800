from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from racs_bif.results.branch import Branch
from racs_bif.results.provenance import SystemInfo
from racs_bif.results.stability import describe_stability, merged, stretches


def test_stability_changes_at_the_special_point(branch):
    parts = stretches(branch)
    at = branch["H1"].index
    assert [(p.first, p.last, p.unstable) for p in parts] == [(0, at, 0), (at, len(branch) - 1, 2)]
    assert describe_stability(branch) == "stable 5 to 10, unstable (2) 10 to 30"


def test_stability_is_told_from_the_lower_end(branch):
    backward = replace(
        branch,
        values=branch.values[::-1],
        unstable=branch.unstable[::-1],
        labels=branch.labels[::-1],
        special=(),
    )
    assert describe_stability(backward) == describe_stability(branch)


def test_ends_that_nearly_coincide_are_told_apart_and_rounding_is_zero(branch):
    short = replace(branch, values=7.922 + 1e-7 * (branch.values - 5.0), special=())
    told = "stable 7.922 to 7.9220005, unstable (2) 7.9220005 to 7.9220025"
    assert describe_stability(short) == told
    about = replace(branch, values=branch.values - 10.0 + 1e-15, special=())
    assert describe_stability(about) == "stable -5 to 0, unstable (2) 0 to 20"


def test_a_stretch_that_turns_back_says_how_far_it_goes(branch):
    unstable = np.zeros(len(branch), dtype=int)
    values = 1.0 + np.linspace(-2.0, 2.0, len(branch))[:, None] ** 2
    values[len(branch) // 2] = 1.0
    turned = replace(branch, values=values, unstable=unstable, special=())
    assert describe_stability(turned) == "stable 5 to 1 to 5"


@pytest.mark.parametrize("own", [0, 1, 2])
def test_what_the_special_point_itself_has_does_not_matter(branch, own):
    unstable = branch.unstable.copy()
    unstable[branch["H1"].index] = own
    assert stretches(replace(branch, unstable=unstable)) == stretches(branch)


def test_stretches_cover_the_branch_without_gaps():
    rng = np.random.default_rng(1)
    n = 60
    branch = Branch(
        name="EQ1",
        kind="equilibrium",
        parameters=("u",),
        values=np.arange(n),
        arclength=np.arange(n),
        stable=np.zeros(n),
        unstable=rng.integers(-1, 3, n),
        spectrum=np.empty((n, 0)),
        labels=[("H" if k % 7 == 0 else "UZ" if k % 5 == 0 else "") for k in range(n)],
        stopped="",
        early=False,
        system=SystemInfo(model="m"),
    )
    parts = stretches(branch)
    for joined in (parts, merged(parts)):
        assert joined[0].first == 0
        assert joined[-1].last == n - 1
        assert all(a.last == b.first for a, b in pairwise(joined))
    kinds = [part.kind for part in merged(parts)]
    assert all(a != b for a, b in pairwise(kinds))


def test_a_change_that_was_not_located_is_taken_for_unstable(branch):
    plain = replace(branch, labels=[""] * len(branch), special=())
    first, second = stretches(plain)
    assert plain.parameter[first.last] <= 10.0
    assert second.unstable == 2
    assert second.first == first.last


def test_unknown_stability_has_a_kind_of_its_own(branch):
    unknown = replace(branch, unstable=np.full(len(branch), -1))
    assert [p.kind for p in stretches(unknown)] == ["unknown"]
