"""Pages with ``{code-cell}`` blocks as Jupyter notebooks."""

from __future__ import annotations

import re
from typing import Any, Final

_CELL: Final = re.compile(r"^```\{code-cell\}[^\n]*\n(.*?)^```$", re.DOTALL | re.MULTILINE)
_FRONT: Final = re.compile(r"\A---\n.*?\n---\n", re.DOTALL)
_MARK: Final = re.compile(r"^<!-- fill: .*? -->\n", re.MULTILINE)
_OPTIONS: Final = re.compile(r"\A(?::[\w-]+:[^\n]*\n)+\n?")
_ROLE: Final = re.compile(r"\{\w+\}(`[^`]+`)")


def link(docname: str) -> str:
    """Return the line that offers the notebook."""
    name = docname.rpartition("/")[2]
    return (
        f'<p>This page is a notebook that ran when it was built: <a href="{name}.ipynb" '
        f"download>{name}.ipynb</a>.</p>"
    )


def convert(text: str) -> dict[str, Any]:
    """Return a page in MyST Markdown as a notebook, in the form of its JSON."""
    text = _MARK.sub("", _FRONT.sub("", text))
    cells: list[dict[str, Any]] = []
    done = 0
    for found in _CELL.finditer(text):
        _add(cells, "markdown", text[done : found.start()])
        _add(cells, "code", _OPTIONS.sub("", found.group(1)))
        done = found.end()
    _add(cells, "markdown", text[done:])
    return {
        "cells": cells,
        "metadata": {
            "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
            "language_info": {"name": "python"},
        },
        "nbformat": 4,
        "nbformat_minor": 5,
    }


def _add(cells: list[dict[str, Any]], kind: str, text: str) -> None:
    text = text.strip("\n")
    if not text:
        return
    if kind == "markdown":
        text = _ROLE.sub(r"\1", text)
    cell: dict[str, Any] = {
        "cell_type": kind,
        "id": f"cell-{len(cells)}",
        "metadata": {},
        "source": text.splitlines(keepends=True),
    }
    if kind == "code":
        cell |= {"execution_count": None, "outputs": []}
    cells.append(cell)
