"""Branches as trees of named numbers, for files."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.results.tree import (
    COMPLEX,
    Attribute,
    Node,
    Variable,
    complex_variable,
    words_variable,
)
from racs_bif.units import SECONDS

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from racs_bif.results.branch import Branch, Profile
    from racs_bif.results.provenance import SystemInfo
    from racs_bif.results.special import SpecialPoint

POINT, TIME, ROOT = "point", "time", "root"
"""Dimensions: points along a branch, time along an orbit, eigenvalues or multipliers."""
DATA = "data."
"""What the names of attributes begin with that a detector found."""
SETTING = "setting."
"""What the names of attributes begin with that are settings of a realisation."""
SPECTRA = {"orbit": "multipliers"}
"""What the spectrum of a kind of branch is called, where it is not eigenvalues."""
EIGENVALUES = "eigenvalues"
FIXED = ("arclength", "stable", "unstable", "label", EIGENVALUES, *SPECTRA.values())
"""Columns that every branch has; a parameter or state of the same name gives way."""


def encode_branch(branch: Branch) -> Node:
    """Return a branch as a tree that `decode.decode_branch` turns back into the same."""
    node = Node(
        attributes={
            "name": branch.name,
            "kind": branch.kind,
            "stopped": branch.stopped,
            "early": int(branch.early),
            "connected": int(branch.connected),
            "method": branch.method,
            "title": f"{branch.kind} branch {branch.name} of {branch.system.model}",
        }
    )
    node.variables = {
        "arclength": Variable((POINT,), branch.arclength, {"long_name": "scaled arclength"}),
        "stable": Variable((POINT,), branch.stable.astype(np.int8), {"long_name": "1: stable"}),
        "unstable": Variable(
            (POINT,), branch.unstable, {"long_name": "number of unstable roots, -1: not known"}
        ),
        "label": words_variable(POINT, branch.labels),
        SPECTRA.get(branch.kind, EIGENVALUES): complex_variable((POINT, ROOT), branch.spectrum),
    }
    columns = [("parameter", name, branch.values[:, k]) for k, name in enumerate(branch.parameters)]
    columns += [("state", name, branch.states[:, k]) for k, name in enumerate(branch.state_names)]
    columns += [("measure", name, column) for name, column in branch.measures.items()]
    _add_columns(node, columns, branch.system)
    node.groups["system"] = encode_system(branch.system)
    special = {point.name: _encode_special(point) for point in branch.special}
    if special:
        names = tuple(special)
        node.groups["special_points"] = Node({"order": names}, groups=special)
    profiles = {name: _encode_profile(p, branch.system) for name, p in branch.profiles.items()}
    if profiles:
        node.groups["profiles"] = Node({"order": tuple(profiles)}, groups=profiles)
    samples = {str(k): _encode_profile(p, branch.system) for k, p in branch.samples.items()}
    if samples:
        node.groups["samples"] = Node({"order": tuple(samples)}, groups=samples)
    return node


def encode_system(system: SystemInfo) -> Node:
    """Return a system as a tree that `decode.decode_system` turns back into the same."""
    node = Node(
        attributes={
            "model": system.model,
            "title": system.title,
            "variant": system.variant,
            "shown": system.shown,
            "version": system.version,
            "loaded": system.loaded,
            "equations": system.equations,
            # left out where it is the one of all files before there was a choice
            **({} if system.time_unit == SECONDS else {"time_unit": system.time_unit}),
            **_listed("states", system.states),
            **_listed("notes", system.notes),
        }
    )
    node.variables = {
        "parameter_name": words_variable("parameter", tuple(system.parameters)),
        "parameter_value": Variable(("parameter",), _numbers(system.parameters.values())),
        "unit_of": words_variable("quantity", tuple(system.units)),
        "unit": words_variable("quantity", tuple(system.units.values())),
    }
    if system.realisation is not None:
        how = system.realisation
        node.groups["realisation"] = Node(
            {
                "name": how.name,
                "states": how.states,
                "error": how.error,
                **{f"{SETTING}{name}": value for name, value in how.settings.items()},
            },
            {"band": Variable(("end",), _numbers(how.band), {"units": system.frequency_unit})},
        )
    return node


def _encode_special(point: SpecialPoint) -> Node:
    node = Node(
        attributes={
            "label": point.label,
            "name": point.name,
            "branch": point.branch,
            "index": point.index,
            **_numbered("parameter", point.parameters),
            **_numbered("state", point.state),
        }
    )
    if point.exact is not None:
        node.attributes["exact_omega"] = point.exact.omega
        if point.exact.l1 is not None:
            node.attributes["exact_l1"] = point.exact.l1
        node.attributes |= _numbered("exact_parameter", point.exact.parameters)
        node.attributes |= _numbered("exact_shift", point.exact.shift)
    for name, value in point.data.items():
        if isinstance(value, np.ndarray | complex):
            node.variables[name] = _encode_array(point, name, value)
        else:
            node.attributes[f"{DATA}{name}"] = value
    return node


def _encode_array(point: SpecialPoint, name: str, value: np.ndarray | complex) -> Variable:
    array = np.asarray(value)
    kind = "array" if isinstance(value, np.ndarray) else "number"
    attributes: dict[str, Attribute] = {"type": kind, "dtype": array.dtype.str}
    dimensions = tuple(f"{name}_{axis}" for axis in range(array.ndim))
    if array.dtype.kind == "c":
        return complex_variable(dimensions, array.astype(complex), attributes)
    if array.dtype.kind == "b":
        return Variable(dimensions, array.astype(np.int8), attributes)
    if array.dtype.kind in "iuf":
        return Variable(dimensions, array, attributes)
    msg = f"{point.name}: '{name}' holds {array.dtype}, a file takes numbers and words"
    raise TypeError(msg)


def _encode_profile(profile: Profile, system: SystemInfo) -> Node:
    units = tuple(system.unit(name) for name in profile.names)
    attributes = _listed("names", profile.names) | _listed("units", units)
    return Node(
        variables={
            TIME: Variable((TIME,), profile.times, {"units": system.time_unit}),
            "states": Variable((TIME, "state"), profile.states, attributes),
        }
    )


def _numbered(name: str, values: Mapping[str, float]) -> dict[str, Attribute]:
    """Return names and numbers as two attributes; none where there are none."""
    if not values:
        return {}
    return {f"{name}_names": tuple(values), f"{name}_values": tuple(values.values())}


def _add_columns(
    node: Node, columns: Iterable[tuple[str, str, np.ndarray]], system: SystemInfo
) -> None:
    for place, (role, name, column) in enumerate(columns):
        attributes: dict[str, Attribute] = {
            "units": system.unit(name),
            "long_name": name,
            "role": role,
            "place": place,
        }
        free = _variable_name(name, node)
        node.variables[free] = Variable((POINT,), np.ascontiguousarray(column), attributes)


def _variable_name(name: str, node: Node) -> str:
    free = re.sub(r"\W", "_", name)
    while free in node.variables or free in (*FIXED, POINT, TIME, ROOT, COMPLEX):
        free += "_"
    return free


def _listed(name: str, texts: tuple[str, ...]) -> dict[str, Attribute]:
    return {name: texts} if texts else {}


def _numbers(values: Iterable[float]) -> np.ndarray:
    return np.array(list(values), dtype=float)
