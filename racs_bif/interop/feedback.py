"""Feedback put around a model: parameters become expressions of what is measured."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from graphlib import CycleError, TopologicalSorter
from typing import TYPE_CHECKING, TypeAlias

from racs_bif.errors import ModelError, nearest
from racs_bif.fractional.system import System
from racs_bif.shelf import find, load_module
from racs_bif.symbolic.model import Calibration, FractionalElement, Model, Parameter
from racs_bif.symbolic.strings import parse

if TYPE_CHECKING:
    from collections.abc import Sequence

    import sympy as sp

    from racs_bif.symbolic.model import DerivedParameter

    Law: TypeAlias = "str | sp.Expr | Mapping[str, float]"
    """An expression as text or sympy's, or gains by what they multiply."""


def with_feedback(
    model: Model | System,
    laws: Mapping[str, Law] | None = None,
    *,
    parameters: Mapping[str, float] | None = None,
    forces: Mapping[str, str | sp.Expr] | None = None,
    inputs: Sequence[str] = (),
    name: str = "",
) -> Model:
    """Return a model whose parameters are driven by its own states, or whose equations are.

    Parameters
    ----------
    model : Model or System
        The open loop. Of a system its parameter values become the defaults.
    laws : mapping of str to expression or gains, optional
        By the name of a base parameter: the expression, a string or sympy's, that replaces it. It
        may use states, outputs of the model and of its elements, and parameters, the one replaced
        among them, which then remains as the reference: ``{"T": "T - k*w"}``. A mapping of numbers
        is a row of gains, ``u = u - K x`` as `control.lqr` has it: ``{"T": {"w": 300.0}}`` is
        ``T - k_T_w*w`` with the new parameter k_T_w = 300.
    parameters : mapping of str to float, optional
        New parameters and their default values.
    forces : mapping of str to expression, optional
        By the name of a state: what is added to the right-hand side of its equation, before the
        mass matrix is inverted.
    inputs : sequence of str
        Parameters that are inputs from now on, besides those that already are.
    name : str
        Of the new model; the old one with ``_feedback`` where left out.

    Returns
    -------
    Model
        An ordinary model: it is continued, simulated and linearised like any other, and whatever is
        fractional in it stays exact.

    Raises
    ------
    ModelError
        If a name is unknown or taken, a parameter is part of an element's law or of a derived
        parameter, an output that is fed back depends on what is replaced without delay, a default
        is still to be calibrated, or the equations are not to be had as expressions.

    Examples
    --------
    >>> import racs_bif as rb
    >>> pendulum = rb.model_from_strings(
    ...     "pendulum", {"x": "y", "y": "sin(x) + T"}, parameters={"T": 0.0})
    >>> held = rb.with_feedback(pendulum, {"T": {"x": 2.0, "y": 1.0}})
    >>> held.equations["y"]
    T - k_T_x*x - k_T_y*y + sin(x)
    """
    base = symbolic(model)
    if base.external is not None:
        msg = (
            f"model '{base.name}': its equations are a Python function that is called, which "
            "feedback cannot be put into; write them as expressions"
        )
        raise ModelError(msg)
    table = dict(parameters or {})
    replaced = {k: _expression(base, k, law, table) for k, law in dict(laws or {}).items()}
    added = {k: _parsed(e) for k, e in dict(forces or {}).items()}
    _check(base, replaced, added)
    outputs = dict(base.outputs)
    for law in replaced.values():
        _refuse_loops(base, replaced, law)
    swap = {k: _swapped(e, outputs) for k, e in replaced.items()}
    equations = {
        k: _swapped(e + _swapped(added.get(k, 0 * e), outputs), swap)
        for k, e in base.equations.items()
    }
    elements = tuple(
        FractionalElement(e.output, _swapped(e.input, swap), e.law) for e in base.elements
    )
    kept = {s.name for e in swap.values() for s in e.free_symbols}
    gone = {k for k in swap if k not in kept}
    there = tuple(p for p in base.parameters if p.name not in gone)
    return replace(
        base,
        name=name or f"{base.name}_feedback",
        equations=equations,
        elements=elements,
        outputs={k: _swapped(e, swap) for k, e in outputs.items()},
        terms=_in_order({k: _swapped(e, swap) for k, e in base.terms.items()}),
        mass=None if base.mass is None else base.mass.applyfunc(lambda e: _swapped(e, swap)),
        parameters=(*there, *(Parameter(k, float(v)) for k, v in table.items())),
        inputs=(*(i for i in base.inputs if i not in gone), *inputs),
    )


def _in_order(terms: dict[str, sp.Expr]) -> dict[str, sp.Expr]:
    """Return terms so that each uses earlier ones only.

    Raises
    ------
    ModelError
        If the law made them depend on one another.
    """
    used = {k: {symbol.name for symbol in e.free_symbols} for k, e in terms.items()}
    before = {k: [name for name in terms if name in used[k]] for k in terms}
    try:
        return {k: terms[k] for k in TopologicalSorter(before).static_order()}
    except CycleError as error:
        loop = " -> ".join(error.args[1])
        msg = (
            f"the feedback closes an algebraic loop: {loop}; feed back a state, or an output of it"
        )
        raise ModelError(msg) from None


def symbolic(model: Model | System) -> Model:
    """Return the symbolic model of a system, its parameter values as defaults.

    Raises
    ------
    ModelError
        If the system was made in Python, so that no file tells its equations, or a default of a
        model is still to be calibrated.
    """
    if not isinstance(model, System):
        for parameter in model.parameters:
            if isinstance(parameter.default, Calibration):
                msg = (
                    f"model '{model.name}': the default of '{parameter.name}' is to be calibrated, "
                    "which feedback would change; give the system that load_model returns"
                )
                raise ModelError(msg)
        return model
    if not model.loaded:
        msg = (
            f"system '{model.name}' was made in Python and does not keep its equations; give the "
            "Model that it was made of"
        )
        raise ModelError(msg)
    build = load_module(find("models", model.loaded)).model
    found: Model = build(variant=model.variant) if model.variant else build()
    values = tuple(
        replace(p, default=float(value))
        for p, value in zip(found.parameters, model.values, strict=True)
    )
    return replace(found, parameters=values)


def _expression(model: Model, name: str, law: Law, table: dict[str, float]) -> sp.Expr:
    if not isinstance(law, Mapping):
        return _parsed(law)
    known = [*model.states, *model.outputs, *(e.output for e in model.elements)]
    text = name
    for measured, gain in law.items():
        if measured not in known:
            hint = nearest(measured, known)
            msg = f"model '{model.name}': '{measured}' cannot be fed back to '{name}'; {hint}"
            raise ModelError(msg)
        table[f"k_{name}_{measured}"] = float(gain)
        text += f" - k_{name}_{measured}*{measured}"
    return parse(text)


def _parsed(law: str | sp.Expr) -> sp.Expr:
    return parse(law) if isinstance(law, str) else law


def _check(model: Model, laws: Mapping[str, sp.Expr], forces: Mapping[str, sp.Expr]) -> None:
    base = [p.name for p in model.parameters]
    for names, known, what in ((laws, base, "parameter"), (forces, model.states, "state")):
        for name in names:
            if name not in known:
                msg = f"model '{model.name}': unknown {what} '{name}'; {nearest(name, known)}"
                raise ModelError(msg)
    for element in model.elements:
        _refuse(model, laws, element.law, f"the law of '{element.output}'")
    for derived in model.derived:
        where = f"the derived parameter '{derived.name}'"
        _refuse(model, laws, derived.expression, where, derived)


def _refuse(
    model: Model,
    laws: Mapping[str, sp.Expr],
    expression: sp.Expr,
    where: str,
    derived: DerivedParameter | None = None,
) -> None:
    used = {symbol.name for symbol in expression.free_symbols}
    used |= {derived.sets} if derived else set()
    for name in laws:
        if name in used:
            msg = (
                f"model '{model.name}': '{name}' is part of {where}, which is constant in time; "
                "feed back to another parameter"
            )
            raise ModelError(msg)


def _refuse_loops(model: Model, laws: Mapping[str, sp.Expr], law: sp.Expr) -> None:
    """Refuse an output that depends at once on what is being replaced."""
    for used in sorted(s.name for s in law.free_symbols if s.name in model.outputs):
        for name in _names(model, model.outputs[used]) & set(laws):
            msg = (
                f"model '{model.name}': output '{used}' depends on '{name}' without delay, so that "
                "feeding it back closes an algebraic loop; feed back a state"
            )
            raise ModelError(msg)


def _names(model: Model, expression: sp.Expr) -> set[str]:
    """Return the names in an expression, and in the terms that it uses."""
    names = {symbol.name for symbol in expression.free_symbols}
    for term, meaning in reversed(list(model.terms.items())):
        if term in names:
            names |= {symbol.name for symbol in meaning.free_symbols}
    return names


def _swapped(expression: sp.Expr, by_name: Mapping[str, sp.Expr]) -> sp.Expr:
    """Return an expression with symbols replaced by name, all at once."""
    table = {s: by_name[s.name] for s in expression.free_symbols if s.name in by_name}
    return expression.xreplace(table) if table else expression
