"""Time histories as trees of named numbers, for files."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.results.decode import decode_system
from racs_bif.results.encode import TIME, encode_system
from racs_bif.results.history import TimeHistory
from racs_bif.results.tree import Attribute, Node, Variable, real_array

if TYPE_CHECKING:
    from numpy.typing import NDArray

GROUP: Final = "history"
"""Name of the group in a file, and of its content."""
_WORDS: Final = ("operator", "method", "history", "stopped")
_ROLES: Final = ("state", "output", "input")


def encode_history(history: TimeHistory) -> Node:
    """Return a time history as a tree that `decode_history` turns back into the same."""
    node = Node(attributes={name: getattr(history, name) for name in _WORDS})
    node.attributes |= {
        "title": f"time history of {history.system.model}",
        "step": history.step,
        "order": history.order,
        "extrapolated": int(history.extrapolated),
        "early": int(history.early),
    }
    node.variables[TIME] = Variable((TIME,), history.times, {"units": history.system.time_unit})
    states = dict(zip(history.state_names, history.states.T, strict=True))
    for role, columns in zip(_ROLES, (states, history.outputs, history.inputs), strict=True):
        for place, (name, column) in enumerate(columns.items()):
            attributes: dict[str, Attribute] = {
                "units": history.system.unit(name),
                "long_name": name,
                "role": role,
                "place": place,
            }
            if name in history.errors:
                attributes["error"] = history.errors[name]
            own = f"{name}_" if name == TIME else name
            node.variables[own] = Variable((TIME,), np.ascontiguousarray(column), attributes)
    node.groups["system"] = encode_system(history.system)
    return node


def decode_history(node: Node) -> TimeHistory:
    """Return the time history that `encode_history` made a tree of."""
    columns = {role: _columns(node, role) for role in _ROLES}
    times = real_array(node.variables[TIME])
    states = np.array(list(columns["state"].values())).reshape(-1, len(times)).T
    named = [(str(v.attributes["long_name"]), v) for v in _ordered(node)]
    return TimeHistory(
        times=times,
        state_names=tuple(columns["state"]),
        states=np.ascontiguousarray(states),
        outputs=columns["output"],
        inputs=columns["input"],
        system=decode_system(node.groups["system"]),
        operator=str(node.attributes["operator"]),
        method=str(node.attributes["method"]),
        history=str(node.attributes["history"]),
        stopped=str(node.attributes["stopped"]),
        step=_number(node.attributes["step"]),
        order=_number(node.attributes["order"]),
        errors={n: _number(v.attributes["error"]) for n, v in named if "error" in v.attributes},
        extrapolated=bool(node.attributes["extrapolated"]),
        early=bool(node.attributes["early"]),
    )


def _ordered(node: Node) -> list[Variable]:
    """Return the columns in the order in which they were stored."""
    found = [v for v in node.variables.values() if "role" in v.attributes]
    return sorted(
        found,
        key=lambda v: (_ROLES.index(str(v.attributes["role"])), _number(v.attributes["place"])),
    )


def _columns(node: Node, role: str) -> dict[str, NDArray[np.float64]]:
    return {
        str(v.attributes["long_name"]): real_array(v)
        for v in _ordered(node)
        if v.attributes["role"] == role
    }


def _number(value: Attribute) -> float:
    return float(value) if isinstance(value, int | float) else float("nan")
