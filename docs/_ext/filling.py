"""Fills pages from the program itself: a line ``<!-- fill: WHAT -->`` becomes what it names.

`cli` all verbs with their arguments, `models` and `analyses` what is on the shelf, `labels` the
labels of special points, `api GROUP` public names, `notebook` the link to a page as a notebook.
Notebooks are written beside their pages when these are.
"""

from __future__ import annotations

import ast
import json
import re
import textwrap
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import api_pages
import cli_page
import notebooks

from racs_bif.labels import LABELS
from racs_bif.shelf import names

if TYPE_CHECKING:
    from collections.abc import Callable

    from sphinx.application import Sphinx

_MARK: Final = re.compile(r"^<!-- fill: (\w+)(?: (\w+))? -->$", re.MULTILINE)


def models() -> str:
    """Return the models on the shelf as Markdown: what their files say of themselves."""
    return "\n\n".join(
        f"## {name}\n\n{as_markdown(_docstring(path))}" for name, path in names("models").items()
    )


def analyses() -> str:
    """Return the analyses on the shelf as Markdown."""
    return "\n\n".join(
        f"## {name}\n\n{as_markdown(_docstring(path))}\n\n"
        f"```sh\nracs-bif run {name} --out {name}\n```"
        for name, path in names("analyses").items()
    )


def labels() -> str:
    """Return the labels of special points as a table."""
    rows = [f"| {c} | {', '.join(x.aliases)} | {x.title} |" for c, x in LABELS.items()]
    return "\n".join(["| label | also written | what it is |", "|---|---|---|", *rows])


def as_markdown(docstring: str) -> str:
    """Turn a docstring into Markdown: underlined titles bold, literal blocks fenced."""
    lines, fenced = docstring.splitlines(), False
    out: list[str] = []
    for k, line in enumerate(lines):
        after = lines[k + 1] if k + 1 < len(lines) else ""
        if fenced and line.strip() and not line.startswith(" "):
            _close(out)
            fenced = False
        if fenced:
            out.append(line)
        elif line and after and set(after) == {"-"}:
            out.append(f"**{line}**\n")
        elif line and set(line) == {"-"} and out:
            continue
        elif line.rstrip().endswith("::"):
            told = line.rstrip()[:-2].rstrip()
            out += [f"{told}:" if told else "", "", "```text"]
            fenced = True
        else:
            out.append(line)
    if fenced:
        _close(out)
    return "\n".join(out)


def _close(out: list[str]) -> None:
    while out[-1] == "":
        out.pop()
    if out[-1] == "```text":  # nothing was in it
        out.pop()
    else:
        start = len(out) - out[::-1].index("```text")
        block = textwrap.dedent("\n".join(out[start:])).strip("\n")
        out[start:] = [block, "```", ""]


def _docstring(path: Path) -> str:
    if path.suffix != ".py":
        return path.name
    return ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or path.name


def fill(app: Sphinx, docname: str, source: list[str]) -> None:
    """Replace the marks of a page."""

    def filled(mark: re.Match[str]) -> str:
        what, argument = mark.groups()
        if what == "api":
            return api_pages.page(argument)
        if what == "notebook":
            return notebooks.link(docname)
        return _FILLINGS[what]()

    source[0] = _MARK.sub(filled, source[0])


def write_notebooks(app: Sphinx, exception: Exception | None) -> None:
    """Write pages that are notebooks as such, beside their HTML."""
    if exception is not None or app.builder.name != "html":
        return
    for docname in sorted(app.env.found_docs):
        text = Path(app.env.doc2path(docname)).read_text(encoding="utf-8")
        if "file_format: mystnb" not in text:
            continue
        target = Path(app.outdir) / f"{docname}.ipynb"
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(json.dumps(notebooks.convert(text), indent=1), encoding="utf-8")


_FILLINGS: Final[dict[str, Callable[[], str]]] = {
    "cli": cli_page.page,
    "models": models,
    "analyses": analyses,
    "labels": labels,
}


def setup(app: Sphinx) -> dict[str, Any]:
    """Connect to Sphinx."""
    app.connect("source-read", fill)
    app.connect("build-finished", write_notebooks)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
