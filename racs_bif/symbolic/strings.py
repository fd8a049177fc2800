"""Models from strings. Expressions are parsed, never evaluated as Python."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any, Final

from racs_bif.errors import ModelError, nearest
from racs_bif.symbolic.model import FractionalElement, Model, Parameter

if TYPE_CHECKING:
    import sympy as sp

_FUNCTIONS: Final = {
    name: name
    for name in (
        "exp log sqrt sin cos tan asin acos atan sinh cosh tanh asinh acosh atanh erf sign"
    ).split()
} | {"abs": "Abs", "ln": "log", "heaviside": "Heaviside", "max": "Max", "min": "Min"}
_CONSTANTS: Final = {"pi": "pi"}
_LONGEST = 20_000


def model_from_strings(
    name: str,
    equations: Mapping[str, str],
    *,
    parameters: Mapping[str, float],
    guess: Mapping[str, float] | None = None,
    elements: Iterable[tuple[str, str, str]] = (),
    outputs: Mapping[str, str] | None = None,
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
    return Model(
        name=name,
        equations={state: parse(text) for state, text in equations.items()},
        parameters=tuple(Parameter(key, float(value)) for key, value in parameters.items()),
        guess=dict(guess or {}),
        elements=tuple(
            FractionalElement(output, parse(source), parse(law))
            for output, source, law in elements
        ),
        outputs={key: parse(text) for key, text in (outputs or {}).items()},
    )


def parse(text: str) -> sp.Expr:
    """Return the sympy expression of an arithmetic expression.

    Numbers, names, ``+ - * / ** ^``, comparisons, ``a if c else b`` and elementary functions are
    understood, nothing else.

    Raises
    ------
    ModelError
        If the text is anything else.

    Examples
    --------
    >>> parse("2*x**2 + sin(pi*t)")
    2*x**2 + sin(pi*t)
    """
    if not isinstance(text, str):
        msg = f"an expression must be a string, not {type(text).__name__}"
        raise ModelError(msg)
    if len(text) > _LONGEST:
        msg = f"an expression of {len(text)} characters is too long; split it"
        raise ModelError(msg)
    try:
        tree = ast.parse(text.strip().replace("^", "**"), mode="eval")
        return _Builder(text)(tree.body)
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        if isinstance(error, ModelError):
            raise
        msg = f"'{_short(text)}' is not an arithmetic expression; check brackets and operators"
        raise ModelError(msg) from None


class _Builder:
    def __init__(self, text: str) -> None:
        self.text = text

    def __call__(self, node: ast.expr) -> Any:  # noqa: ANN401 - sympy is untyped
        handler: Callable[[Any], Any] | None = getattr(self, f"_{type(node).__name__}", None)
        if handler is None:
            msg = (
                f"'{_short(ast.unparse(node))}' in '{_short(self.text)}' is not allowed; use numbers, "
                "names, + - * / ** and elementary functions"
            )
            raise ModelError(msg)
        return handler(node)

    def _Constant(self, node: ast.Constant) -> Any:  # noqa: ANN401 - sympy is untyped
        import sympy as sp

        if isinstance(node.value, bool) or not isinstance(node.value, int | float):
            msg = f"'{node.value!r}' in '{_short(self.text)}' is not a real number"
            raise ModelError(msg)
        if isinstance(node.value, int):
            return sp.Integer(node.value)
        return sp.Float(repr(node.value))

    def _Name(self, node: ast.Name) -> Any:  # noqa: ANN401 - sympy is untyped
        import sympy as sp

        return sp.pi if node.id in _CONSTANTS else sp.Symbol(node.id)

    def _UnaryOp(self, node: ast.UnaryOp) -> Any:  # noqa: ANN401 - sympy is untyped
        if isinstance(node.op, ast.USub):
            return -self(node.operand)
        if isinstance(node.op, ast.UAdd):
            return self(node.operand)
        msg = f"'{_short(self.text)}': only + and - may stand before a term"
        raise ModelError(msg)

    def _BinOp(self, node: ast.BinOp) -> Any:  # noqa: ANN401 - sympy is untyped
        left, right = self(node.left), self(node.right)
        if isinstance(node.op, ast.Add):
            return left + right
        if isinstance(node.op, ast.Sub):
            return left - right
        if isinstance(node.op, ast.Mult):
            return left * right
        if isinstance(node.op, ast.Div):
            return left / right
        if isinstance(node.op, ast.Pow):
            if right.is_number and abs(right) > 1000:
                msg = f"the exponent {right} in '{_short(self.text)}' is too large"
                raise ModelError(msg)
            return left**right
        msg = f"'{_short(self.text)}': use the operators + - * / **"
        raise ModelError(msg)

    def _Call(self, node: ast.Call) -> Any:  # noqa: ANN401 - sympy is untyped
        import sympy as sp

        if not isinstance(node.func, ast.Name) or node.keywords:
            msg = f"'{_short(ast.unparse(node))}' is not a function call that is understood"
            raise ModelError(msg)
        if node.func.id not in _FUNCTIONS:
            known = nearest(node.func.id, _FUNCTIONS)
            msg = f"unknown function '{node.func.id}' in '{_short(self.text)}'; {known}"
            raise ModelError(msg)
        function = getattr(sp, _FUNCTIONS[node.func.id])
        try:
            return function(*map(self, node.args))
        except TypeError as error:
            msg = f"'{_short(ast.unparse(node))}': wrong number of arguments"
            raise ModelError(msg) from error

    def _Compare(self, node: ast.Compare) -> Any:  # noqa: ANN401 - sympy is untyped
        import sympy as sp

        names = {"Lt": sp.Lt, "LtE": sp.Le, "Gt": sp.Gt, "GtE": sp.Ge}
        kind = type(node.ops[0]).__name__
        if len(node.ops) != 1 or kind not in names:
            msg = f"'{_short(ast.unparse(node))}': compare two terms with < <= > or >="
            raise ModelError(msg)
        return names[kind](self(node.left), self(node.comparators[0]))

    def _IfExp(self, node: ast.IfExp) -> Any:  # noqa: ANN401 - sympy is untyped
        import sympy as sp

        return sp.Piecewise((self(node.body), self(node.test)), (self(node.orelse), True))


def _short(text: str) -> str:
    return text if len(text) <= 60 else text[:57] + "..."
