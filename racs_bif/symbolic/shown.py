"""A model in a notebook: equations, fractional elements and parameters with units."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from racs_bif.markup import card, listed, paragraph, table, with_unit

if TYPE_CHECKING:
    from collections.abc import Mapping

_LONG: Final = 160
"""Characters of an equation that are shown."""


def model_card(meta: Mapping[str, Any], values: Mapping[str, float] | None = None) -> str:
    """Return a model as HTML.

    Parameters
    ----------
    meta : mapping
        What `racs_bif.symbolic.metadata.describe` tells.
    values : mapping of str to float, optional
        Values of base and derived parameters; defaults where left out.
    """
    title = f"{meta['name']}: {meta['title']}" if meta["title"] else meta["name"]
    if meta["variant"]:
        title += f" (variant {meta['variant']})"
    return card(
        title,
        paragraph(f"Source: {meta['source']}" if meta["source"] else ""),
        listed("Equations" if meta["mass"] is None else "Equations, M x' = ...", _equations(meta)),
        listed(
            "Fractional elements",
            [f"{e['output']} = Z(s) ({e['input']}),  Z(s) = {e['law']}" for e in meta["elements"]],
        ),
        table(
            ("state", "meaning"),
            [
                (with_unit(name, meta["units"].get(name, "")), meta["descriptions"].get(name, ""))
                for name in meta["states"]
                if name in meta["units"] or name in meta["descriptions"]
            ],
        ),
        table(("parameter", "value", "unit", "meaning"), _parameters(meta, values)),
        *(paragraph(f"Note: {note}") for note in meta["notes"]),
    )


def _equations(meta: Mapping[str, Any]) -> list[str]:
    prime = "'" if meta["mass"] is None else ":"
    named = {**meta["terms"]}
    lines = [f"{name} = {_short(text)}" for name, text in named.items()]
    return lines + [f"{name}{prime} = {_short(text)}" for name, text in meta["equations"].items()]


def _short(text: str) -> str:
    return text if len(text) <= _LONG else f"{text[:_LONG]} ..."


def _parameters(
    meta: Mapping[str, Any], values: Mapping[str, float] | None
) -> list[tuple[object, ...]]:
    rows: list[tuple[object, ...]] = []
    for entry in (*meta["parameters"], *meta["derived"]):
        value: object = entry.get("default", f"= {_short(entry.get('expression', ''))}")
        if isinstance(value, dict):
            value = "calibrated"
        if values is not None:
            value = values[entry["name"]]
        rows.append((entry["name"], value, entry["unit"], entry["description"]))
    return rows
