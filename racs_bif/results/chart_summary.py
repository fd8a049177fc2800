"""The summary of a stability chart as JSON; the keys are a promise, more may be added."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from racs_bif.results.chart import Chart, describe_count
from racs_bif.results.chart_slices import ChartSlices
from racs_bif.results.summary import SCHEMA, to_json

if TYPE_CHECKING:
    from collections.abc import Sequence

    from racs_bif.results.chart import ChartBoundary, ChartRegion, Reals
    from racs_bif.results.chart_map import ChartMap
    from racs_bif.results.summary import Json

GRID: Final = 200
"""Cells each way of the grid that the cost of a chart is compared with."""


def summarise_chart(
    result: Chart | ChartSlices, command: Sequence[str], version: str
) -> dict[str, Json]:
    """Return the summary of a chart, or of slices.

    Parameters
    ----------
    result : Chart or ChartSlices
        What to summarise; of slices, boundaries and regions are under ``slices``.
    command : sequence of str
        The arguments it was computed with.
    version : str
        The racs_bif that computed it.
    """
    chart = result.charts[0] if isinstance(result, ChartSlices) else result
    system = chart.system
    whole: dict[str, object] = {
        "schema": SCHEMA,
        "version": version,
        "command": list(command),
        "model": system.model,
        "variant": system.variant,
        "parameters": dict(system.parameters),
        "units": dict(system.units),
        "realisation": None,
        "operator": chart.operator,
        "notes": list(system.notes),
        "plane": list(chart.parameters),
        "spans": dict(zip(chart.parameters, map(list, chart.spans), strict=True)),
    }
    if isinstance(result, ChartSlices):
        whole["slices"] = [
            {"parameters": {result.parameter: value}, **_chart(one)}
            for value, one in zip(result.values, result, strict=True)
        ]
    else:
        whole |= _chart(chart)
    return {key: to_json(value) for key, value in whole.items()}


def _chart(chart: Chart) -> dict[str, object]:
    grid = round(chart.per_count * GRID**2)
    told: dict[str, object] = {
        "boundaries": [_boundary(chart, boundary) for boundary in chart.boundaries],
        "regions": [_region(chart, region) for region in chart.regions],
        "cost": {
            "evaluations": chart.evaluations,
            "counts": len(chart.node_counts),
            "seconds": chart.seconds,
            "grid": {"cells": [GRID, GRID], "evaluations": grid},
        },
        "search": {"depth": chart.depth, "smallest_island": chart.smallest_island},
        "curves": [
            {
                "kind": curve.kind,
                "name": curve.name,
                "stopped": curve.stopped,
                "points": [{"parameters": _named(chart, values)} for values in curve.values],
            }
            for curve in chart.curves
        ],
        "unexplained": chart.unexplained,
        "troubles": list(chart.troubles),
        "remarks": list(chart.remarks),
        "map": None,
    }
    if chart.map is not None:
        told["map"] = _map(chart.map)
    return told


def _map(found: ChartMap) -> dict[str, object]:
    told: dict[str, object] = {
        "quantity": found.quantity,
        "cells": list(found.unstable.shape),
        "unknown": found.unknown,
        "evaluations": found.evaluations,
    }
    sweep = found.sweep
    if sweep is not None:
        known = sweep.value[np.isfinite(sweep.value)]
        told |= {
            "watch": sweep.watch,
            "duration": sweep.duration,
            "tolerance": sweep.tolerance,
            "start": dict(sweep.start),
            "status": sweep.tally,
            "least": float(known.min()) if len(known) else None,
            "greatest": float(known.max()) if len(known) else None,
        }
    return told


def _boundary(chart: Chart, boundary: ChartBoundary) -> dict[str, object]:
    points = []
    for values, omega, l1 in zip(boundary.values, boundary.omega, boundary.l1, strict=True):
        point: dict[str, object] = {"parameters": _named(chart, values), "omega": float(omega)}
        if np.isfinite(l1):  # it was asked for
            point |= {"l1": float(l1), "criticality": "subcritical" if l1 > 0 else "supercritical"}
        points.append(point)
    return {
        "kind": boundary.kind,
        "closed": boundary.closed,
        "complete": boundary.complete,
        "stopped": boundary.stopped,
        "points": points,
        "special_points": [
            {"label": p.label, "parameters": dict(p.parameters), **p.data} for p in boundary.points
        ],
    }


def _region(chart: Chart, region: ChartRegion) -> dict[str, object]:
    return {
        "unstable": region.unstable if region.unstable >= 0 else None,
        "told": describe_count(region.unstable),
        "area": region.area,
        "at": _named(chart, region.place),
        "nodes": region.nodes,
        "disagreeing": region.disagreeing,
    }


def _named(chart: Chart, values: Reals) -> dict[str, float]:
    return dict(zip(chart.parameters, map(float, values), strict=True))
