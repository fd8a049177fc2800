"""Which files of models depend on nothing but their own text, and need not be run again."""

from __future__ import annotations

import ast
from pathlib import Path
from typing import Final

_CLOSED: Final = {
    "__future__",
    "collections",
    "dataclasses",
    "enum",
    "functools",
    "itertools",
    "math",
    "sympy",
    "typing",
}
"""Modules that do not change between two runs of the same versions."""
_OWN: Final = {"racs_bif.errors", "racs_bif.symbolic"}
"""Parts of this package that read no other files."""
_OWN_NAMES: Final = {
    *("Calibration", "DerivedParameter", "FractionalElement", "Model", "Parameter"),
    *("model_from_function", "model_from_strings"),
}
"""Public names of this package that read no other files."""
_NUMPY_NAMES: Final = {
    *("abs", "add", "arange", "arccos", "arccosh", "arcsin", "arcsinh", "arctan", "arctan2"),
    *("arctanh", "array", "asarray", "cbrt", "clip", "concatenate", "cos", "cosh", "cumsum"),
    *(
        "diag",
        "diff",
        "divide",
        "dot",
        "e",
        "empty",
        "empty_like",
        "exp",
        "expm1",
        "eye",
        "float64",
    ),
    *("full", "heaviside", "hypot", "linspace", "log", "log10", "log1p", "log2", "matmul"),
    *("maximum", "mean", "minimum", "multiply", "ndarray", "negative", "newaxis", "ones"),
    *("ones_like", "outer", "pi", "power", "prod", "roll", "sign", "sin", "sinh", "sqrt", "square"),
    *("stack", "subtract", "sum", "tan", "tanh", "vstack", "where", "zeros", "zeros_like"),
}
"""What numpy computes without reading or remembering anything."""
_OPEN_NAMES: Final = {
    *("open", "exec", "eval", "compile", "input", "getattr", "globals", "vars"),
    *("__import__", "__builtins__", "__loader__", "__spec__"),
}
"""Names by which a file can reach what is not in its text."""


def rules() -> str:
    """Return what the judgement of `is_closed` depends on besides a file's text: this module."""
    return Path(__file__).read_text(encoding="utf-8")


def is_closed(path: Path, text: str) -> bool:
    """Say whether the meaning of a model's file depends on its text alone.

    Parameters
    ----------
    path : Path
        The file; one in TOML is always closed.
    text : str
        What is in it.
    """
    if path.suffix == ".toml":
        return True
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError):
        return False
    names = {"racs_bif": _called(tree, "racs_bif"), "numpy": _called(tree, "numpy")}
    return all(_is_closed_node(node, names) for node in ast.walk(tree))


def _called(tree: ast.AST, package: str) -> set[str]:
    """Return the names by which a file calls a package."""
    return {
        alias.asname or alias.name
        for node in ast.walk(tree)
        if isinstance(node, ast.Import)
        for alias in node.names
        if alias.name == package
    }


def _is_closed_node(node: ast.AST, names: dict[str, set[str]]) -> bool:
    """Judge one node; `names` holds the names of packages that are looked into."""
    if isinstance(node, ast.Import):
        return all(a.name in names or _is_closed_module(a.name) for a in node.names)
    if isinstance(node, ast.ImportFrom):
        allowed = {"racs_bif": _OWN_NAMES, "numpy": _NUMPY_NAMES}.get(node.module or "")
        if allowed is not None:
            return all(alias.name in allowed for alias in node.names)
        return not node.level and _is_closed_module(node.module or "")
    if isinstance(node, ast.Attribute):
        return _is_closed_attribute(node, names)
    return not (isinstance(node, ast.Name) and node.id in _OPEN_NAMES)


def _is_closed_attribute(node: ast.Attribute, names: dict[str, set[str]]) -> bool:
    owner = node.value.id if isinstance(node.value, ast.Name) else ""
    if owner in names["racs_bif"]:
        return node.attr in _OWN_NAMES
    if owner in names["numpy"]:
        return node.attr in _NUMPY_NAMES
    return node.attr not in _OPEN_NAMES


def _is_closed_module(name: str) -> bool:
    parts = name.split(".")
    return parts[0] in _CLOSED or ".".join(parts[:2]) in _OWN
