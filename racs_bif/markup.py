"""Small HTML tables for notebooks: text in, text out, nothing of it from anywhere else."""

from __future__ import annotations

import html
import math
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

MOST: Final = 40
"""Rows of a table that are shown; of more, how many there are is said."""


def card(title: str, *parts: str) -> str:
    """Return a title over parts that are HTML already; empty parts are left out."""
    kept = "".join(part for part in parts if part)
    return f'<div class="racs-bif"><p><strong>{html.escape(title)}</strong></p>{kept}</div>'


def paragraph(text: str) -> str:
    """Return a paragraph, or nothing for no text."""
    return f"<p>{html.escape(text)}</p>" if text else ""


def listed(heading: str, lines: Sequence[str]) -> str:
    """Return lines in print as they are, under a heading; nothing where there are none."""
    if not lines:
        return ""
    shown = list(lines[:MOST])
    if len(lines) > MOST:
        shown.append(f"... and {len(lines) - MOST} more")
    return f"<p><em>{html.escape(heading)}</em></p><pre>{html.escape(chr(10).join(shown))}</pre>"


def table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Return a table; nothing where it has no rows.

    Parameters
    ----------
    head : sequence of str
        Titles of the columns; those that no row fills are left out.
    rows : iterable of sequence
        Cells: numbers are printed with six digits, None and NaN as nothing, all else as text.
    """
    texts = [[_cell(cell) for cell in row] for row in rows]
    used = [k for k in range(len(head)) if any(row[k] for row in texts)]
    if not used:
        return ""
    top = "".join(f"<th>{html.escape(head[k])}</th>" for k in used)
    body = "".join(
        "<tr>" + "".join(f"<td>{html.escape(row[k])}</td>" for k in used) + "</tr>"
        for row in texts[:MOST]
    )
    if len(texts) > MOST:
        body += f'<tr><td colspan="{len(used)}">... and {len(texts) - MOST} more</td></tr>'
    return f"<table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table>"


def with_unit(name: str, unit: str) -> str:
    """Return what heads a column.

    Examples
    --------
    >>> with_unit("u", "m/s"), with_unit("x", "")
    ('u [m/s]', 'x')
    """
    return f"{name} [{unit}]" if unit else name


def _cell(value: object) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return "" if math.isnan(value) else f"{value:.6g}"
    return str(value)
