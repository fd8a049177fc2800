"""The ledger of claims: verdicts follow from what is computed."""

from __future__ import annotations

import re

import pytest

from racs_bif.cli.main import main
from racs_bif.shelf import find, load_module
from racs_bif.shelf.analyses import _checks_motion as motion
from racs_bif.shelf.analyses import _checks_stability as stability
from racs_bif.shelf.analyses import _claimed as claimed
from racs_bif.shelf.analyses import _claims_page as page
from racs_bif.shelf.analyses import _ledger as ledger

MOVING = (motion.Chaos, motion.Widths, motion.Cycle)
"""Checks that take seconds."""


@pytest.fixture(scope="module")
def claims():
    return load_module(find("analyses", "claims"))


@pytest.fixture(scope="module")
def entries(claims):
    quick = tuple(c for c in claims.CLAIMS if not isinstance(c.check, MOVING))
    return {entry.claim.key: entry for entry in claims.check(quick, resolution=80)}


def test_claims_are_complete_and_told_apart(claims):
    keys = [claim.key for claim in claims.CLAIMS]
    assert len(keys) == len(set(keys)) >= 35
    figures = {claim.figure for claim in claims.CLAIMS}
    assert {f"fig{k:02d}" for k in range(3, 15)} <= figures
    conclusions = {key[:12] for key in keys if key.startswith("conclusion")}
    assert conclusions == {f"conclusion-{k}"[:12] for k in range(1, 6)}
    assert all(claim.says and claim.place for claim in claims.CLAIMS)


@pytest.mark.parametrize(
    ("key", "verdict"),
    [
        ("law", ledger.FALSE),
        ("matrices", ledger.FALSE),
        ("fig03", ledger.CALIBRATED),
        ("fig03-super", ledger.CALIBRATED),
        ("fig03-below", ledger.CALIBRATED),
        ("fig04-seven", ledger.ONLY),
        ("fig06a", ledger.CALIBRATED),
        ("fig07", ledger.CONTRADICTS),
        ("fig08", ledger.HOLDS),
        ("fig09", ledger.ONLY),
        ("fig13", ledger.ONLY),
        ("fig14b", ledger.ONLY),
        ("one-vehicle", ledger.FALSE),
        ("conclusion-1", ledger.HOLDS),
        ("conclusion-4m", ledger.HOLDS),
    ],
)
def test_verdicts(entries, key, verdict):
    assert entries[key].kind == verdict


def test_figures_5_and_7_say_the_opposite_of_one_vehicle(entries):
    assert "fig05" in entries["fig07"].against
    assert "fig07" in entries["fig05"].against
    # Figure 5 holds with the calibrated stiffness, so that is its verdict.
    assert entries["fig05"].verdict == ledger.CALIBRATED
    assert "contradicts" in entries["fig07"].verdict
    assert "38327 to 43003" in entries["fig07"].verdict


def test_what_cannot_be_true_together_is_listed_both_ways(entries):
    assert {"fig07", "fig09", "fig13"} <= set(entries["fig03"].apart)
    assert "fig03" in entries["fig09"].apart


def test_seven_seconds_need_a_stiffer_axle(entries):
    ((low, high),) = entries["fig04-seven"].finding.where
    assert (low, high) == pytest.approx((30991.0, 31456.0), abs=1.0)
    assert "49 to 64 s" in entries["fig04-seven"].finding.found


def test_orbits_grow_as_the_mass_falls(claims):
    (claim,) = (c for c in claims.CLAIMS if c.key == "fig10-smaller")
    check = motion.Widths(
        "m_c", (120.0, 200.0), (155.0, 130.0), {"u": 20.0, "c": 0.3}, key="fig10", reading=2
    )
    bench = ledger.Bench((claim,), 60, 10.0)
    found = check.find(bench)
    assert found.where is not None
    assert found.where[0] == pytest.approx((29051.0, 29229.0), abs=1.0)
    assert "155: 0.0469" in found.found
    falls = motion.Widths(
        "m_c", (120.0, 200.0), (130.0, 155.0), {"u": 20.0, "c": 0.3}, key="fig10", reading=2
    )
    assert falls.find(bench).where == ()


def test_a_tendency_the_wrong_way_round_does_not_hold():
    wrong = stability.Threshold("c", (0.15, 0.2), stabilises=True)
    claim = ledger.Claim(key="x", place="", says="", stated="", check=wrong)
    found = wrong.find(ledger.Bench((claim,), 60, 10.0))
    assert found.where == ()
    assert ledger.verdict_on(found, (), 29661.0) == ledger.FALSE


@pytest.mark.parametrize(
    ("where", "true", "against", "verdict"),
    [
        (ledger.ALWAYS, False, (), "holds"),
        (((2e4, 4e4),), False, ("b",), "holds with the calibrated C_s"),
        (((4e4, 5e4),), False, (), "holds only for C_s in [40000 to 50000] N/rad"),
        (((4e4, 1e7),), False, ("b",), "contradicts b; holds only for C_s in [above 40000] N/rad"),
        ((), False, (), "does not hold"),
        (None, True, (), "holds with the calibrated C_s"),
        (None, False, (), "does not hold with the calibrated C_s"),
    ],
)
def test_the_verdict_follows_from_the_finding(where, true, against, verdict):
    finding = ledger.Finding(computed="", found="", where=where, true=true)
    assert ledger.verdict_on(finding, against, 29661.0) == verdict
    entry = ledger.Entry(claim=None, finding=finding, verdict=verdict)
    assert verdict.startswith(entry.kind)


def test_pages_link_to_the_pictures_there_are(entries):
    some = [entries["fig03"], entries["fig07"]]
    pictures = ["fig03_speed.png", "fig07_alpha.png", "fig09_c.png"]
    html = page.to_html(some, pictures, 29661.065)
    assert 'href="fig03_speed.png"' in html
    assert "fig09_c.png" not in html
    assert set(re.findall(r'<article id="([^"]+)"', html)) == {"fig03", "fig07"}
    assert "http" not in html
    text = page.to_markdown(some, [], 29661.065)
    rows = [line for line in text.splitlines() if line.startswith("| `")]
    assert len(rows) == 2
    assert all(line.count(" | ") == 8 for line in rows)


def test_every_key_is_of_a_statement(claims):
    known = {statement.key for statement in claimed.STATEMENTS}
    said = {c.check.key for c in claims.CLAIMS if isinstance(c.check, stability.Says)}
    assert said == known


def test_it_runs_from_the_command_line(tmp_path, capsys):
    numbers = ["--set", "resolution=60", "--set", "seconds=8"]
    (tmp_path / "fig03_speed.png").write_bytes(b"")
    assert main(["run", "claims", *numbers, "--out", str(tmp_path)]) == 0
    assert "Wrote" in capsys.readouterr().out
    html = (tmp_path / "claims.html").read_text(encoding="utf-8")
    text = (tmp_path / "claims.md").read_text(encoding="utf-8")
    assert 'href="fig03_speed.png"' in html
    assert html.count("<article") == text.count("\n| `") >= 35
    chaos = next(line for line in text.splitlines() if line.startswith("| `fig09-chaos`"))
    assert "**does not hold**" in chaos
    grows = next(line for line in text.splitlines() if line.startswith("| `fig03-grows`"))
    assert "20: 0.2510" in grows
