import json
import os
import sys

import pytest

from racs_bif.results.diagram import Diagram
from racs_bif.results.files import save
from racs_bif.results.summary import summarise, write_summary


@pytest.fixture
def folder(tmp_path, known):
    diagram = Diagram(known.equilibria(), known.orbits())
    save(diagram, tmp_path / "branches.nc")
    summary = summarise(diagram, ["continue", "u", "5", "30"], "1.2.3")
    write_summary(summary, tmp_path / "summary.json")
    return tmp_path


def _one_line(told):
    return told.status == 2 and told.err.count("\n") == 1 and told.err.startswith("racs-bif: ")


def test_the_page_is_written_beside_the_files(cli, folder):
    told = cli("report", folder)
    assert told.status == 0, told.err
    assert told.out == f"Wrote {(folder / 'report.html').resolve()}\n"
    text = (folder / "report.html").read_text(encoding="utf-8")
    assert "racs-bif continue u 5 30" in text
    assert '"shown":"delta_c"' in text


def test_another_file_and_quantity(cli, folder):
    told = cli("report", folder, "--to", folder / "sub.html", "--state", "period", "--quiet")
    assert (told.status, told.out, told.err) == (0, "", "")
    assert '"shown":"period"' in (folder / "sub.html").read_text(encoding="utf-8")
    assert not (folder / "report.html").exists()


@pytest.mark.parametrize("change", ["points", "broken", "gone"])
def test_a_summary_of_another_run_is_not_quoted(cli, folder, change):
    path = folder / "summary.json"
    summary = json.loads(path.read_text())
    summary["branches"][0]["points"] += 1
    path.write_text(json.dumps(summary) if change == "points" else "{")
    if change == "gone":
        path.unlink()
    assert cli("report", folder).status == 0
    text = (folder / "report.html").read_text(encoding="utf-8")
    assert "racs-bif continue u 5 30" not in text
    assert "no summary.json of this run" in text


@pytest.mark.parametrize(
    ("file", "message"),
    [(None, "run 'racs-bif continue ... --out"), ("chart.nc", "holds a chart: see its chart.svg")],
)
def test_a_folder_without_branches_is_one_line(cli, tmp_path, file, message):
    if file:
        (tmp_path / file).write_text("")
    told = cli("report", tmp_path)
    assert _one_line(told)
    assert message in told.err


def test_bad_input_is_one_line(cli, folder, tmp_path):
    told = cli("report", tmp_path / "nowhere")
    assert _one_line(told)
    assert "there is no folder" in told.err
    told = cli("report", folder, "--state", "delta_d")
    assert _one_line(told)
    assert "did you mean 'delta_c'" in told.err


def test_without_plotly_one_line_tells_the_mend(cli, folder, monkeypatch):
    monkeypatch.setitem(sys.modules, "plotly.offline", None)
    told = cli("report", folder)
    assert _one_line(told)
    assert "pip install 'racs-bif[report]'" in told.err
    assert not (folder / "report.html").exists()


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="folders here have no POSIX modes")
def test_an_unwritable_target_is_one_line(cli, folder):
    told = cli("report", folder, "--to", folder / "branches.nc" / "page.html")
    assert _one_line(told)
    assert "cannot write" in told.err


def test_one_branch_alone_is_shown_too(cli, tmp_path, known):
    save(known.equilibria(), tmp_path / "branches.nc")
    told = cli("report", tmp_path)
    assert told.status == 0, told.err
    assert "EQ1" in (tmp_path / "report.html").read_text(encoding="utf-8")
