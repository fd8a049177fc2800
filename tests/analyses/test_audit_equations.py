"""The audit of the printed equations."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

from racs_bif.cli.main import main
from racs_bif.shelf import find, load_module
from racs_bif.shelf.analyses import _audit_dimensions as dimensions
from racs_bif.shelf.analyses import _audit_symbols as symbols
from racs_bif.shelf.models import racs


def test_entries_of_the_state_space_form():
    entries = {entry.name: entry for entry in symbols.state_space_entries()}
    wrong = {name for name, entry in entries.items() if not entry.agrees}
    assert len(entries) == 19
    assert wrong == {"A_2[1,1]", "A_2[1,2]", "B_2[1,2]", "B_2[1,3]"}
    assert symbols.reading_agrees()
    X = racs.e * (racs.c - racs.e) * racs.m_c - racs.I_cs
    derived = -(racs.c - racs.e) * racs.m_c / X
    assert sp.simplify(entries["A_2[1,1]"].derived - derived) == 0


def test_what_rigid_bodies_have_beyond_the_printed_rows():
    missing = symbols.missing_terms()
    term = racs.m_c * (racs.u * racs.w - racs.c * racs.d2delta_c)
    factors = (1, racs.b - racs.c, racs.c - racs.e)
    for found, factor in zip(list(missing.values())[:3], factors, strict=True):
        assert sp.expand(found - term * factor) == 0
    assert missing["alpha_r"] == -racs.c * racs.ddelta_c / racs.u
    assert symbols.lagrange_agrees()


def test_dimensions_of_all_equations_are_right():
    checks = dimensions.check_all()
    assert len(checks) == 17
    assert all(check.wrong == "" for check in checks)
    assert next(c.unit for c in checks if c.name == "(6)") == "kg m s^(-2)"


def test_wrong_dimensions_are_found():
    x, t, a = sp.symbols("x t a")
    table = {x: (0, 1, 0), t: (0, 0, 1), a: (0, 0, 0)}
    assert dimensions.dimension(x / t**a, table) == (0, 1, -a)
    for wrong in (x + t, sp.sin(x), x**t, x + 1):
        with pytest.raises(dimensions.MismatchError):
            dimensions.dimension(wrong, table)


def test_a_pair_crosses_beside_the_real_root_of_the_printed_signs():
    crossing = load_module(find("analyses", "audit_equations")).printed_crossing()
    assert crossing.speed == pytest.approx(40.8297, abs=1e-4)
    assert crossing.omega == pytest.approx(7.754, abs=1e-3)
    assert (crossing.before, crossing.after) == (1, 3)


def test_root_counts_tell_the_signs_apart():
    audit = load_module(find("analyses", "audit_equations"))
    printed, restoring, paper = (audit.sign_map(name, 40, 12) for name in audit.SIGNS)
    assert np.all(printed.count % 2 == 1)
    assert set(np.unique(paper.count)) == {0, 2}
    assert np.nanmax(paper.omega) > 9.0
    assert np.nanmax(restoring.omega, initial=0.0) < 0.1
    assert np.mean(restoring.count == 0) > 0.6


def test_it_runs_from_the_command_line(tmp_path, capsys):
    numbers = ["--set", "resolution=30", "--set", "speeds=8"]
    assert main(["run", "audit_equations", *numbers, "--out", str(tmp_path)]) == 0
    assert "Wrote" in capsys.readouterr().out
    text = (tmp_path / "audit_equations.md").read_text(encoding="utf-8")
    assert "19 entries derived from (9); 4 differ" in text
    assert "u = 40.8297 m/s" in text
    assert (tmp_path / "audit_signs.png").is_file()
