"""Maps over stability charts as trees of named numbers, for files."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.results.chart_map import STATUS, ChartMap, SweepMap
from racs_bif.results.tree import Attribute, Node, Variable, real_array
from racs_bif.units import rate_unit

if TYPE_CHECKING:
    from racs_bif.results.chart import Chart

_AXES: Final = ("first", "second")
_START: Final = "start."


def encode_map(chart: Chart, chart_map: ChartMap) -> Node:
    """Return a map as a tree that `decode_map` turns back into the same."""
    node = Node({"quantity": chart_map.quantity, "evaluations": chart_map.evaluations})
    for axis, name, span, n in zip(
        _AXES, chart.parameters, chart.spans, chart_map.unstable.shape, strict=True
    ):
        middles = span[0] + (np.arange(n) + 0.5) / n * (span[1] - span[0])
        about: dict[str, Attribute] = {"long_name": name, "units": chart.system.unit(name)}
        node.variables[axis] = Variable((axis,), middles, about)
    node.variables["unstable"] = Variable(
        _AXES, chart_map.unstable, {"long_name": "number of unstable roots; -1 unknown, -2 none"}
    )
    if chart_map.quantity == "damping":
        node.variables["sigma"] = Variable(
            _AXES, chart_map.sigma, {"units": rate_unit(chart.system.time_unit)}
        )
        node.variables["omega"] = Variable(
            _AXES, chart_map.omega, {"units": chart.system.frequency_unit}
        )
    if chart_map.sweep is not None:
        node.groups["sweep"] = _encode_sweep(chart_map.sweep, chart_map.unit(chart.system))
    return node


def decode_map(node: Node) -> ChartMap:
    """Return the map that `encode_map` made a tree of."""
    unstable = node.variables["unstable"].data.astype(np.int8)
    nothing = np.full(unstable.shape, np.nan)
    known = node.variables
    return ChartMap(
        quantity=str(node.attributes["quantity"]),
        unstable=unstable,
        sigma=real_array(known["sigma"]) if "sigma" in known else nothing,
        omega=real_array(known["omega"]) if "omega" in known else nothing.copy(),
        evaluations=int(str(node.attributes["evaluations"])),
        sweep=_decode_sweep(node.groups["sweep"]) if "sweep" in node.groups else None,
    )


def _encode_sweep(sweep: SweepMap, unit: str) -> Node:
    told: dict[str, Attribute] = {
        "watch": sweep.watch,
        "duration": sweep.duration,
        "tolerance": sweep.tolerance,
    }
    told |= {f"{_START}{name}": value for name, value in sweep.start.items()}
    meanings = "; ".join(f"{k} {text}" for k, text in enumerate(STATUS))
    return Node(
        told,
        {
            "value": Variable(_AXES, sweep.value, {"units": unit}),
            "error": Variable(_AXES, sweep.error, {"units": unit}),
            "status": Variable(_AXES, sweep.status, {"long_name": meanings}),
        },
    )


def _decode_sweep(node: Node) -> SweepMap:
    return SweepMap(
        value=real_array(node.variables["value"]),
        error=real_array(node.variables["error"]),
        status=node.variables["status"].data.astype(np.int8),
        watch=str(node.attributes["watch"]),
        duration=float(str(node.attributes["duration"])),
        tolerance=float(str(node.attributes["tolerance"])),
        start={
            name.removeprefix(_START): float(str(value))
            for name, value in node.attributes.items()
            if name.startswith(_START)
        },
    )
