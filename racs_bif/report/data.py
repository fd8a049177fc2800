"""What the page draws: branches, spectra and orbits as numbers for its script."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from racs_bif.markup import with_unit
from racs_bif.plots.diagram import LOOKS, MARKERS
from racs_bif.plots.style import VERMILION
from racs_bif.report.names import axis_label, plain, symbol, unit
from racs_bif.report.vehicle import geometry, yaw_angle
from racs_bif.results.special import OPERATING
from racs_bif.results.stability import merged, stretches
from racs_bif.results.summary import Json, to_json
from racs_bif.units import frequency_unit, rate_unit

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from racs_bif.results.branch import Branch, Profile
    from racs_bif.results.diagram import Diagram

_DIGITS: Final = 10
_PROFILE_DIGITS: Final = 6
_SYMBOLS: Final = {"o": "circle", "s": "square", "D": "diamond", "^": "triangle-up"}
_SYMBOLS_MORE: Final = {"v": "triangle-down", "X": "x"}


def page_data(diagram: Diagram, shown: str) -> dict[str, Json]:
    """Return everything that the page's script draws.

    Parameters
    ----------
    diagram : Diagram
        Branches of one system.
    shown : str
        The quantity on the vertical axis to begin with.

    Returns
    -------
    dict
        ``branches``, ``names`` (how each quantity is written), ``shown``, ``vehicle`` (or null)
        and where the page ``begins``; numbers are SI, what is not a number is null.
    """
    system = diagram.branches[0].system
    vehicle = geometry(system)
    branches = [_branch(branch, swings=vehicle is not None) for branch in diagram]
    used = {name for branch in diagram for name in branch.parameters}
    used |= {name for told in branches for name in told["curves"]}
    used |= {name for branch in diagram for name in branch.state_names} | set(system.states)
    names = {
        name: {
            "axis": axis_label(name, system.unit(name)),
            "symbol": symbol(name),
            "text": plain(name),
            "unit": system.unit(name),
            "unit_html": unit(system.unit(name)),
        }
        for name in sorted(used)
    }
    whole = {
        "branches": branches,
        "names": names,
        "shown": shown,
        "states": list(system.states),
        "axes": {
            "time": with_unit("<i>t</i>", system.time_unit),
            "rate": with_unit("Re", rate_unit(system.time_unit)),
            "frequency": with_unit("Im", frequency_unit(system.time_unit)),
        },
        "time_unit": system.time_unit,
        "vehicle": vehicle,
        "begins": _begins(diagram),
    }
    return {key: to_json(value) for key, value in whole.items()}


def quantities(branch: Branch) -> dict[str, list[NDArray[np.float64]]]:
    """Return what may be on the vertical axis: a column, or the largest and smallest on orbits."""
    if branch.kind == "curve":
        return {branch.parameters[1]: [branch.values[:, 1]]}
    found: dict[str, list[NDArray[np.float64]]] = {}
    if branch.kind == "equilibrium":
        own = branch.system.states or branch.state_names
        found = {name: [branch.column(name)] for name in branch.state_names if name in own}
    for name, column in branch.measures.items():
        if name.startswith("max "):
            low = branch.measures.get(f"min {name[4:]}")
            found[name[4:]] = [column] if low is None else [column, low]
        elif not name.startswith("min "):
            found.setdefault(name, [column])
    return found


def _branch(branch: Branch, *, swings: bool) -> dict[str, Any]:
    look = LOOKS.get(branch.kind)
    active = dict(zip(branch.parameters, branch.values.T, strict=True))
    return {
        "name": branch.name,
        "kind": branch.kind,
        "cycles": branch.kind == "orbit" or "period" in branch.measures,
        "title": look.title if look else branch.method or branch.kind,
        "colour": look.colour if look else VERMILION,
        "parameter": branch.parameters[0],
        "active": {name: _rounded(column) for name, column in active.items()},
        "curves": {
            name: [_rounded(column) for column in columns]
            for name, columns in quantities(branch).items()
        },
        "states": {
            name: _rounded(branch.column(name))
            for name in branch.system.states
            if name in branch.state_names
        },
        "parts": [
            {"first": part.first, "last": part.last, "kind": part.kind}
            for part in merged(stretches(branch))
        ],
        "unstable": branch.unstable.tolist(),
        "spectrum": [_spectrum(row) for row in branch.spectrum],
        "special": [
            {
                "name": point.name,
                "label": point.label,
                "title": point.title,
                "index": point.index,
                "named": point.label not in OPERATING,
                "symbol": _marker(point.label),
            }
            for point in branch.special
            if point.index >= 0 and point.label not in {"EP", "MX"}
        ],
        "orbits": {str(k): _orbit(p, swings=swings) for k, p in kept_orbits(branch).items()},
    }


def kept_orbits(branch: Branch) -> dict[int, Profile]:
    """Return the orbits that were kept, at special points and along the branch, by their places."""
    places = {point.name: point.index for point in branch.special if point.index >= 0}
    kept = dict(branch.samples)
    kept |= {places[name]: p for name, p in branch.profiles.items() if name in places}
    return dict(sorted(kept.items()))


def _orbit(profile: Profile, *, swings: bool) -> dict[str, Any]:
    columns = dict(zip(profile.names, profile.states.T, strict=True))
    found: dict[str, Any] = {
        "times": _rounded(profile.times, _PROFILE_DIGITS),
        "states": {name: _rounded(column, _PROFILE_DIGITS) for name, column in columns.items()},
    }
    if swings and "w" in columns:
        found["yaw"] = _rounded(yaw_angle(profile), _PROFILE_DIGITS)
    return found


def _marker(label: str) -> str:
    if label == "UZ":
        return "circle-open"
    return (_SYMBOLS | _SYMBOLS_MORE)[MARKERS.get(label, "X")]


def _begins(diagram: Diagram) -> list[int]:
    """Return the branch and the point that the page shows first.

    The middle one of the orbits that were kept on the first branch that has any, else the first
    special point, else the first point.
    """
    for number, branch in enumerate(diagram):
        places = list(kept_orbits(branch))
        if places:
            return [number, places[len(places) // 2]]
    for number, branch in enumerate(diagram):
        for point in branch.special:
            if point.label not in OPERATING and point.index >= 0:
                return [number, point.index]
    return [0, 0]


def _spectrum(row: NDArray[np.complex128]) -> list[list[float]]:
    roots = row[np.isfinite(row)]
    return [[_short(root.real, 8), _short(root.imag, 8)] for root in roots.tolist()]


def _rounded(column: NDArray[np.float64], digits: int = _DIGITS) -> list[float]:
    return [_short(value, digits) for value in column.tolist()]


def _short(value: float, digits: int) -> float:
    return float(f"{value:.{digits}g}")
