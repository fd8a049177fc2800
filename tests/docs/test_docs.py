"""The documentation is built as anybody would, with warnings as errors; its notebooks run."""

import json
import os
import re
import subprocess
import sys
from html import unescape
from pathlib import Path

import pytest

import racs_bif
from racs_bif.cli.main import VERBS, build_parser
from racs_bif.labels import LABELS
from racs_bif.shelf import names

pytest.importorskip("sphinx", reason="the extra 'docs' is not installed")
DOCS = Path(__file__).parents[2] / "docs"
NOTEBOOKS = [
    path.relative_to(DOCS).with_suffix("").as_posix()
    for path in sorted(DOCS.rglob("*.md"))
    if "file_format: mystnb" in path.read_text(encoding="utf-8")
]


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """Build everything once; no network is asked for anything."""
    out = tmp_path_factory.mktemp("docs")
    command = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-j", "2", "-b", "html"]
    nowhere = {"http_proxy": "http://127.0.0.1:9", "https_proxy": "http://127.0.0.1:9"}
    done = subprocess.run(
        [*command, "-d", str(out / "doctrees"), str(DOCS), str(out / "html")],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, **nowhere},
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return out / "html"


def text_of(page):
    return unescape(re.sub(r"<[^>]+>", "", page.read_text(encoding="utf-8")))


def test_what_is_shown_beside_auto_is_what_runs_beside_matcont():
    shown = (DOCS / "howto/from_auto.md").read_text(encoding="utf-8")
    block = re.search(r"```python\n(.*?)```", shown, re.DOTALL)[1]
    runs = (DOCS / "howto/from_matcont.md").read_text(encoding="utf-8")
    assert f"```{{code-cell}} ipython3\n{block.rstrip()};\n```" in runs


def test_every_other_block_of_python_runs():
    for path in DOCS.rglob("*.md"):
        blocks = re.findall(r"```python\n(.*?)```", path.read_text(encoding="utf-8"), re.DOTALL)
        allowed = {"from_auto": 1, "index": 1}  # the one above; an import
        assert len(blocks) <= allowed.get(path.stem, 0), path


def test_there_are_the_pages_that_were_promised():
    assert {
        "tutorials/ten_minutes",
        "tutorials/control_students",
        "tutorials/fractional_elements",
        "tutorials/reading_a_diagram",
    } <= set(NOTEBOOKS)


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_a_notebook_ran_and_can_be_taken_along(built, name):
    page = (built / f"{name}.html").read_text(encoding="utf-8")
    assert f"{Path(name).name}.ipynb" in page
    nbformat = pytest.importorskip("nbformat")
    written = json.loads((built / f"{name}.ipynb").read_text(encoding="utf-8"))
    nbformat.validate(written)
    cells = ["".join(cell["source"]) for cell in written["cells"]]
    kinds = [cell["cell_type"] for cell in written["cells"]]
    source = (DOCS / f"{name}.md").read_text(encoding="utf-8")
    assert kinds.count("code") == source.count("```{code-cell}") > 0
    for kind, text in zip(kinds, cells, strict=True):
        if kind == "code":
            compile(text, name, "exec")
        assert "{code-cell}" not in text
        assert "<!-- fill" not in text
    shown = page.count('<img alt="') + page.count("<img src=")
    plots = len(re.findall(r"\.(?:plot|plot_\w+|draw)\(.*\);$", source, re.MULTILINE))
    assert shown >= plots  # every figure is on the page, not only the first


def test_a_notebook_taken_along_runs(built, tmp_path):
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    notebook = nbformat.read(built / "howto/own_model.ipynb", as_version=4)
    environment = {**os.environ, "PYTHONPATH": str(DOCS.parent)}
    client = nbclient.NotebookClient(notebook, timeout=120, kernel_name="python3")
    client.execute(cwd=str(tmp_path), env=environment)
    assert (tmp_path / "pendulum.toml").exists()


@pytest.mark.parametrize("verb", VERBS)
def test_the_command_line_is_told(built, verb):
    text = text_of(built / "reference/cli.html")
    parser = build_parser()[1][verb]
    assert " ".join(parser.description.split()) in " ".join(text.split())
    for action in parser._actions:
        for option in action.option_strings:
            assert option in text
        if not action.option_strings:
            assert (action.metavar or action.dest.upper()) in text


@pytest.mark.parametrize("kind", ["models", "analyses"])
def test_the_shelf_is_told(built, kind):
    page = (built / f"reference/{kind}.html").read_text(encoding="utf-8")
    headings = re.findall(r"<h2>(.*?)<a", page)
    assert headings == list(names(kind))
    assert "::" not in re.sub(r"<pre>.*?</pre>", "", page, flags=re.DOTALL).replace("::before", "")


def test_every_label_is_told(built):
    text = text_of(built / "reference/labels.html")
    assert all(label.title in text for label in LABELS.values())


@pytest.mark.parametrize("name", racs_bif.__all__)
def test_every_public_name_has_its_entry(built, name):
    pages = sorted((built / "reference/api").glob("*.html"))
    found = [page for page in pages if f'id="racs_bif.{name}"' in page.read_text(encoding="utf-8")]
    assert len(found) == 1


def test_no_page_asks_the_network_for_anything(built):
    for page in built.rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        fetched = re.findall(r'<(?:script|img|iframe)[^>]* src="(https?:[^"]*)"', text)
        fetched += re.findall(r'<link[^>]* rel="stylesheet"[^>]* href="(https?:[^"]*)"', text)
        assert not fetched, (page, fetched)
