"""Branches from trees of named numbers."""

from __future__ import annotations

from dataclasses import replace
from operator import itemgetter

import numpy as np

from racs_bif.results.branch import Branch, Profile
from racs_bif.results.encode import DATA, EIGENVALUES, SETTING, SPECTRA, TIME
from racs_bif.results.provenance import RealisationInfo, SystemInfo
from racs_bif.results.saved import Saved
from racs_bif.results.special import ExactPoint, SpecialPoint, Value
from racs_bif.results.tree import (
    Node,
    Variable,
    complex_array,
    numbers,
    real_array,
    words,
    words_array,
)
from racs_bif.units import SECONDS


def decode_branch(node: Node) -> Branch:
    """Return the branch that `encode.encode_branch` made a tree of."""
    kind = str(node.attributes["kind"])
    count = len(node.variables["arclength"].data)
    parameters, values = _columns(node, "parameter", count)
    state_names, states = _columns(node, "state", count)
    measure_names, measures = _columns(node, "measure", count)
    special = node.groups.get("special_points", Node())
    profiles = node.groups.get("profiles", Node())
    samples = node.groups.get("samples", Node())
    branch = Branch(
        name=str(node.attributes["name"]),
        kind=kind,
        parameters=parameters,
        values=values,
        arclength=real_array(node.variables["arclength"]),
        stable=node.variables["stable"].data.astype(bool),
        unstable=node.variables["unstable"].data.astype(np.int64),
        spectrum=complex_array(node.variables[SPECTRA.get(kind, EIGENVALUES)]),
        labels=words_array(node.variables["label"]),
        stopped=str(node.attributes["stopped"]),
        early=bool(node.attributes["early"]),
        connected=bool(node.attributes["connected"]),
        system=decode_system(node.groups["system"]),
        state_names=state_names,
        states=states,
        measures=dict(zip(measure_names, np.ascontiguousarray(measures.T), strict=True)),
        special=tuple(_decode_special(special.groups[name]) for name in _order(special)),
        method=str(node.attributes["method"]),
        profiles={name: _decode_profile(profiles.groups[name]) for name in _order(profiles)},
        samples={int(k): _decode_profile(samples.groups[k]) for k in _order(samples)},
    )
    if not branch.profiles:
        return branch
    # an orbit can be found again from its profile
    origins = {name: Saved(branch, name) for name in branch.profiles}
    return replace(
        branch, special=tuple(replace(p, origin=origins.get(p.name)) for p in branch.special)
    )


def decode_system(node: Node) -> SystemInfo:
    """Return the system that `encode.encode_system` made a tree of."""
    text = {key: str(node.attributes[key]) for key in ("model", "title", "variant", "version")}
    realisation = None
    if "realisation" in node.groups:
        how = node.groups["realisation"]
        low, high = how.variables["band"].data
        realisation = RealisationInfo(
            name=str(how.attributes["name"]),
            states=_integer(how, "states"),
            band=(float(low), float(high)),
            error=_real(how, "error"),
            settings={
                name.removeprefix(SETTING): value
                for name, value in how.attributes.items()
                if name.startswith(SETTING) and isinstance(value, int | float)
            },
        )
    values = node.variables["parameter_value"].data.tolist()
    units = zip(
        words_array(node.variables["unit_of"]), words_array(node.variables["unit"]), strict=True
    )
    return SystemInfo(
        **text,
        states=words(node.attributes.get("states")),
        notes=words(node.attributes.get("notes")),
        parameters=dict(zip(words_array(node.variables["parameter_name"]), values, strict=True)),
        units=dict(units),
        shown=str(node.attributes["shown"]),
        realisation=realisation,
        loaded=str(node.attributes.get("loaded", "")),
        equations=str(node.attributes.get("equations", "")),
        time_unit=str(node.attributes.get("time_unit", SECONDS)),
    )


def _decode_special(node: Node) -> SpecialPoint:
    found: dict[str, Value] = {}
    for name, value in node.attributes.items():
        if name.startswith(DATA) and not isinstance(value, tuple):
            found[name.removeprefix(DATA)] = value
    found |= {name: _decode_array(variable) for name, variable in node.variables.items()}
    exact = None
    if "exact_omega" in node.attributes:
        exact = ExactPoint(
            parameters=_numbered(node, "exact_parameter"),
            omega=_real(node, "exact_omega"),
            shift=_numbered(node, "exact_shift"),
            l1=_real(node, "exact_l1") if "exact_l1" in node.attributes else None,
        )
    return SpecialPoint(
        label=str(node.attributes["label"]),
        name=str(node.attributes["name"]),
        branch=str(node.attributes["branch"]),
        index=_integer(node, "index"),
        parameters=_numbered(node, "parameter"),
        state=_numbered(node, "state"),
        data=found,
        exact=exact,
    )


def _decode_profile(node: Node) -> Profile:
    states = node.variables["states"]
    return Profile(
        times=real_array(node.variables[TIME]),
        names=words(states.attributes.get("names")),
        states=real_array(states),
    )


def _decode_array(variable: Variable) -> Value:
    dtype = np.dtype(str(variable.attributes["dtype"]))
    if dtype.kind == "c":
        array: np.ndarray = complex_array(variable).astype(dtype)
    else:
        array = variable.data.astype(dtype)
    if variable.attributes["type"] == "array":
        return array
    value: Value = array.item()
    return value


def _numbered(node: Node, name: str) -> dict[str, float]:
    names = words(node.attributes.get(f"{name}_names"))
    return dict(zip(names, numbers(node.attributes.get(f"{name}_values")), strict=True))


def _columns(node: Node, role: str, count: int) -> tuple[tuple[str, ...], np.ndarray]:
    found = []
    for variable in node.variables.values():
        if variable.attributes.get("role") == role:
            place, name = variable.attributes["place"], str(variable.attributes["long_name"])
            found.append((place, name, real_array(variable)))
    found.sort(key=itemgetter(0))
    names = tuple(name for _, name, _ in found)
    columns = [column for _, _, column in found]
    return names, np.column_stack(columns) if columns else np.empty((count, 0))


def _order(node: Node) -> tuple[str, ...]:
    return words(node.attributes.get("order"))


def _integer(node: Node, name: str) -> int:
    return int(node.attributes[name])  # type: ignore[arg-type]


def _real(node: Node, name: str) -> float:
    return float(node.attributes[name])  # type: ignore[arg-type]
