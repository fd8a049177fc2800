"""Stability charts as trees of named numbers, for files."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.results.chart import (
    BoundaryPoint,
    Chart,
    ChartBoundary,
    ChartRegion,
)
from racs_bif.results.chart_curve import ChartCurve
from racs_bif.results.chart_map_tree import decode_map, encode_map
from racs_bif.results.chart_slices import ChartSlices
from racs_bif.results.decode import decode_system
from racs_bif.results.encode import encode_system
from racs_bif.results.tree import Attribute, Node, Variable, numbers, real_array, words

if TYPE_CHECKING:
    from numpy.typing import NDArray

CHART: Final = "chart"
SLICES: Final = "slices"
"""What a file of charts holds: one, or several slices."""
_AXES: Final = ("first", "second")
_POINT: Final = "point"


def encode_charts(result: Chart | ChartSlices) -> Node:
    """Return one chart or several slices as a tree."""
    charts = result.charts if isinstance(result, ChartSlices) else (result,)
    node = Node({"content": CHART, "charts": len(charts)})
    if isinstance(result, ChartSlices):
        node.attributes |= {"content": SLICES, "slices_of": result.parameter}
    node.groups = {f"chart{k + 1}": encode_chart(chart) for k, chart in enumerate(charts)}
    return node


def decode_charts(node: Node) -> Chart | ChartSlices:
    """Return what `encode_charts` made a tree of."""
    charts = [decode_chart(node.groups[f"chart{k + 1}"]) for k in range(_whole(node, "charts"))]
    if node.attributes["content"] == CHART:
        return charts[0]
    return ChartSlices(parameter=str(node.attributes["slices_of"]), charts=tuple(charts))


def encode_chart(chart: Chart) -> Node:
    """Return a chart as a tree that `decode_chart` turns back into the same."""
    node = Node(
        attributes={
            "title": f"stability chart of {chart.system.model}",
            "parameters": chart.parameters,
            "first_span": chart.spans[0],
            "second_span": chart.spans[1],
            "unexplained": chart.unexplained,
            "torn": chart.torn,
            "evaluations": chart.evaluations,
            "per_count": chart.per_count,
            "boundaries": len(chart.boundaries),
            "regions": len(chart.regions),
            "operator": chart.operator,
            "depth": chart.depth,
            "curves": len(chart.curves),
        }
    )
    if chart.troubles:
        node.attributes["troubles"] = chart.troubles
    node.variables = _places(chart, "node", chart.node_values)
    node.variables["node_unstable"] = Variable(
        ("node",), chart.node_counts, {"long_name": "number of unstable roots"}
    )
    node.groups["system"] = encode_system(chart.system)
    for k, boundary in enumerate(chart.boundaries):
        node.groups[f"boundary{k + 1}"] = _encode_boundary(chart, boundary)
    for k, region in enumerate(chart.regions):
        node.groups[f"region{k + 1}"] = _encode_region(chart, region)
    if chart.map is not None:
        node.groups["map"] = encode_map(chart, chart.map)
    for k, curve in enumerate(chart.curves):
        told: dict[str, Attribute] = {
            "kind": curve.kind,
            "name": curve.name,
            "stopped": curve.stopped,
        }
        node.groups[f"curve{k + 1}"] = Node(told, _places(chart, _POINT, curve.values))
    return node


def decode_chart(node: Node) -> Chart:
    """Return the chart that `encode_chart` made a tree of."""
    parameters = words(node.attributes["parameters"])
    spans = [numbers(node.attributes[f"{axis}_span"]) for axis in _AXES]
    return Chart(
        parameters=(parameters[0], parameters[1]),
        spans=((spans[0][0], spans[0][1]), (spans[1][0], spans[1][1])),
        boundaries=tuple(
            _decode_boundary(node.groups[f"boundary{k + 1}"], parameters)
            for k in range(_whole(node, "boundaries"))
        ),
        regions=tuple(
            _decode_region(node.groups[f"region{k + 1}"]) for k in range(_whole(node, "regions"))
        ),
        node_values=_values(node, "node"),
        node_counts=node.variables["node_unstable"].data.astype(np.int64),
        system=decode_system(node.groups["system"]),
        map=decode_map(node.groups["map"]) if "map" in node.groups else None,
        curves=tuple(
            _decode_curve(node.groups[f"curve{k + 1}"])
            for k in range(int(str(node.attributes.get("curves", 0))))
        ),
        operator=str(node.attributes.get("operator", "exact")),
        depth=int(str(node.attributes.get("depth", 0))),
        unexplained=_whole(node, "unexplained"),
        torn=_whole(node, "torn"),
        evaluations=_whole(node, "evaluations"),
        per_count=_real(node, "per_count"),
        troubles=words(node.attributes.get("troubles")),
    )


def _encode_boundary(chart: Chart, boundary: ChartBoundary) -> Node:
    node = Node(
        attributes={
            "kind": boundary.kind,
            "closed": int(boundary.closed),
            "complete": int(boundary.complete),
            "stopped": boundary.stopped,
            "named_points": len(boundary.points),
        }
    )
    node.variables = _places(chart, _POINT, boundary.values) | _places(chart, "line", boundary.line)
    node.variables["omega"] = Variable(
        (_POINT,), boundary.omega, {"units": chart.system.frequency_unit}
    )
    node.variables["l1"] = Variable(
        (_POINT,), boundary.l1, {"long_name": "first Lyapunov coefficient"}
    )
    for k, point in enumerate(boundary.points):
        values: dict[str, Attribute] = {f"data.{name}": v for name, v in point.data.items()}
        node.groups[f"point{k + 1}"] = Node(
            {"label": point.label, "values": tuple(point.parameters.values()), **values}
        )
    return node


def _decode_boundary(node: Node, parameters: tuple[str, ...]) -> ChartBoundary:
    points = []
    for k in range(_whole(node, "named_points")):
        told = node.groups[f"point{k + 1}"].attributes
        points.append(
            BoundaryPoint(
                label=str(told["label"]),
                parameters=dict(zip(parameters, numbers(told["values"]), strict=True)),
                data={
                    name.removeprefix("data."): float(value)
                    for name, value in told.items()
                    if name.startswith("data.") and isinstance(value, int | float)
                },
            )
        )
    return ChartBoundary(
        kind=str(node.attributes["kind"]),
        values=_values(node, _POINT),
        omega=real_array(node.variables["omega"]),
        l1=real_array(node.variables["l1"]),
        line=_values(node, "line"),
        closed=bool(node.attributes["closed"]),
        complete=bool(node.attributes["complete"]),
        stopped=str(node.attributes["stopped"]),
        points=tuple(points),
    )


def _encode_region(chart: Chart, region: ChartRegion) -> Node:
    node = Node(
        attributes={
            "unstable": region.unstable,
            "area": region.area,
            "place": tuple(map(float, region.place)),
            "nodes": region.nodes,
            "disagreeing": region.disagreeing,
            "loops": len(region.loops),
        }
    )
    for k, loop in enumerate(region.loops):
        node.variables |= _places(chart, f"loop{k + 1}", loop)
    return node


def _decode_region(node: Node) -> ChartRegion:
    return ChartRegion(
        unstable=_whole(node, "unstable"),
        area=_real(node, "area"),
        place=np.array(numbers(node.attributes["place"])),
        loops=tuple(_values(node, f"loop{k + 1}") for k in range(_whole(node, "loops"))),
        nodes=_whole(node, "nodes"),
        disagreeing=_whole(node, "disagreeing"),
    )


def _decode_curve(node: Node) -> ChartCurve:
    return ChartCurve(
        kind=str(node.attributes["kind"]),
        name=str(node.attributes["name"]),
        values=_values(node, _POINT),
        stopped=str(node.attributes["stopped"]),
    )


def _places(chart: Chart, dimension: str, values: NDArray[np.float64]) -> dict[str, Variable]:
    """Return both parameters along a dimension."""
    return {
        f"{dimension}_{axis}": Variable(
            (dimension,),
            np.ascontiguousarray(values[:, k]),
            {"long_name": name, "units": chart.system.unit(name)},
        )
        for k, (axis, name) in enumerate(zip(_AXES, chart.parameters, strict=True))
    }


def _values(node: Node, dimension: str) -> NDArray[np.float64]:
    return np.column_stack([real_array(node.variables[f"{dimension}_{axis}"]) for axis in _AXES])


def _whole(node: Node, name: str) -> int:
    return int(node.attributes[name])  # type: ignore[arg-type] # as it was written


def _real(node: Node, name: str) -> float:
    return float(node.attributes[name])  # type: ignore[arg-type] # as it was written
