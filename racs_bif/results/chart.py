"""A stability chart as data: boundaries, regions, and a map where there is one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from racs_bif.charts.faces import Face
from racs_bif.errors import UsageError
from racs_bif.results.same import same

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.axes import Axes

    from racs_bif.results.chart_curve import ChartCurve
    from racs_bif.results.chart_map import ChartMap
    from racs_bif.results.provenance import SystemInfo

Reals = NDArray[np.float64]
Span = tuple[float, float]
_EDGE = 1e-9


@dataclass(frozen=True, kw_only=True, eq=False)
class BoundaryPoint:
    """A point on a boundary that has a name.

    Parameters
    ----------
    label : str
        "GH", where the first Lyapunov coefficient changes sign, or "UZ", asked for.
    parameters : dict of str to float
        Where, SI.
    data : dict of str to float
        omega, l1, l2.
    """

    label: str
    parameters: Mapping[str, float]
    data: Mapping[str, float]

    def __eq__(self, other: object) -> bool:
        """Compare bit by bit."""
        return same(self, other) if isinstance(other, BoundaryPoint) else NotImplemented

    __hash__ = None  # type: ignore[assignment]


@dataclass(frozen=True, kw_only=True, eq=False)
class ChartBoundary:
    """A boundary, m points long, every one of them exact.

    Parameters
    ----------
    kind : {"hopf", "static", "fold", "singular"}
        A pair of roots crosses the imaginary axis, a real root crosses zero, the equilibrium ends
        in a fold, or the mass matrix is singular.
    values : array (m, 2)
        The two parameters, SI.
    omega : array (m,)
        Frequency of the critical pair [rad/s], NaN but on a Hopf boundary.
    l1 : array (m,)
        First Lyapunov coefficient [Kuznetsov: Re c1 / omega], NaN where not computed.
    line : array (k, 2)
        A smooth line through the points, parameters, SI: for pictures.
    closed : bool
        Whether it is a closed curve.
    complete : bool
        Whether it ends at the box, on another boundary, or is closed.
    stopped : str
        Why it ended.
    points : tuple of BoundaryPoint
        GH and UZ points.
    """

    kind: str
    values: Reals
    omega: Reals
    l1: Reals
    line: Reals
    closed: bool
    complete: bool
    stopped: str
    points: tuple[BoundaryPoint, ...] = ()

    def __len__(self) -> int:
        """Return the number of points."""
        return len(self.values)

    def __eq__(self, other: object) -> bool:
        """Compare bit by bit."""
        return same(self, other) if isinstance(other, ChartBoundary) else NotImplemented

    __hash__ = None  # type: ignore[assignment]


@dataclass(frozen=True, kw_only=True, eq=False)
class ChartRegion:
    """A region between boundaries.

    Parameters
    ----------
    unstable : int
        Number of unstable roots; -1 where it could not be counted, -2 where no equilibrium was
        found, -3 where the mass matrix is singular on the way there.
    area : float
        Its share of the plane.
    place : array (2,)
        Parameters well inside it, SI.
    loops : tuple of arrays (k, 2)
        Its outline and holes in it, SI.
    nodes, disagreeing : int
        Places at which the search counted within it, and how many of them have another number.
    """

    unstable: int
    area: float
    place: Reals
    loops: tuple[Reals, ...]
    nodes: int
    disagreeing: int

    def __eq__(self, other: object) -> bool:
        """Compare bit by bit."""
        return same(self, other) if isinstance(other, ChartRegion) else NotImplemented

    __hash__ = None  # type: ignore[assignment]


@dataclass(frozen=True, kw_only=True, eq=False)
class Chart:
    """A stability chart of a plane of two parameters.

    Parameters
    ----------
    parameters : (str, str)
        The parameters.
    spans : ((float, float), (float, float))
        Their intervals, SI.
    boundaries : tuple of ChartBoundary
        What parts the regions.
    regions : tuple of ChartRegion
        The largest first.
    node_values : array (N, 2)
        Where the search counted.
    node_counts : int array (N,)
        What it counted there; negative as in `ChartRegion`.
    system : SystemInfo
        What it was computed from; its parameters hold besides the two.
    map : ChartMap, optional
        A map that was asked for.
    curves : tuple of ChartCurve
        Curves of other points over it, such as folds of cycles.
    operator : {"exact", "realised"}
        Whose characteristic roots.
    depth : int
        The search divided cells that might hide a boundary down to a ``2**-depth``-th of a span.
    unexplained : int
        Places between neighbouring nodes where counts differ for no boundary that was found.
    torn : int
        Places between neighbouring nodes where more than one equilibrium is continued.
    evaluations : int
        Characteristic matrices, and derivatives of them, that the boundaries took.
    per_count : float
        Mean number of determinants of one count.
    troubles : tuple of str
        What went wrong.
    seconds : float
        How long it took; not saved, and not compared.
    """

    parameters: tuple[str, str]
    spans: tuple[Span, Span]
    boundaries: tuple[ChartBoundary, ...]
    regions: tuple[ChartRegion, ...]
    node_values: Reals
    node_counts: NDArray[np.int64]
    system: SystemInfo
    map: ChartMap | None = None
    curves: tuple[ChartCurve, ...] = ()
    operator: str = "exact"
    depth: int = 0
    unexplained: int = 0
    torn: int = 0
    evaluations: int = 0
    per_count: float = 0.0
    troubles: tuple[str, ...] = ()
    seconds: float = field(default=0.0, compare=False)

    def __eq__(self, other: object) -> bool:
        """Compare bit by bit; how long it took is left out."""
        return same(self, other) if isinstance(other, Chart) else NotImplemented

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        """Return one line: of what, how many boundaries, which regions."""
        numbers = ", ".join(describe_count(region.unstable) for region in self.regions)
        return (
            f"<stability chart of {self.system.model} over {', '.join(self.parameters)}: "
            f"{len(self.boundaries)} boundaries, unstable roots by region: {numbers}>"
        )

    def _repr_html_(self) -> str:
        """Return what a notebook shows."""
        from racs_bif.results.shown import chart_card

        return chart_card(self)

    @property
    def early(self) -> bool:
        """Whether something that was looked for may be missing."""
        return bool(self.unexplained or self.troubles) or not all(
            boundary.complete for boundary in self.boundaries
        )

    @property
    def remarks(self) -> tuple[str, ...]:
        """What is to be known about a chart in which nothing went wrong."""
        told = []
        if self.torn:
            told.append(
                "More than one equilibrium is continued over part of the plane, between its folds; "
                "the counts there are those of one of them."
            )
        if self.depth:
            cell = f"1/{2**self.depth} of a span"
            found = self.smallest_island
            size = "" if found is None else f"; the smallest found is {found:.2g} of a span across"
            told.append(
                f"An island smaller than {cell} may be missed where nothing points to it, and near "
                f"another boundary a larger one{size}. A greater depth, and more cells to begin "
                "with, search more finely."
            )
        return tuple(told)

    @property
    def smallest_island(self) -> float | None:
        """Greatest extent of the smallest closed boundary, in spans; None where none is closed."""
        width = np.diff(np.array(self.spans), axis=1)[:, 0]
        sizes = [
            float((np.ptp(boundary.line, axis=0) / width).max())
            for boundary in self.boundaries
            if boundary.closed
        ]
        return min(sizes) if sizes else None

    @property
    def nominal(self) -> Reals | None:
        """The model's own values of the two parameters (2,); None where they are outside."""
        own = np.array([self.system.parameters[name] for name in self.parameters])
        low, high = np.array(self.spans).T
        return own if bool(np.all((own >= low) & (own <= high))) else None

    def unstable_at(self, **values: float) -> int:
        """Return the number of unstable roots at a place, from the region that it is in.

        Parameters
        ----------
        **values : float
            Both parameters by name, SI.

        Returns
        -------
        int
            As of `ChartRegion`; -1 exactly on a boundary.

        Raises
        ------
        UsageError
            If a parameter is missing, or the place is outside the chart.
        """
        first, second = self.parameters
        if set(values) != {first, second}:
            msg = f"give both parameters of the chart, {first} and {second}"
            raise UsageError(msg)
        place = np.array([[values[first], values[second]]])
        low, high = np.array(self.spans).T
        if not bool(np.all((place >= low) & (place <= high))):
            where = f"{first} = {values[first]:g}, {second} = {values[second]:g}"
            msg = f"{where} is outside the chart; compute it over wider spans"
            raise UsageError(msg)
        return int(self.unstable_on(place)[0])

    def unstable_on(self, values: Reals) -> NDArray[np.int64]:
        """Return the numbers of unstable roots (N,) at places of the chart, from its regions.

        Parameters
        ----------
        values : array (N, 2)
            Both parameters, SI, within the chart.

        Returns
        -------
        int array (N,)
            As of `ChartRegion`; -1 exactly on a boundary, and in a region of which the search
            counted differently at the nearest place.
        """
        low, high = np.array(self.spans).T
        unit = np.clip((values - low) / (high - low), _EDGE, 1.0 - _EDGE)
        found = np.full(len(unit), -1, dtype=np.int64)
        doubtful = np.zeros(len(unit), dtype=bool)
        for region in self.regions:
            outline, *holes = ((loop - low) / (high - low) for loop in region.loops)
            inside = Face(outline, tuple(holes)).contains(unit)
            found[inside] = region.unstable
            doubtful |= inside & (region.disagreeing > 0)
        if np.any(doubtful):
            known = self.node_counts != -1
            nodes = (self.node_values[known] - low) / (high - low)
            near = [int(np.hypot(*(nodes - place).T).argmin()) for place in unit[doubtful]]
            same = self.node_counts[known][near] == found[doubtful]
            found[doubtful] = np.where(same, found[doubtful], -1)
        return found

    def to_dataframe(self) -> pd.DataFrame:
        """Return the points of all boundaries as a table, a point a row."""
        import pandas as pd

        tables = []
        for k, boundary in enumerate(self.boundaries):
            columns: dict[str, object] = {"boundary": k + 1, "kind": boundary.kind}
            columns |= dict(zip(self.parameters, boundary.values.T, strict=True))
            columns |= {"omega": boundary.omega, "l1": boundary.l1}
            tables.append(pd.DataFrame(columns))
        names = ["boundary", "kind", *self.parameters, "omega", "l1"]
        return pd.concat(tables, ignore_index=True) if tables else pd.DataFrame(columns=names)

    def to_xarray(self, shape: tuple[int, int] = (200, 200)) -> xr.Dataset:
        """Return the plane as a data set; see `racs_bif.results.arrays.chart_dataset`."""
        from racs_bif.results.arrays import chart_dataset

        return chart_dataset(self, shape)

    def plot(self, *, ax: Axes | None = None) -> Axes:
        """Draw the chart; see `racs_bif.plots.chart.draw`."""
        from racs_bif.plots.chart import draw

        return draw(self, ax=ax)


def describe_count(unstable: int) -> str:
    """Return a number of unstable roots in words.

    Examples
    --------
    >>> describe_count(0), describe_count(2), describe_count(-2)
    ('stable', '2 unstable', 'no equilibrium')
    """
    words = {0: "stable", -1: "unknown", -2: "no equilibrium", -3: "beyond singular mass"}
    return words.get(unstable, f"{unstable} unstable")
