"""The summary of a diagram as JSON: what a program, or a person in a hurry, wants of it.

The keys are a promise; more may be added. Numbers are SI; what is not a number is null.
"""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.results.atomic import write_text
from racs_bif.results.stability import stretches

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from racs_bif.results.branch import Branch
    from racs_bif.results.diagram import Diagram
    from racs_bif.results.special import ExactPoint, SpecialPoint

SCHEMA = 1
Json = None | bool | int | float | str | list["Json"] | dict[str, "Json"]


def summarise(diagram: Diagram, command: Sequence[str], version: str) -> dict[str, Json]:
    """Return the summary of a diagram.

    Parameters
    ----------
    diagram : Diagram
        Branches of one system.
    command : sequence of str
        The arguments it was computed with.
    version : str
        The racs_bif that computed it.

    Returns
    -------
    dict
        Of the schema in design.md: ``schema, version, command, model, variant, parameters,
        realisation, branches, special_points, orbits``, and beside these ``notes``, ``units`` and
        ``equilibria``, the operating points among equilibria as ``orbits`` has those among orbits.
    """
    system = diagram.branches[0].system
    how = system.realisation
    named = [point for point in diagram.special_points if point.label not in {"EP", "MX"}]
    whole: dict[str, object] = {
        "schema": SCHEMA,
        "version": version,
        "command": list(command),
        "model": system.model,
        "variant": system.variant,
        "parameters": dict(system.parameters),
        "units": dict(system.units),
        "realisation": None
        if how is None
        else {
            "name": how.name,
            "states": how.states,
            "band": list(how.band),
            "error": how.error,
        },
        "notes": list(system.notes),
        "branches": [_branch(branch) for branch in diagram],
        "special_points": [_special(point) for point in named],
        "equilibria": [
            _operating(branch, k) | _equilibrium(branch, k)
            for branch in diagram
            if branch.kind == "equilibrium"
            for k in _marked(branch)
        ],
        "orbits": [
            _operating(branch, k) | _orbit(branch, k)
            for branch in diagram
            if branch.kind == "orbit"
            for k in _marked(branch)
        ],
    }
    return {key: to_json(value) for key, value in whole.items()}


def to_json(value: object) -> Json:
    """Turn numbers, words, arrays, mappings and sequences into what JSON can hold.

    NaN and infinity become null, complex numbers pairs.

    Raises
    ------
    TypeError
        If the value is of another kind.

    Examples
    --------
    >>> to_json({"l1": float("nan"), "multipliers": [1 + 2j]})
    {'l1': None, 'multipliers': [[1.0, 2.0]]}
    """
    if value is None or isinstance(value, bool | str | int):
        return value
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    if isinstance(value, complex):
        return [to_json(value.real), to_json(value.imag)]
    if isinstance(value, np.ndarray | np.generic):
        return to_json(value.tolist())
    if isinstance(value, dict):
        return {str(key): to_json(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [to_json(item) for item in value]
    msg = f"JSON has no {type(value).__name__}"
    raise TypeError(msg)


def to_text(summary: Mapping[str, Json]) -> str:
    """Return a summary as JSON text."""
    return json.dumps(summary, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def curve_points(curve: Branch) -> list[Json]:
    """Return the points of a curve in two parameters: where, frequency, l1 and other measures.

    Those of a curve of cycles have a period instead, and the coefficient of their normal form.
    """
    known = ("omega", "l1", "neutral", "period", "angle", "c", "Re d")
    names = [name for name in known if name in curve.measures]
    points: list[Json] = []
    for k, label in enumerate(curve.labels):
        point: dict[str, object] = {"curve": curve.name, "parameters": _parameters(curve, k)}
        point |= {name: float(curve.measures[name][k]) for name in names}
        points.append(to_json(point | {"label": label}))
    return points


def write_summary(summary: Mapping[str, Json], path: Path) -> None:
    """Write a summary, whole or not at all.

    Raises
    ------
    FileError
        If it cannot be written there.
    """
    write_text(path, to_text(summary))


def _branch(branch: Branch) -> dict[str, object]:
    return {
        "name": branch.name,
        "kind": branch.kind,
        "parameters": list(branch.parameters),
        "points": len(branch),
        "stopped": branch.stopped,
        "early": branch.early,
        "connected": branch.connected,
        "method": branch.method,
        "stability": [
            {
                "from": _parameters(branch, part.first),
                "to": _parameters(branch, part.last),
                "unstable": None if part.kind == "unknown" else part.unstable,
            }
            for part in stretches(branch)
        ],
    }


def _special(point: SpecialPoint) -> dict[str, object]:
    found: dict[str, object] = {
        "label": point.label,
        "name": point.name,
        "branch": point.branch,
        "parameters": dict(point.parameters),
        "state": dict(point.state),
    }
    # What is found under these names too has its place above.
    found |= {key: value for key, value in point.data.items() if key not in found}
    found["exact"] = None if point.exact is None else _exact(point.exact)
    return found


def _exact(exact: ExactPoint) -> dict[str, object]:
    return {
        "parameters": dict(exact.parameters),
        "omega": exact.omega,
        "shift": dict(exact.shift),
        "l1": exact.l1,
    }


def _marked(branch: Branch) -> list[int]:
    last = len(branch) - 1
    return [k for k, label in enumerate(branch.labels) if label or k in {0, last}]


def _operating(branch: Branch, k: int) -> dict[str, object]:
    unstable = int(branch.unstable[k])
    end = "MX" if branch.early and k == len(branch) - 1 else "EP"
    names = [p.name for p in branch.special if p.index == k and p.label not in {"EP", "MX"}]
    return {
        "branch": branch.name,
        "name": names[0] if names else None,
        "label": branch.labels[k] or end,
        "parameters": _parameters(branch, k),
        "stable": None if unstable < 0 else bool(branch.stable[k]),
        "unstable": None if unstable < 0 else unstable,
    }


def _equilibrium(branch: Branch, k: int) -> dict[str, object]:
    own = branch.system.states or branch.state_names
    state = {name: float(column[k]) for name, column in branch.measures.items()}
    state |= zip(branch.state_names, branch.states[k].tolist(), strict=True)
    return {
        "state": {name: value for name, value in state.items() if name in own},
        "eigenvalues": _spectrum(branch, k),
    }


def _orbit(branch: Branch, k: int) -> dict[str, object]:
    measures = {name: float(column[k]) for name, column in branch.measures.items()}
    found: dict[str, object] = {"period": measures.pop("period", None)}
    for bound in ("max", "min"):
        start = f"{bound} "
        found[bound] = {
            name.removeprefix(start): value
            for name, value in measures.items()
            if name.startswith(start)
        }
    return found | {"multipliers": _spectrum(branch, k)}


def _spectrum(branch: Branch, k: int) -> list[complex]:
    row = branch.spectrum[k]
    roots: list[complex] = row[~np.isnan(row)].tolist()
    return roots


def _parameters(branch: Branch, k: int) -> dict[str, float]:
    return dict(zip(branch.parameters, branch.values[k].tolist(), strict=True))
