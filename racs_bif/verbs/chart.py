"""Stability charts of planes of two parameters."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import numpy as np

from racs_bif.charts.backends import choose_backend
from racs_bif.charts.maps import QUANTITIES, MapJob
from racs_bif.charts.pieces import own_pieces
from racs_bif.charts.plane import Plane
from racs_bif.charts.regions import regions
from racs_bif.charts.running import run_map
from racs_bif.charts.search import Search, search
from racs_bif.charts.settings import ChartSettings
from racs_bif.errors import UsageError, nearest
from racs_bif.numerics.threads import single_threaded
from racs_bif.results.chart import (
    BoundaryPoint,
    Chart,
    ChartBoundary,
    ChartMap,
    ChartRegion,
)
from racs_bif.results.chart_slices import ChartSlices
from racs_bif.results.provenance import describe
from racs_bif.shelf.load import system_of
from racs_bif.verbs.equilibria import check_span

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path

    from racs_bif.charts.backends import Backend
    from racs_bif.charts.boundary import Boundary
    from racs_bif.charts.regions import Region
    from racs_bif.fractional.system import System
    from racs_bif.symbolic.field import Array
    from racs_bif.symbolic.model import Model

    Span = tuple[float, float]
    Progress = Callable[[str, int, int], None]


@single_threaded
def stability_chart(  # noqa: PLR0913 - each is one choice of the user's
    model: Model | System,
    first: str,
    second: str,
    spans: tuple[Span, Span],
    *,
    at: Mapping[str, float] | None = None,
    marks: Mapping[str, Sequence[float]] | None = None,
    lyapunov: bool = False,
    quantity: str | None = None,
    shape: tuple[int, int] = (200, 200),
    workers: int = 0,
    scheduler: str | None = None,
    tiles: Path | None = None,
    resume: bool = False,
    settings: ChartSettings | None = None,
    progress: Progress | None = None,
) -> Chart:
    """Draw up the stability chart of a plane, on the exact characteristic equation.

    Boundaries are continued, not painted: a quadtree of counts only finds where to begin, and that
    nothing is missing. Regions say how many roots are unstable.

    Parameters
    ----------
    model : Model or System
        What the chart is of.
    first, second : str
        The parameters of the plane, base or derived.
    spans : ((float, float), (float, float))
        Their intervals, SI.
    at : mapping of str to float, optional
        Values of other parameters.
    marks : mapping of str to sequence of float, optional
        Values of `first` or `second` at which boundary points are wanted exactly, labelled UZ.
    lyapunov : bool
        Compute the first Lyapunov coefficient along Hopf boundaries, and the GH points where it
        changes sign.
    quantity : {"count", "damping"}, optional
        A map over the plane: the number of unstable roots, or the rightmost root besides.
    shape : (int, int)
        Cells of the map.
    workers : int
        Processes of this machine that compute the map; 0 computes it here. A script that asks for
        them needs ``if __name__ == "__main__":``.
    scheduler : str, optional
        Address of a Dask scheduler that computes the map instead.
    tiles : Path, optional
        Folder for finished tiles of the map.
    resume : bool
        Go on with the tiles there.
    settings : ChartSettings, optional
        How finely the plane is searched.
    progress : callable, optional
        Called with what is done, how much of it, and of how much.

    Returns
    -------
    Chart

    Raises
    ------
    UsageError
        If the parameters are the same, a span is empty, or a choice is not there.
    ParameterError
        If a parameter is unknown, or a span leaves the model's validity.
    ConvergenceError
        If no equilibrium is found anywhere in the plane.

    Examples
    --------
    >>> import racs_bif as rb
    >>> mine = rb.model_from_strings(
    ...     "mine", {"x": "v", "v": "-x - (a**2 + b**2 - 1)*v"}, parameters={"a": 0.0, "b": 0.0}
    ... )
    >>> chart = rb.stability_chart(mine, "a", "b", spans=((-2, 2), (-2, 2)))
    >>> chart.boundaries[0].closed, chart.unstable_at(a=0, b=0), chart.unstable_at(a=1, b=1)
    (True, 2, 0)
    """
    began = time.perf_counter()
    system, plane = _plane(model, (first, second), spans, at or {})
    backend = choose_backend(workers, scheduler)
    if quantity is not None and quantity not in QUANTITIES:
        msg = f"unknown map '{quantity}'; {nearest(quantity, QUANTITIES)}"
        raise UsageError(msg)
    _check_marks(plane, marks or {})
    tell = progress or (lambda _what, _done, _of: None)
    found = search(
        plane,
        settings or ChartSettings(),
        lyapunov=lyapunov,
        marks=marks,
        progress=lambda what: tell(what, 0, 0),
    )
    pieces = [piece for b in found.boundaries for piece in own_pieces(found.lattice, b)]
    parts = regions(found.lattice, pieces)
    chart_map = None
    if quantity is not None:
        job = MapJob.over(found.lattice, shape, quantity)
        chart_map = _map(job, backend, tiles, tell, resume=resume)
    nodes = list(found.lattice.nodes.values())
    counted = [node for node in nodes if node.count >= 0]
    return Chart(
        parameters=(first, second),
        spans=plane.spans,
        boundaries=tuple(_boundary(plane, piece) for piece in pieces),
        regions=tuple(_region(plane, part) for part in parts),
        node_values=plane.values(np.array([node.place for node in nodes]).T).T,
        node_counts=np.array([node.count for node in nodes], dtype=np.int64),
        system=describe(system),
        map=chart_map,
        unexplained=len(found.unexplained),
        torn=found.torn,
        evaluations=found.evaluations,
        per_count=found.lattice.counter.evaluations / max(len(counted), 1),
        troubles=_troubles(found, parts),
        seconds=time.perf_counter() - began,
    )


def chart_slices(
    model: Model | System,
    first: str,
    second: str,
    spans: tuple[Span, Span],
    slices: tuple[str, Sequence[float]],
    *,
    at: Mapping[str, float] | None = None,
    tiles: Path | None = None,
    **options: Any,  # noqa: ANN401 - those of `stability_chart`
) -> ChartSlices:
    """Draw up charts of the same plane at several values of a third parameter.

    Parameters
    ----------
    model, first, second, spans, at, tiles, **options
        See `stability_chart`; every slice has its own folder of tiles.
    slices : (str, sequence of float)
        The third parameter and its values, SI.

    Raises
    ------
    UsageError
        If the third parameter is one of the plane's, or no value or one value twice is given.
    """
    name, values = slices
    if name in {first, second} or name in (at or {}):
        msg = f"'{name}' is held or varied already; slice along another parameter"
        raise UsageError(msg)
    if not values or len(set(values)) < len(values):
        msg = f"slices along '{name}' need values that differ, such as {name}=10,15,20"
        raise UsageError(msg)
    charts = [
        stability_chart(
            model,
            first,
            second,
            spans,
            at={**(at or {}), name: value},
            tiles=None if tiles is None else tiles / f"{name}={value:.12g}",
            **options,
        )
        for value in values
    ]
    return ChartSlices(parameter=name, charts=tuple(charts))


def _plane(
    model: Model | System,
    names: tuple[str, str],
    spans: tuple[Span, Span],
    at: Mapping[str, float],
) -> tuple[System, Plane]:
    system = system_of(model)
    if names[0] == names[1]:
        msg = f"a chart needs two different parameters, not '{names[0]}' twice"
        raise UsageError(msg)
    low, high = (check_span(system, n, s) for n, s in zip(names, spans, strict=True))
    for name in at:
        if name in names:
            msg = f"'{name}' is varied, it cannot be held as well; leave it out"
            raise UsageError(msg)
    system = system.with_parameters(at) if at else system
    system.path(*names)  # refuses two that move the same
    return system, Plane(system, names, (low, high))


def _check_marks(plane: Plane, marks: Mapping[str, Sequence[float]]) -> None:
    spans = dict(zip(plane.names, plane.spans, strict=True))
    for name, values in marks.items():
        if name not in spans:
            msg = f"points can be wanted at values of {' or '.join(plane.names)}, not of '{name}'"
            raise UsageError(msg)
        low, high = spans[name]
        for value in values:
            if not low <= value <= high:
                msg = f"{name} = {value:g} is outside its span {low:g} to {high:g}; widen the span"
                raise UsageError(msg)


def _map(
    job: MapJob, backend: Backend, tiles: Path | None, tell: Progress, *, resume: bool
) -> ChartMap:
    whole = run_map(
        job,
        backend,
        folder=tiles,
        resume=resume,
        progress=lambda done, of: tell("map", done, of),
    )
    nothing = np.full(job.shape, np.nan)
    return ChartMap(
        quantity=job.quantity,
        unstable=whole["unstable"].astype(np.int8),
        sigma=np.asarray(whole.get("sigma", nothing), dtype=float),
        omega=np.asarray(whole.get("omega", nothing), dtype=float),
        evaluations=int(whole["evaluations"].sum()),
    )


def _boundary(plane: Plane, boundary: Boundary) -> ChartBoundary:
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


def _region(plane: Plane, region: Region) -> ChartRegion:
    return ChartRegion(
        unstable=region.count,
        area=region.face.area,
        place=plane.values(region.place),
        loops=tuple(_values(plane, loop) for loop in region.face.loops),
        nodes=region.nodes,
        disagreeing=region.disagreeing,
    )


def _values(plane: Plane, places: Array) -> Array:
    return np.ascontiguousarray(plane.values(places.T).T)


def _troubles(found: Search, parts: tuple[Region, ...]) -> tuple[str, ...]:
    """Return what a user must know before trusting the chart."""
    troubles = list(dict.fromkeys(found.troubles))
    if found.unexplained:
        troubles.append(
            f"counts differ in {len(found.unexplained)} places for no boundary that was found; "
            "raise the depth of the search"
        )
    wrong = sum(part.disagreeing for part in parts)
    if wrong:
        troubles.append(f"{wrong} places have another count than the region they are in")
    return tuple(troubles)
