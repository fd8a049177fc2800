"""Models from strings. Expressions are parsed, never evaluated as Python."""

from __future__ import annotations

import ast
import keyword
import math
import operator
import re
import unicodedata
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final

from racs_bif.errors import ModelError, nearest
from racs_bif.symbolic.model import GRAMMAR, FractionalElement, Model, Parameter
from racs_bif.units import SECONDS

if TYPE_CHECKING:
    import sympy as sp

_SAME_NAMES: Final = (
    *("exp", "log", "sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh"),
    *("asinh", "acosh", "atanh", "erf", "sign"),
)
_FUNCTIONS: Final = {name: name for name in _SAME_NAMES} | {
    "abs": "Abs",
    "ln": "log",
    "heaviside": "Heaviside",
    "max": "Max",
    "min": "Min",
}
_AS_WRITTEN: Final = {"abs", "max", "min", "sign", "heaviside"}
"""Functions that sympy would look at for minutes, for simplifications that nothing needs."""
_MANY: Final = (2, 100)
_ARGUMENTS: Final = {"log": (1, 2), "heaviside": (1, 2), "max": _MANY, "min": _MANY}
"""Least and greatest number of arguments of functions that do not take one."""
_OPERATORS: Final[dict[type[ast.operator], Callable[[Any, Any], Any]]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}
_CONSTANTS: Final = {"pi"}
_FREE_KEYWORDS: Final = frozenset(keyword.kwlist) - GRAMMAR
_WORD: Final = re.compile(r"[^\W\d]\w*")
_MARK: Final = "\u00b7keyword"
"""What a keyword has behind it where it is a name; a dot that may stand in names, and does not."""
_LONGEST = 20_000
_MOST_BITS = 8192
_LARGEST_POWER = 1000.0
"""Greatest exponent of a symbol, and greatest number of decimal places of a power of a number."""


def model_from_strings(  # noqa: PLR0913 - the parts of a model, by their names
    name: str,
    equations: Mapping[str, str],
    *,
    parameters: Mapping[str, float],
    guess: Mapping[str, float] | None = None,
    elements: Iterable[tuple[str, str, str]] = (),
    outputs: Mapping[str, str] | None = None,
    terms: Mapping[str, str] | None = None,
    inputs: Iterable[str] = (),
    time_unit: str = SECONDS,
) -> Model:
    """Build a model from strings.

    Parameters
    ----------
    name : str
        Name of the model.
    equations : mapping of str to str
        State name to its time derivative, for example ``{"x": "A - (B + 1)*x + x**2*y"}``.
    parameters : mapping of str to float
        Parameter names and default values.
    guess : mapping of str to float, optional
        Where to look for an equilibrium.
    elements : iterable of (output, input, law)
        Fractional elements, for example ``[("w", "x", "s**0.5")]``.
    outputs : mapping of str to str, optional
        Further quantities.
    terms : mapping of str to str, optional
        Shared terms that equations, outputs and later terms may use.
    inputs : iterable of str
        Parameters that act on the model from outside: the inputs of its linearisations.
    time_unit : str
        Unit of the time; ``""`` where it has none.

    Returns
    -------
    Model

    Raises
    ------
    ModelError
        If a string is not an arithmetic expression or a symbol is unknown.

    Examples
    --------
    >>> model = model_from_strings("decay", {"x": "-k*x"}, parameters={"k": 2.0})
    >>> model.states
    ('x',)
    """
    _check_tables(name, equations, parameters, guess, outputs, terms)
    return Model(
        name=name,
        equations=read_table(equations),
        parameters=tuple(
            Parameter(plain(key), number(name, key, value)) for key, value in parameters.items()
        ),
        guess={plain(k): number(name, k, value) for k, value in (guess or {}).items()},
        elements=tuple(read_element(name, element) for element in elements),
        outputs=read_table(outputs or {}),
        terms=read_table(terms or {}),
        inputs=read_inputs(name, inputs),
        time_unit=time_unit,
    )


def read_inputs(name: str, inputs: Iterable[str]) -> tuple[str, ...]:
    """Return the names of a model's inputs, of which one string alone is none."""
    if isinstance(inputs, str) or not isinstance(inputs, Iterable):
        msg = f"model '{name}': give the names of the inputs as a list, not as {inputs!r}"
        raise ModelError(msg)
    return tuple(plain(key) for key in inputs)


def _check_tables(name: str, *tables: object) -> None:
    for table in tables:
        if table is not None and not isinstance(table, Mapping):
            kind = type(table).__name__
            msg = f"model '{name}': give names and expressions as a dict, not as {kind}"
            raise ModelError(msg)
        for key in table or ():
            check_name(name, key)


def check_name(model: str, name: object) -> None:
    """Refuse what can be no name in an expression.

    Raises
    ------
    ModelError
        If it is no string, or a constant.
    """
    if not isinstance(name, str):
        msg = f"model '{model}': {name!r} cannot be a name; give a string"
        raise ModelError(msg)
    if name in _CONSTANTS:
        msg = f"model '{model}': '{name}' is a constant; rename it"
        raise ModelError(msg)


def plain(name: str) -> str:
    """Return a name as Python's tokeniser spells it (the micro sign becomes a Greek mu)."""
    return unicodedata.normalize("NFKC", name)


def read_table(table: Mapping[str, str]) -> dict[str, sp.Expr]:
    """Return expressions by name."""
    found: dict[str, sp.Expr] = {}
    for name, text in table.items():
        if plain(name) in found:
            msg = f"the name '{plain(name)}' is given twice, in two spellings; rename one of them"
            raise ModelError(msg)
        try:
            found[plain(name)] = parse(text)
        except ModelError as inner:
            msg = f"'{_short(name)}': {inner}"
            raise ModelError(msg) from None
    return found


def read_element(name: str, element: Sequence[str]) -> FractionalElement:
    """Return an element of a model from its strings (output, input, law)."""
    if isinstance(element, str) or len(element) != 3:
        msg = f"model '{name}': an element must be (output, input, law), not {element!r}"
        raise ModelError(msg)
    output, source, law = element
    check_name(name, output)
    return FractionalElement(plain(output), parse(source), parse(law))


def number(name: str, key: str, value: float) -> float:
    """Return a model's number as a float, refusing what is none by its name."""
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        msg = f"model '{name}': '{key}' is {_short(repr(value))}, which is no number; give one"
        raise ModelError(msg) from None


def parse(text: str) -> sp.Expr:
    """Return the sympy expression of an arithmetic expression.

    Numbers, names, ``+ - * / ** ^``, ``a if c else b`` with a comparison c, and elementary
    functions are understood, nothing else.

    Raises
    ------
    ModelError
        If the text is anything else.

    Examples
    --------
    >>> parse("2*x**2 + sin(pi*t)")
    2*x**2 + sin(pi*t)
    """
    _check_text(text)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of Python's tokeniser: what matters is refused below
            tree = ast.parse(_named(text.strip().replace("^", "**")), mode="eval")
        return _Reader(text).expression(tree.body)
    except ModelError:
        raise
    except (RecursionError, MemoryError):
        msg = f"'{_short(text)}' is nested too deeply; split it"
        raise ModelError(msg) from None
    except (SyntaxError, ValueError, TypeError, ArithmeticError):
        msg = f"'{_short(text)}' is not an arithmetic expression; check brackets and operators"
        raise ModelError(msg) from None


def _named(text: str) -> str:
    """Put words in for keywords that mean nothing in an expression, such as `lambda`."""
    return _WORD.sub(lambda m: m[0] + _MARK if m[0] in _FREE_KEYWORDS else m[0], text)


def _check_text(text: object) -> None:
    if not isinstance(text, str):
        msg = f"an expression must be a string, not {type(text).__name__}"
        raise ModelError(msg)
    if len(text) > _LONGEST:
        msg = f"an expression of {len(text)} characters is too long; split it"
        raise ModelError(msg)


class _Reader:
    """Build sympy expressions from those nodes of Python's syntax tree that are arithmetic."""

    def __init__(self, text: str) -> None:
        self.text = text
        self._rules: dict[type[ast.expr], Callable[[Any], sp.Expr]] = {
            ast.Constant: self._number,
            ast.Name: self._name,
            ast.UnaryOp: self._signed,
            ast.BinOp: self._binary,
            ast.Call: self._call,
            ast.IfExp: self._choice,
        }

    def expression(self, node: ast.expr) -> sp.Expr:
        """Return the expression of a node."""
        rule = self._rules.get(type(node))
        if rule is None:
            msg = (
                f"'{_short(ast.unparse(node))}' in '{_short(self.text)}' is not allowed; "
                "use numbers, names, + - * / ** and elementary functions"
            )
            raise ModelError(msg)
        return rule(node)

    def _number(self, node: ast.Constant) -> sp.Expr:
        import sympy as sp

        if isinstance(node.value, bool) or not isinstance(node.value, int | float):
            msg = f"'{node.value!r}' in '{_short(self.text)}' is not a real number; give one"
            raise ModelError(msg)
        if isinstance(node.value, int):
            return self._bounded(sp.Integer(node.value))
        if not math.isfinite(node.value):
            msg = f"a number in '{_short(self.text)}' is too large; scale the equation"
            raise ModelError(msg)
        return sp.Float(repr(node.value))

    def _name(self, node: ast.Name) -> sp.Expr:
        import sympy as sp

        return sp.pi if node.id in _CONSTANTS else sp.Symbol(node.id.removesuffix(_MARK))

    def _signed(self, node: ast.UnaryOp) -> sp.Expr:
        if isinstance(node.op, ast.USub):
            return -self.expression(node.operand)
        if isinstance(node.op, ast.UAdd):
            return self.expression(node.operand)
        msg = f"'{_short(self.text)}': only + and - may stand before a term; write it so"
        raise ModelError(msg)

    def _binary(self, node: ast.BinOp) -> sp.Expr:
        operation = _OPERATORS.get(type(node.op))
        if operation is None:
            msg = f"'{_short(self.text)}': use the operators + - * / **"
            raise ModelError(msg)
        left, right = self.expression(node.left), self.expression(node.right)
        if isinstance(node.op, ast.Pow):
            self._check_power(left, right)
        return self._bounded(operation(left, right))

    def _bounded(self, value: sp.Expr) -> sp.Expr:
        """Refuse numbers whose digits alone take long to reckon with."""
        if value.is_Rational and max(value.p.bit_length(), value.q.bit_length()) > _MOST_BITS:
            msg = f"a number in '{_short(self.text)}' has too many digits; write it as 1.0e9"
            raise ModelError(msg)
        return value

    def _check_power(self, left: sp.Expr, right: sp.Expr) -> None:
        """Refuse powers whose exact value alone could fill the memory."""
        if not right.is_number:
            return
        size = abs(float(right))
        if left.is_number and left != 0:
            size *= max(1.0, abs(math.log10(abs(complex(left)))))
        if not size <= _LARGEST_POWER:
            msg = f"a power in '{_short(self.text)}' is too large; write it with a smaller exponent"
            raise ModelError(msg)

    def _call(self, node: ast.Call) -> sp.Expr:
        import sympy as sp

        if not isinstance(node.func, ast.Name) or node.keywords:
            called = _short(ast.unparse(node))
            msg = f"'{called}' is not a function call that is understood; write it as sin(x)"
            raise ModelError(msg)
        name = node.func.id
        if name not in _FUNCTIONS:
            hint = nearest(name, _FUNCTIONS)
            msg = f"unknown function '{name}' in '{_short(self.text)}'; {hint}"
            raise ModelError(msg)
        least, most = _ARGUMENTS.get(name, (1, 1))
        if not least <= len(node.args) <= most:
            wanted = f"{least}" if least == most else f"{least} to {most}"
            msg = f"'{_short(ast.unparse(node))}': wrong number of arguments; give {wanted}"
            raise ModelError(msg)
        options = {"evaluate": False} if name in _AS_WRITTEN else {}
        return getattr(sp, _FUNCTIONS[name])(*map(self.expression, node.args), **options)

    def _choice(self, node: ast.IfExp) -> sp.Expr:
        import sympy as sp

        chosen = (self.expression(node.body), self._condition(node.test))
        return sp.Piecewise(chosen, (self.expression(node.orelse), True), evaluate=False)

    def _condition(self, node: ast.expr) -> sp.Basic:
        import sympy as sp

        relations = {ast.Lt: sp.Lt, ast.LtE: sp.Le, ast.Gt: sp.Gt, ast.GtE: sp.Ge}
        if not isinstance(node, ast.Compare) or len(node.ops) != 1:
            msg = f"'{_short(ast.unparse(node))}': compare two terms with < <= > or >="
            raise ModelError(msg)
        relation = relations.get(type(node.ops[0]))
        if relation is None:
            msg = f"'{_short(ast.unparse(node))}': compare two terms with < <= > or >="
            raise ModelError(msg)
        sides = self.expression(node.left), self.expression(node.comparators[0])
        return relation(*sides, evaluate=False)


def _short(text: str) -> str:
    """Return a text fit for one line of a message."""
    line = "".join(c if c.isprintable() else " " for c in text)
    return line if len(line) <= 60 else line[:57] + "..."
