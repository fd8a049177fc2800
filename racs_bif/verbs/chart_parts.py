"""What a search found as the data of a chart."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from racs_bif.results.chart import BoundaryPoint, ChartBoundary, ChartRegion

if TYPE_CHECKING:
    from racs_bif.charts.boundary import Boundary
    from racs_bif.charts.plane import Plane
    from racs_bif.charts.regions import Region
    from racs_bif.charts.search import Search
    from racs_bif.symbolic.field import Array


def boundary_of(plane: Plane, boundary: Boundary) -> ChartBoundary:
    """Return a boundary in the parameters' units."""
    return ChartBoundary(
        kind=boundary.kind,
        values=boundary.values,
        omega=boundary.omega,
        l1=boundary.l1,
        line=_values(plane, boundary.line),
        closed=boundary.closed,
        complete=boundary.complete,
        stopped=boundary.stopped,
        points=tuple(
            BoundaryPoint(
                label=point.label,
                parameters=dict(zip(plane.names, map(float, point.values), strict=True)),
                data=point.data,
            )
            for point in boundary.special
        ),
    )


def region_of(plane: Plane, region: Region) -> ChartRegion:
    """Return a region in the parameters' units."""
    return ChartRegion(
        unstable=region.count,
        area=region.face.area,
        place=plane.values(region.place),
        loops=tuple(_values(plane, loop) for loop in region.face.loops),
        nodes=region.nodes,
        disagreeing=region.disagreeing,
    )


def troubles_of(found: Search, parts: tuple[Region, ...]) -> tuple[str, ...]:
    """Return what a user must know before trusting the chart."""
    troubles = list(dict.fromkeys(found.troubles))
    if found.unexplained:
        troubles.append(
            f"counts differ in {len(found.unexplained)} places for no boundary that was found; "
            "raise the depth of the search"
        )
    wrong = sum(part.disagreeing for part in parts)
    if wrong:
        other = f", and in {found.torn} another equilibrium than beside them" if found.torn else ""
        troubles.append(f"{wrong} places have another count than the region they are in{other}")
    return tuple(troubles)


def _values(plane: Plane, places: Array) -> Array:
    return np.ascontiguousarray(plane.values(places.T).T)
