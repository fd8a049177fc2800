"""Mutants of modules of the package: where they are and what their text is.

The changes are those of cosmic-ray. A module is parsed once; a mutant is then made by changing the
parsed tree in place, which is to be done in a forked process: the tree of its parent stays whole.
"""

from __future__ import annotations

import random
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any, Final

HERE: Final = Path(__file__).resolve().parents[1]
FOLDERS: Final = ("continuation", "fractional")
CONSTANTS: Final = "NumberReplacer"
BINARY: Final = ("Add_Sub", "Sub_Add", "Mul_Div", "Div_Mul", "Pow_Mul", "FloorDiv_Mul", "Mod_Mul")
COMPARED: Final = (
    *("Lt_GtE", "Lt_LtE", "LtE_Gt", "LtE_Lt", "Gt_LtE", "Gt_GtE", "GtE_Lt", "GtE_Gt"),
    *("Eq_NotEq", "NotEq_Eq", "Is_IsNot", "IsNot_Is"),
)
OPERATORS: Final = (
    *(f"ReplaceBinaryOperator_{name}" for name in BINARY),
    *(f"ReplaceComparisonOperator_{name}" for name in COMPARED),
    *(f"ReplaceUnaryOperator_Delete_{name}" for name in ("USub", "Not", "Invert")),
    *("AddNot", "ReplaceTrueWithFalse", "ReplaceFalseWithTrue"),
    *("ReplaceAndWithOr", "ReplaceOrWithAnd", "ReplaceBreakWithContinue"),
    *("ReplaceContinueWithBreak", "ExceptionReplacer", CONSTANTS, "ZeroIterationForLoop"),
)


@dataclass(frozen=True)
class Mutant:
    """One change of one module: which operator, where it is used, and on which line."""

    folder: str
    module: str
    operator: str
    occurrence: int
    line: int

    @property
    def path(self) -> Path:
        """File of the module that is changed."""
        return HERE / "racs_bif" / self.folder / f"{self.module}.py"

    @property
    def imported_as(self) -> str:
        """Name under which the module is imported."""
        return f"racs_bif.{self.folder}.{self.module}"


def population(seed: int) -> list[Mutant]:
    """Return all mutants in a fixed random order, changes of constants after all others."""
    found = [
        Mutant(folder, path.stem, name, occurrence, line)
        for folder in FOLDERS
        for path in sorted((HERE / "racs_bif" / folder).glob("*.py"))
        for name in OPERATORS
        for occurrence, (_, _, line) in enumerate(_places(path, name))
    ]
    random.Random(seed).shuffle(found)
    return sorted(found, key=lambda mutant: mutant.operator == CONSTANTS)


def made(mutant: Mutant) -> tuple[str, str, str]:
    """Change the parsed tree; return the module's new text, and the first line changed of each."""
    node, index, _ = _places(mutant.path, mutant.operator)[mutant.occurrence]
    new = _operator(mutant.operator).mutate(node, index)
    if new is not node:
        siblings = node.parent.children
        siblings[siblings.index(node)] = new
        new.parent = node.parent
    text = mutant.path.read_text(encoding="utf-8")
    code: str = _tree(mutant.path).get_code()
    pairs = zip(text.splitlines(), code.splitlines(), strict=False)
    old, changed = next(((a, b) for a, b in pairs if a != b), ("", ""))
    return code, old.strip(), changed.strip()


@cache
def _tree(path: Path) -> Any:  # noqa: ANN401  # parso and cosmic-ray bring no types
    return import_module("parso").parse(path.read_text(encoding="utf-8"))


@cache
def _nodes(path: Path) -> list[Any]:
    return list(import_module("cosmic_ray.ast").ast_nodes(_tree(path)))


@cache
def _operator(name: str) -> Any:  # noqa: ANN401
    return import_module("cosmic_ray.plugins").get_operator(f"core/{name}")()


@cache
def _places(path: Path, name: str) -> list[tuple[Any, int, int]]:
    """Return where an operator changes something: the node, which of its changes, the line."""
    lines = path.read_text(encoding="utf-8").splitlines()
    return [
        (node, index, start[0])
        for node in _nodes(path)
        for index, (start, _) in enumerate(_operator(name).mutation_positions(node))
        # what only type checkers read, and `*` among parameters, are no mutants
        if "TYPE_CHECKING" not in lines[start[0] - 1]
        and not lines[start[0] - 1][start[1] :].startswith(("*,", "/,"))
    ]
