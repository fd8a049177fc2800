"""Stability charts of one plane at several values of a third parameter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from racs_bif.results.same import same

if TYPE_CHECKING:
    from collections.abc import Iterator

    import pandas as pd
    import xarray as xr
    from matplotlib.figure import Figure

    from racs_bif.results.chart import Chart


@dataclass(frozen=True, kw_only=True, eq=False)
class ChartSlices:
    """Charts of the same plane at several values of a third parameter.

    Parameters
    ----------
    parameter : str
        The third parameter.
    charts : tuple of Chart
        One for each value, which is among the parameters of the chart's system.
    """

    parameter: str
    charts: tuple[Chart, ...]

    def __len__(self) -> int:
        """Return the number of slices."""
        return len(self.charts)

    def __iter__(self) -> Iterator[Chart]:
        """Iterate over the charts."""
        return iter(self.charts)

    def __eq__(self, other: object) -> bool:
        """Compare bit by bit."""
        return same(self, other) if isinstance(other, ChartSlices) else NotImplemented

    __hash__ = None  # type: ignore[assignment]

    @property
    def values(self) -> tuple[float, ...]:
        """Values of the third parameter, SI."""
        return tuple(chart.system.parameters[self.parameter] for chart in self.charts)

    @property
    def early(self) -> bool:
        """Whether something that was looked for may be missing in one of them."""
        return any(chart.early for chart in self.charts)

    def to_dataframe(self) -> pd.DataFrame:
        """Return the boundaries of all slices as one table, a point a row."""
        import pandas as pd

        tables = [
            chart.to_dataframe().assign(**{self.parameter: value})
            for chart, value in zip(self.charts, self.values, strict=True)
        ]
        return pd.concat(tables, ignore_index=True)

    def to_xarray(self, shape: tuple[int, int] = (200, 200)) -> xr.Dataset:
        """Return the planes as one data set, the third parameter its last dimension."""
        import xarray as xr

        unit = self.charts[0].system.unit(self.parameter)
        third = xr.DataArray(list(self.values), dims=self.parameter, attrs={"units": unit})
        planes = [chart.to_xarray(shape) for chart in self.charts]
        whole: xr.Dataset = xr.concat(planes, dim=third.assign_coords({self.parameter: third}))
        return whole.transpose(..., self.parameter)

    def plot(self) -> Figure:
        """Draw all on one figure; see `racs_bif.plots.chart.picture_slices`."""
        from racs_bif.plots.chart import picture_slices

        return picture_slices(self)
