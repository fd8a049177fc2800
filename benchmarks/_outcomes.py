"""What becomes of random vehicles: rows kept in a file, and counted by outcome and reason."""

from __future__ import annotations

import json
import re
from collections import Counter
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

REASONS: Final = (
    (
        "No wider band settles it|no band settles it",
        "no realisation's band settles it: what the exact equations refuse is left out",
    ),
    ("not on the default's cells", "a boundary is missed on few cells, but not on the default's"),
    ("counts differ in", "counts differ in a few places for no boundary that was found"),
    (
        "have another count .* another equilibrium",
        "a few places have another count than their region, as another equilibrium is there",
    ),
    ("have another count", "a few places have another count than their region"),
    ("static boundary could not be traced", "a static boundary could not be traced"),
    ("no longer resolves", "more turns or shorter peaks than the discretisation resolves"),
    ("period grew past its limit", "the period grows, as it does near a homoclinic orbit"),
    ("more sharply than the smallest step", "the branch turns more sharply than the smallest step"),
    ("more than .* s$", "ended by the clock"),
    ("outside the realisation's band", "outside the realisation's band"),
)
"""What messages say, in few words: the first that is found."""


def table(rows: Iterable[dict[str, Any]]) -> str:
    """Return the outcomes by part as a Markdown table; numbers in other messages are left out."""
    counts: Counter[tuple[str, str, str]] = Counter()
    examples: dict[tuple[str, str, str], int] = {}
    for row in rows:
        for part, (outcome, detail) in row["parts"].items():
            key = part, outcome, "" if outcome == "ok" else _reason(detail)
            counts[key] += 1
            examples.setdefault(key, row["index"])
    lines = ["| part | outcome | vehicles | reason | for example |", "|---|---|---:|---|---:|"]
    for key in sorted(counts, key=lambda k: (k[0], k[1] != "ok", k[1], -counts[k])):
        part, outcome, detail = key
        lines.append(f"| {part} | {outcome} | {counts[key]} | {detail} | {examples[key]} |")
    return "\n".join(lines)


def _reason(detail: str) -> str:
    for pattern, words in REASONS:
        if re.search(pattern, detail):
            return words
    plain = re.sub(r"-?\d[\d.]*(e[+-]?\d+)?", "#", detail)
    return plain.replace("|", "/").replace("\n", " ")[:150]


def read(paths: Iterable[Path]) -> list[dict[str, Any]]:
    """Return the rows of files, the last one of each vehicle; a line cut off is left out."""
    rows = {}
    for path in paths:
        for line in path.read_text(encoding="utf-8").splitlines() if path.exists() else ():
            try:
                row = json.loads(line)
            except json.JSONDecodeError:
                continue
            rows[row["index"]] = row
    return [rows[index] for index in sorted(rows)]
