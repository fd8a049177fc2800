"""Which C_s: the paper's boundaries solved for the stiffness, and sets of stiffnesses."""

from __future__ import annotations

import numpy as np
import pytest

from racs_bif.cli.main import main
from racs_bif.shelf import find, load_module
from racs_bif.shelf.analyses import _claimed as claimed
from racs_bif.shelf.analyses import _stability as stability
from racs_bif.shelf.analyses import _stability_search as search

PINS = {
    ("fig03", ""): 29661.065,
    ("fig13", ""): 37376.0,
    ("fig09", ""): 13128.4,
    ("fig10", "c = 0.3"): 29139.0,
}
"""Issue 7, item 3, and `model.md` for the first."""


@pytest.fixture(scope="module")
def fitted():
    return load_module(find("analyses", "which_stiffness")).fit("paper", 80)


def by_label(fitted):
    return {
        (statement.key, found.reading.label): found
        for statement, each in zip(claimed.STATEMENTS, fitted.found, strict=True)
        for found in each
    }


@pytest.mark.parametrize(("name", "value"), PINS.items())
def test_boundaries_are_where_the_exact_hopf_condition_has_them(fitted, name, value):
    found = by_label(fitted)[name]
    assert len(found.hopf) == 1
    assert found.hopf[0] == pytest.approx(value, abs=0.06)
    ((low, high),) = found.holds
    assert low < value < high


def test_intervals_of_the_statements_without_a_boundary(fitted):
    found = by_label(fitted)
    assert found["fig07", ""].holds[0] == pytest.approx((38327.0, 43003.0), abs=0.5)
    assert found["fig11a", ""].holds[0][1] == pytest.approx(18022.0, abs=0.5)
    assert found["fig05", ""].holds[0][1] == pytest.approx(38327.0, abs=0.5)


def test_no_stiffness_makes_all_statements_true(fitted):
    assert fitted.never == 0
    assert fitted.most == 7 < len(claimed.STATEMENTS)
    assert fitted.where[0] == pytest.approx((13078.0, 13084.0), abs=1.0)
    assert fitted.calibrated == 5
    assert "fig03" in fitted.missed
    assert fitted.nearest == pytest.approx(26174.0, rel=1e-3)


def test_a_finer_grid_finds_nothing_more(fitted):
    finer = load_module(find("analyses", "which_stiffness")).fit("paper", 170)
    for one, other in zip(fitted.found, finer.found, strict=True):
        for a, b in zip(one, other, strict=True):
            assert a.hopf == pytest.approx(b.hopf, rel=1e-9)


def test_the_printed_signs_make_nothing_true():
    fitted = load_module(find("analyses", "which_stiffness")).fit("printed", 30)
    assert (fitted.most, fitted.never) == (0, len(claimed.STATEMENTS))
    assert np.isnan(fitted.nearest)


def test_slow_pairs_are_no_shimmy_and_a_lost_equilibrium_is_nothing():
    (course,) = stability.courses("restoring", [{"u": 10.0}], 60)
    assert [stretch.state for stretch in course.stretches][-3:] == ["divergence", "slow", "stable"]
    assert course.at(600.0) == "none"
    assert course.hopf[0].omega < search.SLOW


def test_a_pair_that_crosses_twice_within_a_cell_is_found():
    # At a grid this coarse both ends of a cell may look alike; the search looks into it.
    fine = stability.courses("printed", [{"u": 31.0}], 150)[0]
    coarse = stability.courses("printed", [{"u": 31.0}], 26)[0]
    assert len(fine.hopf) == 2
    assert [h.stiffness for h in coarse.hopf] == pytest.approx([h.stiffness for h in fine.hopf])


def test_the_condition_of_another_modulus_scales_the_stiffness():
    soft, stiff = stability.courses("paper", [{"u": 20.0}, {"u": 20.0, "E_0": 1e5}], 40)
    assert soft.hopf[0].stiffness == pytest.approx(2.0 * stiff.hopf[0].stiffness, rel=1e-9)


def test_sets():
    assert claimed.common(((1.0, 3.0), (5.0, 9.0)), ((2.0, 6.0),)) == ((2.0, 3.0), (5.0, 6.0))
    assert claimed.common(((1.0, 2.0),), ((3.0, 4.0),)) == ()
    assert claimed.either(((1.0, 2.0),), (), ((1.5, 3.0), (4.0, 5.0))) == ((1.0, 3.0), (4.0, 5.0))
    apart = claimed.distance(np.array([1.0, 2.0, 4.0]), ((2.0, 3.0),))
    assert apart == pytest.approx([np.log(2.0), 0.0, np.log(4.0 / 3.0)])
    assert np.isinf(claimed.distance(np.array([1.0]), ()))
    assert claimed.describe(((500.0, 2000.0), (3000.0, 1e7))) == "below 2000, above 3000"


def test_it_runs_from_the_command_line(tmp_path, capsys):
    arguments = ["run", "which_stiffness", "--set", "resolution=30", "--out", str(tmp_path)]
    assert main(arguments) == 0
    assert "Wrote" in capsys.readouterr().out
    text = (tmp_path / "which_stiffness.md").read_text(encoding="utf-8")
    assert "29661.07 (9.5201)" in text
    assert "| restoring | 2 of 12 |" in text
    pictures = {path.name for path in tmp_path.glob("*.png")}
    assert pictures == {"which_stiffness.png"} | {
        f"which_stiffness_{variant}.png" for variant in stability.VARIANTS
    }
