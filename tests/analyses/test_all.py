"""The gallery: analyses in processes of their own, and the page."""

from __future__ import annotations

import base64
import re

import pytest

from racs_bif.errors import UsageError
from racs_bif.shelf import find, load_module, names

GOOD = '''"""Study <one>."""
def run(out, *, progress=None):
    (out / "good.txt").write_text("done", encoding="utf-8")
    return out / "good.txt"
'''
BAD = '''"""Study two."""
def run(out):
    raise ValueError("no such thing")
'''


@pytest.fixture
def gallery():
    return load_module(find("analyses", "all"))


def test_it_goes_on_when_one_fails(gallery, tmp_path, monkeypatch):
    folder = tmp_path / "analyses"
    folder.mkdir()
    (folder / "good.py").write_text(GOOD, encoding="utf-8")
    (folder / "bad.py").write_text(BAD, encoding="utf-8")
    monkeypatch.setenv("RACS_BIF_PATH", str(folder))
    out = tmp_path / "out"
    monkeypatch.setattr(gallery, "names", lambda _kind: ["all", "bad", "good"])
    told = []
    page = gallery.run(out, workers=1, progress=told.append)
    text = page.read_text(encoding="utf-8")
    assert (out / "good.txt").read_text(encoding="utf-8") == "done"
    assert "Study &lt;one&gt;" in text
    assert '<a href="good.txt">' in text
    assert "failed: " in text
    assert "no such thing" in text
    assert told[-1] == 1.0


def test_pictures_are_on_the_page_itself(gallery, tmp_path):
    load_module(find("analyses", "fig02_tyres")).run(tmp_path, speed=11.0)
    text = gallery.page(tmp_path, ["fig02_tyres"], {})
    (data,) = re.findall(r'src="data:image/png;base64,([^"]+)"', text)
    assert base64.b64decode(data).startswith(b"\x89PNG")
    assert "cornering stiffness" in text
    assert 'href="fig02_tyres.svg"' in text


def test_every_analysis_has_numbers_for_a_trial(gallery):
    for name in names("analyses"):
        if name != "all":
            full, small = (
                gallery._numbers(name, reduced=False),
                gallery._numbers(name, reduced=True),
            )
            assert full == {}
            assert all(value > 0 for value in small.values())


def test_no_workers_is_refused(gallery, tmp_path):
    with pytest.raises(UsageError, match="at least one worker"):
        gallery.run(tmp_path, workers=0)
