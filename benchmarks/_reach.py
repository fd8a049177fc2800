"""Which tests execute which lines of the package, and how long each of them takes.

Each file of tests is run once, under coverage, in a process of its own. What was measured is kept
in a folder and is measured again where the package, the file or its fixtures changed.
"""

from __future__ import annotations

import ast
import hashlib
import json
import sys
from collections.abc import Callable, Iterable
from functools import cache, cached_property, partial
from importlib import import_module
from pathlib import Path
from typing import Any, Final

from benchmarks._forked import HERE, Watch, in_child, pytest, without_end
from benchmarks._mutating import FOLDERS, Mutant

TESTS: Final = {
    "continuation": ("continuation", "equilibria"),
    "fractional": ("fractional", "equilibria"),
}
"""Folders of tests that are asked, the modules' own first."""
TOO_LONG: Final = ("test_large.py", "test_normal_forms.py")
"""Files that are not asked: minutes of large systems, and of models made for one formula."""

Lines = dict[str, list[int]]


class Measured:
    """What a file of tests reaches: the lines of each module, by test, and each test's seconds."""

    def __init__(self, kept: dict[str, Any]) -> None:
        self.seconds: dict[str, float] = kept["seconds"]
        self.lines: dict[str, Lines] = kept["lines"]
        self.imported: list[str] = kept["imported"]
        self.failed: list[str] = kept["failed"]


def files() -> list[str]:
    """Return the files of tests that are asked, as pytest names them."""
    folders = dict.fromkeys(name for names in TESTS.values() for name in names)
    paths = (path for name in folders for path in (HERE / "tests" / name).glob("test_*.py"))
    return sorted(str(path.relative_to(HERE)) for path in paths if path.name not in TOO_LONG)


def measured(file: str, kept_in: Path) -> Measured:
    """Return what a file of tests reaches, measured now if it is not known."""
    place = kept_in / "reach" / (file.replace("/", "-") + ".json")
    of = _digest(file)
    if place.exists():
        kept = json.loads(place.read_text(encoding="utf-8"))
        if kept["of"] == of:
            return Measured(kept)
    kept = {"of": of, "seconds": {}, "lines": {}, "imported": [], "failed": []}
    stages = ("lines", "seconds")  # to watch the lines takes several times as long as the tests
    for stage, measure in zip(stages, (_watched, _timed), strict=True):
        for line in in_child(partial(measure, file, kept_in / "cache")):
            word, _, rest = line.partition(" ")
            if word == "spent" and stage == "seconds":
                seconds, _, test = rest.partition(" ")
                kept["seconds"][test] = float(seconds)
            elif word == "failed":
                kept["failed"].append(rest)
            elif word == "told":
                kept |= json.loads(rest)
    place.parent.mkdir(parents=True, exist_ok=True)
    place.write_text(json.dumps(kept), encoding="utf-8")
    return Measured(kept)


def _timed(file: str, cache_in: Path, tell: Callable[[str], None]) -> None:
    without_end()
    pytest([file], Watch(tell, cache_in))


def _watched(file: str, cache_in: Path, tell: Callable[[str], None]) -> None:
    without_end()
    watched = [f"{HERE}/racs_bif/{folder}/*" for folder in FOLDERS]
    coverage = import_module("coverage").Coverage(
        data_file=None, config_file=False, include=watched, messages=False
    )
    coverage.start()
    pytest([file], Watch(tell, cache_in, began=coverage.switch_context))
    coverage.stop()
    data = coverage.get_data()
    lines: dict[str, Lines] = {}
    for path in data.measured_files():
        module = ".".join(Path(path).relative_to(HERE).with_suffix("").parts)
        for line, tests in data.contexts_by_lineno(path).items():
            for test in tests:
                lines.setdefault(module, {}).setdefault(test, []).append(line)
    own = ("racs_bif", "tests", "conftest", "test_", "benchmarks", "models", "coverage", "_pytest")
    imported = [name for name in sys.modules if not name.startswith((*own, "__"))]
    tell("told " + json.dumps({"lines": lines, "imported": imported}))


@cache
def _package() -> str:
    digest = hashlib.sha256()
    for folder in FOLDERS:
        for path in sorted((HERE / "racs_bif" / folder).glob("*.py")):
            digest.update(path.read_bytes())
    return digest.hexdigest()


def _digest(file: str) -> str:
    digest = hashlib.sha256(_package().encode())
    for path in (HERE / file, HERE / "tests" / "conftest.py", (HERE / file).parent / "conftest.py"):
        digest.update(path.read_bytes() if path.exists() else b"")
    return digest.hexdigest()


class Reach:
    """Tells the tests that a mutant is to be shown to."""

    def __init__(self, of: dict[str, Measured]) -> None:
        self.of = of
        self.seconds = {t: s for each in of.values() for t, s in each.seconds.items()}
        self.imported = sorted({name for each in of.values() for name in each.imported})
        self._slowest = {file: max(each.seconds.values(), default=0.0) for file, each in of.items()}

    def tests(self, mutant: Mutant) -> list[list[str]]:
        """Return tests that may notice a mutant: likely ones of its folder, others, other folders.

        Each list has the shortest tests first.
        """
        at = _Statement(mutant)
        likely = self._reaching(at.where())
        likely = likely or self._reaching({mutant.imported_as: at.inside})
        rest = self._reaching({mutant.imported_as: at.inside}) if at.is_imported else set()
        if not likely and not rest:  # a module without functions, or one that no test calls
            likely = set() if at.inside else set(self.seconds)
        own = (f"tests/{mutant.folder}/",)
        asked = tuple(f"tests/{name}/" for name in TESTS[mutant.folder])
        return [
            sorted(
                (t for t in tests if t.startswith(asked) and t.startswith(own) == is_own),
                key=lambda test: (self.seconds[test], test),
            )
            for tests in (likely, rest - likely)
            for is_own in (True, False)
        ]

    def share(self, test: str) -> float:
        """Return the processor seconds a test may take: fixtures may be its own to make."""
        return 4.0 + 4.0 * self.seconds[test] + 2.0 * self._slowest[test.partition("::")[0]]

    def _reaching(self, where: dict[str, set[int]]) -> set[str]:
        return {
            test
            for each in self.of.values()
            for module, wanted in where.items()
            for test, lines in each.lines.get(module, {}).items()
            if test in self.seconds and not wanted.isdisjoint(lines)
        }


class _Statement:
    """The statement a mutant changes, and the lines that show whether it was executed."""

    def __init__(self, mutant: Mutant) -> None:
        self.mutant = mutant
        module = _Module.of(mutant.path)
        self.inside = module.inside
        self.node = module.statement(mutant.line)
        self.is_imported = mutant.line not in module.inside

    def where(self) -> dict[str, set[int]]:
        """Return lines by module; a line that is executed by an import has those that use it."""
        if not self.is_imported:
            return {self.mutant.imported_as: _header(self.node)}
        if isinstance(self.node, ast.FunctionDef | ast.ClassDef):
            last = self.node.end_lineno or self.node.lineno
            lines = set(range(self.node.lineno, last + 1)) & self.inside
            return {self.mutant.imported_as: lines}
        if not isinstance(self.node, ast.Assign | ast.AnnAssign):
            return {}
        targets = self.node.targets if isinstance(self.node, ast.Assign) else [self.node.target]
        nodes = (node for target in targets for node in ast.walk(target))
        names = {node.id for node in nodes if isinstance(node, ast.Name)}
        return _using(frozenset(names))


class _Module:
    def __init__(self, path: Path) -> None:
        self.tree = ast.parse(path.read_text(encoding="utf-8"))

    @staticmethod
    @cache
    def of(path: Path) -> _Module:
        return _Module(path)

    @cached_property
    def inside(self) -> set[int]:
        """Lines in the bodies of functions: the others are executed by an import."""
        functions = (node for node in ast.walk(self.tree) if isinstance(node, ast.FunctionDef))
        return {
            line
            for function in functions
            for line in range(function.body[0].lineno, (function.end_lineno or 0) + 1)
        }

    def statement(self, line: int) -> ast.stmt:
        """Return the innermost statement on a line, its decorators included."""
        found = [
            node
            for node in ast.walk(self.tree)
            if isinstance(node, ast.stmt) and _first(node) <= line <= (node.end_lineno or 0)
        ]
        return max(found, key=lambda node: (_first(node), -(node.end_lineno or 0)))


def _first(node: ast.stmt) -> int:
    decorators: list[ast.expr] = getattr(node, "decorator_list", [])
    return min(node.lineno, *(each.lineno for each in decorators), node.lineno)


def _header(node: ast.stmt) -> set[int]:
    """Return the lines of a statement without those of the statements in it."""
    body = getattr(node, "body", None)
    last = body[0].lineno - 1 if body else (node.end_lineno or node.lineno)
    return set(range(node.lineno, max(last, node.lineno) + 1))


@cache
def _using(names: frozenset[str]) -> dict[str, set[int]]:
    """Return the lines, in functions of the package's two folders, that use any of some names."""
    found: dict[str, set[int]] = {}
    for folder in FOLDERS:
        for path in (HERE / "racs_bif" / folder).glob("*.py"):
            module = _Module.of(path)
            lines = {line for name, line in _uses(path) if name in names}
            found[f"racs_bif.{folder}.{path.stem}"] = lines & module.inside
    return found


@cache
def _uses(path: Path) -> Iterable[tuple[str, int]]:
    nodes = list(ast.walk(_Module.of(path).tree))
    names = [(node.id, node.lineno) for node in nodes if isinstance(node, ast.Name)]
    return names + [(node.attr, node.lineno) for node in nodes if isinstance(node, ast.Attribute)]
