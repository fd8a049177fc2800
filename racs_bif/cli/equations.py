"""A model's equations for people: what has a name is called by it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping


def named_equations(meta: Mapping[str, Any]) -> tuple[dict[str, str], dict[str, str]]:
    """Return equations and outputs in which outputs and derived parameters stand by name.

    As they are where they hold names that the printer of equations takes for something else.

    Parameters
    ----------
    meta : mapping
        What a compiled model tells of itself, see `racs_bif.symbolic.metadata.describe`.

    Returns
    -------
    equations, outputs : dict of str to str
        Right-hand sides by state, and expressions by output.
    """
    import sympy as sp

    try:
        return _named(meta)
    except (sp.SympifyError, SyntaxError, TypeError, AttributeError, ValueError):
        return dict(meta["equations"]), dict(meta["outputs"])


def _named(meta: Mapping[str, Any]) -> tuple[dict[str, str], dict[str, str]]:
    import sympy as sp

    derived = {entry["name"]: entry["expression"] for entry in meta["derived"]}
    names = [*meta["equations"], *meta["outputs"], *derived]
    names += [entry["name"] for entry in meta["parameters"]]
    names += meta["terms"]
    names += [element["output"] for element in meta["elements"]]
    symbols = {name: sp.Symbol(name) for name in names}

    def read(text: str) -> sp.Expr:
        return sp.sympify(text, locals=symbols)

    # The simplest first, and only into those after it: no two are told in terms of each other.
    table = [(name, read(text)) for name, text in (derived | meta["outputs"]).items()]
    table.sort(key=lambda entry: entry[1].count_ops())
    known: list[tuple[sp.Symbol, sp.Expr]] = []
    outputs: dict[str, str] = {}
    for name, expression in table:
        shorter = _by_name(expression, known)
        if name in meta["outputs"]:
            outputs[name] = str(shorter)
        if not shorter.is_Atom:
            known.append((symbols[name], shorter))
    equations = {name: _by_name(read(text), known) for name, text in meta["equations"].items()}
    ordered = {name: outputs[name] for name in meta["outputs"]}
    return {name: str(expression) for name, expression in equations.items()}, ordered


def _by_name(expression: Any, known: list[tuple[Any, Any]]) -> Any:  # noqa: ANN401  # sympy's
    """Put names in for what they stand for, where that makes the expression shorter."""
    for symbol, meaning in known:
        shorter = expression.subs(meaning, symbol)
        if shorter.count_ops() < expression.count_ops():
            expression = shorter
    return expression
