"""Stability charts of planes of two parameters."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from racs_bif.charts.backends import InProcess, choose_backend
from racs_bif.charts.pieces import own_pieces
from racs_bif.charts.regions import regions
from racs_bif.charts.search import search
from racs_bif.charts.settings import ChartSettings
from racs_bif.errors import UsageError
from racs_bif.numerics.threads import single_threaded
from racs_bif.results.chart import Chart
from racs_bif.results.chart_slices import ChartSlices
from racs_bif.results.provenance import describe
from racs_bif.shelf.load import system_of
from racs_bif.verbs.chart_map import MapRequest, SweepSettings, compute_map
from racs_bif.verbs.chart_parts import boundary_of, region_of, troubles_of
from racs_bif.verbs.chart_plane import check_marks, curves_over, plane_of

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path

    from racs_bif.fractional.system import System
    from racs_bif.results.branch import Branch
    from racs_bif.results.chart_curve import ChartCurve
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
    operator: str = "exact",
    curves: Sequence[Branch | ChartCurve] = (),
    quantity: str | None = None,
    shape: tuple[int, int] = (200, 200),
    sweep: SweepSettings | None = None,
    workers: int = 0,
    scheduler: str | None = None,
    tiles: Path | None = None,
    resume: bool = False,
    settings: ChartSettings | None = None,
    progress: Progress | None = None,
) -> Chart:
    """Draw up the stability chart of a plane, on the characteristic equation.

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
    operator : {"exact", "realised"}
        Whose characteristic equation: that of the fractional operators themselves, or of the
        filters that realise them. Simulations are always of the realised one.
    curves : sequence of Branch or ChartCurve, optional
        Curves in this plane to draw and save with it, such as the folds of cycles that
        `racs_bif.continue_curve` follows.
    quantity : {"count", "damping", "amplitude", "lyapunov", "periods"}, optional
        A map over the plane: the number of unstable roots; the rightmost root besides; or, by a
        simulation in every cell, the amplitude of what it settles on, its largest Lyapunov
        exponent, or in how many crossings of a Poincare section it repeats.
    shape : (int, int)
        Cells of the map.
    sweep : SweepSettings, optional
        What is simulated.
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
    plane = plane_of(model, (first, second), spans, at or {}, operator)
    backend = choose_backend(workers, scheduler)
    wanted = None
    if quantity is not None:
        wanted = MapRequest(quantity, shape, sweep or SweepSettings())
        wanted.check(plane.system)
    check_marks(plane, marks or {})
    over = curves_over(plane, curves)
    settings = settings or ChartSettings()
    tell = progress or (lambda _what, _done, _of: None)
    found = search(
        plane,
        settings,
        lyapunov=lyapunov,
        marks=marks,
        progress=lambda what: tell(what, 0, 0),
    )
    pieces = [piece for b in found.boundaries for piece in own_pieces(found.lattice, b)]
    parts = regions(found.lattice, pieces)
    chart_map = None
    if wanted is not None:
        job = wanted.job(found.lattice, pieces)
        chart_map = compute_map(job, backend, tiles, tell, resume=resume)
    nodes = list(found.lattice.nodes.values())
    counted = [node for node in nodes if node.count >= 0]
    return Chart(
        parameters=(first, second),
        spans=plane.spans,
        boundaries=tuple(boundary_of(plane, piece) for piece in pieces),
        regions=tuple(region_of(plane, part) for part in parts),
        node_values=plane.values(np.array([node.place for node in nodes]).T).T,
        node_counts=np.array([node.count for node in nodes], dtype=np.int64),
        system=describe(plane.system),
        map=chart_map,
        curves=over,
        operator=operator,
        depth=settings.depth,
        unexplained=len(found.unexplained),
        torn=found.torn,
        evaluations=found.evaluations,
        per_count=found.lattice.counter.evaluations / max(len(counted), 1),
        troubles=troubles_of(found, parts),
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
        See `stability_chart`; every slice has its own folder of tiles. Workers, or a scheduler,
        compute slices side by side, and maps tile by tile where these are asked for.
    slices : (str, sequence of float)
        The third parameter and its values, SI.

    Returns
    -------
    ChartSlices
        One chart for each value, in their order.

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
    if options.get("curves"):
        msg = "curves hold at one value of every other parameter; leave them out of slices"
        raise UsageError(msg)
    job = _Slices(
        system=system_of(model),
        names=(first, second),
        spans=spans,
        parameter=name,
        values=tuple(values),
        at=dict(at or {}),
        tiles=tiles,
        options=dict(options),
    )
    if options.get("quantity") is not None:
        # The backend computes the maps, one after another.
        return ChartSlices(parameter=name, charts=tuple(map(job.compute, range(len(values)))))
    backend = choose_backend(job.options.pop("workers", 0), job.options.pop("scheduler", None))
    tell = None if isinstance(backend, InProcess) else job.options.pop("progress", None)
    done: dict[int, Chart] = {}
    for index, chart in backend.run(job, range(len(values))):
        done[index] = chart
        if tell is not None:
            tell("slices", len(done), len(values))
    return ChartSlices(parameter=name, charts=tuple(done[k] for k in range(len(values))))


@dataclass(frozen=True, kw_only=True)
class _Slices:
    """Charts at several values of a third parameter, as tasks for a backend."""

    system: System
    names: tuple[str, str]
    spans: tuple[Span, Span]
    parameter: str
    values: tuple[float, ...]
    at: dict[str, float]
    tiles: Path | None
    options: dict[str, Any]

    def compute(self, index: int) -> Chart:
        """Draw up one chart."""
        value = self.values[index]
        folder = None if self.tiles is None else self.tiles / f"{self.parameter}={value:.12g}"
        return stability_chart(
            self.system,
            *self.names,
            self.spans,
            at={**self.at, self.parameter: value},
            tiles=folder,
            **self.options,
        )
