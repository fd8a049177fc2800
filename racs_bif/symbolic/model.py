"""A model as its author writes it: equations, parameters with units, fractional elements.

Importing this module does not import sympy: a model loaded from the cache never needs it.
"""

from __future__ import annotations

import math
import unicodedata
from dataclasses import dataclass, field, replace
from numbers import Real
from typing import TYPE_CHECKING

from racs_bif.errors import ModelError, ParameterError, nearest
from racs_bif.units import SECONDS

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    import sympy as sp

    from racs_bif.symbolic.external import External

LAPLACE = "s"
"""Name of the Laplace variable in transfer laws."""
GRAMMAR = frozenset(("and", "else", "for", "if", "in", "is", "not", "or", "True", "False", "None"))
"""Keywords that mean something in expressions; `lambda` and the others are names like any."""
_EVERYWHERE = (-math.inf, math.inf)


@dataclass(frozen=True)
class Calibration:
    """A default value that is computed: it puts an exact Hopf point where it is wanted.

    Parameters
    ----------
    parameter : str
        Parameter (base or derived) that is moved.
    hopf : mapping of str to float
        Where the Hopf point of the exact model has to lie, for example ``{"u": 10.2}``.
    span : (float, float)
        Interval of `parameter` that is searched.
    options : mapping of str to str
        Options of the model's file under which the calibration is made.
    """

    parameter: str
    hopf: Mapping[str, float]
    span: tuple[float, float]
    options: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Parameter:
    """A base parameter of a model.

    Parameters
    ----------
    name : str
        Symbol in the equations.
    default : float or Calibration
        Value where the user gives none, SI.
    unit, description, source : str
        For people: SI unit, meaning, and where the value is from.
    valid : (float, float)
        Open interval in which the model makes sense.
    """

    name: str
    default: float | Calibration
    unit: str = ""
    description: str = ""
    source: str = ""
    valid: tuple[float, float] = _EVERYWHERE


@dataclass(frozen=True)
class DerivedParameter:
    """A quantity computed from base parameters that may be used wherever a parameter may.

    Parameters
    ----------
    name : str
        Its name.
    expression : sympy expression
        Its value in terms of base parameters.
    sets : str
        The base parameter that changes when this one is set.
    unit, description, source, valid
        As in `Parameter`.
    """

    name: str
    expression: sp.Expr
    sets: str
    unit: str = ""
    description: str = ""
    source: str = ""
    valid: tuple[float, float] = _EVERYWHERE


@dataclass(frozen=True)
class FractionalElement:
    """A linear element w = Z(s) e whose transfer law holds fractional powers of s.

    Parameters
    ----------
    output : str
        Name of w, a symbol that equations, outputs and inputs may use.
    input : sympy expression
        e in terms of states, parameters and outputs of elements.
    law : sympy expression
        Z in ``Symbol("s")`` and parameters: a quotient of sums of powers of s. A law that behaves
        like s**-q at s = 0 integrates: then e = 0 at equilibrium.
    """

    output: str
    input: sp.Expr
    law: sp.Expr


@dataclass(frozen=True)
class Model:
    """A dynamical system ``mass * x' = equations`` with fractional elements; symbolic and frozen.

    Parameters
    ----------
    name : str
        Short name.
    equations : mapping of str to sympy expression
        State name to right-hand side, in the order of the states.
    parameters : sequence of Parameter
        Base parameters.
    guess : mapping of str to float
        Where Newton's method looks for an equilibrium; states left out start at zero, and an
        element's output may be given too.
    elements : sequence of FractionalElement
        Fractional elements.
    outputs : mapping of str to sympy expression
        Further quantities of interest.
    mass : sympy matrix, optional
        Invertible mass matrix, n by n; may depend on states and parameters.
    derived : sequence of DerivedParameter
        Derived parameters.
    units, descriptions : mapping of str to str
        Of states and outputs.
    title, source, variant : str
        For people.
    variants : mapping of str to str
        Names of the variants its file can build, with a line on each.
    notes : sequence of str
        What a user must be told whenever results of this model are shown.
    band : (float, float)
        Frequencies [rad/s] that matter in this model: where a realisation has to be good.
    inputs : sequence of str
        Base parameters that act on it from outside, as a control engineer counts them: what
        linearisations have as inputs unless told otherwise.
    terms : mapping of str to sympy expression
        Shared terms, computed once and in this order; each may use those before it. Equations,
        outputs and inputs of elements may use them, the mass matrix and laws may not.
    time_unit : str
        Unit of the time, of which rates are per one and frequencies radians per one; empty where
        the time has none. The equations and the band are in it, nothing is converted.
    external : External, optional
        A Python function that gives the equations; see `racs_bif.symbolic.functions`.

    Raises
    ------
    ModelError
        If a symbol is unknown, a name is used twice or cannot be used, a number is not finite, or
        shapes do not fit.
    """

    name: str
    equations: Mapping[str, sp.Expr]
    parameters: tuple[Parameter, ...] = ()
    guess: Mapping[str, float] = field(default_factory=dict)
    elements: tuple[FractionalElement, ...] = ()
    outputs: Mapping[str, sp.Expr] = field(default_factory=dict)
    mass: sp.Matrix | None = None
    derived: tuple[DerivedParameter, ...] = ()
    units: Mapping[str, str] = field(default_factory=dict)
    descriptions: Mapping[str, str] = field(default_factory=dict)
    title: str = ""
    source: str = ""
    variant: str = ""
    variants: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    band: tuple[float, float] = (0.1, 100.0)
    inputs: tuple[str, ...] = ()
    terms: Mapping[str, sp.Expr] = field(default_factory=dict)
    external: External | None = None
    time_unit: str = SECONDS

    def __post_init__(self) -> None:
        """Make the fields immutable and sympy's, and check that the parts fit together."""
        import sympy as sp

        freeze = object.__setattr__
        for key in ("parameters", "elements", "derived", "notes", "inputs"):
            freeze(self, key, tuple(getattr(self, key)))
        for key in ("equations", "outputs", "terms"):
            mapping = {k: _expression(self.name, k, v) for k, v in dict(getattr(self, key)).items()}
            freeze(self, key, mapping)
        freeze(self, "elements", tuple(_element(self.name, e) for e in self.elements))
        derived = (
            replace(d, expression=_expression(self.name, d.name, d.expression))
            for d in self.derived
        )
        freeze(self, "derived", tuple(derived))
        if self.mass is not None:
            freeze(self, "mass", sp.ImmutableMatrix(self.mass))
        self._check_names()
        self._check_parts()
        self._check_numbers()
        self._check_symbols()

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the states, in the order of the equations."""
        return tuple(self.equations)

    def _repr_html_(self) -> str:
        """Return what a notebook shows."""
        from racs_bif.symbolic.metadata import describe
        from racs_bif.symbolic.shown import model_card

        return model_card(describe(self))

    def _check_names(self) -> None:
        names = [*self.equations, *(p.name for p in self.parameters)]
        names += [e.output for e in self.elements] + [d.name for d in self.derived]
        names += [*self.outputs, *self.terms]
        seen: set[str] = set()
        for name in names:
            if not isinstance(name, str) or not name.isidentifier() or name in GRAMMAR:
                msg = f"model '{self.name}': '{name}' cannot be a name; use letters, digits and _"
                raise ModelError(msg)
            if name in seen:
                msg = f"model '{self.name}': the name '{name}' is used twice; rename one of them"
                raise ModelError(msg)
            seen.add(name)
        if LAPLACE in seen and self.elements:
            msg = f"model '{self.name}': '{LAPLACE}' is the Laplace variable of the laws; rename it"
            raise ModelError(msg)

    def _check_parts(self) -> None:
        n = len(self.equations)
        if n + len(self.elements) == 0:
            msg = f"model '{self.name}' has no equations; give at least one state or element"
            raise ModelError(msg)
        if self.mass is not None and self.mass.shape != (n, n):
            msg = (
                f"model '{self.name}': the mass matrix is {self.mass.shape}, "
                f"it must be ({n}, {n}) for {n} states"
            )
            raise ModelError(msg)
        base = [p.name for p in self.parameters]
        for derived in self.derived:
            if derived.sets not in base:
                msg = (
                    f"model '{self.name}': derived parameter '{derived.name}' sets "
                    f"'{derived.sets}', which is no parameter; {nearest(derived.sets, base)}"
                )
                raise ModelError(msg)
        for name in self.inputs:
            if name not in base:
                msg = f"model '{self.name}': input '{name}' is no parameter; {nearest(name, base)}"
                raise ModelError(msg)
        known = [*self.states, *(e.output for e in self.elements)]
        for name in self.guess:
            if name not in known:
                hint = nearest(name, known)
                msg = f"model '{self.name}': guess for unknown state '{name}'; {hint}"
                raise ModelError(msg)

    def _check_numbers(self) -> None:
        numbers: dict[str, object] = {f"guess of '{k}'": value for k, value in self.guess.items()}
        for p in self.parameters:
            if not isinstance(p.default, Calibration):
                numbers[f"default of '{p.name}'"] = p.default
        for what, value in numbers.items():
            if not isinstance(value, Real) or not math.isfinite(float(value)):
                msg = f"model '{self.name}': the {what} is {value!r}, it must be a finite number"
                raise ModelError(msg)
        unit: object = self.time_unit
        if not isinstance(unit, str):
            msg = (
                f"model '{self.name}': the unit of time is {unit!r}; give a word such as 's', or ''"
            )
            raise ModelError(msg)
        low, high = self.band
        if not 0.0 < low < high < math.inf:
            msg = f"model '{self.name}': band {low:g} .. {high:g} rad/s; give 0 < LOW < HIGH"
            raise ModelError(msg)

    def _check_symbols(self) -> None:
        base = {p.name for p in self.parameters}
        inner = base | set(self.states) | {e.output for e in self.elements}
        places: list[tuple[str, sp.Expr, set[str]]] = []
        for name, expression in self.terms.items():
            places.append((f"term '{name}'", expression, set(inner)))
            inner.add(name)
        places += [(f"equation of '{k}'", v, inner) for k, v in self.equations.items()]
        places += [(f"output '{k}'", v, inner) for k, v in self.outputs.items()]
        places += [(f"input of '{e.output}'", e.input, inner) for e in self.elements]
        places += [(f"law of '{e.output}'", e.law, base | {LAPLACE}) for e in self.elements]
        places += [(f"derived '{d.name}'", d.expression, base) for d in self.derived]
        if self.mass is not None:
            places += [("mass matrix", entry, base | set(self.states)) for entry in self.mass]
        for place, expression, allowed in places:
            for symbol in sorted(expression.free_symbols, key=str):
                if symbol.name not in allowed:
                    msg = (
                        f"model '{self.name}': unknown symbol '{symbol.name}' in the {place}; "
                        f"{nearest(symbol.name, sorted(allowed))}"
                    )
                    raise ModelError(msg)


def _element(model: str, element: FractionalElement) -> FractionalElement:
    return FractionalElement(
        element.output,
        _expression(model, f"input of {element.output}", element.input),
        _expression(model, f"law of {element.output}", element.law),
    )


def _expression(model: str, place: str, value: object) -> sp.Expr:
    import sympy as sp

    try:
        expression = sp.sympify(value, strict=True)
    except (sp.SympifyError, TypeError):
        expression = None
    if not isinstance(expression, sp.Expr) or expression.is_Matrix:
        msg = f"model '{model}': '{place}' is {type(value).__name__}, it must be a sympy expression"
        raise ModelError(msg)
    return expression


def find_parameter(name: str, known: Iterable[str]) -> str:
    """Return `name` if it is known.

    Raises
    ------
    ParameterError
        If it is not, with the nearest name.
    """
    names = list(known)
    if name not in names:
        same = unicodedata.normalize("NFKC", name)
        hint = f"write its letters as in '{same}'" if same in names else nearest(name, names)
        msg = f"unknown parameter '{name}'; {hint}"
        raise ParameterError(msg)
    return name
