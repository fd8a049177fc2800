"""A realised model as the Fortran that AUTO-07p takes: its straight-line program, written out.

The functions of a compiled model are run on texts instead of numbers, so that what AUTO evaluates
is what this package evaluates, operation by operation; what depends on no unknown is a number.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from racs_bif.errors import ModelError
from racs_bif.symbolic.graph import COMPARISONS
from racs_bif.symbolic.kernels import SCALAR
from racs_bif.symbolic.overload import Overloaded, where

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from racs_bif.fractional.system import System
    from racs_bif.symbolic.field import Array

_OPERATORS: Final = {"add": "+", "sub": "-", "mul": "*", "div": "/", "pow": "**"}
_NAMES: Final = {"fabs": "abs"}
_SHORT: Final = 100
_LONGEST: Final = 30
"""Terms of a sum on one line: Fortran's lines are short, and so are its statements."""

HEAD: Final = """\
subroutine func(ndim, u, icp, par, ijac, f, dfdu, dfdp)
  implicit double precision (t)
  integer, intent(in) :: ndim, icp(*), ijac
  double precision, intent(in) :: u(ndim), par(*)
  double precision, intent(out) :: f(ndim)
  double precision, intent(inout) :: dfdu(ndim, ndim), dfdp(ndim, *)
"""
START: Final = """\
end subroutine func

subroutine stpnt(ndim, u, par, t)
  integer, intent(in) :: ndim
  double precision, intent(inout) :: u(ndim), par(*)
  double precision, intent(in) :: t
"""
REST: Final = """\
end subroutine stpnt

subroutine bcnd
end subroutine bcnd
subroutine icnd
end subroutine icnd
subroutine fopt
end subroutine fopt
subroutine pvls
end subroutine pvls
"""


class Program:
    """Statements that are written as operations are carried out on their names."""

    def __init__(self) -> None:
        self.lines: list[str] = []

    def name(self, expression: str) -> Name:
        """Give an expression a name."""
        name = f"t{len(self.lines) + 1}"
        self.lines.append(f"{name} = {expression}")
        return Name(self, name)

    def function(self, name: str) -> Callable[..., Any]:
        """Return an elementary function, of names or of floats."""
        plain = getattr(SCALAR, name)

        def call(*args: Any) -> Any:  # noqa: ANN401 - names or floats
            named = any(isinstance(a, Name) for a in args)
            return Name(self, "").primitive(name, *args) if named else plain(*args)

        return call

    @property
    def functions(self) -> SimpleNamespace:
        """What the text of a compiled model calls."""
        found = SimpleNamespace(**{name: self.function(name) for name in vars(SCALAR)})
        found.where = where
        return found


class Name(Overloaded):
    """A quantity in a Fortran program."""

    __slots__ = ("program", "text")

    def __init__(self, program: Program, text: str) -> None:
        self.program, self.text = program, text

    def primitive(self, name: str, *args: Name | float) -> Name:
        """Write an operation; those of logic and ``sign`` do not occur in smooth models."""
        texts = [text(a) for a in args]
        if name in _OPERATORS:
            expression = f"({texts[0]}) {_OPERATORS[name]} ({texts[1]})"
        elif name == "neg":
            expression = f"-({texts[0]})"
        elif name in {"sign", "absorb", "both", "either", "negated"}:
            raise ModelError(f"no Fortran is written for '{name}'")
        else:
            expression = f"{_NAMES.get(name, name)}({texts[0]})"
        return self.program.name(expression)

    def compare(self, name: str, a: Name | float, b: Name | float) -> Condition:
        """Return a condition."""
        return Condition(self.program, f"{text(a)} {COMPARISONS[name]} {text(b)}")


class Condition:
    """A condition in a Fortran program."""

    def __init__(self, program: Program, text: str) -> None:
        self._program, self._text = program, text

    def choose(self, a: Name | float, b: Name | float) -> Name:
        """Write a choice."""
        return self._program.name(f"merge({text(a)}, {text(b)}, {self._text})")


def text(value: Name | float) -> str:
    """Return a name or a number as Fortran has it."""
    if isinstance(value, Name):
        return value.text
    digits = repr(float(value))
    return f"({digits.replace('e', 'd')})" if "e" in digits else f"({digits}d0)"


def written(system: System, parameter: str, value: float) -> str:
    """Return the Fortran of a system, and of its equilibrium at a value of the parameter.

    Parameters
    ----------
    system : System
        The system, with the realisation wanted.
    parameter : str
        A base parameter; it becomes AUTO's PAR(1).
    value : float
        Where AUTO shall begin.

    Raises
    ------
    ModelError
        If the fractional elements depend on the parameter.
    """
    p, base = system.values, [p.name for p in system.compiled.parameters]
    direction = np.eye(len(p))[base.index(parameter)]
    if system.field.law_directions(p, direction) is not None:
        raise ModelError(f"the realisation moves with '{parameter}': AUTO is given a fixed one")
    begun = system.with_parameters({parameter: value})
    x = begun.equilibrium()
    stated = [f"u({k + 1}) = {text(number)}" for k, number in enumerate(x)]
    stated.append(f"par(1) = {text(value)}")
    parts = (HEAD, _lines(_right_hand_side(system, base.index(parameter))), START, _lines(stated))
    return "\n".join((*parts, REST))


def _right_hand_side(system: System, active: int) -> list[str]:
    program, frame = Program(), system.field.frame(system.values)
    namespace: dict[str, Any] = {}
    exec(compile(system.compiled.sources.main, "<racs_bif model>", "exec"), namespace)  # our own
    functions = namespace["make"](program.functions)
    P: list[Name | float] = [float(number) for number in frame.P]
    P[active] = Name(program, "par(1)")
    own, bank = len(system.states), frame.bank
    memory = [f"u({own + k + 1})" for k in range(len(bank.A))]
    zeta = [program.name("0d0") for _ in bank.C]
    for name, row in zip(zeta, bank.C, strict=True):
        _add(program, name.text, row, memory)
    y = [Name(program, f"u({k + 1})") for k in range(own)]
    # a number, where nothing depends on the parameter, is taken as it stands
    result = functions["core"](functions["core_prepare"](P), [*y, *zeta])
    values = [text(value) for value in result]
    program.lines += [f"f({k + 1}) = {value}" for k, value in enumerate(values[:own])]
    for k, (a, b) in enumerate(zip(bank.A, bank.B, strict=True)):
        target = f"f({own + k + 1})"
        program.lines.append(f"{target} = 0d0")
        _add(program, target, np.concatenate((a, b)), [*memory, *values[own:]])
    return program.lines


def _add(program: Program, target: str, row: Array, names: Sequence[str]) -> None:
    """Add a row of numbers times quantities to a target."""
    terms = [f"{text(a)} * {name}" for a, name in zip(row, names, strict=True) if a]
    for k in range(0, len(terms), _LONGEST):
        program.lines.append(f"{target} = {target} + " + " + ".join(terms[k : k + _LONGEST]))


def _lines(statements: Sequence[str]) -> str:
    """Return statements, continued where they are longer than a line of Fortran may be."""
    return "\n".join("  " + _broken(statement) for statement in statements)


def _broken(statement: str) -> str:
    words, lines = statement.split(" "), [""]
    for word in words:
        if len(lines[-1]) + len(word) > _SHORT:
            lines.append("")
        lines[-1] += f"{word} "
    return "&\n    ".join(lines).rstrip()
