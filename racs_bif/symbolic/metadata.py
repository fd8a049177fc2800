"""What a compiled model tells of itself without sympy: names, units, sources, printed equations."""

from __future__ import annotations

from typing import Any

from racs_bif.symbolic.model import Calibration, Model, Parameter


def describe(model: Model) -> dict[str, Any]:
    """Return a literal (strings, numbers, lists, dicts) that describes a model."""
    mass = None
    if model.mass is not None:
        mass = [[str(e) for e in model.mass.row(i)] for i in range(model.mass.rows)]
    return facts(model) | {
        "outputs": {name: str(e) for name, e in model.outputs.items()},
        "equations": {name: str(e) for name, e in model.equations.items()},
        "terms": {name: str(e) for name, e in model.terms.items()},
        "mass": mass,
    }


def facts(model: Model) -> dict[str, Any]:
    """Return `describe` without what grows with the model and takes seconds: printed equations."""
    return {
        "name": model.name,
        "title": model.title,
        "source": model.source,
        "variant": model.variant,
        "variants": dict(model.variants),
        "notes": list(model.notes),
        "band": [float(bound) for bound in model.band],
        "states": list(model.states),
        "inputs": list(model.inputs),
        "time_unit": model.time_unit,
        "external": None if model.external is None else model.external.facts,
        "units": dict(model.units),
        "descriptions": dict(model.descriptions),
        "guess": {name: float(value) for name, value in model.guess.items()},
        "parameters": [_parameter(p) for p in model.parameters],
        "derived": [
            {
                "name": d.name,
                "expression": str(d.expression),
                "sets": d.sets,
                "unit": d.unit,
                "description": d.description,
                "source": d.source,
                "valid": _interval(d.valid),
            }
            for d in model.derived
        ],
        "elements": [
            {"output": e.output, "input": str(e.input), "law": str(e.law)} for e in model.elements
        ],
        "input_states": [
            str(e.input) if str(e.input) in model.states else "" for e in model.elements
        ],
    }


def _parameter(parameter: Parameter) -> dict[str, Any]:
    default: Any = parameter.default
    if isinstance(default, Calibration):
        default = {
            "parameter": default.parameter,
            "hopf": {name: float(value) for name, value in default.hopf.items()},
            "span": [float(bound) for bound in default.span],
            "options": dict(default.options),
        }
    else:
        default = float(default)
    return {
        "name": parameter.name,
        "default": default,
        "unit": parameter.unit,
        "description": parameter.description,
        "source": parameter.source,
        "valid": _interval(parameter.valid),
    }


def _interval(valid: tuple[float, float]) -> list[float | None]:
    """Write infinite bounds as None, so that the text stays a literal."""
    return [bound if abs(bound) < float("inf") else None for bound in map(float, valid)]
