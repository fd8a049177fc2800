"""Exact roots beside eigenvalues, and realisations beside each other."""

from __future__ import annotations

import json

import numpy as np
import pytest

import racs_bif as rb
from racs_bif.cli.main import main
from racs_bif.errors import UsageError
from racs_bif.verbs.realisations import compare_realisations, fitted


def test_roots_of_the_vehicle_at_12_metres_a_second():
    found = rb.spectrum(rb.load_model("racs", parameters={"u": 12}), above=0)
    assert found.roots.unstable == 2
    assert found.roots.roots[0] == pytest.approx(0.49290598 + 8.93656849j, abs=1e-8)
    assert found.shifts.max() < 1e-3


def test_an_ordinary_model_has_its_eigenvalues_as_roots():
    model = rb.model_from_strings(
        "spiral", {"x": "a*x-w*y", "y": "w*x+a*y"}, parameters={"a": -0.25, "w": 3.0}
    )
    found = rb.spectrum(model)
    assert found.roots.roots[0] == pytest.approx(-0.25 + 3.0j, abs=1e-12)
    assert found.shifts.max() < 1e-12


def test_the_line_must_be_somewhere():
    with pytest.raises(UsageError, match="finite"):
        rb.spectrum(rb.load_model("racs"), above=float("inf"))


def test_spectrum_verb_prints_the_roots_as_json(capsys, tmp_path):
    status = main(["spectrum", "--set", "u=20", "--above", "0", "--json", "--out", str(tmp_path)])
    summary = json.loads(capsys.readouterr().out)
    assert status == 0
    assert summary["unstable"] == 2
    assert summary["roots"][0] == pytest.approx([1.80501519, 7.66054698], abs=1e-8)
    assert {p.name for p in tmp_path.iterdir()} >= {"spectrum.png", "spectrum.svg", "summary.json"}


def test_all_realisations_are_compared_at_the_hopf_point():
    table = compare_realisations(rb.load_model("racs"), along=("u", 5.0, 30.0))
    rows = {row.name: row for row in table.rows}
    assert table.hopf["u"] == pytest.approx(10.2, rel=1e-9)
    assert rows["fitted"].hopf_error < 1e-10
    assert 1e-6 < rows["diffusive"].hopf_error < 1e-3
    assert rows["nonnegative"].refused
    assert set(table.errors) == {name for name, row in rows.items() if not row.refused}
    assert all(np.isfinite(errors).all() for errors in table.errors.values())


def test_a_realisation_fitted_to_the_hopf_point_yields_it_exactly():
    system = fitted(rb.load_model("racs", realisation="fitted"), "u", (5.0, 30.0))
    hopf = rb.continue_equilibria(system, "u", (5.0, 30.0))["H1"]
    assert hopf.parameters["u"] == pytest.approx(10.2, rel=1e-9)
    assert abs(hopf.exact.shift["u"]) < 1e-9
    assert hopf.l1 == pytest.approx(hopf.exact.l1, rel=1e-6)


def test_realisations_need_a_fractional_element():
    model = rb.model_from_strings("decay", {"x": "-k*x"}, parameters={"k": 1.0})
    with pytest.raises(UsageError, match="no fractional element"):
        compare_realisations(model)


def test_realisations_verb(capsys, tmp_path):
    arguments = ["--along", "u", "5", "30", "--json", "--out", str(tmp_path)]
    assert main(["realisations", *arguments]) == 0
    summary = json.loads(capsys.readouterr().out)
    assert {row["name"] for row in summary["realisations"]} >= {"fitted", "oustaloup", "aaa"}
    assert (tmp_path / "realisations.svg").stat().st_size > 0
    assert main(["realisations", "--along", "u", "5", "x", "--out", str(tmp_path)]) == 2


def test_a_span_without_a_hopf_point_has_nothing_to_compare():
    system = rb.load_model("racs")
    with pytest.raises(UsageError, match=r"no Hopf point for u in 5 \.\. 6; give another span"):
        compare_realisations(system, along=("u", 5.0, 6.0))
    kept = rb.load_model("racs", realisation="fitted")
    assert fitted(kept, "u", (5.0, 6.0)) is kept
