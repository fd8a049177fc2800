"""Mutants of the numerics: which small changes of the code does no test notice.

Run ``python benchmarks/mutants.py`` in an environment that has the test extra and cosmic-ray, which
makes the mutants (``pip install cosmic-ray``; the package does not depend on it). Mutants are drawn
with a fixed seed, the same number from each folder, and each is run against the tests of its folder
in a copy of the tree. What is done is in a file of one JSON line a mutant, and a run goes on where
the last one stopped; ``--again`` runs the survivors once more, after tests were added. Outcomes and
explanations of the survivors are kept in ``benchmarks/MUTANTS.md``.
"""

from __future__ import annotations

import argparse
import compileall
import json
import os
import random
import shutil
import subprocess
import sys
import time
from collections import Counter
from importlib import import_module
from itertools import islice
from pathlib import Path
from py_compile import PycInvalidationMode
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from collections.abc import Iterator

HERE: Final = Path(__file__).resolve().parents[1]
COPIED: Final = ("racs_bif", "models", "analyses", "tests")
MODULES: Final = {
    "continuation": ("*",),
    "fractional": (
        *("laws", "power_sums", "bank", "filter", "diffusive", "exact", "exact_hopf"),
        *("argument", "characteristic", "certificates", "rational"),
    ),
}
TESTS: Final = {"continuation": ("continuation", "equilibria"), "fractional": ("fractional",)}
"""Folders of tests; the next is run if the one before has noticed nothing."""
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
    *("ReplaceContinueWithBreak", "ExceptionReplacer", "NumberReplacer", "ZeroIterationForLoop"),
)
PATIENCE: Final = 4.0
"""A mutant may take this many times as long as the code itself, and half a minute."""

Row = dict[str, Any]


def drawn(folder: str, seed: int) -> Iterator[Row]:
    """Yield mutants of a folder's modules: where, by which operator, old line and new."""
    home = HERE / "racs_bif" / folder
    paths = sorted(path for pattern in MODULES[folder] for path in home.glob(f"{pattern}.py"))
    texts = {path.stem: path.read_text(encoding="utf-8") for path in paths}
    places = [(module, *place) for module, text in texts.items() for place in _places(text)]
    random.Random(seed).shuffle(places)
    for module, name, occurrence in places:
        changed = _changed(texts[module], mutated(texts[module], name, occurrence))
        # what only type checkers read, and `*` among parameters, are no mutants
        if changed and "TYPE_CHECKING" not in changed[1] and "/," not in changed[2]:
            where = {"folder": folder, "module": module, "line": changed[0]}
            made = {"operator": name, "occurrence": occurrence}
            yield {**where, **made, "old": changed[1], "new": changed[2]}


def _places(text: str) -> list[tuple[str, int]]:
    nodes = list(import_module("cosmic_ray.ast").ast_nodes(import_module("parso").parse(text)))
    found = []
    for name in OPERATORS:
        operator = import_module("cosmic_ray.plugins").get_operator(f"core/{name}")()
        count = sum(len(list(operator.mutation_positions(node))) for node in nodes)
        found += [(name, occurrence) for occurrence in range(count)]
    return found


def mutated(text: str, name: str, occurrence: int) -> str | None:
    """Return a module's text with one change, or None where the operator makes none."""
    operator = import_module("cosmic_ray.plugins").get_operator(f"core/{name}")()
    code: str | None = import_module("cosmic_ray.mutating").mutate_code(text, operator, occurrence)
    return code


def _changed(text: str, other: str | None) -> tuple[int, str, str] | None:
    pairs = zip(text.splitlines(), (other or "").splitlines(), strict=False)
    lines = ((k, a.strip(), b.strip()) for k, (a, b) in enumerate(pairs, 1) if a != b)
    return next(lines, None)


def copied(scratch: Path) -> None:
    """Make a copy of the tree; its compiled modules are told from mutants by their contents."""
    for name in COPIED:
        shutil.rmtree(scratch / name, ignore_errors=True)
        shutil.copytree(HERE / name, scratch / name, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(HERE / "pyproject.toml", scratch)
    mode = PycInvalidationMode.CHECKED_HASH
    compileall.compile_dir(scratch / "racs_bif", quiet=1, invalidation_mode=mode)


def tested(scratch: Path, folder: str, module: str, wait: float, left_out: list[str]) -> str:
    """Run a folder's tests, those that name the module first; return what became of them."""
    files = sorted((scratch / "tests" / folder).glob("test_*.py"))
    files.sort(key=lambda path: f".{module} import" not in path.read_text(encoding="utf-8"))
    pytest = [sys.executable, "-m", "pytest", "-n", "0", "-x", "-q", "-p", "no:cacheprovider"]
    environment = os.environ | {"PYTHONPATH": str(scratch), "OPENBLAS_NUM_THREADS": "1"}
    environment |= {"RACS_BIF_CACHE": str(scratch / "cache"), "PYTHONDONTWRITEBYTECODE": "1"}
    how: Row = {"cwd": scratch, "env": environment, "timeout": wait, "capture_output": True}
    command = [*pytest, *left_out, *(str(path.relative_to(scratch)) for path in files)]
    try:
        run = subprocess.run(command, text=True, check=False, **how)
    except subprocess.TimeoutExpired:
        return "too long"
    told = [line for line in run.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))]
    killed = f"killed by {told[0].split()[1]}" if told else "killed"
    return killed if run.returncode else "survived"


def done(scratch: Path, row: Row, folder: str, wait: float, left_out: list[str]) -> Row:
    """Run one mutant against one folder and return its row with the outcome."""
    path = scratch / "racs_bif" / row["folder"] / f"{row['module']}.py"
    text = path.read_text(encoding="utf-8")
    code = mutated(text, row["operator"], row["occurrence"])
    assert code is not None
    try:
        path.write_text(code, encoding="utf-8")
        outcome = tested(scratch, folder, row["module"], wait, left_out)
    finally:
        path.write_text(text, encoding="utf-8")
    passed = [*row.get("passed", ()), folder] if outcome == "survived" else []
    return row | {"outcome": outcome, "passed": passed}


def table(rows: list[Row]) -> None:
    """Print counts by module and outcome, then each survivor in one line."""
    names = ("killed", "too long", "survived")
    counts = Counter((f"{r['folder']}/{r['module']}", r["outcome"].split(" by")[0]) for r in rows)
    print("| module | " + " | ".join(names) + " |\n|---|" + "---:|" * len(names))
    for module in sorted({module for module, _ in counts}):
        print(f"| {module} | " + " | ".join(str(counts[module, name]) for name in names) + " |")
    sums = [sum(n for (_, outcome), n in counts.items() if outcome == name) for name in names]
    print("| all | " + " | ".join(map(str, sums)) + " |\n")
    for row in rows:
        if row["outcome"] == "survived":
            print(f"{row['module']}.py:{row['line']}: - {row['old']}  + {row['new']}")


def _key(row: Row) -> tuple[str, ...]:
    return tuple(str(row[name]) for name in ("module", "operator", "occurrence", "old", "new"))


def main() -> None:
    """Draw the mutants, run those that are not done, print what there is."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=100, help="mutants, half from each folder")
    parser.add_argument("--seed", type=int, default=9, help="of the draw")
    parser.add_argument("--scratch", type=Path, default=Path("mutants"), help="folder to work in")
    parser.add_argument("--again", action="store_true", help="run the survivors once more")
    parser.add_argument("--deselect", action="append", default=[], help="a test to leave out")
    given = parser.parse_args()
    left_out = [f"--deselect={test}" for test in given.deselect]
    halves = [islice(drawn(folder, given.seed), given.count // 2) for folder in MODULES]
    kept = {_key(row): row for pair in zip(*halves, strict=True) for row in pair}
    scratch: Path = given.scratch.resolve()
    copied(scratch)
    log = scratch / "outcomes.jsonl"
    for line in log.read_text(encoding="utf-8").splitlines() if log.exists() else ():
        row = json.loads(line)
        if _key(row) in kept and not (given.again and row["outcome"] == "survived"):
            kept[_key(row)] = row
    waits: dict[str, float] = {}
    for stage in (0, 1):
        for key, row in kept.items():
            folder = (*TESTS[row["folder"]], "")[stage]
            killed = row.get("outcome", "survived") != "survived"
            if killed or not folder or folder in row.get("passed", ()):
                continue
            if folder not in waits:
                begun = time.perf_counter()
                if tested(scratch, folder, "", 3600.0, left_out) != "survived":
                    sys.exit(f"tests/{folder} fails by itself: mend it, or --deselect a test")
                waits[folder] = 30.0 + PATIENCE * (time.perf_counter() - begun)
            kept[key] = done(scratch, row, folder, waits[folder], left_out)
            with log.open("a", encoding="utf-8") as file:
                file.write(json.dumps(kept[key]) + "\n")
    table(list(kept.values()))


if __name__ == "__main__":
    main()
