"""The texts of all errors for users, read from the source: each names its thing and a mend."""

import ast
import re
from dataclasses import dataclass
from pathlib import Path

import racs_bif

ROOT = Path(racs_bif.__file__).parent
PUBLIC = {
    "RacsBifError",
    "UsageError",
    "ModelError",
    "ParameterError",
    "ValidityError",
    "ConvergenceError",
    "FileError",
}
CAPITALS = ("Newton's ", "LOW ", "E_{a,b} ")
"""What a text may begin with though it is a capital: names."""
REASONS = ("numerics/", "orbits/", "equilibria/", "continuation/segment.py")
"""Whose ConvergenceErrors are reasons: the layers above put them in brackets, with their mend."""
VERBS = (
    "add|ask|begin|calibrate|check|choose|compare|compute|continue|define|divide|draw|end|feed|follow|give"
    "|go|integrate|keep|leave|let|load|lower|make|mend|move|multiply|name|narrow|put|raise|remove|rename"
    "|replace|return|run|say|scale|see|simulate|slice|solve|split|start|swap|take|update|use|widen"
    "|write"
)
MEND = re.compile(
    rf"(?:^|[;:?,.(—] ?|\bor |\band |\bthen )(?:{VERBS})\b"
    r"|\bmust\b|\bneeds?\b|\bat least \d|\bthere are\b|\bthese can\b|\bpip install\b"
    r"|@",
    re.IGNORECASE,
)
HINT = re.compile(r"\{(?:hint|mend|lost|nearest\(|[^}]*\binner)[^}]*\}")
"""Where a mend is put in; `inner` is another error of ours that is passed on with its place."""
THINGS = re.compile(
    r"\b(?:argument principle|batch|branch|chart|chart's|curves?|cycle|diagram|eigenvalues|element"
    r"|equations?|exact Hopf point|exponent|function|history|interval|integrator|laws?|law's|map"
    r"|mass|matrix|mesh|model|moduli|multipliers?|Newton's method|normal form|omega|operator|orbit"
    r"|parameter|Piecewise|Plotly|proofs?|roots?|samples|scheduler|scipy|settings|span|steps?|sweep"
    r"|table|tail|tangent|time|trajectory|verb|workers?|--\w+)\b"
)


@dataclass(frozen=True)
class Site:
    """A place that raises, with one of its texts; what is put into it stands in braces."""

    place: str
    kind: str
    text: str

    @property
    def mended(self) -> bool:
        """Whether words, not the names of what is put in, say what to do."""
        words = re.sub(r"\{[^}]*\}", "{}", HINT.sub("@", self.text))
        return MEND.search(words) is not None

    @property
    def reason(self) -> bool:
        return self.kind == "ConvergenceError" and self.place.startswith(REASONS)


class Reader:
    """Collects the texts of errors from the source of the package."""

    def __init__(self):
        self.trees = {path: ast.parse(path.read_text()) for path in sorted(ROOT.rglob("*.py"))}
        self.functions: dict[str, list[tuple[Path, ast.FunctionDef]]] = {}
        self.constants: dict[tuple[Path, str], str] = {}
        self.open: list[str] = []
        for path, tree in self.trees.items():
            for node in ast.walk(tree):
                if isinstance(node, ast.FunctionDef):
                    self.functions.setdefault(node.name, []).append((path, node))
            for node in tree.body:
                match node:
                    case (
                        ast.Assign(targets=[ast.Name(name)], value=ast.Constant(str(text)))
                        | ast.AnnAssign(target=ast.Name(name), value=ast.Constant(str(text)))
                    ):
                        self.constants[path, name] = text

    def sites(self) -> list[Site]:
        """Every text of every error raised."""
        found: list[Site] = []
        for path, tree in self.trees.items():
            self._statements(path, tree.body, {}, found)
        return found

    def _statements(self, path, body, known, found, returned=None):
        """Read a block; `known` holds the texts that each name may stand for."""
        known = dict(known)
        for node in body:
            match node:
                case ast.Assign(targets=[ast.Name(name)], value=value):
                    known[name] = self._texts(path, value, known)
                case ast.Return(value=value) if returned is not None and value is not None:
                    returned.extend(self._texts(path, value, known) or ["{}"])
                case _:
                    pass
            here: list[ast.expr] = []
            for field, value in ast.iter_fields(node):
                if isinstance(value, list) and value and isinstance(value[0], ast.stmt):
                    inner = {} if isinstance(node, ast.FunctionDef) else known
                    self._statements(path, value, inner, found, returned)
                    self._merge(path, node, field, known)
                elif isinstance(value, list) and field in ("handlers", "cases"):
                    for part in value:
                        self._statements(path, part.body, known, found, returned)
                elif isinstance(value, ast.expr):
                    here.append(value)
            for value in here:
                self._calls(path, value, known, found)

    def _merge(self, path, node, field, known):
        """What a branch assigns may be raised behind it."""
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            return
        for inner in getattr(node, field):
            match inner:
                case ast.Assign(targets=[ast.Name(name)], value=value):
                    texts = self._texts(path, value, known)
                    known[name] = [*known.get(name, []), *texts]

    def _calls(self, path, value, known, found):
        for node in ast.walk(value):
            match node:
                case ast.Call(func=ast.Name(kind), args=[text, *_]) if kind in PUBLIC:
                    place = f"{path.relative_to(ROOT).as_posix()}:{node.lineno}"
                    for words in self._texts(path, text, known) or ["{}"]:
                        found.append(Site(place, kind, words))

    def _texts(self, path, node, known) -> list[str]:
        """Read what an expression may say; nothing where that cannot be told."""
        texts: list[str] = []
        match node:
            case ast.Constant(value=str(text)):
                texts = [text]
            case ast.JoinedStr(values=parts):
                texts = ["".join(self._part(part) for part in parts)]
            case ast.BinOp(left=left, right=right, op=ast.Add()):
                ends = self._texts(path, right, known)
                texts = [a + b for a in self._texts(path, left, known) for b in ends]
            case ast.IfExp(body=body, orelse=other):
                texts = [*self._texts(path, body, known), *self._texts(path, other, known)]
            case ast.Name(id=name):
                constant = self.constants.get((path, name))
                texts = known.get(name, []) if constant is None else [constant]
            case (
                ast.Call(func=ast.Attribute(attr="join"), args=[inner])
                | ast.Call(func=ast.Attribute(value=inner, attr="split"))
            ):
                texts = self._texts(path, inner, known)
            case ast.Call(func=ast.Name(name) | ast.Attribute(attr=name)):
                texts = self._returned(path, name)
        return texts

    @staticmethod
    def _part(part) -> str:
        if isinstance(part, ast.Constant):
            return str(part.value)
        return "{" + ast.unparse(part.value) + "}"

    def _returned(self, path, name) -> list[str]:
        """Read what the functions of a name that word errors may return."""
        there = [one for one in self.functions.get(name, []) if one[1].returns is not None]
        there = [one for one in there if ast.unparse(one[1].returns) == "str"]
        there = [one for one in there if one[0] == path] or there
        texts: list[str] = []
        if name not in self.open:
            self.open.append(name)
            for home, function in there:
                self._statements(home, function.body, {}, [], texts)
            self.open.remove(name)
        return texts


SITES = Reader().sites()


def test_all_errors_are_found():
    assert len({site.place for site in SITES}) > 450
    unread = [site for site in SITES if site.text == "{}"]
    assert not unread, unread


def faults(check) -> list[str]:
    return sorted({f"{site.place} {site.text}" for site in SITES if not check(site)})


def test_texts_are_one_line_without_capital_and_full_stop():
    def check(site):
        text = site.text
        capital = text[0].isupper() and not text.startswith(CAPITALS)
        return "\n" not in text and not capital and not text.endswith((".", "!", " "))

    assert not faults(check)


def test_texts_name_the_thing():
    """A text holds a name or a number of this case, or names by itself what is wrong."""
    assert not faults(lambda site: "{" in site.text or THINGS.search(site.text))


def test_texts_give_a_mend():
    assert not faults(lambda site: site.reason or site.mended)
