"""README's Python runs as it is printed."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

README = Path(__file__).parents[1] / "README.md"
BLOCKS = re.findall(r"```python\n(.*?)```", README.read_text(encoding="utf-8"), re.DOTALL)


def test_there_are_examples():
    assert len(BLOCKS) >= 2


def test_the_examples_run_one_after_another(tmp_path, monkeypatch):
    from matplotlib import pyplot as plt

    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    for block in BLOCKS:
        exec(compile(block, str(README), "exec"), names)
    plt.close("all")
    assert (tmp_path / "po.nc").stat().st_size > 0
    hopf = names["hopf"]
    assert hopf.exact.parameters["u"] == pytest.approx(18.934671, rel=1e-7)  # model.md, c = .30
